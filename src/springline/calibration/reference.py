"""Range scale and boresight from the ellipses that a scanner shows of a reference of known diameter.

A scanner tilted by tau sees a ring of radius R as an ellipse with semi-axes R and R / cos(tau). A boresight error b
adds to the tilt that is stated, so it moves the ellipse by R tau b: to first order at known tilts, to second order only
at none. The range scale multiplies all of it. The reference's own ovality does not change sign with the tilt, which is
what tells it from boresight.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from ..geometry.checks import finite, positive, require
from ..geometry.robot import frame

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

REFERENCE_TERMS = ("range_scale", "boresight_pitch", "boresight_yaw", "boresight_roll", "oval_cos", "oval_sin")
"""Order of what `fit_reference` finds: reading over true range, three angles [rad], the reference's ovality [m]."""

TILT_SIGMA = np.radians(0.1)
"""One-sigma of a stated tilt, when it is not given [rad]."""
ALIGNMENT_SIGMA = np.radians(1.0)
"""One-sigma of each angle between scanner and reference where no tilt is stated [rad]: set up by eye."""
ROUNDNESS_SIGMA = 0.005
"""Prior one-sigma of the reference's own ovality terms, over its radius."""

_BORESIGHT = slice(1, 4)
_BORESIGHT_SIGMA = np.radians(20.0)
_OBSERVED = np.radians(1.0)
"""An angle known no better than this [rad] counts as unknown."""
_STEPS = np.array([1e-6, 1e-6, 1e-6, 1e-6, 1e-8, 1e-8])
_ITERATIONS = 30


@dataclass(frozen=True, eq=False)
class ReferenceFit:
    """What scans of a reference tell of the scanner.

    Attributes:
        values: In the order of REFERENCE_TERMS (6,); NaN for an angle that the tilts do not show.
        covariance: Of `values` (6, 6), with the reference's and the tilts' own uncertainty; NaN likewise.
        misfit: Squared misfit of the scans over that expected; 1 when scans agree with their stated uncertainty.
        scan_misfit: The same for each scan, over three (n,).
        degrees_of_freedom: Of `misfit`.
        consistent: Whether the misfit may be chance (1 in 100); where it is not, the covariance is widened by it.
    """

    values: Array
    covariance: Array
    misfit: float
    scan_misfit: Array
    degrees_of_freedom: int
    consistent: bool

    @property
    def sigma(self) -> Array:
        """One-sigma of `values` (6,)."""
        return np.sqrt(np.diagonal(self.covariance))


def reference_shapes(values: ArrayLike, tilts: ArrayLike, radius: float) -> Array:
    """Return the ellipses that a scanner shows of a reference ring.

    Args:
        values: Scanner and reference in the order of REFERENCE_TERMS (6,).
        tilts: Robot's pitch, yaw and roll against the reference's axis [rad] (n, 3), as `conventions` defines them.
        radius: Mean radius of the reference [m].

    Returns:
        mean_radius, oval_cos, oval_sin of each ellipse in the ring's own plane [m] (n, 3).

    Source: (5.4)-(5.7) with the boresight turned before the robot's attitude; exact.

    >>> shape = reference_shapes([1.005, 0, 0, 0, 0, 0], [[np.radians(60), 0, 0]], 0.15)
    >>> shape.round(6).tolist()  # semi-axes 0.15 and 0.3, a half per cent too long, upright
    [[0.226125, -0.075375, 0.0]]
    """
    scale, *boresight, p, q = np.asarray(values, float)
    tilts = np.asarray(tilts, float)
    axes = frame(*boresight) @ frame(tilts[:, 0], tilts[:, 1], tilts[:, 2])
    # Columns: what a metre along the scanner's z and y moves on the reference's z and y.
    plane = axes[:, [2, 1]][:, :, [2, 1]].swapaxes(1, 2)
    section = np.array([[radius + p, q], [q, radius - p]])
    inverse = np.linalg.inv(plane) @ section
    shape = inverse @ inverse.swapaxes(1, 2)
    zz, yy, zy = shape[:, 0, 0], shape[:, 1, 1], shape[:, 0, 1]
    mean = 0.5 * np.sqrt(zz + yy + 2.0 * np.sqrt(zz * yy - zy * zy))
    return scale * np.stack([mean, 0.25 * (zz - yy) / mean, 0.5 * zy / mean], axis=1)


