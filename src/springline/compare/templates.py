"""A bank of dents of many sizes, and how seldom each is seen where nothing changed.

Each template has unit depth in its middle and falls as cos^2 to its edges, which lie at twice its size; a size is that
at half depth. Its best depth at a place, over the depth's sigma, is a unit normal where nothing changed. How many
peaks of such a field pass a threshold u by chance follows from its correlation alone: per unit of area, for both signs,
2 (2 pi)^(-3/2) sqrt(lx lt) u exp(-u^2 / 2), with lx, lt the second spectral moments along and around.

Source: R. J. Adler, The Geometry of Random Fields (1981), theorem 5.4.1 and its corollary for high levels.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft
from scipy.optimize import brentq

if TYPE_CHECKING:
    from numpy.typing import NDArray

LENGTHS = (0.05, 0.1, 0.2, 0.4, 0.8)
"""Lengths of the templates at half depth [m]."""

WIDTHS = tuple(np.radians((9.0, 18.0, 36.0, 72.0)).tolist())
"""Widths of the templates at half depth [rad]."""

FALSE_ALARMS = 1.0
"""False alarms per 100 m of pipe, over all sizes and both signs."""

DISTINCT = 0.5
"""Share of the alarms of all sizes that are not one seen in several: 0.35 in white noise, but walls are less tidy."""

_FEWEST_CELLS = 3
_HUNDRED = 100.0


@dataclass(frozen=True)
class Template:
    """One size of dent, sampled on the map's grid.

    Attributes:
        length: At half depth [m].
        width: At half depth [rad].
        along: Its shape along the pipe, centred.
        around: (m,) its shape round the whole ring from its middle on, less what moves the middle of the section.
        reach: Cells to each side of its middle round the ring.
    """

    length: float
    width: float
    along: NDArray[np.float64]
    around: NDArray[np.float64]
    reach: int

    @property
    def energy(self) -> float:
        """Sum of its squares over the map: its depth's variance is that of a cell over this."""
        return float(np.sum(self.along**2) * np.sum(self.around**2))

    @property
    def moments(self) -> tuple[float, float]:
        """Second spectral moments of the scan along [1/cell^2] and around [1/cell^2]."""
        along = np.sum(np.diff(self.along, prepend=0, append=0) ** 2) / np.sum(self.along**2)
        around = np.sum(np.diff(self.around, append=self.around[0]) ** 2) / np.sum(self.around**2)
        return float(along), float(around)


def bank(step: float, rows: int) -> tuple[Template, ...]:
    """Return the templates that a map of this `step` [m] and number of bearings resolves."""
    turn = 2 * np.pi / rows
    return tuple(
        template(length, width, step, rows)
        for length in LENGTHS
        for width in WIDTHS
        if 2 * length / step >= _FEWEST_CELLS and 2 * width / turn >= _FEWEST_CELLS
    )


def template(length: float, width: float, step: float, rows: int) -> Template:
    """Return the dent of a `length` [m] and `width` [rad] at half depth, on a map of this `step` [m] and `rows`."""
    along, around = _bump(max(length / step, 1.0)), _bump(max(width * rows / (2 * np.pi), 1.0))
    return Template(length, width, along, _ring(around, rows), len(around) // 2)


def _bump(size: float) -> NDArray[np.float64]:
    """Return cos^2 of half-depth width `size` [cells], centred."""
    half = int(np.ceil(size)) - 1
    return np.cos(0.5 * np.pi * np.arange(-half, half + 1) / size) ** 2


def _ring(bump: NDArray[np.float64], rows: int) -> NDArray[np.float64]:
    """Return a centred shape round a ring (rows,), less its first order."""
    ring = np.zeros(rows)
    np.add.at(ring, (np.arange(len(bump)) - len(bump) // 2) % rows, bump)
    turn = np.arange(rows) * (2 * np.pi / rows)
    return ring - (2.0 / rows) * (ring @ np.cos(turn)) * np.cos(turn)


def slide(wave: NDArray, one: Template, power: int, shape: tuple[int, int], n: int) -> NDArray[np.float32]:
    """Return a map summed under a template (to a power) about each cell (n, m), from its waves on a grid of `shape`."""
    along = np.zeros(shape[0], np.float32)
    half = len(one.along) // 2
    along[np.arange(-half, half + 1)] = one.along**power
    around = (one.around**power).astype(np.float32)
    product = wave * fft.fft(along)[:, None] * fft.rfft(around)[None, :]
    return fft.irfft2(product, s=shape)[:n].astype(np.float32)


def false_alarms(score: float, one: Template, rows: int, step: float) -> float:
    """Return how many peaks of one template, of either sign, pass `score` by chance in 100 m of pipe.

    >>> small = bank(0.01, 180)[0]
    >>> false_alarms(5.0, small, 180, 0.01) > false_alarms(5.5, small, 180, 0.01)
    True
    """
    lx, lt = one.moments
    density = 2.0 * (2 * np.pi) ** -1.5 * np.sqrt(lx * lt) * score * np.exp(-0.5 * score**2)
    return float(rows * _HUNDRED / step * density)


def thresholds(templates: tuple[Template, ...], rows: int, step: float, rate: float) -> NDArray[np.float64]:
    """Return the score (k,) that peaks of each template pass by chance, each an equal share of `rate` in 100 m."""
    share = rate / (DISTINCT * len(templates)) if templates else rate

    def over(u: float, one: Template) -> float:
        return float(np.log(false_alarms(u, one, rows, step) / share))

    return np.array([brentq(over, 1.0, 20.0, args=(t,)) if over(1.0, t) > 0 else 1.0 for t in templates])
