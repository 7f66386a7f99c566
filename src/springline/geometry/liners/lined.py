"""Lined sections: a liner that lies on its host and has left it in one or more lobes, at any clock."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import positive

from ...conventions import CROWN
from ...errors import ParameterError
from ..sections.base import Section
from .chicurel import ChicurelLobe
from .hosts import host_polar, polar_curvature
from .lobes import Lobe, LobeOfAnyKind, SmoothLobe, each, wrapped

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Joints:
    """The places where a liner's parts meet, and how slope and curvature change there; each (*S, J).

    Attributes:
        bearing: Where [rad].
        slope: dr/dtheta counter-clockwise of the joint less that before it [length per rad].
        curvature: Likewise the curvature [1/length].
    """

    bearing: Array
    slope: Array
    curvature: Array


class Liner(Section):
    """A section that belongs to a host: an ellipse with semi-axes r1 along z and r2 along y."""

    r1: Array
    r2: Array

    def host_radius(self, bearing: ArrayLike) -> Array:
        """Return the host's polar radius at (..., M) bearings [rad]."""
        return self._along(lambda theta: host_polar(theta, self.r1[..., None], self.r2[..., None])[0], bearing)

    @abstractmethod
    def joints(self) -> Joints:
        """Return where the liner's parts meet, and the jumps there."""


@dataclass(frozen=True, eq=False)
class LinedSection(Liner):
    """Liners with lobes; made by `lined` and its short forms.

    Attributes:
        r1, r2: The host's semi-axes along z and y.
        lobes: The lobes; none overlaps another.
    """

    r1: Array
    r2: Array
    lobes: tuple[LobeOfAnyKind, ...]

    def __getitem__(self, key: object) -> LinedSection:
        """Return some of a batch: `key` indexes the leading batch axes."""
        return LinedSection(self.r1[key], self.r2[key], tuple(each(lobe, lambda x: x[key]) for lobe in self.lobes))

    def joints(self) -> Joints:
        """Return the lobes' edges and centres, and the jumps there."""
        found = []
        for lobe in self.lobes:
            low, high = lobe.edges(self.r1, self.r2)
            parts = [
                (low, self._host(low), lobe.evaluate(low, self.r1, self.r2, side=-1.0)),
                (
                    lobe.bearing,
                    lobe.evaluate(lobe.bearing, self.r1, self.r2, side=-1.0),
                    lobe.evaluate(lobe.bearing, self.r1, self.r2, side=1.0),
                ),
                (high, lobe.evaluate(high, self.r1, self.r2, side=1.0), self._host(high)),
            ]
            with np.errstate(invalid="ignore"):
                found += [(at, after[1] - before[1], after[2] - before[2]) for at, before, after in parts]
        return Joints(*(np.stack(np.broadcast_arrays(*column), axis=-1) for column in zip(*found, strict=True)))

    def _shape(self) -> tuple[int, ...]:
        return self.r1.shape

    def _breaks(self) -> Array:
        places = [p for lobe in self.lobes for p in (*lobe.edges(self.r1, self.r2), lobe.bearing)]
        return np.sort(np.stack(np.broadcast_arrays(*places), axis=-1) % (2 * np.pi), axis=-1)

    def _panels(self) -> Array:
        places = [*np.arange(4) * (np.pi / 2), *(k for lobe in self.lobes for k in lobe.knees(self.r1, self.r2))]
        further = np.stack([np.broadcast_to(p, self.shape) for p in places], axis=-1) % (2 * np.pi)
        return np.sort(np.concatenate([self.breaks, further], axis=-1), axis=-1)

    def _radius(self, bearing: Array) -> Array:
        return self._evaluate(bearing)[0]

    def _slope(self, bearing: Array) -> Array:
        return self._evaluate(bearing)[1]

    def _curvature(self, bearing: Array) -> Array:
        return self._evaluate(bearing)[2]

    @cached_property
    def _raised(self) -> tuple[Array, Array, tuple[LobeOfAnyKind, ...]]:
        """The parameters with an axis for bearings."""
        lobes = tuple(each(lobe, lambda x: x[..., None]) for lobe in self.lobes)
        return self.r1[..., None], self.r2[..., None], lobes

    def _evaluate(self, bearing: Array) -> tuple[Array, ...]:
        r1, r2, lobes = self._raised
        radius, slope, second = host_polar(bearing, r1, r2)
        found = (radius, slope, polar_curvature(radius, slope, second))
        for lobe in lobes:
            here = lobe.covers(bearing, r1, r2)
            found = tuple(
                np.where(here, own, rest) for own, rest in zip(lobe.evaluate(bearing, r1, r2), found, strict=True)
            )
        return found

    def _host(self, bearing: Array) -> tuple[Array, Array, Array]:
        radius, slope, second = host_polar(bearing, self.r1, self.r2)
        return radius, slope, polar_curvature(radius, slope, second)


