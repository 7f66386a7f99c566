"""The host pipe of a liner: an ellipse with semi-axes r1 along z and r2 along y, in polar form about its centre.

Theta is the bearing, from +z counter-clockwise to +y; chapter 7 counts from the r2 axis, which is bearing pi/2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ellipe, ellipeinc

from springline.geometry.checks import positive

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


def host_polar(theta: ArrayLike, r1: ArrayLike, r2: ArrayLike) -> tuple[Array, Array, Array]:
    """Return the host's polar radius and its first and second derivative by bearing.

    Args:
        theta: Bearing [rad].
        r1, r2: Semi-axes along z and y.

    Source: (3.17), and (7.19) with errata A11.

    >>> [round(float(x), 6) for x in host_polar(np.pi / 2 + 0.5, 12.0, 10.0)]
    [10.370808, 1.43396, 2.436287]
    """
    theta = np.asarray(theta, float)
    r1, r2 = positive("r1", r1), positive("r2", r2)
    cos, sin = np.cos(theta), np.sin(theta)
    u = (cos / r1) ** 2 + (sin / r2) ** 2
    half_first = sin * cos * (1.0 / r2**2 - 1.0 / r1**2)
    half_second = (cos - sin) * (cos + sin) * (1.0 / r2**2 - 1.0 / r1**2)
    radius = 1.0 / np.sqrt(u)
    return radius, -radius * half_first / u, radius * (3.0 * (half_first / u) ** 2 - half_second / u)


def polar_curvature(radius: Array, first: Array, second: Array) -> Array:
    """Return the curvature of a polar curve from its radius and two derivatives by bearing.

    >>> float(polar_curvature(np.array(2.0), np.array(0.0), np.array(0.0)))
    0.5
    """
    square = radius**2 + first**2
    return (square + first**2 - radius * second) / square**1.5


def host_arc(low: ArrayLike, high: ArrayLike, r1: ArrayLike, r2: ArrayLike) -> Array:
    """Return the length of the host's wall between two bearings [rad], low to high counter-clockwise.

    >>> round(float(host_arc(0.0, np.pi, 1.0, 1.0)), 12)
    3.14159265359
    """
    r1, r2 = positive("r1", r1), positive("r2", r2)
    m = 1.0 - (r1 / r2) ** 2

    def from_zero(theta: ArrayLike) -> Array:
        theta = np.asarray(theta, float)
        turns = np.floor((theta + np.pi) / (2 * np.pi))
        within = theta - 2 * np.pi * turns
        eccentric = np.arctan2(np.sin(within) / r2, np.cos(within) / r1)
        # with t counted from r1 the speed is r2 sqrt(1 - m sin^2 t)
        return r2 * (ellipeinc(eccentric, m) + 4.0 * turns * ellipe(m))

    return from_zero(high) - from_zero(low)
