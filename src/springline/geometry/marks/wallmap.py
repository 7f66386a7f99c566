"""The unrolled wall in cells: how far out it stands on average, and what share of it is open."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_LEAST_SEEN = 0.25


@dataclass(frozen=True)
class WallMap:
    """Sums over the cells of an unrolled wall; rows run along the pipe, columns round it.

    Attributes:
        row: (ring,) the row in which each ring lies.
        column: (bearing,) the column in which each bearing lies.
        possible: (row, column) readings that could have been.
        seen: (row, column) readings that are there.
        outside: (row, column) sum of their deviations [m].
        missing: (row, column) readings without a return.
        far: (row, column) readings that stand far outside.
        water: (row, column) readings of water or a bed.
    """

    row: NDArray[np.int64]
    column: NDArray[np.int64]
    possible: NDArray[np.float64]
    seen: NDArray[np.float64]
    outside: NDArray[np.float64]
    missing: NDArray[np.float64]
    far: NDArray[np.float64]
    water: NDArray[np.float64]

    @property
    def mean(self) -> NDArray[np.float64]:
        """(row, column) mean deviation [m]; NaN where less than a quarter was seen."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.seen >= _LEAST_SEEN * self.possible, self.outside / self.seen, np.nan)

    def row_means(self, values: ArrayLike) -> NDArray[np.float64]:
        """Return the mean over each row of a value per ring."""
        count = np.bincount(self.row, minlength=len(self.possible))
        total = np.bincount(self.row, np.asarray(values, float), minlength=len(self.possible))
        return total / np.maximum(count, 1)


def empty_map(distance: ArrayLike, bearings: int, *, length: float, columns: int) -> WallMap:
    """Return a map without readings: rows of `length` [m] (rings farther apart are a row each), `columns` round.

    Args:
        distance: (ring,) increasing [m].
        bearings: Readings per ring.
        length: Of a cell [m].
        columns: Cells round the pipe; no more than there are bearings.
    """
    distance = np.asarray(distance, float)
    rows = np.floor((distance - distance[0]) / length + 1e-9).astype(np.int64)
    row = np.concatenate([[0], np.cumsum(np.diff(rows) > 0)]).astype(np.int64)
    columns = min(columns, bearings)
    column = np.arange(bearings) * columns // bearings
    shape = (int(row[-1]) + 1, columns)
    possible = np.outer(np.bincount(row), np.bincount(column)).astype(float)
    return WallMap(row, column, possible, *(np.zeros(shape) for _ in range(5)))


def add_rings(
    cells: WallMap, first: int, deviation: ArrayLike, missing: ArrayLike, water: ArrayLike, *, far: ArrayLike
) -> None:
    """Add a block of rings to the map.

    Args:
        cells: The map.
        first: Index of the block's first ring.
        deviation: (ring, bearing) [m]; NaN = not of the wall.
        missing: (ring, bearing) whether there was no return at all.
        water: (ring, bearing) whether it was of water or a bed.
        far: (ring, 1) deviation beyond which a reading stands far outside [m].
    """
    deviation = np.asarray(deviation)
    rows = cells.row[first : first + len(deviation)]
    starts = np.searchsorted(cells.column, np.arange(cells.possible.shape[1]))
    seen = np.isfinite(deviation)
    with np.errstate(invalid="ignore"):
        outside = deviation > far
    wall = seen & ~outside
    for target, values in (
        (cells.seen, wall),
        (cells.outside, np.where(wall, deviation, 0.0)),
        (cells.missing, missing),
        (cells.far, outside),
        (cells.water, water),
    ):
        np.add.at(target, rows, np.add.reduceat(np.asarray(values, np.float64), starts, axis=1))


