"""Long ring tables: a row per reading (distance, angle, range) becomes rings that share their bearings."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from ..survey.turning import FEWEST, turn_of
from .columns import Column, factor, find
from .ring_arrays import RingArrays, clean_ranges

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from .ring_arrays import Table

_ROUND = 1e-6
_SPREAD = 1.5


def read_long(table: Table, columns: list[Column], units: Mapping[str, str]) -> RingArrays:
    """Return rings from a long table; readings that a ring lacks are NaN.

    Rows of one distance form one ring, in whatever order its readings stand; in a run that comes back, rows of one
    distance that follow one another.

    Args:
        table: The table.
        columns: What its column names say.
        units: Unit by quantity, for columns whose name has none.

    Raises:
        InputError: A column is missing, a cell of distance or angle is, the angle has no unit, a reading is given
            twice, distances go back, or the rings do not share their bearings.
    """
    path = table.path
    at = {q: find(columns, q, path) for q in ("distance", "bearing", "range")}
    at_time = find(columns, "time", path, required=False)
    wanted = [at["distance"], at["bearing"], at["range"], *([] if at_time is None else [at_time])]
    parts, numbers, zeros = [], [], 0
    for block in table.blocks():
        values = block.values[:, wanted]
        zeros += clean_ranges(values[:, 2:3], block.numbers, [columns[wanted[2]].name], path)
        _check_present(values[:, :2], block.numbers, [columns[i] for i in wanted[:2]], path)
        parts.append(values)
        numbers.append(block.numbers)
    if not parts or not sum(map(len, parts)):
        raise InputError("there are no rows below the header", where=path, expected="at least one reading")
    values, rows = np.concatenate(parts), np.concatenate(numbers)
    angle = _angles(values[:, 1], columns[wanted[1]], units, path)
    distance, ring = _rings(values[:, 0], rows, path)
    _, first_of, reading = np.unique(np.round(angle / _ROUND).astype(np.int64), return_index=True, return_inverse=True)
    bearings = angle[first_of]
    most = int(np.bincount(ring).max())
    if len(bearings) > _SPREAD * most:
        raise InputError(
            f"the rings do not share their bearings: {len(bearings)} different angles, at most {most} in a ring",
            where=path,
            expected="readings at the same angles in every ring",
            mend="round the angles to the device's step, or give the readings as a cloud of x, y, z",
        )
    _check_twice(ring, reading, len(bearings), rows, columns[wanted[1]].name, path)
    ranges = np.full((len(distance), len(bearings)), np.nan, np.float32)
    ranges[ring, reading] = values[:, 2]
    first = np.full(len(distance), np.iinfo(np.int64).max)
    np.minimum.at(first, ring, rows)
    time = None
    if at_time is not None:
        time = np.full(len(distance), np.nan)
        np.fmin.at(time, ring, values[:, 3])
    return RingArrays(distance, ranges, bearings, first, time, zeros)


def _angles(values: np.ndarray, column: Column, units: Mapping[str, str], path: Path) -> np.ndarray:
    """Return device angles [rad] in [0, 2 pi)."""
    unit = column.unit or units.get("bearing") or ("h" if column.word == "clock" else None)
    if unit is None:
        raise InputError(
            f"the column '{column.name}' states no unit",
            where=path,
            expected=f"a unit in its name, {column.name}_deg or {column.name}_rad",
        )
    angle = values * factor(column, unit) % (2 * pi)
    angle[2 * pi - angle < _ROUND / 2] = 0.0
    return angle


def _rings(distance: np.ndarray, rows: np.ndarray, path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the distance of each ring, and the ring that each row belongs to.

    A distance that stands twice is one ring, but in a run that comes back: there it is one of either way.
    """
    change = np.diff(distance) != 0
    runs = distance[np.concatenate([[True], change])]
    if turn_of(runs) is not None:
        return runs, np.concatenate([[0], np.cumsum(change)])
    distances, ring = np.unique(distance, return_inverse=True)
    back = np.flatnonzero(np.diff(distance) < 0)
    if len(runs) == len(distances) and back.size:
        k = int(back[0]) + 1
        raise InputError(
            f"the distance goes back: {distance[k - 1]:g}, then {distance[k]:g}",
            where=f"{path}, row {rows[k]}",
            expected="distances that increase along travel",
            mend=f"a run may come back once, with {FEWEST} rings or more either way; split others into one table each",
        )
    return distances, ring


def _check_present(values: np.ndarray, rows: np.ndarray, columns: list[Column], path: Path) -> None:
    missing = np.argwhere(~np.isfinite(values))
    if missing.size:
        i, j = missing[0]
        raise InputError(
            "the cell is empty or not finite",
            where=f"{path}, row {rows[i]}, column {columns[j].name}",
            expected="a number",
        )


def _check_twice(ring: np.ndarray, reading: np.ndarray, count: int, rows: np.ndarray, name: str, path: Path) -> None:
    key = ring.astype(np.int64) * count + reading
    order = np.argsort(key, kind="stable")
    twice = np.flatnonzero(np.diff(key[order]) == 0)
    if twice.size:
        a, b = sorted((rows[order[twice[0]]], rows[order[twice[0] + 1]]))
        raise InputError(
            f"the rows {a} and {b} give the same reading twice: their distance and {name} are equal",
            where=path,
            expected="each distance in one ring only",
            mend="drop rings taken at a standstill",
        )
