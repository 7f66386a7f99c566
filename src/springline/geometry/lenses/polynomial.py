"""Polynomial fisheye r = k (t + k1 t^3 + k2 t^5 + k3 t^7 + k4 t^9) of the zenith t, as OpenCV's fisheye camera has it.

With equal focal lengths OpenCV's `K[0, 0]` is k here and its `D` are the coefficients; missing ones are zero.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import finite, positive
from springline.geometry.lenses.models import ROUNDING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

MOST_COEFFICIENTS = 4
"""OpenCV's fisheye has four."""

_CELLS = 256
_ROUNDS = 60


def polynomial_limit(coefficients: Sequence[float]) -> float:
    """Return the largest zenith [rad], at most pi, up to which the radius rises.

    Args:
        coefficients: k1 to at most k4.

    Returns:
        The first zero of the slope [rad], or pi.

    Raises:
        ParameterError: There are more than four coefficients, or one is not finite.

    >>> round(polynomial_limit([-1 / 3]), 12), round(polynomial_limit([0.1]), 6)
    (1.0, 3.141593)
    """
    odd = np.concatenate([[1.0], _coefficients(coefficients)])
    order = np.arange(len(odd))
    # in the square of zenith / pi, at most 1 inside the range: terms below its rounding would spoil the roots
    slope = odd * (2.0 * order + 1.0) * np.pi ** (2 * order)
    slope = np.where(np.abs(slope) > 1e-15 * np.abs(slope).max(), slope, 0.0)
    roots = np.roots(slope[::-1])
    real = roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 0)]
    return float(np.pi * np.sqrt(min(1.0, real.min()))) if real.size else np.pi


def polynomial_radius(zenith: ArrayLike, k: ArrayLike, coefficients: Sequence[float]) -> Array:
    """Return how far from the image centre a ray lands.

    Args:
        zenith: Angle between ray and optical axis [rad].
        k: Scale [px], OpenCV's focal length.
        coefficients: k1 to at most k4.

    Returns:
        Radius [px]; NaN outside the one-to-one range of `polynomial_limit`.

    Raises:
        ParameterError: k is not above zero, or the coefficients cannot be used.

    Source: the fisheye model of OpenCV's module `calib3d`.

    >>> polynomial_radius([0.0, 0.5, 3.0], 100.0, [-0.1]).round(6)
    array([ 0.  , 48.75,   nan])
    """
    inside = _inside(finite("zenith", zenith), polynomial_limit(coefficients))
    return positive("k", k, "give the lens scale in pixels") * inside * _factor(inside**2, _coefficients(coefficients))


def polynomial_slope(zenith: ArrayLike, k: ArrayLike, coefficients: Sequence[float]) -> Array:
    """Return the derivative of `polynomial_radius` with respect to the zenith [px/rad]; arguments as there.

    >>> float(polynomial_slope(0.5, 100.0, [-0.1]))
    92.5
    """
    odd = _coefficients(coefficients)
    inside = _inside(finite("zenith", zenith), polynomial_limit(coefficients))
    return positive("k", k, "give the lens scale in pixels") * _factor(inside**2, odd * (2 * np.arange(len(odd)) + 3))


def polynomial_zenith(radius: ArrayLike, k: ArrayLike, coefficients: Sequence[float]) -> Array:
    """Return the zenith [rad] of the ray that lands at an image radius: the inverse of `polynomial_radius`.

    Args:
        radius: Distance from the image centre [px].
        k: Scale [px].
        coefficients: k1 to at most k4.

    Returns:
        Zenith [rad]; NaN where no ray lands.

    Raises:
        ParameterError: k is not above zero, or the coefficients cannot be used.

    Source: root of the monotone polynomial, by Newton kept inside a bracket.

    >>> polynomial_zenith([48.75, 1e4], 100.0, [-0.1]).round(12)
    array([0.5, nan])
    """
    odd, limit = _coefficients(coefficients), polynomial_limit(coefficients)
    target = np.asarray(finite("radius", radius) / positive("k", k, "give the lens scale in pixels"))
    knots = np.linspace(0.0, limit, _CELLS + 1)
    heights = np.maximum.accumulate(knots * _factor(knots**2, odd))
    inside = (target >= 0) & (target <= heights[-1] * (1.0 + ROUNDING))
    found = np.full(target.shape, np.nan)
    found[inside] = _root(np.minimum(target[inside], heights[-1]), odd, knots, heights)
    return found


def _root(wanted: Array, odd: Array, knots: Array, heights: Array) -> Array:
    """Zeniths of the reduced radii `wanted` (n,), each between two of the knots."""
    cell = np.clip(np.searchsorted(heights, wanted, side="right") - 1, 0, _CELLS - 1)
    low, high = knots[cell], knots[cell + 1]
    rise = heights[cell + 1] - heights[cell]
    zenith = low + (high - low) * (wanted - heights[cell]) / np.where(rise > 0, rise, 1.0)
    slopes = odd * (2 * np.arange(len(odd)) + 3)
    left = np.arange(len(wanted))
    for _ in range(_ROUNDS):
        at = zenith[left]
        excess = at * _factor(at**2, odd) - wanted[left]
        low[left], high[left] = np.where(excess < 0, at, low[left]), np.where(excess > 0, at, high[left])
        with np.errstate(divide="ignore", invalid="ignore"):
            step = at - excess / _factor(at**2, slopes)
        # near the end of the range the slope vanishes and Newton leaves the bracket
        within = (step >= low[left]) & (step <= high[left])
        moved = np.where(excess == 0, at, np.where(within, step, (low[left] + high[left]) / 2.0))
        zenith[left] = moved
        left = left[np.abs(moved - at) > ROUNDING]
        if not len(left):
            break
    return zenith


def _factor(square: Array, odd: Array) -> Array:
    """1 + odd_1 s + odd_2 s^2 + ... of the squared zenith s."""
    total = np.zeros_like(square)
    for coefficient in odd[::-1]:
        total = (total + coefficient) * square
    return 1.0 + total


def _inside(zenith: Array, limit: float) -> Array:
    return np.where((zenith >= 0) & (zenith <= limit), zenith, np.nan)


def _coefficients(coefficients: Sequence[float]) -> Array:
    odd = np.atleast_1d(np.asarray(coefficients, dtype=float)).ravel()
    if len(odd) > MOST_COEFFICIENTS or not np.isfinite(odd).all():
        raise ParameterError(
            f"coefficients = {odd.tolist()} cannot be used",
            expected=f"at most {MOST_COEFFICIENTS} finite numbers, k1 to k{MOST_COEFFICIENTS}",
            mend="give OpenCV's fisheye D, not the distortion of its pinhole camera",
        )
    return odd
