"""Closed contours as points or complex numbers: their sense, and equal steps along their length (2.9.2).

A contour is an array (..., n, 2) of z and y, the first point not repeated at the end; its complex form (..., n) is
z + i y. A contour with a missing (NaN) point is not closed, and everything about it is NaN.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import finite

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]
    Complex = NDArray[np.complex128]


def to_complex(contour: ArrayLike) -> Complex:
    """Return the complex form z + i y, (..., n), of a contour (..., n, 2).

    Raises:
        ParameterError: The contour has another shape, fewer than three points, or an infinite one.

    Source: 2.9.2.

    >>> to_complex([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
    array([ 1.+0.j,  0.+1.j, -1.+0.j])
    """
    points = finite("contour", contour)
    if points.ndim < 2 or points.shape[-1] != 2 or points.shape[-2] < 3:
        raise ParameterError(
            f"contour has shape {points.shape}", expected="(..., n, 2), z and y of three or more points"
        )
    return points[..., 0] + 1j * points[..., 1]


def from_complex(curve: ArrayLike) -> Array:
    """Return the points (..., n, 2) of a complex curve (..., n): the inverse of `to_complex`.

    >>> from_complex([1.0 + 2.0j])
    array([[1., 2.]])
    """
    curve = np.asarray(curve, dtype=complex)
    return np.stack([curve.real, curve.imag], axis=-1)


def signed_area(contour: ArrayLike) -> Array:
    """Return the area (...) within a contour (..., n, 2), positive when it runs counter-clockwise.

    >>> float(signed_area([[0.0, 0.0], [0.0, 2.0], [1.0, 0.0]]))
    -1.0
    """
    curve = to_complex(contour)
    curve = curve - curve[..., :1]  # far from the origin the products would cancel
    return 0.5 * np.sum((np.conj(curve) * np.roll(curve, -1, axis=-1)).imag, axis=-1)


def orient(contour: ArrayLike) -> Array:
    """Return the contour (..., n, 2) run counter-clockwise from the same first point.

    The descriptors of the two senses differ in more than phase, so this comes before any transform.

    Source: erratum 30.

    >>> orient([[0.0, 0.0], [0.0, 2.0], [1.0, 0.0]]).tolist()
    [[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]]
    """
    points = np.asarray(contour, dtype=float)
    clockwise = signed_area(points) < 0
    return np.where(clockwise[..., None, None], np.roll(points[..., ::-1, :], 1, axis=-2), points)


def resample(contour: ArrayLike, count: int) -> Array:
    """Return points at equal steps along the contour's length, from its first point on.

    Args:
        contour: (..., n, 2) z and y.
        count: How many points, three or more.

    Returns:
        Array (..., count, 2); NaN for a contour without length.

    Raises:
        ParameterError: The contour cannot be used, or `count` is below three.

    Source: the sampling that the descriptors of 2.9.2 depend on (erratum 31).

    >>> resample([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]], 6)[:3].round(12).tolist()
    [[0.0, 0.0], [2.0, 0.0], [3.0, 1.0]]
    """
    if count < 3:
        raise ParameterError(f"count = {count} is out of range", expected="count >= 3")
    curve = to_complex(contour)
    shape, n = curve.shape[:-1], curve.shape[-1]
    flat = curve.reshape(-1, n)
    closed = np.concatenate([flat, flat[:, :1]], axis=1)
    along = np.concatenate([np.zeros((len(flat), 1)), np.cumsum(np.abs(np.diff(closed)), axis=1)], axis=1)
    usable = np.isfinite(along[:, -1]) & (along[:, -1] > 0)
    closed, along = closed[usable], along[usable]
    if not usable.any():
        return np.full((*shape, count, 2), np.nan)
    found = np.zeros((len(flat), count), dtype=complex)
    # one search for all contours: each has its own unit interval, with a gap to the next
    apart = 2.0 * np.arange(len(along))[:, None]
    knots = (along / along[:, -1:] + apart).ravel()
    steps = (np.arange(count) / count + apart).ravel()
    parts = (np.interp(steps, knots, part.ravel()) for part in (closed.real, closed.imag))
    real, imaginary = (part.reshape(-1, count) for part in parts)
    found[usable] = real + 1j * imaginary
    return np.where(usable[:, None, None], from_complex(found), np.nan).reshape(*shape, count, 2)
