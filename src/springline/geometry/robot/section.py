"""A straight pipe's section from one ring and a known attitude, with its covariance.

The ring is linear in (1/r1^2, 1/r2^2) through all three entries of its form, so least squares needs no root and is
never singular; the printed 2 by 2 system is singular near beta = 45 degrees (errata 3, 4). Covariances of a measured
ring are those of (mean_radius, oval_cos, oval_sin) = ((A + B)/2, (A - B)/2 cos 2 beta, (A - B)/2 sin 2 beta), the
parameters of `conventions.SECTION_PARAMETERS`: unlike those of (A, B, beta) they stay finite for a circle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import finite, positive, require
from springline.geometry.robot._numeric import jacobian, propagate, whitener
from springline.geometry.robot.attitude import frame
from springline.geometry.robot.oblique import design_matrix

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

_ROTATION_INVARIANT = np.sqrt(np.array([1.0, 2.0, 1.0]))
"""Weights under which the three entries' norm is the form's Frobenius norm: m_zy stands in it twice."""


@dataclass(frozen=True)
class RingSection:
    """Section of a straight pipe from one ring.

    Attributes:
        r1: Semi-axis on the pipe's z [m]; NaN where the ring belongs to no elliptical pipe in this attitude.
        r2: Semi-axis on the pipe's y [m]; NaN likewise.
        inconsistency: Norm of what no such pipe explains over the norm of the ring form; 0 for an exact ring.
        covariance: Of (r1, r2) [m2], (..., 2, 2); NaN when no covariance was given.
    """

    r1: np.ndarray
    r2: np.ndarray
    inconsistency: np.ndarray
    covariance: np.ndarray


def ring_covariance(noise: ArrayLike, readings: ArrayLike) -> Array:
    """Return the covariance of (mean_radius, oval_cos, oval_sin) of an ellipse fitted to a full ring.

    Args:
        noise: One sigma of one reading [m].
        readings: Number of readings, evenly spread over the ring.

    Returns:
        Array (..., 3, 3) [m2]: noise^2/readings times diag(1, 2, 2), the least-squares value to first order in the
        ellipse's flatness.

    Raises:
        ParameterError: Negative noise, or fewer than five readings.

    >>> np.sqrt(np.diag(ring_covariance(1e-3, 400))).round(8)
    array([5.000e-05, 7.071e-05, 7.071e-05])
    """
    noise, readings = finite("noise", noise), finite("readings", readings)
    require(~(noise < 0), "noise", noise, "noise >= 0", "give the one-sigma of a reading in metres")
    require(~(readings < 5), "readings", readings, "at least 5", "an ellipse has five parameters")
    return (noise * noise / readings)[..., None, None] * np.diag([1.0, 2.0, 2.0])


def ring_parameters(major: ArrayLike, minor: ArrayLike, beta: ArrayLike) -> Array:
    """Return (mean_radius, oval_cos, oval_sin) of an ellipse, (..., 3); `beta` may be NaN where major == minor.

    >>> ring_parameters(1.1, 0.9, np.pi / 2).round(12) + 0.0
    array([ 1. , -0.1,  0. ])
    """
    major, minor, beta = np.broadcast_arrays(positive("major", major), positive("minor", minor), finite("beta", beta))
    require(~(minor > major * (1 + 1e-12)), "minor", minor, "minor <= major", "exchange the axes and turn beta by pi/2")
    half = (major - minor) / 2.0
    beta = np.where(half <= 1e-12 * major, 0.0, beta)
    return np.stack([(major + minor) / 2.0, half * np.cos(2.0 * beta), half * np.sin(2.0 * beta)], axis=-1)


def form_of(parameters: Array) -> Array:
    """Return the ring form (m_zz, m_zy, m_yy), (..., 3), of (mean_radius, oval_cos, oval_sin); smooth at a circle.

    >>> form_of(np.array([2.0, 0.0, 0.0]))
    array([0.25, 0.  , 0.25])
    """
    mean, cos, sin = np.moveaxis(parameters, -1, 0)
    half_square = cos * cos + sin * sin
    product = (mean * mean - half_square) ** 2
    level, tilt = (mean * mean + half_square) / product, 2.0 * mean / product
    return np.stack([level - tilt * cos, 0.0 - tilt * sin, level + tilt * cos], axis=-1)


def section_from_ring(
    major: ArrayLike,
    minor: ArrayLike,
    beta: ArrayLike,
    pitch: ArrayLike,
    yaw: ArrayLike,
    roll: ArrayLike = 0.0,
    *,
    order: str = "direct",
    covariance: ArrayLike | None = None,
    attitude_covariance: ArrayLike | None = None,
) -> RingSection:
    """Return the semi-axes of a straight pipe from the ellipse that one ring measured, the attitude being known.

    Args:
        major: Semi-major axis of the measured ellipse [m].
        minor: Semi-minor axis [m].
        beta: Bearing of the major axis in the ring plane, from robot z towards robot y [rad]; ignored (may be NaN)
            for a circle.
        pitch: Nose up [rad].
        yaw: Nose right [rad].
        roll: From robot z towards robot y [rad].
        order: How the attitude was reached.
        covariance: Of the ring's (mean_radius, oval_cos, oval_sin) [m2], (..., 3, 3); also weights the three entries.
        attitude_covariance: Of (pitch, yaw, roll) [rad2], (..., 3, 3).

    Returns:
        RingSection of broadcast arrays. The pipe's axes are taken to lie on y and z; a section that is turned by psi
        is the same as a robot rolled by -psi.

    Raises:
        ParameterError: An axis is not positive, minor > major, or an angle is out of range.

    Source: 5.3 with all three entries of the ring form (errata 3, 4).

    >>> found = section_from_ring(11.135204968, 10.309418280571, np.radians(13.042130262), *np.radians([15, 7.5]))
    >>> round(float(found.r1), 6), round(float(found.r2), 6)
    (11.0, 10.0)
    """
    ring = ring_parameters(major, minor, beta)
    attitude = np.stack(np.broadcast_arrays(*(np.asarray(v, float) for v in (pitch, yaw, roll))), axis=-1)
    weights = _weights(ring, covariance)

    def solve(values):
        design = design_matrix(frame(values[..., 3], values[..., 4], values[..., 5], order=order))
        return _semi_axes(form_of(values[..., :3]), design, weights)

    shape = np.broadcast_shapes(ring.shape[:-1], attitude.shape[:-1], weights.shape[:-2])
    values = np.concatenate([np.broadcast_to(ring, (*shape, 3)), np.broadcast_to(attitude, (*shape, 3))], axis=-1)
    found = solve(values)
    spread = _input_covariance(shape, covariance, attitude_covariance)
    if spread is None:
        result = np.full((*shape, 2, 2), np.nan)
    else:
        # Steps relative to the ring's size, and of a microradian: the functions are smooth on these scales.
        size = float(np.nanmean(ring[..., 0]))
        result = propagate(jacobian(lambda x: solve(x)[..., :2], values, [1e-6 * size] * 3 + [1e-6] * 3), spread)
    return RingSection(found[..., 0], found[..., 1], found[..., 2], result)


def _semi_axes(form: Array, design: Array, weights: Array) -> Array:
    left, right = weights @ design, (weights @ form[..., None])[..., 0]
    normal = np.swapaxes(left, -1, -2) @ left
    curvature = np.linalg.solve(normal, np.swapaxes(left, -1, -2) @ right[..., None])[..., 0]
    residual = _ROTATION_INVARIANT * (form - (design @ curvature[..., None])[..., 0])
    inconsistency = np.linalg.norm(residual, axis=-1) / np.linalg.norm(_ROTATION_INVARIANT * form, axis=-1)
    curvature = np.where((curvature > 0).all(axis=-1, keepdims=True), curvature, np.nan)
    r1, r2 = np.moveaxis(curvature**-0.5, -1, 0)
    return np.stack([r1, r2, inconsistency], axis=-1)


def _weights(ring: Array, covariance: ArrayLike | None) -> Array:
    """Return weights (..., 3, 3) of the form's entries: from the covariance, else rotation-invariant."""
    if covariance is None:
        return np.diag(_ROTATION_INVARIANT)
    covariance = matrix("covariance", covariance, 3)
    size = float(np.nanmean(ring[..., 0]))
    weights = whitener(propagate(jacobian(form_of, ring, [1e-6 * size] * 3), covariance))
    known = np.isfinite(ring).all(axis=-1) & np.isfinite(covariance).all(axis=(-1, -2))
    if np.isnan(weights[known]).any():
        raise ParameterError(
            "covariance is not positive definite",
            expected="a positive definite 3 by 3 covariance of (mean_radius, oval_cos, oval_sin)",
            mend="ring_covariance makes one from the noise of a reading",
        )
    return weights


def _input_covariance(shape: tuple[int, ...], covariance: ArrayLike | None, attitude_covariance: Array) -> Array | None:
    if covariance is None and attitude_covariance is None:
        return None
    total = np.zeros((*shape, 6, 6))
    if covariance is not None:
        total[..., :3, :3] = covariance
    if attitude_covariance is not None:
        total[..., 3:, 3:] = matrix("attitude_covariance", attitude_covariance, 3)
    return total


def matrix(name: str, value: ArrayLike, size: int) -> Array:
    """Return `value` as (..., size, size) floats; refuse any other shape."""
    value = np.asarray(value, dtype=float)
    if value.shape[-2:] != (size, size):
        raise ParameterError(f"{name} has shape {value.shape}", expected=f"(..., {size}, {size})")
    return value
