"""Values along the pipe, thinned for drawing without losing the extremes, and round axes to draw them on."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, log10
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..results import Results

_POINTS = 800


@dataclass(frozen=True)
class Axis:
    """A drawn axis: its two ends and its ticks in the unit of the values; labels show `factor` times as much."""

    low: float
    high: float
    ticks: tuple[float, ...]
    decimals: int
    factor: float = 1.0

    def share(self, value: float | np.ndarray) -> float | np.ndarray:
        """Return where a value lies between the ends, 0 to 1."""
        return (value - self.low) / (self.high - self.low)

    def label(self, value: float) -> str:
        """Return the text of a tick."""
        return f"{value * self.factor + 0.0:.{self.decimals}f}".replace("-", "−")


def make_axis(low: float, high: float, *, ticks: int = 5, tight: bool = False) -> Axis:
    """Return an axis over at least [low, high] with about `ticks` round ticks; it ends at the values when `tight`.

    >>> make_axis(0.0, 4.1).ticks
    (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)
    """
    if not (np.isfinite(low) and np.isfinite(high)):
        low, high = 0.0, 1.0
    if high - low < 1e-9 * max(abs(low), abs(high), 1e-6):
        low, high = low - 0.5, high + 0.5
    rough = (high - low) / ticks
    decade = 10.0 ** floor(log10(rough))
    step = next(s for s in (1.0, 2.0, 2.5, 5.0, 10.0) if s * decade >= rough * (1 - 1e-9)) * decade
    first, last = (ceil, floor) if tight else (floor, ceil)
    marks = np.arange(
        first(low / step - 1e-9 * (1 if tight else -1)), last(high / step + 1e-9 * (1 if tight else -1)) + 1
    )
    decimals = max(0, ceil(-log10(step) - 1e-9))
    decimals += abs(round(step, decimals) - step) > 1e-9 * step
    values = tuple(float(round(m * step, 12)) for m in marks)
    ends = (low, high) if tight else (values[0], values[-1])
    return Axis(*ends, values, decimals)


class Profiles:
    """The chainage axis that all charts share, and the thinning of values onto it.

    Args:
        results: The finished survey.
        factor: Printed unit of chainage per metre, such as 3.28 for feet: ticks are round in it.
    """

    def __init__(self, results: Results, factor: float = 1.0) -> None:
        self._group = results.groups(_POINTS)
        self._first = np.flatnonzero(np.diff(self._group, prepend=-1))
        start, end = results.extents
        self.start, self.end = start[self._first], end[np.append(self._first[1:], start.size) - 1]
        self.middle = (self.start + self.end) / 2
        low, high = float(self.start[0]), float(self.end[-1])
        if high <= low:
            low, high = low - 0.5, high + 0.5
        shown = _onto_ticks(make_axis(low * factor, high * factor, ticks=8, tight=True))
        ticks = tuple(tick / factor for tick in shown.ticks)
        self.axis = Axis(shown.low / factor, shown.high / factor, ticks, shown.decimals, factor)

    def thin(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the smallest and the largest value of each group of stations, NaN where none has one."""
        return np.fmin.reduceat(values, self._first), np.fmax.reduceat(values, self._first)

    def breaks(self) -> np.ndarray:
        """Return whether a gap without stations lies before each group."""
        return np.append(False, self.start[1:] > self.end[:-1] + 1e-9)

    def spans(self, flagged: np.ndarray) -> list[tuple[float, float]]:
        """Return start and end [m] of each run of groups in which every station is flagged."""
        whole = np.logical_and.reduceat(flagged, self._first)
        edges = np.flatnonzero(np.diff(np.concatenate(([False], whole, [False]))))
        return [(float(self.start[i]), float(self.end[j - 1])) for i, j in zip(edges[::2], edges[1::2], strict=True)]

    def gaps(self) -> list[tuple[float, float]]:
        """Return start and end [m] of each gap between stations."""
        at = np.flatnonzero(self.breaks())
        return [(float(self.end[k - 1]), float(self.start[k])) for k in at]


def _onto_ticks(axis: Axis) -> Axis:
    """Return the axis with its ends moved out to the next tick where that is near."""
    step = axis.ticks[1] - axis.ticks[0] if len(axis.ticks) > 1 else axis.high - axis.low
    near = 0.02 * (axis.high - axis.low)
    low, high = floor(axis.low / step + 1e-9) * step, ceil(axis.high / step - 1e-9) * step
    low, high = (low if axis.low - low < near else axis.low), (high if high - axis.high < near else axis.high)
    ticks = sorted({*axis.ticks, *(round(end, 12) for end in (low, high) if end not in (axis.low, axis.high))})
    return Axis(low, high, tuple(ticks), axis.decimals)