def fit_reference(
    shapes: ArrayLike,
    covariance: ArrayLike,
    radius: float,
    tilts: ArrayLike | None = None,
    *,
    radius_sigma: float = 0.0,
    tilt_sigma: float = TILT_SIGMA,
    alignment_sigma: float = ALIGNMENT_SIGMA,
    roundness: float = ROUNDNESS_SIGMA,
) -> ReferenceFit:
    """Return range scale and boresight from scans of one reference.

    Args:
        shapes: mean_radius, oval_cos, oval_sin that each scan shows [m] (n, 3).
        covariance: Of `shapes` [m2] (n, 3, 3).
        radius: Mean radius of the reference [m].
        tilts: Robot's pitch, yaw and roll against the reference's axis [rad] (n, 3); None when nobody measured them:
            scanner and reference are then taken as aligned within `alignment_sigma`, and boresight is not observable.
        radius_sigma: One-sigma of `radius` [m].
        tilt_sigma: One-sigma of each stated tilt by itself [rad]. What all tilts have wrong in common is boresight.
        alignment_sigma: One-sigma of each angle between scanner and reference where no tilt tells it [rad].
        roundness: Prior one-sigma of the reference's own ovality terms, over its radius.

    Returns:
        ReferenceFit. Maximum likelihood by Gauss-Newton, the errors of tilts marginalised.

    Raises:
        InputError: Shapes that do not belong together, or no scan at all.
        ParameterError: A radius or a sigma out of range.

    >>> tilts = np.radians([[0, 0, 0], [20, 0, 0], [-20, 0, 0], [0, 20, 0], [0, -20, 0]])
    >>> seen = reference_shapes([1.005, 0.005, -0.003, 0.0, 0.0, 0.0], tilts, 0.15)
    >>> found = fit_reference(seen, np.tile(1e-10 * np.eye(3), (5, 1, 1)), 0.15, tilts)
    >>> found.values[:3].round(6).tolist()
    [1.005, 0.005, -0.003]
    """
    shapes, spread, tilts, stated = _checked(shapes, covariance, tilts)
    positive("radius", radius)
    for name, value in (("radius_sigma", radius_sigma), ("tilt_sigma", tilt_sigma), ("roundness", roundness)):
        require(finite(name, value) >= 0, name, value, f"{name} >= 0", "give a one-sigma")
    prior = np.array([0.0, *[_BORESIGHT_SIGMA**-2.0] * 3, *[(roundness * radius) ** -2.0] * 2])
    values = np.array([np.median(shapes[:, 0]) / radius, 0.0, 0.0, 0.0, 0.0, 0.0])
    for _ in range(_ITERATIONS):
        residual, slopes, weight = _linear(values, shapes, spread, tilts, radius, tilt_sigma)
        information = np.einsum("nia,nij,njb->ab", slopes, weight, slopes) + np.diag(prior)
        step = np.linalg.solve(information, np.einsum("nia,nij,nj->a", slopes, weight, residual) - prior * values)
        values = values + np.clip(step, -0.1, 0.1)
        if np.all(np.abs(step) < 1e-10):
            break
    residual, slopes, weight = _linear(values, shapes, spread, tilts, radius, tilt_sigma)
    information = np.einsum("nia,nij,njb->ab", slopes, weight, slopes) + np.diag(prior)
    found = _finish(values, np.linalg.inv(information), residual, weight, stated)
    found.covariance[0, 0] += (values[0] * radius_sigma / radius) ** 2
    if np.isnan(found.values[1:3]).any():
        # A tilt that nobody knows lengthens the mean radius by a quarter of its square, two angles of it.
        found.covariance[0, 0] += (0.5 * alignment_sigma**2) ** 2
    return found


def _checked(shapes: ArrayLike, covariance: ArrayLike, tilts: ArrayLike | None) -> tuple[Array, Array, Array, bool]:
    shapes, spread = np.asarray(shapes, float), np.asarray(covariance, float)
    stated = tilts is not None
    tilts = np.zeros_like(shapes) if tilts is None else np.asarray(tilts, float)
    if not len(shapes) or shapes.shape[1:] != (3,) or spread.shape != (*shapes.shape, 3) or tilts.shape != shapes.shape:
        raise InputError(
            f"shapes {shapes.shape}, covariance {spread.shape} and tilts {tilts.shape} do not belong together",
            expected="(n, 3), (n, 3, 3) and (n, 3) with at least one scan",
        )
    for name, array in (("shapes", shapes), ("covariance", spread), ("tilts", tilts)):
        if not np.isfinite(array).all():
            raise InputError(f"{name} has missing values", expected="one finite row for each scan")
    return shapes, spread, tilts, stated


def _linear(
    values: Array, shapes: Array, spread: Array, tilts: Array, radius: float, tilt_sigma: float
) -> tuple[Array, Array, Array]:
    """Return residuals (n, 3), slopes (n, 3, 6) and weights (n, 3, 3) with the tilts' errors marginalised."""

    def slope(step: Array, turn: Array) -> Array:
        ahead = reference_shapes(values + step, tilts + turn, radius)
        return (ahead - reference_shapes(values - step, tilts - turn, radius)) / (2.0 * max(step.max(), turn.max()))

    slopes = np.stack([slope(step, np.zeros(3)) for step in np.diag(_STEPS)], axis=2)
    turning = np.stack([slope(np.zeros(6), turn) for turn in 1e-6 * np.eye(3)], axis=2)
    whole = spread + tilt_sigma**2 * turning @ turning.swapaxes(1, 2)
    return shapes - reference_shapes(values, tilts, radius), slopes, np.linalg.inv(whole)


def _finish(values: Array, covariance: Array, residual: Array, weight: Array, stated: bool) -> ReferenceFit:
    from scipy.stats import chi2

    square = np.einsum("ni,nij,nj->n", residual, weight, residual)
    unseen = np.sqrt(np.diagonal(covariance)) > _OBSERVED
    unseen[[0, 4, 5]] = False
    unseen[_BORESIGHT] |= not stated
    # The prior of the ovality counts as two observations.
    freedom = max(residual.size + 2 - int((~unseen).sum()), 1)
    misfit = float(square.sum() / freedom)
    consistent = bool(chi2.sf(square.sum(), freedom) > 0.01)
    if not consistent:
        covariance = covariance * misfit
    covariance = covariance.copy()
    values = np.where(unseen, np.nan, values)
    covariance[unseen, :] = covariance[:, unseen] = np.nan
    return ReferenceFit(values, covariance, misfit, square / 3.0, freedom, consistent)
