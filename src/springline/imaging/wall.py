"""Joints and laterals of one frame placed on the pipe, with lens and pose.

The frame is laid out on the wall, where the edge of a round lateral is nearly a circle whatever the view; circles are
found there by the same evidence as joints are in frames, and what they hit is then fitted in the frame itself, pose and
all. Joints are lines across the wall laid out (`seams`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.camera import camera_eye, from_pixels
from springline.imaging.decision import verdict
from springline.imaging.edges import edge_field
from springline.imaging.frames import checked_frame
from springline.imaging.reprojection import Place, PosePrior, fit_joint, fit_lateral
from springline.imaging.rings import Shape, find_rings, with_profile
from springline.imaging.seams import seam_odds, seams_of_frame
from springline.imaging.unwrapping import wall_grid

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens
    from springline.imaging.reprojection import ContourFit
    from springline.imaging.rings import Ring
    from springline.imaging.seams import Seams

    Array = NDArray[np.float64]

_OPENING = Shape(one_sense=False, least_ratio=0.55, flatness=0.3)
_FINE = 75  # cells of the laid out wall per radius of the pipe
_NEUTRAL = 60.0  # evidence of a lateral's edge that speaks neither for nor against it
_TEMPER = 25.0  # evidence is divided by it: samples beside one another see the same edge


@dataclass(frozen=True)
class WallRules:
    """What counts as a lateral or a joint on the wall.

    Attributes:
        nearest, farthest: Of the wall ahead that is looked at for laterals, in radii of the pipe.
        seam: Least score of a joint's line.
        evidence: Least evidence of a lateral's edge.
        coverage: Least share of its edge that is seen.
        sharpness: Least sharpness of its edge.
        odds: Least log odds of a lateral against a joint and anything else.
        noise: Least one-sigma of an edge's points that is believed [px].
        bores: Smallest and largest lateral, in radii of the pipe.
        usual: The usual lateral, in radii of the pipe, and the one-sigma of its logarithm.
    """

    nearest: float = 0.4
    farthest: float = 3.0
    seam: float = 5.0
    evidence: float = 50.0
    coverage: float = 0.6
    sharpness: float = 0.3
    odds: float = 0.0
    noise: float = 0.7
    bores: tuple[float, float] = (0.12, 0.9)
    usual: tuple[float, float] = (0.4, 0.45)


@dataclass(frozen=True)
class Mark:
    """A joint or a lateral of one frame, on the pipe.

    Attributes:
        kind: joint or lateral.
        x: Along the pipe, in the frame of the pose [m], and its one-sigma; of a lateral where its axis meets the wall.
        bearing: Of a lateral [rad], and its one-sigma; NaN for a joint.
        radius: Of a lateral's bore [m], and its one-sigma; NaN for a joint.
        inclination: Of a lateral's bore [rad]; NaN for a joint.
        odds: Log odds that it is there, by this frame alone.
        coverage: Share of its edge that was seen.
        ahead: How far ahead of the camera it is [m].
    """

    kind: str
    x: float
    x_sigma: float
    bearing: float
    bearing_sigma: float
    radius: float
    radius_sigma: float
    inclination: float
    odds: float
    coverage: float
    ahead: float


@dataclass(frozen=True)
class Looked:
    """What one frame shows.

    Attributes:
        marks: Joints and laterals, joints first.
        seams: How much each place looks like a joint; None where too little of the wall is seen.
        eye: x of the camera [m].
    """

    marks: list[Mark]
    seams: Seams | None
    eye: float


def marks_of_frame(
    image: NDArray[np.uint8],
    matrix: ArrayLike,
    lens: Lens,
    centre: ArrayLike,
    r1: float,
    r2: float,
    *,
    prior: PosePrior | None = None,
    rules: WallRules | None = None,
) -> Looked:
    """Return the joints and laterals of a frame.

    Args:
        image: (row, column) or (row, column, 3) of 8 bits.
        matrix: (4, 4) pose of the camera, as of `geometry.camera.camera_matrix`.
        lens: The lens.
        centre: Column and row of its principal point [px].
        r1, r2: Semi-axes of the pipe along z and y [m].
        prior: How far the pose may be off.
        rules: What counts as a lateral or a joint.

    Returns:
        Looked.

    Raises:
        InputError: The image's shape, type or size is out of range.
        ParameterError: A number is out of range.
        MissingExtraError: OpenCV is not installed.
    """
    image = checked_frame(image)
    matrix = np.asarray(matrix, dtype=float)
    rules, prior = rules or WallRules(), prior or PosePrior()
    view = _View(image, matrix, lens, np.asarray(centre, dtype=float), r1, r2, prior, rules)
    seams = seams_of_frame(image, matrix, lens, centre, r1, r2, prior=prior)
    return Looked(view.joints(seams) + view.laterals(), seams, view.eye_x)


@dataclass(frozen=True)
class _View:
    image: NDArray[np.uint8]
    matrix: Array
    lens: Lens
    centre: Array
    r1: float
    r2: float
    prior: PosePrior
    rules: WallRules

    @property
    def eye_x(self) -> float:
        return float(camera_eye(self.matrix)[0])

    def joints(self, seams: Seams | None) -> list[Mark]:
        if seams is None:
            return []
        unknown = (math.nan,) * 5
        return [
            Mark("joint", x, sigma, *unknown, seam_odds(score, expected=False), 1.0, x - self.eye_x)
            for score, x, sigma in seams.peaks(self.rules.seam)
        ]

    def laterals(self) -> list[Mark]:
        rules, radius = self.rules, max(self.r1, self.r2)
        step = radius / _FINE
        x = self.eye_x + np.arange(rules.nearest * radius, rules.farthest * radius, step)
        columns = round(2.0 * math.pi * _FINE)
        grid = wall_grid(
            self.matrix, self.lens, self.centre, self.r1, self.r2, x, columns=columns, first_bearing=-0.5 * math.pi
        )
        laid, seen = grid.unwrap(self.image), grid.seen(self.image.shape[:2])
        field = edge_field(laid, seen=seen)
        if field is None:
            return []
        found: list[tuple[Ring, Mark]] = []
        for ring in find_rings(field, self._size_cost, _OPENING):
            evidence = ring.evidence - float(self._size_cost(ring.ellipse[None])[0])
            if evidence < rules.evidence or ring.support.coverage < rules.coverage:
                continue
            if any(_overlap(ring.ellipse, other.ellipse) for other, _ in found):
                continue
            ring = with_profile(field, ring)
            if ring.sharpness < rules.sharpness:
                continue
            hit = field.points[ring.support.hits[ring.support.hits > 0] - 1, :2]
            pixels = np.stack([_at(grid.columns, hit), _at(grid.rows, hit)], axis=-1)
            near = Place(bearing=float(grid.bearing[0] + ring.ellipse[0] / _FINE), bearing_sigma=0.3)
            fits = [
                fit(
                    from_pixels(pixels, self.centre),
                    self.matrix,
                    self.lens,
                    self.r1,
                    self.r2,
                    prior=self.prior,
                    noise=rules.noise,
                    near=near,
                )
                for fit in (fit_lateral, fit_joint)
            ]
            odds = verdict(*fits)
            if fits[0] and odds >= rules.odds:
                found.append((ring, self._mark(fits[0], ring, (evidence - _NEUTRAL) / _TEMPER)))
        return [mark for _, mark in found]

    def _size_cost(self, ellipses: Array) -> Array:
        """Circles that no lateral has are out of the question, unusual ones cost what the prior says."""
        size = np.sqrt(ellipses[:, 2] * ellipses[:, 3]) / _FINE
        small, large = self.rules.bores
        usual, spread = self.rules.usual
        cost = 0.5 * (np.log(size / usual) / spread) ** 2
        return np.where((size < small) | (size > large), 1e3, cost)

    def _mark(self, fit: ContourFit, ring: Ring, odds: float) -> Mark:
        # an inclined bore leaves the wall elsewhere than its axis meets the pipe's
        tilt, reach = fit.value("inclination"), math.sqrt(self.r1 * self.r2)
        slope = np.zeros(len(fit.parameters))
        slope[0], slope[-1] = 1.0, reach / math.cos(tilt) ** 2
        x, x_sigma = fit.value("x") + reach * math.tan(tilt), math.sqrt(float(slope @ fit.covariance @ slope))
        return Mark(
            "lateral",
            x,
            x_sigma / ring.support.coverage,
            fit.value("bearing"),
            fit.sigma("bearing"),
            fit.value("radius"),
            fit.sigma("radius"),
            tilt,
            odds,
            ring.support.coverage,
            x - self.eye_x,
        )


def _overlap(one: Array, other: Array) -> bool:
    return bool(np.hypot(*(one[:2] - other[:2])) < max(one[2], other[2]))


def _at(values: NDArray[np.float32], places: Array) -> Array:
    """Values of a grid between its cells, at (column, row)."""
    column = np.clip(places[:, 0], 0.0, values.shape[1] - 1.001)
    row = np.clip(places[:, 1], 0.0, values.shape[0] - 1.001)
    left, top = column.astype(int), row.astype(int)
    u, v = column - left, row - top
    upper = values[top, left] * (1.0 - u) + values[top, left + 1] * u
    lower = values[top + 1, left] * (1.0 - u) + values[top + 1, left + 1] * u
    return upper * (1.0 - v) + lower * v
