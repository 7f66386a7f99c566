"""Fit a bend to rings: radius, angle, plane, start and section, with covariance, from points on its wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.bends import _first
from springline.geometry.bends.centreline import locate
from springline.geometry.checks import choice, finite, require

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

BEND_STATUS = {
    0: "fitted",
    1: "too few rings with readings",
    2: "no bend: the rings run straight within their noise",
    3: "no convergence",
    4: "the bend begins before the first ring: its angle and start are not observable",
    5: "the bend goes on beyond the last ring: its angle is not observable",
    6: "the bend is too slight or too short for these rings: its radius and start are not observable",
}
"""What became of a fit."""

BEND_PARAMETERS = ("bend_radius", "angle", "start_chainage", "r1", "r2")
"""Order of the covariance of a BendFit."""

SECTIONS = ("circle", "ellipse")

_UNSEEN = {4: ("angle", "start_chainage"), 5: ("angle",), 6: ("bend_radius", "start_chainage")}
"""What is missing under each status."""


_RINGS = 4
_READINGS = 5
_RADIUS_LIMIT = 0.2
"""Relative sigma of the bend radius beyond which only the angle is known: a short bend looks like any other kink."""


@dataclass(frozen=True)
class BendFit:
    """A bend between two straights, in the coordinates of the points.

    Attributes:
        bend_radius: Radius of the pipe's axis [m].
        angle: Angle of the bend [rad]; NaN where the rings do not reach both straights.
        start_chainage: From the first ring's centre along the axis to the start of the arc [m]; NaN likewise.
        r1: Semi-axis of the section across the plane of the bend [m].
        r2: Semi-axis in the plane of the bend [m]; equal to r1 for a circle.
        start: Point of the axis where the arc starts (3,) [m]; any point of its arc where that is not observable.
        frame: Rows (3, 3): forward, inward to the bend's centre, and their normal, at `start`.
        covariance: Of BEND_PARAMETERS (5, 5); NaN for what is missing.
        plane_sigma: One sigma of the plane's normal about the forward axis [rad].
        noise: Robust one sigma of a reading's distance to the wall [m].
        rms: Root mean square distance of all readings to the wall [m].
        status: Key of BEND_STATUS; a fit is true when it is 0.
    """

    bend_radius: float
    angle: float
    start_chainage: float
    r1: float
    r2: float
    start: np.ndarray
    frame: np.ndarray
    covariance: np.ndarray
    plane_sigma: float
    noise: float
    rms: float
    status: int

    def __bool__(self) -> bool:
        return self.status == 0

    @property
    def reason(self) -> str:
        """What became of the fit, in words."""
        return BEND_STATUS[self.status]

    @property
    def centre(self) -> np.ndarray:
        """Centre of the bend (3,) [m]."""
        return self.start + self.bend_radius * self.frame[1]

    @property
    def exit(self) -> np.ndarray:
        """Forward unit vector (3,) after the bend; NaN where the angle is missing."""
        return np.cos(self.angle) * self.frame[0] + np.sin(self.angle) * self.frame[1]

    def bearing(self, up: ArrayLike = (0.0, 1.0, 0.0)) -> float:
        """Return the bearing [rad] of the bend's centre, seen looking forward before the bend: 0 turns right.

        Args:
            up: Upward vector in the coordinates of the points.
        """
        forward, inward = self.frame[:2]
        crown = np.asarray(up, float) - np.dot(up, forward) * forward
        return float(np.arctan2(inward @ crown, inward @ np.cross(forward, crown)))


def fit_bend(
    rings: ArrayLike, *, section: str = "circle", straights: bool = True, noise: float | None = None
) -> BendFit:
    """Fit a bend between two straights to rings in common coordinates.

    Args:
        rings: Wall points (n, m, 3) [m], ring by ring in the order of travel; NaN where there was no return.
        section: `circle`, or `ellipse` with its axes in and across the plane of the bend.
        straights: Whether the rings reach from one straight into the other; without, all lie within the bend and
            angle and start are missing.
        noise: One sigma of a reading's distance to the wall [m]; found from the residuals when not given.

    Returns:
        BendFit; false with its reason when the rings hold no bend or not the whole of it.

    Raises:
        ParameterError: Wrong shape, infinite values, or unknown section.

    Source: 4.2.1 (torus between straights), least squares of distances with a soft-L1 loss against outliers.

    >>> from springline.geometry.bends.centreline import centreline
    >>> t = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    >>> s, turn = np.linspace(-1, 2.5, 24), np.clip(np.linspace(-1, 2.5, 24) / 1.0, 0, np.pi / 2)
    >>> out = np.stack([np.sin(turn), -np.cos(turn), 0 * turn], axis=-1)[:, None]
    >>> across = np.sin(t)[:, None] * np.array([0.0, 0.0, 1.0])
    >>> wall = 0.2 * (np.cos(t)[None, :, None] * out + across)
    >>> found = fit_bend(centreline(s, np.zeros(3), np.eye(3), 1.0, np.pi / 2)[:, None] + wall)
    >>> round(found.bend_radius, 6), round(found.angle, 6), found.reason
    (1.0, 1.570796, 'fitted')
    """
    rings = finite("rings", rings)
    choice("section", section, SECTIONS)
    if rings.ndim != 3 or rings.shape[-1] != 3:
        raise ParameterError(f"rings has shape {rings.shape}", expected="(n, m, 3): rings of points x, y, z")
    if noise is not None:
        require(finite("noise", noise) > 0, "noise", noise, "noise > 0", "leave it out to find it from the residuals")
    rings = rings[np.isfinite(rings).all(axis=-1).sum(axis=-1) >= _READINGS]
    if len(rings) < _RINGS:
        return _failed(1)
    first = _first.guess(rings, straights=straights)
    model = _Model(rings[np.isfinite(rings).all(axis=-1)], first, section, straights)
    values, noise, converged = model.solve(noise)
    return _result(model, rings, values, noise, converged)


class _Model:
    """Distances to the wall as a function of small changes from a first guess.

    Values: shift along inward and normal, turn about forward, inward and normal, log of the bend radius, log r1[,
    log r2 for an ellipse][, shift along forward and angle with straights]. Logs keep lengths positive.
    """

    def __init__(self, points: Array, first: _first.Guess, section: str, straights: bool) -> None:
        self.points, self.first, self.straights = points, first, straights
        self.radii = 2 if section == "ellipse" else 1
        self.size = 6 + self.radii + (2 if straights else 0)

    def unpack(self, values: Array) -> tuple[Array, Array, float, float, float, float]:
        from scipy.spatial.transform import Rotation

        first, tail = self.first, values[6 + self.radii :]
        forward = tail[0] if self.straights else 0.0
        start = first.start + np.array([forward, values[0], values[1]]) @ first.frame
        frame = Rotation.from_rotvec(values[2:5]).as_matrix().T @ first.frame
        radii = first.radius * np.exp(values[6 : 6 + self.radii])
        angle = first.angle + tail[1] if self.straights else np.pi
        return start, frame, first.bend_radius * np.exp(values[5]), angle, radii[0], radii[-1]

    def residual(self, values: Array) -> Array:
        start, frame, bend_radius, angle, r1, r2 = self.unpack(values)
        place = locate(self.points, start, frame, bend_radius, angle, straights=self.straights)
        depth = np.hypot(place.out, place.across)
        level = np.hypot(place.out / r2, place.across / r1)
        # Along the ray from the axis; for a circle the distance itself.
        return depth - np.divide(depth, level, out=np.full_like(depth, r1), where=level > 0)

    def solve(self, noise: ArrayLike) -> tuple[Array, float, bool]:
        """Return the values, the noise and whether the search converged."""
        from scipy.optimize import least_squares

        values = np.zeros(self.size)
        scale = noise or 0.05 * self.first.radius
        for _ in range(3):
            found = least_squares(self.residual, values, loss="soft_l1", f_scale=3.0 * scale, x_scale="jac")
            values = found.x
            scale = noise or max(1.4826 * np.median(np.abs(found.fun)), 1e-12 * self.first.radius)
        return values, scale, found.success

    def derivative(self, values: Array, function: Callable[[Array], Array]) -> Array:
        steps = np.eye(self.size) * 1e-6
        return np.stack([(function(values + h) - function(values - h)) / 2e-6 for h in steps], axis=-1)


def _result(model: _Model, rings: Array, values: Array, noise: float, converged: bool) -> BendFit:
    start, frame, bend_radius, angle, r1, r2 = model.unpack(values)
    residual = model.residual(values)
    rms = float(np.sqrt(np.mean(residual**2)))
    _, singular, rows = np.linalg.svd(model.derivative(values, model.residual), full_matrices=False)
    seen = singular > 1e-9 * singular[0]
    spread = noise**2 * (rows[seen].T / singular[seen] ** 2) @ rows[seen]
    lost = (rows[~seen] ** 2 > 1e-6).any(axis=0)
    middles = _first.centres(rings)

    def named(x):
        start, frame, bend_radius, angle, r1, r2 = model.unpack(x)
        return np.array([bend_radius, angle, (start - middles[0]) @ frame[0], r1, r2])

    derivative = model.derivative(values, named)
    covariance = derivative @ spread @ derivative.T
    missing = (derivative[:, lost] != 0).any(axis=1)
    covariance[missing, missing] = np.inf
    along = locate(middles, start, frame, bend_radius, angle).along if model.straights else None
    status = _status(converged, bend_radius, angle, r2, covariance, along)
    if status in (2, 3):
        return _failed(status, r1, r2, noise, rms)
    missing |= np.isin(BEND_PARAMETERS, _UNSEEN.get(status, ()))
    if not model.straights:
        missing |= np.isin(BEND_PARAMETERS, ("angle", "start_chainage"))
    parameters = np.where(missing, np.nan, named(values))
    covariance[missing, :] = covariance[:, missing] = np.nan
    plane_sigma = float(np.sqrt(spread[2, 2]))
    return BendFit(*map(float, parameters), start, frame, covariance, plane_sigma, float(noise), rms, status)


def _status(
    converged: bool, bend_radius: float, angle: float, r2: float, covariance: Array, along: Array | None
) -> int:
    """Return the key of BEND_STATUS; `along` are the rings' places along a bend between straights, else None."""
    if not converged:
        return 3
    slight = np.sqrt(covariance[0, 0]) > _RADIUS_LIMIT * bend_radius
    if along is None:
        return 2 if slight else 0
    early, late = along.min() > -r2, along.max() < bend_radius * angle + r2
    if slight:
        turned = angle > 3.0 * np.sqrt(covariance[1, 1])
        return 6 if turned and not (early or late) else 2
    return 4 if early else 5 if late else 0


def _failed(status: int, r1: float = np.nan, r2: float = np.nan, noise: float = np.nan, rms: float = np.nan) -> BendFit:
    missing, frame = np.full(3, np.nan), np.full((3, 3), np.nan)
    covariance = np.full((5, 5), np.nan)
    return BendFit(
        np.nan, np.nan, np.nan, float(r1), float(r2), missing, frame, covariance, np.nan, float(noise), rms, status
    )
