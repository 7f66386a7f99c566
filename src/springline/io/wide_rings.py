"""Wide ring tables: a row per ring, with its distance and r_0 ... r_n at equal bearings."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from .columns import Column, factor, find
from .ring_arrays import RingArrays, clean_ranges

if TYPE_CHECKING:
    from .ring_arrays import Table

_MIN_READINGS = 3


def read_wide(table: Table, columns: list[Column]) -> RingArrays:
    """Return rings from a wide table.

    Args:
        table: The table.
        columns: What its column names say.

    Raises:
        InputError: A column is missing or given twice, or a range is negative.
    """
    path = table.path
    at_distance, at_time = find(columns, "distance", path), find(columns, "time", path, required=False)
    by_index = {c.index: i for i, c in enumerate(columns) if c.index is not None}
    indexed = [c for c in columns if c.index is not None]
    if len(by_index) < len(indexed):
        twice = next(c for c in indexed if columns[by_index[c.index]] is not c)
        raise InputError(f"the column '{twice.name}' is given twice", where=path)
    gap = next((k for k in range(len(by_index)) if k not in by_index), None)
    if gap is not None or len(by_index) < _MIN_READINGS:
        raise InputError(
            f"reading {gap} is missing" if gap is not None else f"a ring has {len(by_index)} readings only",
            where=path,
            expected=f"columns r_0, r_1, ... without a gap, at least {_MIN_READINGS}, at equal bearings",
        )
    order = [by_index[k] for k in range(len(by_index))]
    scales = _relative_scales([columns[i] for i in order])
    distance, time, ranges, rows, zeros = [], [], [], [], 0
    for block in table.blocks():
        readings = block.values[:, order]
        zeros += clean_ranges(readings, block.numbers, [columns[i].name for i in order], path)
        ranges.append((readings if scales is None else readings * scales).astype(np.float32))
        distance.append(block.values[:, at_distance])
        rows.append(block.numbers)
        if at_time is not None:
            time.append(block.values[:, at_time])
    if not rows or not sum(map(len, rows)):
        raise InputError("there are no rows below the header", where=path, expected="at least one ring")
    return RingArrays(
        np.concatenate(distance),
        np.concatenate(ranges),
        2 * pi * np.arange(len(order)) / len(order),
        np.concatenate(rows),
        np.concatenate(time) if time else None,
        zeros,
    )


def _relative_scales(readings: list[Column]) -> np.ndarray | None:
    """Return factors to the first reading's unit where columns differ in unit."""
    if len({c.unit for c in readings}) == 1:
        return None
    bare = next((c for c in readings if c.unit is None), None)
    if bare is not None:
        raise InputError(
            f"the column '{bare.name}' has no unit but '{next(c.name for c in readings if c.unit)}' has",
            where="header",
            expected="a unit in every reading's name or in none",
        )
    return np.array([factor(c) for c in readings]) / factor(readings[0])
