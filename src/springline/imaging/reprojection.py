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
from numba import njit

from springline.errors import ParameterError
from springline.geometry.camera import camera_eye, rays
from springline.geometry.checks import finite, positive

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens

    Array = NDArray[np.float64]

POSE = ("x", "offset_y", "offset_z", "pitch", "yaw", "roll")
"""Parameters that both models share: where the model lies along the pipe, and what the camera's pose is off."""

LATERAL = (*POSE, "bearing", "log_radius", "inclination")
JOINT = (*POSE, "ovality")

ROBUST = 3.0
"""Sigmas beyond which a point counts less and less (Cauchy)."""

EXPECTED = 0.437
"""Mean cost of a point that is off by the noise alone: the Cauchy loss at 3 sigmas averaged over a Gaussian."""

_STEPS = 40
_GOOD = 1.3  # times what noise alone would cost, below which no further starts are tried
_FEWEST = 8
_FARTHEST = 60.0  # radii along the pipe beyond which a point tells nothing of the start
_USUAL = 0.3  # radii of the pipe, of a bore where geometry proposes one
_LEAN = 0.6  # rad of inclination from which a fit is begun too
_SMALLEST = 0.03  # least bore to begin with, in radii
_WIDE = 0.7  # bores beyond this share of the pipe's radius are unusual,
_WIDER = 0.1  # and this, relative, is how fast they become so


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
        reason: Why there is no fit.
    """

    kind: str
    parameters: Array
    covariance: Array
    cost: float
    noise: float
    points: int
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
    seen = points[np.isfinite(points).all(axis=1)]
    noise = max(noise, 0.3) if math.isfinite(noise) else math.nan
    sets = np.stack([rays(np.eye(4), seen + shift, lens) for shift in ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0])])
    sets = sets[:, np.isfinite(sets).all(axis=(0, 2))]
    if sets.shape[1] < _FEWEST or not math.isfinite(noise):
        nothing = np.full(len(names), np.nan)
        reason = f"{sets.shape[1]} points of the contour are seen, too few"
        return ContourFit(kind, nothing, np.full((len(names),) * 2, np.nan), np.inf, noise, sets.shape[1], reason)
    eye = camera_eye(matrix)
    mean, sigma = np.zeros(len(names)), np.full(len(names), np.inf)
    sigma[1:3], sigma[3:6], sigma[-1] = max(prior.offset, 1e-9), max(prior.turn, 1e-9), last_sigma
    if near is not None and near.x is not None:
        mean[0], sigma[0] = near.x - eye[0], near.x_sigma
    if near is not None and near.bearing is not None and kind == "lateral":
        mean[6], sigma[6] = near.bearing, near.bearing_sigma
    best_cost, best = np.inf, None
    for wave in _poses(prior):
        for pose, tilt in wave:
            if tilt and kind == "joint":
                continue
            starts = [_start(kind, sets[0], matrix[:3, :3], eye, radii_array, pose, mean[6], tilt)]
            if kind == "lateral" and not tilt and np.isfinite(sigma[[0, 6]]).all():
                usual = math.log(_USUAL * radii_array.min())
                starts.append(np.array([mean[0], *pose[1:], mean[6], usual, 0.0]))
            for start in starts:
                if start is None:
                    continue
                found, cost = _solve(
                    kind == "lateral", sets, matrix[:3, :3], eye, radii_array, start, mean, sigma, noise, _STEPS
                )
                if cost < best_cost:
                    best_cost, best = cost, found
        if best_cost < _GOOD * EXPECTED * sets.shape[1]:
            break
    if best is None:
        nothing = np.full(len(names), np.nan)
        reason = "no pose within the prior sees the contour on the wall"
        return ContourFit(kind, nothing, np.full((len(names),) * 2, np.nan), np.inf, noise, sets.shape[1], reason)
    information = _information(kind == "lateral", sets, matrix[:3, :3], eye, radii_array, best, sigma, noise)
    best[0] += eye[0]
    return ContourFit(kind, best, np.linalg.pinv(information, hermitian=True), best_cost, noise, sets.shape[1])


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
    if not _cast(directions, axes, eye, radii, pose, places):
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
    size = min(max(size, _SMALLEST * radii.min()), _WIDE * radii.min())
    return np.array([x - radii.min() * math.tan(tilt), *pose[1:], bearing, math.log(size), tilt])


@njit(cache=True)
def _turned(axes, pose):  # type: ignore[no-untyped-def]
    """Rows backwards, up and right of the camera turned about its own axes: yaw, pitch, roll."""
    n, v, u = axes[0].copy(), axes[1].copy(), axes[2].copy()
    cos, sin = math.cos(-pose[4]), math.sin(-pose[4])
    n, u = cos * n + sin * u, cos * u - sin * n
    cos, sin = math.cos(-pose[3]), math.sin(-pose[3])
    n, v = cos * n + sin * v, cos * v - sin * n
    cos, sin = math.cos(pose[5]), math.sin(pose[5])
    u, v = cos * u + sin * v, cos * v - sin * u
    return n, v, u


@njit(cache=True)
def _cast(directions, axes, eye, radii, pose, places):  # type: ignore[no-untyped-def]
    """Where rays meet the wall, x from the camera's; False when the camera is outside the pipe."""
    n, v, u = _turned(axes, pose)
    eye_y, eye_z = eye[1] + pose[1], eye[2] + pose[2]
    wy, wz = 1.0 / radii[1] ** 2, 1.0 / radii[0] ** 2
    c = wy * eye_y * eye_y + wz * eye_z * eye_z - 1.0
    if c >= -0.01:
        return False
    for k in range(directions.shape[0]):
        back, up, right = directions[k, 0], directions[k, 1], directions[k, 2]
        dx = back * n[0] + up * v[0] + right * u[0]
        dy = back * n[1] + up * v[1] + right * u[1]
        dz = back * n[2] + up * v[2] + right * u[2]
        a = max(wy * dy * dy + wz * dz * dz, 1e-12)
        b = wy * dy * eye_y + wz * dz * eye_z
        t = (-b + math.sqrt(b * b - a * c)) / a
        places[k, 0], places[k, 1], places[k, 2] = t * dx, eye_y + t * dy, eye_z + t * dz
    return True