def lasting_shape(mean: ArrayLike, *, window: int) -> NDArray[np.float64]:
    """Return what of the map goes on along the pipe: its running median over `window` rows, holes bridged.

    A section that is no ellipse departs from its ellipse in the same way for metres; a mark does not.
    """
    mean = np.asarray(mean, float)
    rows = len(mean)
    thin = min(max(1, window // 11), rows)
    starts = np.arange(0, rows, thin)
    padded = np.full((len(starts) * thin, mean.shape[1]), np.inf)
    padded[:rows] = np.where(np.isfinite(mean), mean, np.inf)
    ordered = np.sort(padded.reshape(len(starts), thin, -1), axis=1)
    count = np.isfinite(ordered).sum(axis=1)
    middle = np.take_along_axis(ordered, np.maximum(count - 1, 0)[:, None] // 2, axis=1)[:, 0]
    coarse = np.where(count > 0, middle, 0.0)
    coarse = median_filter(coarse, size=(min(11, len(coarse) | 1), 1), mode="nearest")
    at = np.minimum(starts + 0.5 * (thin - 1), rows - 1)
    place = np.clip(np.searchsorted(at, np.arange(rows)) - 1, 0, max(len(at) - 2, 0))
    if len(at) == 1:
        return np.repeat(coarse, rows, axis=0)
    share = np.clip((np.arange(rows) - at[place]) / (at[place + 1] - at[place]), 0.0, 1.0)[:, None]
    return (1.0 - share) * coarse[place] + share * coarse[place + 1]


def at_readings(rows: ArrayLike, cells: WallMap, values: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return values of cells at every reading of some rings, linear round the pipe.

    Args:
        rows: (ring,) row of each ring.
        cells: The map.
        values: (row, column) one value per cell.
    """
    bearings = len(cells.column)
    middle = (np.bincount(cells.column, np.arange(bearings)) / np.bincount(cells.column)).astype(float)
    around = np.concatenate([[middle[-1] - bearings], middle, [middle[0] + bearings]])
    wrapped = np.concatenate([values[:, -1:], values, values[:, :1]], axis=1)
    place = np.searchsorted(around, np.arange(bearings), side="right") - 1
    share = (np.arange(bearings) - around[place]) / (around[place + 1] - around[place])
    here = wrapped[np.asarray(rows)].astype(np.float32)
    return here[:, place] * (1.0 - share).astype(np.float32) + here[:, place + 1] * share.astype(np.float32)


def smoothed(mean: ArrayLike, *, along: int, around: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean over boxes of cells, and the share of each box that was seen; NaN under half.

    Args:
        mean: (row, column) values; NaN = not seen.
        along: Rows of the box.
        around: Columns of the box, which closes round the pipe.
    """
    mean = np.asarray(mean, float)
    seen = np.isfinite(mean)
    total, share = np.where(seen, mean, 0.0), seen.astype(float)
    for axis, size, mode in ((0, along, "constant"), (1, around, "wrap")):
        total = uniform_filter1d(total, size, axis=axis, mode=mode)
        share = uniform_filter1d(share, size, axis=axis, mode=mode)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(share >= 0.5 - 1e-9, total / share, np.nan), share


def confirmed(height: ArrayLike) -> NDArray[np.float64]:
    """Return the map with what stands inward in one row alone brought back to its neighbours in the rows beside it.

    Stray readings of one ring do not make a mark; something that lasts over two rows does.

    Args:
        height: (row, column) [m]; NaN = not seen.

    >>> confirmed([[0.0, 0.0, 0.0], [0.0, -5.0, 0.0], [0.0, 0.0, 0.0]])[1].tolist()
    [0.0, 0.0, 0.0]
    """
    height = np.asarray(height, float)
    high = np.where(np.isfinite(height), height, np.inf)
    beside = np.minimum(high, np.minimum(np.roll(high, 1, axis=1), np.roll(high, -1, axis=1)))
    support = np.full(height.shape, np.inf)
    support[1:] = beside[:-1]
    support[:-1] = np.minimum(support[:-1], beside[1:])
    return np.where(np.isfinite(height), np.maximum(height, np.where(np.isfinite(support), support, 0.0)), np.nan)
