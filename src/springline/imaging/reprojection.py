"""Laterals and joints fitted to a contour seen in a frame, by casting its points back onto the pipe's wall.

A point of the contour is a ray from the camera; where it meets the wall, it is off the edge of the model by so much,
and by first order so many pixels. That needs no pairing of points with the model, works for any part of the contour
that is seen, and takes any lens. The camera's pose is known up to a prior and is fitted along with the model.

Pipe frame of `springline.conventions`, an elliptical pipe z^2/r1^2 + y^2/r2^2 = 1; lengths in metres, angles in
radians, images with z right and y up from the principal point [px].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.camera import camera_eye, rays
from springline.geometry.checks import finite, positive
from springline.imaging._casting import WIDE, cast, information, solve, whole_cost
from springline.imaging._evidence import disorder, occam, stain

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens

    Array = NDArray[np.float64]

POSE = ("x", "offset_y", "offset_z", "pitch", "yaw", "roll")
"""Parameters that both models share: where the model lies along the pipe, and what the camera's pose is off."""

LATERAL = (*POSE, "bearing", "log_radius", "inclination")
JOINT = (*POSE, "ovality")

EXPECTED = 0.437
"""Mean cost of a point that is off by the noise alone: the Cauchy loss at 3 sigmas averaged over a Gaussian."""

_STEPS = 40
_GOOD = 1.3  # times what noise alone would cost, below which no further starts are tried
_FEWEST = 8
_FARTHEST = 60.0  # radii along the pipe beyond which a point tells nothing of the start
_USUAL = (0.08, 0.3)  # radii of the pipe, of a bore where geometry proposes one
_LEAN = 0.6  # rad of inclination from which a fit is begun too
_SMALLEST = 0.03  # least bore to begin with, in radii


@dataclass(frozen=True)
class PosePrior:
    """How far the camera's pose may be off, one-sigma of each part; 0 holds it.

    Attributes:
        offset: Of the camera across the pipe, each way [m].
        turn: Of pitch, yaw and roll, each [rad].
    """

    offset: float = 0.0
    turn: float = 0.0


@dataclass(frozen=True)
class Place:
    """Where geometry says that something is; what it does not say is None.

    Attributes:
        x: Along the pipe [m].
        x_sigma: Its one-sigma [m].
        bearing: From +z counter-clockwise [rad]; of laterals alone.
        bearing_sigma: Its one-sigma [rad].
    """

    x: float | None = None
    x_sigma: float = 0.1
    bearing: float | None = None
    bearing_sigma: float = math.radians(10.0)


@dataclass(frozen=True)
class ContourFit:
    """A model fitted to a contour; falsy when it could not be.

    Attributes:
        kind: lateral or joint.
        parameters: (9) of `LATERAL` or (7) of `JOINT`.
        covariance: Of the parameters, from the curvature at the solution and the prior.
        cost: Robust misfit plus what the prior says, half a sum of squares where all is well.
        noise: One-sigma of the contour's points that was used [px].
        points: How many points were used.
        evidence: Log likelihood of the contour for any lateral, or any joint, within the prior, up to what both share.
        stain: Log odds of an irregular outline of that size against the lateral; of a joint minus infinity.
        reason: Why there is no fit.
    """

    kind: str
    parameters: Array
    covariance: Array
    cost: float
    noise: float
    points: int
    evidence: float = -math.inf
    stain: float = -math.inf
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason

    def value(self, name: str) -> float:
        """Return a parameter by its name; `radius` of a lateral in metres too."""
        if name == "radius" and self.kind == "lateral":
            return math.exp(self.parameters[LATERAL.index("log_radius")])
        return float(self.parameters[(LATERAL if self.kind == "lateral" else JOINT).index(name)])

    def sigma(self, name: str) -> float:
        """Return the one-sigma of a parameter by its name."""
        if name == "radius" and self.kind == "lateral":
            return self.sigma("log_radius") * self.value("radius")
        place = (LATERAL if self.kind == "lateral" else JOINT).index(name)
        return math.sqrt(max(float(self.covariance[place, place]), 0.0))