@njit(cache=True)
def _off(lateral, places, parameters, out):  # type: ignore[no-untyped-def]
    """How far points of the wall lie off the model's edge [m]."""
    x = parameters[0]
    if not lateral:
        for k in range(places.shape[0]):
            out[k] = places[k, 0] - x
        return
    bearing, radius, tilt = parameters[6], math.exp(parameters[7]), parameters[8]
    ax, ay, az = math.sin(tilt), math.cos(tilt) * math.sin(bearing), math.cos(tilt) * math.cos(bearing)
    for k in range(places.shape[0]):
        qx, qy, qz = places[k, 0] - x, places[k, 1], places[k, 2]
        along = qx * ax + qy * ay + qz * az
        across = math.sqrt(max(qx * qx + qy * qy + qz * qz - along * along, 0.0))
        # the far side of the bore's axis is another wall: what lies there is off by the way round
        out[k] = (across if along > 0.0 else across - 2.0 * along) - radius


@njit(cache=True)
def _residuals(lateral, sets, axes, eye, radii, parameters, places, off, out):  # type: ignore[no-untyped-def]
    """How far each point is off [px], by first order; False when the parameters make no sense."""
    shape = radii
    if not lateral:
        shape = np.array([radii[0] * (1.0 + parameters[6]), radii[1] * (1.0 - parameters[6])])
    elif parameters[7] > math.log(1.02 * min(radii[0], radii[1])) or abs(parameters[8]) > 1.3:
        return False
    for which in range(3):
        if not _cast(sets[which], axes, eye, shape, parameters, places):
            return False
        _off(lateral, places, parameters, off[which])
    for k in range(out.shape[0]):
        right, up = off[1, k] - off[0, k], off[2, k] - off[0, k]
        out[k] = off[0, k] / math.sqrt(right * right + up * up + 1e-18)
    return True


@njit(cache=True)
def _excess(lateral, radii, parameters):  # type: ignore[no-untyped-def]
    """By how many sigmas a bore is unusually wide."""
    if not lateral:
        return 0.0
    return max(parameters[7] - math.log(_WIDE * min(radii[0], radii[1])), 0.0) / _WIDER


@njit(cache=True)
def _cost(lateral, radii, residuals, noise, parameters, mean, sigma):  # type: ignore[no-untyped-def]
    total = 0.0
    square = 9.0
    for k in range(residuals.shape[0]):
        total += 0.5 * square * math.log1p((residuals[k] / noise) ** 2 / square)
    for p in range(parameters.shape[0]):
        if sigma[p] < 1e300:
            total += 0.5 * ((parameters[p] - mean[p]) / sigma[p]) ** 2
    return total + 0.5 * _excess(lateral, radii, parameters) ** 2


