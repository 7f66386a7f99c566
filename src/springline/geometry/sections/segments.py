"""Pipe segments in three dimensions: a section whose parameters run along the pipe.

Chapter 3.4.2 and 7.3 show parameters that are constant, linear or sinusoidal along the pipe (Figures 3.15 and 7.13);
tables serve everything else. Any pipe section or liner may be carried along.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import between, positive

from ...errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from .base import Section

    Array = NDArray[np.float64]
    Course = Callable[[Array], Array]


def constant(value: float) -> Course:
    """Return the course of a parameter that stays.

    >>> constant(0.9)(np.array([0.0, 5.0])).tolist()
    [0.9, 0.9]
    """
    return lambda x: np.full(np.shape(x), float(value))


def linear(start: tuple[float, float], end: tuple[float, float]) -> Course:
    """Return the course of a parameter that runs straight from (x, value) to (x, value), and on beyond them.

    >>> linear((0.0, 1.0), (10.0, 0.9))(np.array([0.0, 5.0])).tolist()
    [1.0, 0.95]
    """
    (x0, v0), (x1, v1) = start, end
    if x0 == x1:
        raise ParameterError(f"x = {x0:g} stands at both ends", expected="two different places along the pipe")
    return lambda x: v0 + (v1 - v0) * (np.asarray(x, float) - x0) / (x1 - x0)


def sinusoidal(mean: float, amplitude: float, wavelength: float, crest: float = 0.0) -> Course:
    """Return the course mean + amplitude cos(2 pi (x - crest) / wavelength).

    >>> sinusoidal(0.9, 0.05, 4.0)(np.array([0.0, 1.0, 2.0])).round(12).tolist()
    [0.95, 0.9, 0.85]
    """
    wavelength = float(positive("wavelength", wavelength))
    return lambda x: mean + amplitude * np.cos(2 * np.pi * (np.asarray(x, float) - crest) / wavelength)


def tabulated(x: ArrayLike, values: ArrayLike) -> Course:
    """Return the course that joins a table's values by straight lines; places outside the table are refused.

    Args:
        x: (T,): ascending places along the pipe.
        values: (T,): the parameter there.

    >>> tabulated([0.0, 1.0, 2.0], [1.0, 0.9, 1.0])(np.array([0.5, 1.5])).tolist()
    [0.95, 0.95]
    """
    x, values = np.asarray(x, float), np.asarray(values, float)
    if x.ndim != 1 or x.shape != values.shape or x.size < 2 or not np.all(np.diff(x) > 0.0):
        raise ParameterError(
            f"the table has x of shape {x.shape} and values of shape {values.shape}",
            expected="two columns of equal length, x ascending",
        )
    return lambda at: np.interp(between("x", at, x[0], x[-1]), x, values)


@dataclass(frozen=True, eq=False)
class Segment:
    """A segment of pipe or liner.

    Attributes:
        x: (X,): places along the pipe.
        section: The sections there, a batch of shape (X,).
    """

    x: Array
    section: Section

    def surface(self, bearing: ArrayLike) -> tuple[Array, Array, Array, Array]:
        """Return x, y, z and the polar radius of the wall, each (X, M); the radius colours the published figures.

        Args:
            bearing: (M,) [rad].
        """
        bearing = np.atleast_1d(np.asarray(bearing, float))
        radius = self.section.polar_radius(bearing)
        along = np.broadcast_to(self.x[:, None], radius.shape)
        return along, radius * np.sin(bearing), radius * np.cos(bearing), radius

    @property
    def volume(self) -> Array:
        """Volume inside, by the trapezoidal rule between the places."""
        return np.trapezoid(self.section.area, self.x)


def segment(build: Callable[..., Section], x: ArrayLike, **courses: float | Course) -> Segment:
    """Return the segment whose sections are built from parameters that run along the pipe.

    Args:
        build: Makes sections from keyword arguments, such as `hinged` or a liner; parameters that do not vary and have
            no meaning as numbers are bound beforehand (`functools.partial`).
        x: (X,): ascending places along the pipe.
        courses: Each parameter as a number or as a course (`constant`, `linear`, `sinusoidal`, `tabulated`, or any
            function of x).

    Raises:
        ParameterError: A parameter leaves its range somewhere along the pipe; the message names the place's number.

    Source: chapter 3.4.2, chapter 7.3, appendices A and E.

    >>> from springline.geometry.sections import hinged
    >>> pipe = segment(hinged, np.linspace(0.0, 4.0, 5), mode=2, s1=linear((0.0, 1.0), (4.0, 0.8)), r=0.15)
    >>> pipe.surface(np.pi / 2)[1][:, 0].round(4).tolist()
    [0.15, 0.1425, 0.135, 0.1275, 0.12]
    """
    x = np.asarray(x, float)
    if x.ndim != 1 or not np.all(np.diff(x) > 0.0):
        raise ParameterError(f"x has shape {x.shape} or does not ascend", expected="(X,) ascending places")
    along = {name: course(x) if callable(course) else np.full(x.shape, course) for name, course in courses.items()}
    return Segment(x, build(**along))