def contour_noise(contour: ArrayLike) -> float:
    """Return the one-sigma of a contour's points [px] from its roughness, so that any smooth shape counts as none.

    Args:
        contour: (n, 2) in order along it; gaps and rows of NaN are allowed.

    Returns:
        Sigma across and along together, per coordinate; NaN below five points.

    >>> turn = np.linspace(0.0, 6.0, 200)
    >>> circle = 90.0 * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    >>> bool(contour_noise(circle) < 0.2)
    True
    """
    points = np.asarray(contour, dtype=float)
    points = points[np.isfinite(points).all(axis=-1)]
    if len(points) < 5:
        return math.nan
    bend = points[:-4] - 4 * points[1:-3] + 6 * points[2:-2] - 4 * points[3:-1] + points[4:]
    size = np.abs(bend)
    kept = size <= 4.0 * 1.4826 * np.median(size)  # corners and joins of pieces are no noise
    return float(np.sqrt(np.mean(bend[kept] ** 2) / 70.0))


def fit_lateral(
    contour: ArrayLike,
    matrix: ArrayLike,
    lens: Lens,
    r1: float,
    r2: float,
    *,
    prior: PosePrior | None = None,
    noise: float | None = None,
    inclination_sigma: float = math.radians(15.0),
    near: Place | None = None,
) -> ContourFit:
    """Fit the edge of a round lateral to a contour.

    Args:
        contour: (n, 2) z and y of points of the contour, in order [px]; rows of NaN are not seen.
        matrix: (4, 4) pose of the camera, as of `geometry.camera.camera_matrix`.
        lens: The lens.
        r1, r2: Semi-axes of the pipe along z and y [m].
        prior: How far the pose may be off; known exactly when not given.
        noise: One-sigma of the points [px]; from the contour's own roughness when not given.
        inclination_sigma: One-sigma of the bore's inclination [rad].
        near: Where geometry says that something is.

    Returns:
        ContourFit whose x is that of the bore's axis at the pipe's axis.

    Raises:
        ParameterError: A shape does not fit or a number is out of range.

    Source: 6.4 turned round; the edge of `geometry.openings.lateral_contour`.
    """
    return _fit("lateral", contour, matrix, lens, (r1, r2), prior, noise, inclination_sigma, near)


def fit_joint(
    contour: ArrayLike,
    matrix: ArrayLike,
    lens: Lens,
    r1: float,
    r2: float,
    *,
    prior: PosePrior | None = None,
    noise: float | None = None,
    ovality_sigma: float = 0.05,
    near: Place | None = None,
) -> ContourFit:
    """Fit a joint, the pipe's whole section at one x, to a contour; arguments as for `fit_lateral`.

    Args:
        contour, matrix, lens, r1, r2, prior, noise, near: As for `fit_lateral`.
        ovality_sigma: One-sigma of how much wider, and so much lower, the section may be there, relative.

    Returns:
        ContourFit.

    Raises:
        ParameterError: A shape does not fit or a number is out of range.

    Source: 6.4; the ring of `geometry.openings.joint_contour`.
    """
    return _fit("joint", contour, matrix, lens, (r1, r2), prior, noise, ovality_sigma, near)


