"""Chicurel's lobe: a buckled beam over the chord between its two edges, in a circular host.

k is half the chord over the host's radius, w = sqrt(1 - k^2). The lobe always leaves the host a little at its edges
(errata A18); it is kept for comparison with what was published.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ellipeinc

from springline.geometry.checks import TOLERANCE, between, positive

from ...conventions import CROWN
from ..sections.search import golden, rising_root
from .lobes import wrapped

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

DEEPEST_K = 0.85086
"""Largest k, to five digits, at which every ray from the host's centre meets Chicurel's lobe once."""


def chicurel_u(k: ArrayLike) -> Array:
    """Return u of Chicurel's lobe: the root of tan u / u = (1 + w)/(2 w) in (pi, 3 pi/2), the buckled branch.

    Args:
        k: Half the chord over the host's radius, in (0, 1).

    Raises:
        ParameterError: k outside (0, 1).

    Source: (7.8) with errata A18.

    >>> round(float(chicurel_u(0.5)), 6)
    4.509386
    """
    k = between("k", k, 0.0, 1.0, bounds="()")
    w = _w(k)
    u = np.full(k.shape, 4.6)
    for _ in range(20):
        # 2 w sin u = (1 + w) u cos u keeps its scale where tan u has its pole (k near 1)
        sin, cos = np.sin(u), np.cos(u)
        u = u - (2.0 * w * sin - (1.0 + w) * u * cos) / ((w - 1.0) * cos + (1.0 + w) * u * sin)
    return u


def chicurel_height(z: ArrayLike, k: ArrayLike, r: ArrayLike = 1.0) -> Array:
    """Return the lobe's height above the chord between its edges.

    Args:
        z: Along the chord from one edge, in [0, 2 k r].
        k: Half the chord over r, in (0, 1).
        r: The host's radius.

    Source: (7.1), (7.6), (7.7).

    >>> round(float(chicurel_height(0.5, 0.25, 10.0)), 12)
    0.100516612121
    """
    r, u = positive("r", r), chicurel_u(k)
    length = 2.0 * np.asarray(k, float) * r
    z = between("z", z, -TOLERANCE * length, length * (1.0 + TOLERANCE), given={"k": k, "r": r})
    return r * shape(z / r - k, k, u)[0]


def chicurel_protrusion(k: ArrayLike) -> tuple[Array, Array]:
    """Return how far the lobe leaves the host, over r, and where along the chord, over its length.

    Source: errata A18: always above zero.

    >>> [round(float(x), 5) for x in chicurel_protrusion(0.9)]
    [0.0303, 0.10523]
    """
    u = chicurel_u(k)
    k = np.asarray(k, float)
    share = np.linspace(0.0, 0.5, 201)[1:]

    def leaving(at: Array) -> Array:
        x = (2.0 * at - 1.0) * k[..., None]
        y = shape(x, k[..., None], u[..., None])[0]
        # the squared radius less 1, free of the cancellation that would hide a protrusion of 1e-13
        excess = y * (2.0 * _w(k)[..., None] + y) - (k[..., None] - x) * (k[..., None] + x)
        return excess / (1.0 + np.sqrt(np.maximum(1.0 + excess, 0.0)))

    best = np.argmax(leaving(share), axis=-1, keepdims=True)
    step = share[1] - share[0]
    value, at = golden(leaving, share[best] - step, np.minimum(share[best] + step, 0.5))
    return value[..., 0], at[..., 0]


def chicurel_arc_ratio(k: ArrayLike) -> Array:
    """Return the lobe's length over that of the host's arc between its edges; 1 would mean no stretch.

    >>> round(float(chicurel_arc_ratio(0.75)), 9)
    1.120291389
    """
    u = chicurel_u(k)
    k = np.asarray(k, float)
    steepest = k / (_w(k) * np.sin(u))
    return k / u * ellipeinc(u, -(steepest**2)) / np.arcsin(k)


@dataclass(frozen=True)
class ChicurelLobe:
    """Chicurel's lobe as part of a lined section, in a circular or an elliptical host.

    An elliptical host is the affine image of a circle, and the lobe is taken along: on an axis of the host that is
    (7.1) itself, elsewhere it keeps the slope continuous at both edges.

    Attributes:
        k: Half the chord over the radius of the circle that the host is the image of, in (0, 0.85086].
        bearing: Bearing of the lobe's centre [rad].

    Source: (7.1) to (7.8) with errata A18.
    """

    k: ArrayLike
    bearing: ArrayLike = CROWN

    def __post_init__(self) -> None:
        object.__setattr__(self, "k", between("k", self.k, 0.0, DEEPEST_K, bounds="(]"))
        object.__setattr__(self, "bearing", np.asarray(self.bearing, float))

    def edges(self, r1: ArrayLike, r2: ArrayLike) -> tuple[Array, Array]:
        """Return the bearings of the two edges, the second counter-clockwise of the first [rad]."""
        centre, half = self._centre(r1, r2), np.arcsin(self.k)
        low, high = (np.arctan2(r2 * np.sin(t), r1 * np.cos(t)) for t in (centre - half, centre + half))
        return low, low + (high - low) % (2 * np.pi)

    def knees(self, r1: ArrayLike, r2: ArrayLike) -> tuple[Array, ...]:
        """Return the bearings of the points of inflection, where a ray comes closest to grazing the lobe [rad]."""
        u = chicurel_u(self.k)
        x = 0.5 * np.pi * self.k / u
        half = np.arctan2(x, _w(self.k) + shape(x, self.k, u)[0])
        centre = self._centre(r1, r2)
        return tuple(np.arctan2(r2 * np.sin(t), r1 * np.cos(t)) for t in (centre - half, centre + half))

    def covers(self, bearing: Array, r1: ArrayLike, r2: ArrayLike) -> NDArray[np.bool_]:
        """Return whether the lobe stands at each bearing."""
        return np.abs(self._offset(bearing, r1, r2)) <= np.arcsin(self.k)

    def evaluate(
        self, bearing: Array, r1: ArrayLike, r2: ArrayLike, *, side: ArrayLike | None = None
    ) -> tuple[Array, Array, Array]:
        """Return radius, slope dr/dtheta and curvature at bearings; beyond an edge those of the edge."""
        half = np.arcsin(self.k)
        offset = np.clip(self._offset(bearing, r1, r2), -half, half)
        u = chicurel_u(self.k)
        x = np.sign(offset) * self._along_chord(np.abs(offset), u)
        y, first, second = shape(x, self.k, u)
        spin = np.exp(1j * self._centre(r1, r2))
        in_circle = (spin * (_w(self.k) + y + 1j * x), spin * (first + 1j), spin * second)
        point, tangent, bend = (r1 * p.real + 1j * r2 * p.imag for p in in_circle)
        turned = np.conj(point) * tangent
        radius = np.abs(point)
        return radius, radius * turned.real / turned.imag, (np.conj(tangent) * bend).imag / np.abs(tangent) ** 3

    def _along_chord(self, offset: Array, u: Array) -> Array:
        """Return the place x >= 0 on the chord at which the lobe is seen at an angle from its centre."""
        cos, sin = np.cos(offset), np.sin(offset)

        def ahead(x: Array) -> tuple[Array, Array]:
            y, slope, _ = shape(x, self.k, u)
            return x * cos - (_w(self.k) + y) * sin, cos - slope * sin

        return rising_root(ahead, np.zeros_like(offset * u), np.broadcast_to(self.k, np.shape(offset * u)))

    def _centre(self, r1: ArrayLike, r2: ArrayLike) -> Array:
        return np.arctan2(np.sin(self.bearing) / r2, np.cos(self.bearing) / r1)

    def _offset(self, bearing: Array, r1: ArrayLike, r2: ArrayLike) -> Array:
        return wrapped(np.arctan2(np.sin(bearing) / r2, np.cos(bearing) / r1) - self._centre(r1, r2))


def shape(x: Array, k: Array, u: Array) -> tuple[Array, Array, Array]:
    """Return the lobe's height above the chord, over r, and two derivatives by x, its place from the middle over r."""
    w = _w(k)
    swing = u * x / k
    # cos u = 2 w sin u / ((1 + w) u) by (7.8), in which w is exact where cos u has lost its digits
    sin_u = np.sin(u)
    cos_u = 2.0 * w * sin_u / ((1.0 + w) * u)
    scale = 2.0 * (k * k / (1.0 + w)) / u**2
    height = scale * (np.cos(swing) / cos_u - 1.0)
    return height, -scale * np.sin(swing) / cos_u * u / k, -scale * np.cos(swing) / cos_u * (u / k) ** 2


def _w(k: ArrayLike) -> Array:
    k = np.asarray(k, float)
    return np.sqrt((1.0 - k) * (1.0 + k))
