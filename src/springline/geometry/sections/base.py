"""The one interface of every cross-section, pipe or liner, and what follows from the polar radius alone.

A section is a closed curve that every ray from O meets once. O is the conic's centre, or the shape's own origin; z runs
right, y up, bearings from +z counter-clockwise, as seen looking forward. A section may be a batch: its parameters
broadcast to the batch shape S, scalars describe one section (S is empty).

Whatever takes bearings takes (..., M): the last axis runs over bearings and the leading axes broadcast with S, so that
(M,) bearings give (*S, M) results and a scalar gives S.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from springline.geometry.checks import choice

from . import hull
from .quadrature import spread
from .search import maximise

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

Mean = Literal["axes", "polar", "area", "caliper"]

_STEP = np.pi / 180  # between the bearings at which a search for an extreme begins


@dataclass(frozen=True)
class Chord:
    """A chord through O: its length, and its bearing in (-pi/2, pi/2] [rad]."""

    length: Array
    bearing: Array


@dataclass(frozen=True)
class Diameters:
    """The diameters of a section, in its unit of length; the four means are all diameters (errata A2, A9).

    `axes` is the mean of the largest and the smallest chord, `polar` twice the mean over bearing of the polar radius
    about O, `area` the diameter of the circle of equal area, `caliper` the convex hull's perimeter over pi.
    """

    largest: Chord
    smallest: Chord
    x: Array
    y: Array
    axes: Array
    polar: Array
    area: Array
    caliper: Array

    def ovality(self, mean: Mean = "polar", *, extreme: Literal["max", "min"] = "max") -> Array:
        """Return the ovality as a fraction: (max - mean)/mean, or (mean - min)/mean.

        Source: (1.3); the definitions side by side in errata A2.
        """
        choice("mean", mean, ("axes", "polar", "area", "caliper"))
        choice("extreme", extreme, ("max", "min"))
        m = getattr(self, mean)
        return self.largest.length / m - 1.0 if extreme == "max" else 1.0 - self.smallest.length / m


@dataclass(frozen=True)
class Moments:
    """Area moments: the centroid from O, and the second moments about it, of z^2, y^2 and z y over the area."""

    centroid_z: Array
    centroid_y: Array
    zz: Array
    yy: Array
    zy: Array


class Section(ABC):
    """A closed cross-section; see the module for O, frame and batch shape.

    A subclass states `shape`, `breaks` and how radius, slope and curvature follow from the bearing; closed forms
    override what is integrated or searched here.
    """

    @abstractmethod
    def _shape(self) -> tuple[int, ...]:
        """Return the batch shape S."""

    @abstractmethod
    def _breaks(self) -> Array:
        """Return (*S, P): bearings of the joints, ascending within one turn."""

    @abstractmethod
    def _radius(self, bearing: Array) -> Array:
        """Return the polar radius at (..., M) bearings."""

    @abstractmethod
    def _slope(self, bearing: Array) -> Array:
        """Return dr/dtheta at (..., M) bearings."""

    @abstractmethod
    def _curvature(self, bearing: Array) -> Array:
        """Return the curvature at (..., M) bearings, positive where the contour bends around O."""

    def _panels(self) -> Array:
        """Return (*S, P): bearings between which the radius is easy to integrate; the breaks, and more if need be."""
        return self.breaks

    @property
    def shape(self) -> tuple[int, ...]:
        """Batch shape S."""
        return self._shape()

    @cached_property
    def breaks(self) -> Array:
        """(*S, P): bearings of hinges, corners, lobe edges and other joints, ascending within one turn [rad]."""
        return self._breaks()

    @cached_property
    def panels(self) -> Array:
        """(*S, P): bearings between which the radius is easy to integrate: the breaks and, at need, more [rad]."""
        return self._panels()

    def polar_radius(self, bearing: ArrayLike) -> Array:
        """Return the distance from O to the contour at each bearing [rad]."""
        return self._along(self._radius, bearing)

    def polar_slope(self, bearing: ArrayLike) -> Array:
        """Return the derivative of the polar radius by bearing [length per rad]; at a break, that of either side."""
        return self._along(self._slope, bearing)

    def curvature(self, bearing: ArrayLike) -> Array:
        """Return the contour's curvature [1/length] at each bearing, positive where it bends around O."""
        return self._along(self._curvature, bearing)

    def contour(self, bearing: ArrayLike) -> tuple[Array, Array]:
        """Return z and y of the contour at each bearing [rad]."""
        bearing = np.asarray(bearing, float)
        radius = self.polar_radius(bearing)
        return radius * np.cos(bearing), radius * np.sin(bearing)

    def chord(self, bearing: ArrayLike) -> Array:
        """Return the chord through O at each bearing [rad]: r(theta) + r(theta + pi)."""
        return self._along(self._chord, bearing)

    def support(self, direction: ArrayLike) -> Array:
        """Return how far the section reaches from O in each direction [rad]: the parallel jaw's distance."""
        return self._along(self._support, direction)

    def caliper(self, direction: ArrayLike) -> Array:
        """Return the distance between parallel jaws closed on the section along each direction [rad]."""
        direction = np.asarray(direction, float)
        return self.support(direction) + self.support(direction + np.pi)

    @cached_property
    def area(self) -> Array:
        """Area inside the contour."""
        return self._area()

    @cached_property
    def perimeter(self) -> Array:
        """Length of the contour."""
        return self._perimeter()

    @cached_property
    def mean_radius(self) -> Array:
        """Mean over bearing of the polar radius about O."""
        return self._mean_radius()

    @cached_property
    def hull_perimeter(self) -> Array:
        """Perimeter of the convex hull, which is pi times the mean caliper diameter (Cauchy)."""
        return self._hull_perimeter()

    @cached_property
    def largest_chord(self) -> Chord:
        """The largest chord through O."""
        return self._largest_chord()

    @cached_property
    def smallest_chord(self) -> Chord:
        """The smallest chord through O."""
        return self._smallest_chord()

    @cached_property
    def width(self) -> Array:
        """Caliper width, between vertical jaws."""
        return self.caliper(0.0)

    @cached_property
    def height(self) -> Array:
        """Caliper height, between horizontal jaws; above the vertical chord where the crown dips (errata A14)."""
        return self.caliper(np.pi / 2)

    @cached_property
    def crown_dip(self) -> Array:
        """How far the crown lies below the section's highest level."""
        return np.maximum(self.support(np.pi / 2) - self.polar_radius(np.pi / 2), 0.0)

    @cached_property
    def invert_dip(self) -> Array:
        """How far the invert lies above the section's lowest level."""
        return np.maximum(self.support(-np.pi / 2) - self.polar_radius(-np.pi / 2), 0.0)

    @cached_property
    def moments(self) -> Moments:
        """Centroid and second moments of the area."""
        first = [self._integral(lambda t, r, f=f: r**3 * f(t) / 3.0) for f in (np.cos, np.sin)]
        z, y = first[0] / self.area, first[1] / self.area

        def second(f: Callable[[Array], Array]) -> Array:
            return self._integral(lambda theta, r: r**4 * f(theta) / 4.0)

        return Moments(
            z,
            y,
            second(lambda t: np.cos(t) ** 2) - self.area * z * z,
            second(lambda t: np.sin(t) ** 2) - self.area * y * y,
            second(lambda t: np.sin(t) * np.cos(t)) - self.area * z * y,
        )

    @cached_property
    def diameters(self) -> Diameters:
        """Largest, smallest, horizontal and vertical chord, and the four mean diameters."""
        largest, smallest = self.largest_chord, self.smallest_chord
        return Diameters(
            largest=largest,
            smallest=smallest,
            x=self.chord(0.0),
            y=self.chord(np.pi / 2),
            axes=0.5 * (largest.length + smallest.length),
            polar=2.0 * self.mean_radius,
            area=2.0 * np.sqrt(self.area / np.pi),
            caliper=self.hull_perimeter / np.pi,
        )

    def area_loss(self, r: ArrayLike) -> Array:
        """Return the area lost against the circle of radius r, as a fraction. Source: chapter 3.4.1."""
        return 1.0 - self.area / (np.pi * np.asarray(r, float) ** 2)

    def _area(self) -> Array:
        return self._integral(lambda theta, r: 0.5 * r * r)

    def _perimeter(self) -> Array:
        return self._integral(lambda theta, r: np.hypot(r, self._slope(theta)))

    def _mean_radius(self) -> Array:
        return self._integral(lambda theta, r: r) / (2.0 * np.pi)

    def _hull_perimeter(self) -> Array:
        return hull.perimeter(self)

    def _largest_chord(self) -> Chord:
        return self._extreme_chord(1.0)

    def _smallest_chord(self) -> Chord:
        return self._extreme_chord(-1.0)

    def _along(self, of: Callable[[Array], Array], bearing: ArrayLike) -> Array:
        bearing = np.asarray(bearing, float)
        return of(bearing) if bearing.ndim else of(bearing[None])[..., 0]

    def _chord(self, bearing: Array) -> Array:
        return self._radius(bearing) + self._radius(bearing + np.pi)

    def _integral(self, integrand: Callable[[Array, Array], Array]) -> Array:
        """Return the integral over one turn of integrand(theta, r)."""
        theta, weight = spread(self.panels)
        return np.sum(weight * integrand(theta, self._radius(theta)), axis=-1)

    def _support(self, direction: Array) -> Array:
        direction = np.broadcast_to(direction, np.broadcast_shapes(direction.shape, (*self.shape, 1)))
        grid = self._grid()

        def reach(theta: Array) -> Array:
            return self._radius(theta) * np.cos(theta - direction)

        reached = self._radius(grid)[..., None, :] * np.cos(grid[..., None, :] - direction[..., None])
        return maximise(reach, grid, reached, _STEP)[0]

    def _extreme_chord(self, sign: float) -> Chord:
        grid = self._grid()
        best, where = maximise(lambda t: sign * self._chord(t), grid, sign * self._chord(grid)[..., None, :], _STEP)
        bearing = (where[..., 0] + np.pi / 2) % np.pi - np.pi / 2
        return Chord(sign * best[..., 0], np.where(bearing <= -np.pi / 2, np.pi / 2, bearing))

    def _grid(self) -> Array:
        """Return (*S, G) bearings over one turn: equal steps, the breaks and their opposites."""
        breaks = self.breaks
        turn = np.arange(0.0, 2 * np.pi, _STEP)
        even = np.broadcast_to(turn, (*breaks.shape[:-1], turn.size))
        return np.concatenate([even, breaks, breaks + np.pi], axis=-1)