def _fit(
    kind: str,
    contour: ArrayLike,
    matrix: ArrayLike,
    lens: Lens,
    radii: tuple[float, float],
    prior: PosePrior | None,
    noise: float | None,
    last_sigma: float,
    near: Place | None,
) -> ContourFit:
    names = LATERAL if kind == "lateral" else JOINT
    points = finite("contour", contour)
    if points.ndim != 2 or points.shape[1] != 2:
        raise ParameterError(f"contour has shape {points.shape}", expected="(n, 2), z and y")
    matrix, radii_array = finite("matrix", matrix), positive("radii", radii)
    prior = prior or PosePrior()
    noise = contour_noise(points) if noise is None else float(noise)
    index = np.flatnonzero(np.isfinite(points).all(axis=1))
    seen = points[index]
    noise = max(noise, 0.3) if math.isfinite(noise) else math.nan
    sets = np.stack([rays(np.eye(4), seen + shift, lens) for shift in ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0])])
    fine = np.isfinite(sets).all(axis=(0, 2))
    sets, index = sets[:, fine], index[fine]
    if sets.shape[1] < _FEWEST or not math.isfinite(noise):
        return _nothing(kind, noise, sets.shape[1], f"{sets.shape[1]} points of the contour are seen, too few")
    eye = camera_eye(matrix)
    mean, sigma = np.zeros(len(names)), np.full(len(names), np.inf)
    sigma[1:3], sigma[3:6], sigma[-1] = max(prior.offset, 1e-9), max(prior.turn, 1e-9), last_sigma
    if near is not None and near.x is not None:
        mean[0], sigma[0] = near.x - eye[0], near.x_sigma
    if near is not None and near.bearing is not None and kind == "lateral":
        mean[6], sigma[6] = near.bearing, near.bearing_sigma
    best_cost, best = np.inf, None
    view = sets, matrix[:3, :3], eye, radii_array
    for wave in _poses(prior):
        for pose, tilt in wave:
            if tilt and kind == "joint":
                continue
            starts = [_start(kind, sets[0], matrix[:3, :3], eye, radii_array, pose, mean[6], tilt)]
            if kind == "lateral" and not tilt and np.isfinite(sigma[[0, 6]]).all():
                usual = [math.log(size * radii_array.min()) for size in _USUAL]
                starts += [np.array([mean[0], *pose[1:], mean[6], size, 0.0]) for size in usual]
            for start in starts:
                if start is None:
                    continue
                found, cost = solve(kind == "lateral", *view, start, mean, sigma, noise, _STEPS)
                if math.isfinite(cost):
                    cost = whole_cost(kind == "lateral", *view, found, mean, sigma, noise)
                if cost < best_cost:
                    best_cost, best = cost, found
        if best_cost < _GOOD * EXPECTED * sets.shape[1]:
            break
    if best is None:
        return _nothing(kind, noise, sets.shape[1], "no pose within the prior sees the contour on the wall")
    known = information(kind == "lateral", *view, best, sigma, noise)
    evidence = -best_cost - occam(known, sigma, float(radii_array.min()))
    irregular = -math.inf
    if kind == "lateral":
        irregular = stain(*view, best, mean, sigma, noise)
    else:
        evidence -= disorder(*view, best, noise, index)
    best[0] += eye[0]
    covariance = np.linalg.pinv(known, hermitian=True)
    return ContourFit(kind, best, covariance, best_cost, noise, sets.shape[1], evidence, irregular)


def _nothing(kind: str, noise: float, points: int, reason: str) -> ContourFit:
    size = len(LATERAL if kind == "lateral" else JOINT)
    return ContourFit(kind, np.full(size, np.nan), np.full((size, size), np.nan), np.inf, noise, points, reason=reason)


def _poses(prior: PosePrior) -> list[list[tuple[Array, float]]]:
    """Poses within the prior, and inclinations of a bore, from which a fit is begun.

    A second lot is for when none of the first leads to a good fit.
    """
    turn, offset = prior.turn, prior.offset
    turns = (0.0,) if turn < math.radians(3.0) else (-turn, 0.0, turn)
    tilts = [(pitch, yaw) for pitch in turns for yaw in turns]
    aside = [(offset, 0.0), (-offset, 0.0), (0.0, offset), (0.0, -offset)] if offset > 0.0 else []
    straight = (0.0, 0.0)
    first = [(*straight, *tilt, 0.0) for tilt in tilts] + [(*away, *straight, 0.0) for away in aside]
    first += [(*straight, *straight, lean) for lean in (_LEAN, -_LEAN)]
    second = [(*away, *tilt, 0.0) for away in aside for tilt in tilts if tilt != straight]
    return [[(np.array([0.0, *pose, 0.0]), lean) for *pose, lean in wave] for wave in (first, second)]


def _start(
    kind: str,
    directions: Array,
    axes: Array,
    eye: Array,
    radii: Array,
    pose: Array,
    bearing_near: float,
    tilt: float,
) -> Array | None:
    """A first guess at one pose: the middle of the points cast onto the wall."""
    places = np.empty((directions.shape[0], 3))
    if not cast(directions, axes, eye, radii, pose, places):
        return None
    ahead = np.abs(places[:, 0]) < _FARTHEST * radii.max()
    if ahead.sum() < _FEWEST:
        return None
    places = places[ahead]
    x = np.median(places[:, 0])
    if kind == "joint":
        return np.array([x, *pose[1:], 0.0])
    bearing = math.atan2(places[:, 1].mean(), places[:, 2].mean())
    # the turn of the bearing that is nearest to where geometry says
    bearing += 2.0 * math.pi * round((bearing_near - bearing) / (2.0 * math.pi))
    aside = places[:, 2] * -math.sin(bearing) + places[:, 1] * math.cos(bearing)
    size = math.sqrt(np.mean((places[:, 0] - x) ** 2 + aside**2))
    size = min(max(size, _SMALLEST * radii.min()), WIDE * radii.min())
    return np.array([x - radii.min() * math.tan(tilt), *pose[1:], bearing, math.log(size), tilt])
