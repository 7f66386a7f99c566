"""Lobes: the part of a liner that has left its host, as a polar curve about the host's centre.

A lobe of half angle phi is centred at a bearing of its own; `oc`, the published OC, is the radius left at its centre
(errata A21), and x runs from 0 there to 1 at either edge. The two sides see different host radii and slopes unless the
lobe is centred on an axis of the host, so each side has its own coefficients; at the crown and at the invert they are
those of chapter 7.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from springline.geometry.checks import TOLERANCE, between, positive

from ...conventions import CROWN
from .hosts import host_polar, polar_curvature

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]
    Polar = tuple[Array, Array, Array]


class LobeOfAnyKind(Protocol):
    """A lobe that can stand in a lined section: a frozen dataclass of numbers that broadcast."""

    bearing: Array

    def edges(self, r1: ArrayLike, r2: ArrayLike) -> tuple[Array, Array]:
        """Return the bearings of the two edges, the second counter-clockwise of the first [rad]."""

    def knees(self, r1: ArrayLike, r2: ArrayLike) -> tuple[Array, ...]:
        """Return further bearings at which an integration along the lobe had better pause [rad]."""

    def covers(self, bearing: Array, r1: ArrayLike, r2: ArrayLike) -> NDArray[np.bool_]:
        """Return whether the lobe stands at each bearing."""

    def evaluate(
        self, bearing: Array, r1: ArrayLike, r2: ArrayLike, *, side: ArrayLike | None = None
    ) -> tuple[Array, Array, Array]:
        """Return radius, slope dr/dtheta and curvature at bearings."""


@dataclass(frozen=True)
class LobeCoefficients:
    """The coefficients of (7.23) on one side of a lobe.

    Attributes:
        k1: OC - OA: minus the depth against the edge.
        k3: OA, the host's radius at the edge.
        kappa: k1 / k2, which never blows up.
        k2: As published; +inf where kappa is zero (errata A13).
    """

    k1: Array
    k3: Array
    kappa: Array
    k2: Array


class PolarLobe(ABC):
    """What every lobe given as a polar curve can say about itself in a host; see `Lobe` and `SmoothLobe`."""

    phi: Array
    bearing: Array

    def edges(self, r1: ArrayLike, r2: ArrayLike) -> tuple[Array, Array]:
        """Return the bearings of the two edges, the second counter-clockwise of the first [rad]."""
        return self.bearing - self.phi, self.bearing + self.phi

    def knees(self, r1: ArrayLike, r2: ArrayLike) -> tuple[Array, ...]:
        """Return no further bearings: a polar lobe is smooth on either side."""
        return ()

    def covers(self, bearing: Array, r1: ArrayLike, r2: ArrayLike) -> NDArray[np.bool_]:
        """Return whether the lobe stands at each bearing."""
        return np.abs(wrapped(bearing - self.bearing)) <= self.phi

    def evaluate(
        self, bearing: Array, r1: ArrayLike, r2: ArrayLike, *, side: ArrayLike | None = None
    ) -> tuple[Array, Array, Array]:
        """Return radius, slope dr/dtheta and curvature at bearings; beyond an edge those of the edge.

        Args:
            bearing: [rad].
            r1, r2: The host's semi-axes.
            side: +1 or -1 for the side to take at the centre itself; by default that on which the bearing lies.
        """
        offset = np.clip(wrapped(bearing - self.bearing), -self.phi, self.phi)
        radius, slope, second = self.polar(offset, r1, r2, side=side)
        with np.errstate(invalid="ignore"):
            return radius, slope, polar_curvature(radius, slope, second)

    @abstractmethod
    def polar(self, offset: ArrayLike, r1: ArrayLike, r2: ArrayLike, *, side: ArrayLike | None = None) -> Polar:
        """Return radius, dr/dtheta and its derivative at bearings `offset` from the lobe's centre."""


