"""Windows of neighbouring knots: what is linearised, eliminated and told at once.

Neighbours share their border knot, and the elimination goes on from one to the next, so windows bound what is held in
memory and change nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MOST_RINGS = 4096
MOST_INTERVALS = 1024
"""What one window may hold: a hundred megabytes of derivatives."""
HELD = 4
"""Most windows whose equations stay in memory."""


@dataclass(frozen=True)
class Window:
    """Knots from `first` to `last`, both included; its intervals are those that begin at all but the last.

    Attributes:
        first: Its first knot.
        last: Its last knot, the next window's first.
        ends: Whether the survey ends with it.
    """

    first: int
    last: int
    ends: bool

    @property
    def intervals(self) -> np.ndarray:
        """Knot at which each of its intervals begins."""
        return np.arange(self.first, self.last)

    @property
    def knots(self) -> slice:
        """Its knots."""
        return slice(self.first, self.last + 1)

    def rows(self, interval: np.ndarray) -> slice:
        """Return which of places in order, known by their interval (n,), lie within it."""
        low, high = np.searchsorted(interval, (self.first, self.last))
        return slice(int(low), int(high))


def cut(interval: np.ndarray, intervals: int) -> list[Window]:
    """Return windows that hold no more than they may.

    Args:
        interval: Of each ring, in order (n,).
        intervals: How many there are.

    >>> [(one.first, one.last, one.ends) for one in cut(np.arange(1500), 1500)]
    [(0, 1024, False), (1024, 1500, True)]
    """
    out, first = [], 0
    while first < intervals:
        last = min(first + MOST_INTERVALS, intervals)
        start = int(np.searchsorted(interval, first))
        if start + MOST_RINGS < len(interval):
            # An interval is never cut, however many rings it holds.
            last = min(last, max(int(interval[start + MOST_RINGS]), first + 1))
        out.append(Window(first, last, last == intervals))
        first = last
    return out