def lined(r1: ArrayLike, r2: ArrayLike, *lobes: LobeOfAnyKind) -> LinedSection:
    """Return liners in an elliptical host with one or more lobes.

    Args:
        r1, r2: The host's semi-axes along z and y; equal for a circular host.
        lobes: `Lobe`, `SmoothLobe` or `ChicurelLobe`; their numbers and the host's broadcast to the batch.

    Raises:
        ParameterError: No lobe, two that overlap, or a number out of range.

    Source: chapter 7.3; two lobes after Figure 7.1.

    >>> liner = lined(12.0, 10.0, Lobe(0.5, 8.0), SmoothLobe(0.4, 9.0, bearing=-np.pi / 2))
    >>> liner.polar_radius([np.pi / 2, 0.0, -np.pi / 2]).round(12).tolist()
    [8.0, 12.0, 9.0]
    """
    if not lobes:
        raise ParameterError("no lobe is given", expected="one lobe or more")
    numbers = [np.asarray(getattr(lobe, f.name)) for lobe in lobes for f in fields(lobe)]
    r1, r2 = positive("r1", r1), positive("r2", r2)
    shape = np.broadcast_shapes(r1.shape, r2.shape, *(x.shape for x in numbers))
    r1, r2 = np.broadcast_to(r1, shape), np.broadcast_to(r2, shape)
    held = tuple(each(lobe, lambda x: np.broadcast_to(x, shape)) for lobe in lobes)
    for (i, one), (j, other) in combinations(enumerate(held, start=1), 2):
        spans = [lobe.edges(r1, r2) for lobe in (one, other)]
        apart = np.abs(wrapped(0.5 * (sum(spans[1]) - sum(spans[0]))))
        room = 0.5 * sum(high - low for low, high in spans)
        if np.any(apart < room * (1 - 1e-12)):
            raise ParameterError(f"lobes {i} and {j} overlap", expected="lobes that stand apart")
    return LinedSection(r1, r2, held)


def lobed(
    r1: ArrayLike, r2: ArrayLike, phi: ArrayLike, oc: ArrayLike, p: ArrayLike = 2.0, bearing: ArrayLike = CROWN
) -> LinedSection:
    """Return liners with one proposed lobe; arguments as for `Lobe` in a host r1 by r2. Source: (7.13), (7.23).

    >>> round(float(lobed(12.0, 10.0, np.pi / 4, 8.0).polar_radius(np.pi / 2)), 12)
    8.0
    """
    return lined(r1, r2, Lobe(phi, oc, p, bearing))


def smooth_lobed(
    r1: ArrayLike, r2: ArrayLike, phi: ArrayLike, oc: ArrayLike, n: ArrayLike = 3.0, bearing: ArrayLike = CROWN
) -> LinedSection:
    """Return liners with one smooth lobe; n = 2 is Glock's. Arguments as for `SmoothLobe`. Source: errata A19.

    >>> liner = smooth_lobed(10.0, 10.0, 0.5, 8.0, n=2)
    >>> round(float(liner.polar_radius(np.pi / 2 + 0.25)), 12)
    9.0
    """
    return lined(r1, r2, SmoothLobe(phi, oc, n, bearing))


def chicurel_lobed(r1: ArrayLike, r2: ArrayLike, k: ArrayLike, bearing: ArrayLike = CROWN) -> LinedSection:
    """Return liners with one of Chicurel's lobes; arguments as for `ChicurelLobe`. Source: (7.1).

    >>> bool(chicurel_lobed(10.0, 10.0, 0.5).polar_radius(np.pi / 2) < 9.0)
    True
    """
    return lined(r1, r2, ChicurelLobe(k, bearing))