@dataclass(frozen=True)
class Lobe(PolarLobe):
    """The proposed lobe with varying amplitude, (k1 - kappa |x|^p) cos(pi x / 2) + k3.

    Slope-continuous at its edges; its curvature is not matched to the host's (errata A3), it may leave the host
    (errata A4), and it does not keep the liner's length (errata A5): ask `springline.geometry.liners.conformity`.

    Attributes:
        phi: Half angle, in (0, pi) [rad].
        oc: Radius left at the lobe's centre, above 0.
        p: Power of the amplitude, above 0; below 2 the curvature at the centre is infinite, at 1 or less there is a
            kink (errata A12).
        bearing: Bearing of the centre [rad].

    Source: (7.13) to (7.23) with errata A11 to A13.

    >>> lobe = Lobe(np.pi / 6, 8.0)
    >>> round(float(lobe.polar(0.0, 12.0, 10.0)[0]), 12)
    8.0
    """

    phi: ArrayLike
    oc: ArrayLike
    p: ArrayLike = 2.0
    bearing: ArrayLike = CROWN

    def __post_init__(self) -> None:
        _hold(self, phi=half_angle(self.phi), oc=positive("oc", self.oc), p=positive("p", self.p))

    def coefficients(self, r1: ArrayLike, r2: ArrayLike, *, side: ArrayLike = 1.0) -> LobeCoefficients:
        """Return the coefficients in a host with semi-axes r1 along z and r2 along y.

        Args:
            r1, r2: The host's semi-axes.
            side: +1 for the side at rising bearings, -1 for the other.

        >>> round(float(Lobe(np.pi / 6, 8.0).coefficients(12.0, 10.0).k2), 9)
        1.260347454
        """
        edge, slope, _ = host_polar(self.bearing + side * self.phi, r1, r2)
        k1 = self.oc - edge
        kappa = k1 + 2.0 * self.phi * side * slope / np.pi
        kappa = np.where(np.abs(kappa) <= 8 * np.finfo(float).eps * edge, 0.0, kappa)
        with np.errstate(divide="ignore", invalid="ignore"):
            k2 = np.where(kappa == 0.0, np.inf, k1 / kappa)
        return LobeCoefficients(k1, edge, kappa, k2)

    def polar(self, offset: ArrayLike, r1: ArrayLike, r2: ArrayLike, *, side: ArrayLike | None = None) -> Polar:
        """Return radius, dr/dtheta and its derivative at bearings `offset` from the lobe's centre.

        Args:
            offset: Counter-clockwise from the centre [rad], within [-phi, phi].
            r1, r2: The host's semi-axes.
            side: +1 or -1 for the side to take at the centre itself; by default the offset's sign.
        """
        offset, side, x = place(offset, self.phi, side)
        c = self.coefficients(r1, r2, side=side)
        p, quarter = np.asarray(self.p, float), np.pi / 2
        cos, sin = np.cos(quarter * x), np.sin(quarter * x)
        power = x**p
        with np.errstate(divide="ignore", invalid="ignore"):
            # p x^(p-1) and p (p-1) x^(p-2), whose limits at x = 0 the products below would miss
            first = p * x ** (p - 1.0)
            second = np.where(p == 1.0, 0.0, p * (p - 1.0) * x ** (p - 2.0))
            amplitude = c.k1 - c.kappa * power
            bend = np.where(c.kappa == 0.0, 0.0, c.kappa * second)
            lean = np.where(c.kappa == 0.0, 0.0, c.kappa * first)
        radius = amplitude * cos + c.k3
        slope = (-lean * cos - quarter * amplitude * sin) / self.phi
        curve = (-bend * cos + 2.0 * quarter * lean * sin - quarter**2 * amplitude * cos) / self.phi**2
        return radius, side * slope, curve

    def edge_second(self, r1: ArrayLike, r2: ArrayLike, *, side: ArrayLike = 1.0) -> Array:
        """Return the second derivative of the radius at an edge, p pi kappa / phi^2.

        Source: errata A3.
        """
        return self.p * np.pi * self.coefficients(r1, r2, side=side).kappa / self.phi**2


