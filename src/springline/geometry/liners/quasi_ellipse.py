"""The quasi-ellipse: a free ring under small deflection d0, before the liner touches its host."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ellipe

from springline.geometry.checks import between, positive

from ..sections.search import rising_root
from .lined import Joints, Liner

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

LARGEST_D0 = 2.0 * np.sqrt(2.0) / 3.0
"""Deflection over r below which every ray from the centre meets the quasi-ellipse once."""


def quasi_ellipse_point(r: ArrayLike, d0: ArrayLike, theta: ArrayLike) -> tuple[Array, Array]:
    """Return z and y of the point that was at bearing theta on the circle.

    Args:
        r: Radius of the undeformed ring.
        d0: Deflection of the axes, outward along z and inward along y; in [0, 0.9428 r).
        theta: Bearing before the deflection [rad].

    Source: chapter 7.1, after Timoshenko; appendix E.

    >>> [round(float(x), 9) for x in quasi_ellipse_point(10.0, 1.0, 2 * np.pi / 3)]
    [-5.125, 8.010734985]
    """
    r, d0 = _checked(r, d0)
    cos, sin = np.cos(theta), np.sin(theta)
    return r * cos + d0 * cos**3, r * sin - d0 * sin**3


def quasi_ellipse(r: ArrayLike, d0: ArrayLike) -> QuasiEllipse:
    """Return quasi-ellipses, with the circle of radius r as host.

    Args:
        r: Radius of the undeformed ring.
        d0: Deflection of the axes, in [0, 0.9428 r).

    Raises:
        ParameterError: A number out of range.

    >>> liner = quasi_ellipse(10.0, 1.0)
    >>> round(float(liner.area / (100 * np.pi)), 6), round(float(liner.perimeter / (20 * np.pi)), 6)
    (0.99625, 1.005601)
    """
    r, d0 = np.broadcast_arrays(*_checked(r, d0))
    return QuasiEllipse(r, d0)


@dataclass(frozen=True, eq=False)
class QuasiEllipse(Liner):
    """Quasi-ellipses; made by `quasi_ellipse`.

    Attributes:
        r: Radius of the undeformed ring and of the host.
        d0: Deflection of the axes.
    """

    r: Array
    d0: Array

    def __getitem__(self, key: object) -> QuasiEllipse:
        """Return some of a batch: `key` indexes the leading batch axes."""
        return QuasiEllipse(self.r[key], self.d0[key])

    @property
    def r1(self) -> Array:
        """Radius of the circular host."""
        return self.r

    @property
    def r2(self) -> Array:
        """Radius of the circular host."""
        return self.r

    def joints(self) -> Joints:
        """Return none: the curve is smooth all round."""
        return Joints(*(np.empty((*self.shape, 0)) for _ in range(3)))

    def _shape(self) -> tuple[int, ...]:
        return self.r.shape

    def _breaks(self) -> Array:
        return np.broadcast_to(np.arange(4) * (np.pi / 2), (*self.shape, 4))

    def _area(self) -> Array:
        return np.pi * (self.r**2 - 0.375 * self.d0**2)

    def _perimeter(self) -> Array:
        # the speed is sqrt(r^2 + (9/4) d0^2 sin^2(2 theta))
        return 4.0 * self.r * ellipe(-((1.5 * self.d0 / self.r) ** 2))

    def _radius(self, bearing: Array) -> Array:
        return np.abs(self._derivatives(bearing)[0])

    def _slope(self, bearing: Array) -> Array:
        point, tangent, _ = self._derivatives(bearing)
        turned = np.conj(point) * tangent
        return np.abs(point) * turned.real / turned.imag

    def _curvature(self, bearing: Array) -> Array:
        _, tangent, bend = self._derivatives(bearing)
        return (np.conj(tangent) * bend).imag / np.abs(tangent) ** 3

    def _derivatives(self, bearing: Array) -> tuple[Array, Array, Array]:
        """Return the point seen at each bearing and its two derivatives by theta, as complex numbers."""
        r, d = self.r[..., None], self.d0[..., None]
        theta = self._theta(bearing)
        c, s = np.cos(theta), np.sin(theta)
        point = r * (c + 1j * s) + d * (c**3 - 1j * s**3)
        tangent = r * (1j * c - s) - 3.0 * d * s * c * (c + 1j * s)
        bend = -r * (c + 1j * s) - 3.0 * d * ((c * c - s * s) * (c + 1j * s) + s * c * (1j * c - s))
        return point, tangent, bend

    def _theta(self, bearing: Array) -> Array:
        """Return the bearing before the deflection, found in the folded quadrant."""
        cos, sin = np.abs(np.cos(bearing)), np.abs(np.sin(bearing))
        r, d = self.r[..., None], self.d0[..., None]

        def ahead(theta: Array) -> tuple[Array, Array]:
            c, s = np.cos(theta), np.sin(theta)
            z, y, by_z, by_y = r * c + d * c**3, r * s - d * s**3, -s * (r + 3.0 * d * c * c), c * (r - 3.0 * d * s * s)
            return y * cos - z * sin, by_y * cos - by_z * sin

        none = np.zeros(np.broadcast_shapes(bearing.shape, r.shape))
        folded = rising_root(ahead, none, none + np.pi / 2)
        mirrored = np.where(np.cos(bearing) < 0.0, np.pi - folded, folded)
        return np.where(np.sin(bearing) < 0.0, -mirrored, mirrored)


def _checked(r: ArrayLike, d0: ArrayLike) -> tuple[Array, Array]:
    r = positive("r", r)
    return r, between("d0", d0, 0.0, LARGEST_D0 * r, bounds="[)", given={"r": r})
