"""Walls made of arcs and lines, as the solver asks for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....errors import ParameterError
from .chains import chain_radius, moving_chain

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .models import Model

    Array = NDArray[np.float64]

LARGEST = 6.0
"""Largest length, over the mean radius of the ring's ellipse, that a coordinate may reach."""


class ChainWall:
    """A family of `models`, in units in which the ring's ellipse has the mean radius 1."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.floor = model.floor
        self.ceiling = np.where(model.lengths, LARGEST, np.inf)
        self.safe = model.coordinates_of(model.starts[:1])

    def prepare(self, coordinates: Array) -> tuple[NDArray[np.bool_], tuple[Array, Array]]:
        """Return which coordinates (R, K) make sections, and what `evaluate` needs of those that do."""
        good = self.model.valid(self.model.parameters_of(coordinates))
        kept, chains = self._chains(np.flatnonzero(good), coordinates)
        good[:] = False
        good[kept] = True
        return good, chains

    def evaluate(self, rows, prepared, bearing, counts, radius, slope, by) -> None:
        """Fill radius, slope and derivatives; see `solve.Wall`."""
        chain_radius(rows, bearing, counts, self.model.straight, *prepared, radius, slope, by)

    def _chains(self, rows: NDArray[np.int64], coordinates: Array) -> tuple[NDArray[np.int64], tuple[Array, Array]]:
        """Return the chains of some rows, without those whose sections are refused: halved until they are found."""
        try:
            return rows, moving_chain(self.model.chain_at, coordinates[rows], self.floor)
        except ParameterError:
            if rows.size == 1:
                empty = moving_chain(self.model.chain_at, self.safe, self.floor)
                return rows[:0], (empty[0][:0], empty[1][:0])
        halves = [self._chains(part, coordinates) for part in (rows[: rows.size // 2], rows[rows.size // 2 :])]
        kept, chains = zip(*halves, strict=True)
        return np.concatenate(kept), tuple(np.concatenate(pair) for pair in zip(*chains, strict=True))