@dataclass(frozen=True)
class SmoothLobe(PolarLobe):
    """The recommended lobe: the host's radius less depth cos^n(pi x / 2).

    It never leaves the host while oc is at most the host's radius at its centre. n = 2 is slope-continuous (Glock's
    lobe, on any host), n above 2 curvature-continuous.

    Attributes:
        phi: Half angle, in (0, pi) [rad].
        oc: Radius left at the lobe's centre, above 0.
        n: Power of the cosine, at least 2.
        bearing: Bearing of the centre [rad].

    Source: errata A19 and E; (7.12) for n = 2 on a circle.

    >>> round(float(SmoothLobe(np.pi / 6, 8.0, 3).polar(np.pi / 12, 12.0, 10.0)[0]), 9)
    9.396833285
    """

    phi: ArrayLike
    oc: ArrayLike
    n: ArrayLike = 3.0
    bearing: ArrayLike = CROWN

    def __post_init__(self) -> None:
        n = between("n", self.n, 2.0, np.inf, bounds="[)")
        _hold(self, phi=half_angle(self.phi), oc=positive("oc", self.oc), n=n)

    def polar(self, offset: ArrayLike, r1: ArrayLike, r2: ArrayLike, *, side: ArrayLike | None = None) -> Polar:
        """Return radius, dr/dtheta and its derivative at bearings `offset` from the lobe's centre; as for `Lobe`."""
        offset, side, x = place(offset, self.phi, side)
        depth = host_polar(self.bearing, r1, r2)[0] - self.oc
        radius, slope, curve = host_polar(self.bearing + offset, r1, r2)
        n, rate = np.asarray(self.n, float), np.pi / (2.0 * np.asarray(self.phi, float))
        cos, sin = np.maximum(np.cos(np.pi / 2 * x), 0.0), np.sin(np.pi / 2 * x)
        fall = depth * n * rate * cos ** (n - 1.0) * sin
        bend = depth * n * rate**2 * (cos**n - (n - 1.0) * cos ** (n - 2.0) * sin**2)
        return radius - depth * cos**n, slope + side * fall, curve + bend


def glock_radius(theta: ArrayLike, r: ArrayLike, depth: ArrayLike, phi: ArrayLike) -> Array:
    """Return Glock's lobe in a circular host: r - depth sin^2(pi theta / (2 phi)).

    Args:
        theta: From the lobe's edge, in [0, 2 phi] [rad].
        r: The host's radius.
        depth: Largest radial deflection, in [0, r).
        phi: Half angle, in (0, pi) [rad].

    Source: (7.12).

    >>> float(glock_radius(0.5, 10.0, 2.0, 0.5))
    8.0
    """
    phi, r = half_angle(phi), positive("r", r)
    depth = between("depth", depth, 0.0, r, bounds="[)", given={"r": r})
    theta = between("theta", theta, -TOLERANCE, 2.0 * phi * (1.0 + TOLERANCE), given={"phi": phi})
    return r - depth * np.sin(np.pi * theta / (2.0 * phi)) ** 2


def wrapped(angle: ArrayLike) -> Array:
    """Return angles brought into [-pi, pi)."""
    return (np.asarray(angle, float) + np.pi) % (2 * np.pi) - np.pi


def half_angle(phi: ArrayLike) -> Array:
    """Return a lobe's half angle as an array, or refuse it unless it lies in (0, pi)."""
    return between("phi", phi, 0.0, np.pi, bounds="()")


def place(offset: ArrayLike, phi: ArrayLike, side: ArrayLike | None) -> tuple[Array, Array, Array]:
    """Return offset, side and x = |offset| / phi, and refuse offsets beyond the lobe's edges."""
    phi = np.asarray(phi, float)
    room = phi * (1.0 + TOLERANCE)
    offset = between("offset", offset, -room, room, given={"phi": phi})
    side = np.where(offset < 0.0, -1.0, 1.0) if side is None else np.asarray(side, float)
    return offset, side, np.minimum(np.abs(offset) / phi, 1.0)


def each(lobe: LobeOfAnyKind, change: Callable[[Array], Array]) -> LobeOfAnyKind:
    """Return a lobe with `change` applied to each of its numbers."""
    return replace(lobe, **{f.name: change(np.asarray(getattr(lobe, f.name))) for f in fields(lobe)})


def _hold(lobe: Lobe | SmoothLobe, **checked: Array) -> None:
    for name, value in {**checked, "bearing": np.asarray(lobe.bearing, float)}.items():
        object.__setattr__(lobe, name, value)
