"""Connected patches of an unrolled wall, which closes round the pipe; and runs of rings."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.ndimage import label

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Regions(NamedTuple):
    """Patches of flagged cells: (row, column) number of the patch, 0 outside; and the extent of each.

    Attributes:
        labels: (row, column) 0 outside, 1 to n.
        first_row: (n,) first row of each patch.
        last_row: (n,) its last row.
        first_column: (n,) its first column, going round with rising bearing.
        columns: (n,) how many columns it spans.
        cells: (n,) how many cells it has.
    """

    labels: NDArray[np.int64]
    first_row: NDArray[np.int64]
    last_row: NDArray[np.int64]
    first_column: NDArray[np.int64]
    columns: NDArray[np.int64]
    cells: NDArray[np.int64]


def regions(flags: ArrayLike) -> Regions:
    """Return the patches of flagged cells that touch, corners included; the last column touches the first.

    >>> found = regions([[True, False, False, True], [False, False, False, False]])
    >>> found.cells.tolist(), found.first_column.tolist(), found.columns.tolist()
    ([2], [3], [2])
    """
    flags = np.asarray(flags, bool)
    labels, count = label(flags, np.ones((3, 3)))
    labels = _joined(labels, count)
    numbers = np.unique(labels[labels > 0])
    rank = np.zeros(int(labels.max(initial=0)) + 1, np.int64)
    rank[numbers] = np.arange(1, len(numbers) + 1)
    labels = rank[labels]
    n, (rows, columns) = len(numbers), flags.shape
    at_row, at_column = np.nonzero(labels)
    which = labels[at_row, at_column] - 1
    first_row, last_row = np.full(n, rows), np.full(n, -1)
    np.minimum.at(first_row, which, at_row)
    np.maximum.at(last_row, which, at_row)
    there = np.zeros((n, columns), bool)
    there[which, at_column] = True
    first_column, span = _arcs(there)
    return Regions(labels, first_row, last_row, first_column, span, np.bincount(which, minlength=n))


def _joined(labels: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return the labels with patches made one that touch across the seam between last and first column."""
    parent = np.arange(count + 1)

    def root(k: int) -> int:
        while parent[k] != k:
            k = int(parent[k])
        return k

    last, first = labels[:, -1], labels[:, 0]
    for shift in (-1, 0, 1):
        a, b = last[max(0, -shift) : len(last) - max(0, shift)], first[max(0, shift) : len(first) + min(0, shift)]
        for p, q in np.unique(np.stack([a, b], axis=1)[(a > 0) & (b > 0)], axis=0).tolist():
            parent[root(q)] = root(p)
    return np.array([root(k) for k in range(count + 1)])[labels]


def _arcs(there: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first column and the span of the shortest arc that holds all columns of each patch."""
    n, columns = there.shape
    first, span = np.zeros(n, np.int64), np.full(n, columns)
    for k in range(n):
        at = np.flatnonzero(there[k])
        gaps = np.diff(np.append(at, at[0] + columns))
        widest = int(np.argmax(gaps))
        if gaps[widest] > 1:
            first[k], span[k] = at[(widest + 1) % len(at)], columns - gaps[widest] + 1
    return first, span


def runs(flags: ArrayLike, *, bridge: int = 0) -> NDArray[np.int64]:
    """Return (run, 2) first and last index of each run of flags, holes of up to `bridge` bridged.

    >>> runs([0, 1, 1, 0, 1, 0, 0, 1], bridge=1).tolist()
    [[1, 4], [7, 7]]
    """
    at = np.flatnonzero(np.asarray(flags, bool))
    if not len(at):
        return np.empty((0, 2), np.int64)
    breaks = np.flatnonzero(np.diff(at) > bridge + 1)
    return np.stack([at[np.concatenate([[0], breaks + 1])], at[np.concatenate([breaks, [len(at) - 1]])]], axis=1)
