"""What a chain assumes and what it gives back: the state, the grid of drift, the smoothed chain."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class State:
    """What is unknown besides the drift.

    Attributes:
        scale: Odometer of B over that of A.
        noise: One-sigma of a feature's chainage in one inspection [m].
        walk: Drift of one odometer against the other [m per root m].
        shared: (kinds,) fraction of A's features that B has.
        tempered: Whether joints count for no more than their own spacing lets them tell one from the next.
    """

    scale: float
    noise: float
    walk: float
    shared: np.ndarray
    tempered: bool = False


@dataclass(frozen=True)
class Grid:
    """Grid of drift: low + k step [m]."""

    low: float
    step: float
    cells: int

    @cached_property
    def drift(self) -> np.ndarray:
        """Drift of each cell [m]."""
        return self.low + self.step * np.arange(self.cells)


@dataclass(frozen=True)
class Passes:
    """Smoothed chain of one state.

    Attributes:
        u: (n,) scaled chainages of A.
        grid: Of drift.
        gamma: (n, cells) posterior of the drift at each feature.
        shares: (n, m) posterior of each pair.
    """

    u: np.ndarray
    grid: Grid
    gamma: np.ndarray
    shares: np.ndarray
