"""Rings of a frame: circles of its arcs, refined to ellipses, each with its evidence and its profile."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from springline.imaging.chains import smooth_arcs
from springline.imaging.circles import circles_of, kasa_circle, smallest_radius
from springline.imaging.evidence import Support, rank, support
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from springline.imaging.edges import EdgeField

    Array = NDArray[np.float64]

_HOPEFUL = 8.0  # evidence of a circle that is looked at again
_MOST = 40  # circles refined
_CLIMBED = 12  # rings whose ellipse is moved to the most evidence
_TURN = 0.4  # share of the turn in which points must lie before an ellipse is fitted to them
_PROFILE = 16  # px inside and outside that a profile spans
_NARROW = 4  # px within which the edge of a joint bends
_OBVIOUS = 3.0  # least height of a lit rim in the profile


@dataclass(frozen=True)
class Shape:
    """What rings may look like.

    Attributes:
        one_sense: Whether the light must rise, or fall, outwards all round: true of a joint, not of an opening.
        least_ratio: Of the axes.
        flatness: One-sigma of how far the axes differ, relative.
    """

    one_sense: bool = True
    least_ratio: float = 0.8
    flatness: float = 0.05


JOINT_SHAPE = Shape()


@dataclass(frozen=True)
class Ring:
    """An ellipse that edges bear out.

    Attributes:
        ellipse: (5,) as in `evidence`, in working pixels.
        sense: +1 where the light rises outwards, -1 where it falls, 0 where either counts.
        support: Its evidence.
        sharpness: Largest bend of the light across it within 4 px, relative to all change within 10 px.
        rim: How far outside a lit rim runs along it [px]; 0 where there is none.
        shape: What it was allowed to look like.
    """

    ellipse: Array
    sense: float
    support: Support
    sharpness: float = math.nan
    rim: float = 0.0
    shape: Shape = JOINT_SHAPE

    @property
    def evidence(self) -> float:
        """Logarithm of the likelihood ratio, less what its flattening costs."""
        return self.support.evidence - _flattening(self.ellipse, self.shape)

    @property
    def on_rim(self) -> Array:
        """The ellipse moved onto its lit rim."""
        moved = self.ellipse.copy()
        moved[2:4] += self.rim
        return moved


def find_rings(field: EdgeField, cost: Callable[[Array], Array], shape: Shape = JOINT_SHAPE) -> list[Ring]:
    """Return the rings of a frame, most evidence first; many may belong to one joint.

    Args:
        field: Edge field of the frame.
        cost: What the place of ellipses (n, 5) costs them, in units of evidence.
        shape: What they may look like.

    Returns:
        Rings with their evidence; profiles are not taken yet.
    """
    circles, senses = circles_of(smooth_arcs(field), field.diagonal, one_sense=shape.one_sense)
    hopeful = cost(circles) < 30.0
    circles, senses = circles[hopeful], senses[hopeful]
    if not len(circles):
        return []
    merit = rank(field, circles, senses) - cost(circles)
    rings = []
    for k in _distinct(circles, senses, merit):
        ring = _refined(field, circles[k], float(senses[k]), cost, shape)
        if ring is not None:
            rings.append(ring)
    rings.sort(key=lambda ring: -_merit(ring, cost))
    rings = [_climbed(field, ring, cost) for ring in rings[:_CLIMBED]] + rings[_CLIMBED:]
    return sorted(rings, key=lambda ring: -_merit(ring, cost))


def with_profile(field: EdgeField, ring: Ring) -> Ring:
    """Return the ring with its sharpness and rim, from the median light across it where it was hit."""
    light = _profile(field, ring)
    bend = light[8:25] - 0.5 * (light[8 - _NARROW : 25 - _NARROW] + light[8 + _NARROW : 25 + _NARROW])
    change = float(np.ptp(light[6:27])) + 4.0
    sharpness = 2.0 * float(np.abs(bend[2:15]).max()) / change
    place = int(np.argmax(bend[3:14])) + 3 + 8
    place = place - 2 + int(np.argmax(light[place - 2 : place + 3]))
    beside = max(light[max(place - 8, 0) : place].min(), light[place + 1 : place + 9].min())
    height = float(light[place] - beside)
    lit = height > 0.12 * change and height > _OBVIOUS
    return replace(ring, sharpness=sharpness, rim=float(place - _PROFILE) if lit else 0.0)


def _merit(ring: Ring, cost: Callable[[Array], Array]) -> float:
    return ring.evidence - float(cost(ring.ellipse[None])[0])


def _flattening(ellipse: Array, shape: Shape) -> float:
    return 0.5 * ((1.0 - float(ellipse[3] / ellipse[2])) / shape.flatness) ** 2


def _distinct(circles: Array, senses: Array, merit: Array) -> list[int]:
    """The hopeful circles, best first, leaving out near copies of better ones."""
    kept: list[int] = []
    for k in np.argsort(-merit):
        if merit[k] < _HOPEFUL or len(kept) == _MOST:
            break
        chosen = np.array(kept, dtype=int)
        apart = np.abs(circles[chosen, :3] - circles[k, :3]).sum(axis=1)
        if not np.any((senses[chosen] == senses[k]) & (apart < max(4.0, 0.05 * circles[k, 2]))):
            kept.append(int(k))
    return kept


def _refined(field: EdgeField, circle: Array, sense: float, cost: Callable[[Array], Array], like: Shape) -> Ring | None:
    """The best of the circle and the ellipses fitted to the points that it hits."""
    best: Ring | None = None
    shape = circle
    for attempt in range(3):
        ring = Ring(shape.copy(), sense, support(field, shape, sense), shape=like)
        merit = ring.support.evidence - float(cost(shape[None])[0])
        if best is None or merit > best.support.evidence - float(cost(best.ellipse[None])[0]):
            best = ring
        hit = support(field, shape, sense, reach=1.8 if attempt else 2.5).points
        fitted = _ellipse(field.points[hit, :2], shape, like.least_ratio) if len(hit) >= 10 else None
        if fitted is None or not smallest_radius() < fitted[2] < 1.6 * field.diagonal:
            break
        shape = fitted
    return best


def _ellipse(points: Array, near: Array, least_ratio: float) -> Array | None:
    """Ellipse through points spread over enough of the turn, else a circle."""
    turn = np.arctan2(points[:, 1] - near[1], points[:, 0] - near[0])
    if np.mean(np.histogram(turn, 24, (-np.pi, np.pi))[0] > 0) >= _TURN and len(points) >= 12:
        cv2 = opencv()
        (x, y), (width, height), degrees = cv2.fitEllipseDirect(points.astype(np.float32))
        angle = math.radians(degrees) + (0.0 if width >= height else 0.5 * math.pi)
        axes = sorted((0.5 * width, 0.5 * height), reverse=True)
        if np.isfinite([x, y, *axes]).all() and axes[1] >= least_ratio * axes[0]:
            return np.array([x, y, *axes, angle])
    centre, radius = kasa_circle(points)
    return np.array([*centre, radius, radius, 0.0]) if math.isfinite(radius) else None


_MOVES = np.array(
    [
        [1, 0, 0, 0],
        [0, 1, 0, 0],
        [0, 0, 1, 1],
        [1, 0, 1, 1],
        [1, 0, -1, -1],
        [0, 1, 1, 1],
        [0, 1, -1, -1],
        [0, 0, 1, -1],
    ],
    dtype=float,
)


def _climbed(field: EdgeField, ring: Ring, cost: Callable[[Array], Array]) -> Ring:
    """The ring moved and resized in small steps while its evidence grows."""
    best, merit = ring, _merit(ring, cost)
    for step in (2.5, 1.2):
        for _ in range(3):
            before = best
            trial = np.repeat(best.ellipse[None], 2 * len(_MOVES), axis=0)
            trial[:, :4] += step * np.concatenate([_MOVES, -_MOVES])
            upright = trial[:, 3] > trial[:, 2]
            trial[upright, 2:4] = trial[upright, 3:1:-1]
            trial[upright, 4] += 0.5 * math.pi
            trial = trial[trial[:, 3] >= smallest_radius()]
            if not len(trial):
                break
            merits = rank(field, trial, np.full(len(trial), ring.sense)) - cost(trial)
            merits -= np.array([_flattening(one, ring.shape) for one in trial])
            if merits.max() > merit + 0.5:
                shape = trial[int(np.argmax(merits))]
                best = Ring(shape, ring.sense, support(field, shape, ring.sense), shape=ring.shape)
                merit = float(merits.max())
            if best is before:
                break
    return best


def _profile(field: EdgeField, ring: Ring) -> Array:
    """Median light at -16 ... 16 px across the ring, over the samples that were hit."""
    cv2 = opencv()
    column, row, major, minor, angle = ring.ellipse
    hits = ring.support.hits
    turn = 2.0 * np.pi * np.flatnonzero(hits > 0) / len(hits)
    u, v = major * np.cos(turn), minor * np.sin(turn)
    out_u, out_v = minor * np.cos(turn), major * np.sin(turn)
    length = np.hypot(out_u, out_v)
    away = np.arange(-_PROFILE, _PROFILE + 1.0)
    u = u[:, None] + away * (out_u / length)[:, None]
    v = v[:, None] + away * (out_v / length)[:, None]
    cos, sin = math.cos(angle), math.sin(angle)
    x, y = (column + cos * u - sin * v).astype(np.float32), (row + sin * u + cos * v).astype(np.float32)
    return np.median(cv2.remap(field.light, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), axis=0)