@njit(cache=True)
def _normal(lateral, sets, axes, eye, radii, parameters, sigma, noise, base, places, off):  # type: ignore[no-untyped-def]
    """Information matrix and gradient of the robust misfit, by differences."""
    count, size = base.shape[0], parameters.shape[0]
    slopes = np.zeros((count, size))
    moved = np.empty(count)
    for p in range(size):
        if sigma[p] < 1e-8:
            continue
        step = 1e-5 * (radii[0] if p < 3 else 1.0)
        trial = parameters.copy()
        trial[p] += step
        if _residuals(lateral, sets, axes, eye, radii, trial, places, off, moved):
            slopes[:, p] = (moved - base) / step
    information = np.zeros((size, size))
    gradient = np.zeros(size)
    for k in range(count):
        weight = 1.0 / (1.0 + (base[k] / noise) ** 2 / 9.0) / noise**2
        for p in range(size):
            gradient[p] += weight * slopes[k, p] * base[k]
            for q in range(p + 1):
                information[p, q] += weight * slopes[k, p] * slopes[k, q]
    for p in range(size):
        for q in range(p):
            information[q, p] = information[p, q]
    return information, gradient


@njit(cache=True)
def _solve(lateral, sets, axes, eye, radii, start, mean, sigma, noise, steps):  # type: ignore[no-untyped-def]
    """Levenberg and Marquardt's steps from a first guess; parameters and cost."""
    count, size = sets.shape[1], start.shape[0]
    places, off = np.empty((count, 3)), np.empty((3, count))
    here, there = np.empty(count), np.empty(count)
    best = start.copy()
    if not _residuals(lateral, sets, axes, eye, radii, best, places, off, here):
        return best, np.inf
    # wide noise at first, so that a far start feels where to go
    coarse = max(noise, 0.5 * np.median(np.abs(here)))
    damping = 1e-2
    cost = _cost(lateral, radii, here, coarse, best, mean, sigma)
    for step in range(steps):
        information, gradient = _normal(lateral, sets, axes, eye, radii, best, sigma, coarse, here, places, off)
        for p in range(size):
            if sigma[p] < 1e-8:
                information[p, :] = 0.0
                information[:, p] = 0.0
                information[p, p] = 1.0
                gradient[p] = 0.0
            elif sigma[p] < 1e300:
                information[p, p] += 1.0 / sigma[p] ** 2
                gradient[p] += (best[p] - mean[p]) / sigma[p] ** 2
        excess = _excess(lateral, radii, best)
        if excess > 0.0:
            information[7, 7] += 1.0 / _WIDER**2
            gradient[7] += excess / _WIDER
        gained = False
        for _ in range(6):
            damped = information.copy()
            for p in range(size):
                damped[p, p] = information[p, p] * (1.0 + damping) + 1e-12
            trial = best - np.linalg.solve(damped, gradient)
            if _residuals(lateral, sets, axes, eye, radii, trial, places, off, there):
                new = _cost(lateral, radii, there, coarse, trial, mean, sigma)
                if new < cost:
                    gain = cost - new
                    best, cost = trial, new
                    here[:] = there
                    damping = max(damping * 0.3, 1e-9)
                    gained = gain > 1e-4
                    break
            damping = min(damping * 5.0, 1e9)
        if not gained and coarse <= noise:
            break
        if not gained or step % 4 == 3:
            coarse = max(noise, 0.4 * coarse)
            cost = _cost(lateral, radii, here, coarse, best, mean, sigma)
            damping = min(damping, 1e-2)
    return best, _cost(lateral, radii, here, noise, best, mean, sigma)


@njit(cache=True)
def _information(lateral, sets, axes, eye, radii, parameters, sigma, noise):  # type: ignore[no-untyped-def]
    count = sets.shape[1]
    places, off, base = np.empty((count, 3)), np.empty((3, count)), np.empty(count)
    _residuals(lateral, sets, axes, eye, radii, parameters, places, off, base)
    information, _ = _normal(lateral, sets, axes, eye, radii, parameters, sigma, noise, base, places, off)
    for p in range(parameters.shape[0]):
        if sigma[p] < 1e300:
            information[p, p] += 1.0 / max(sigma[p], 1e-8) ** 2
    return information
