"""From a ring table to the group `/rings`: wide (a row per ring) or long (a row per reading)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import pi
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..conventions import BEARING_SENSES, BEARING_ZEROS
from ..errors import FormatError, InputError
from ..survey import Survey, add_assumption
from ..survey.turning import FEWEST, turn_of
from .columns import Column, base_quantity, factor, find, parse_column
from .long_rings import read_long
from .ring_units import check_nominal, range_unit
from .wide_rings import read_wide

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from .options import ReadOptions
    from .ring_arrays import RingArrays, Table

_BLOCK = 4096
_FARTHEST = 1e6
"""Distance [m] beyond which a counter's unit, or its cells, cannot be right."""


@dataclass(frozen=True)
class Statements:
    """What stands beside a table about it, such as in `survey.toml` or in a Parquet file's metadata.

    Args:
        units: Unit by quantity, for columns whose name has none.
        bearing_zero: Where the device's zero lies.
        bearing_sense: ccw or cw.
        attrs: Attributes of `/rings` that the file states.
        flags: How the user may state bearings, for the sentence that tells what was assumed.
        assumptions: Sentences on what was assumed when the table was made.
    """

    units: Mapping[str, str] = field(default_factory=dict)
    bearing_zero: str | None = None
    bearing_sense: str | None = None
    attrs: Mapping[str, object] = field(default_factory=dict)
    flags: str = "--bearing-zero crown --bearing-sense cw"
    assumptions: tuple[str, ...] = ()


def is_ring_table(names: tuple[str, ...]) -> bool:
    """Whether columns of these names make a ring table: readings by index, or ranges by angle.

    >>> is_ring_table(("distance_m", "r_0", "r_1")), is_ring_table(("x", "y", "z"))
    (True, False)
    """
    columns = [parse_column(name) for name in names]
    quantities = {c.quantity for c in columns if c.index is None}
    return any(c.index is not None for c in columns) or {"bearing", "range"} <= quantities


def ring_survey(table: Table, options: ReadOptions, statements: Statements | None = None) -> Survey:
    """Return a survey with `/rings` from a wide or a long table.

    Bearings are turned to run from +z counter-clockwise and are put in increasing order in [0, 2 pi). Where neither
    the user nor the file states zero and sense, right and ccw are assumed, and `bearing_assumed` is 1.

    Args:
        table: The table; wide has a distance and r_0 ... r_n, long has a distance, an angle and a range.
        options: What the user states.
        statements: What the file's surroundings state; the user's word wins.

    Raises:
        InputError: A column is missing or given twice, a range is negative, a distance is missing, repeats or goes
            back, or the unit cannot be told or contradicts the nominal diameter.
    """
    statements = statements or Statements()
    path = table.path
    if not table.names:
        raise FormatError("the table has no header", where=path, expected="a header such as distance_m, r_0, r_1, ...")
    columns = [parse_column(name) for name in table.names]
    wide = any(c.index is not None for c in columns)
    arrays = read_wide(table, columns) if wide else read_long(table, columns, statements.units)
    return rings_from_arrays(arrays, columns, path, options, statements)


def rings_from_arrays(
    arrays: RingArrays, columns: list[Column], path: Path, options: ReadOptions, statements: Statements
) -> Survey:
    """Return a survey with `/rings` from rings as a file holds them, changed in place; checks as in `ring_survey`.

    Args:
        arrays: The rings.
        columns: What the names of the file's columns say.
        path: The file, for messages.
        options: What the user states.
        statements: What the file's surroundings state.
    """
    notes = list(statements.assumptions)
    readings = [c for c in columns if c.quantity == "range"]
    _settle_units(arrays, columns, readings, path, options, statements, notes)
    if not np.isfinite(arrays.ranges).any():
        raise InputError("every reading is missing", where=path, expected="at least one return")
    _check_distance(arrays, path)
    check_nominal(arrays.ranges, options.nominal_diameter, path)
    clock = any(c.word == "clock" for c in columns)
    data = _dataset(arrays, path, options, _with_clock(statements) if clock else statements, notes)
    return add_assumption(Survey({"rings": data}), *notes)


def _with_clock(statements: Statements) -> Statements:
    return replace(statements, bearing_zero="crown", bearing_sense="cw")


def _settle_units(
    arrays: RingArrays,
    columns: list[Column],
    readings: list[Column],
    path: Path,
    options: ReadOptions,
    statements: Statements,
    notes: list[str],
) -> None:
    """Turn distance, time and ranges to SI, in place."""
    distance = columns[find(columns, "distance", path) or 0]
    stated = replace_unit(readings[0], statements.units)
    stated_distance = replace_unit(distance, statements.units)
    unit, note = range_unit(arrays.ranges, stated, stated_distance.unit, path, options)
    notes += [note] if note else []
    if distance.word != "distance":
        notes.append(f"{path.name}: the column '{distance.name}' is taken as what the odometer read.")
    if stated_distance.unit is None:
        assumed = "ft" if unit in ("in", "ft") else "m"
        notes.append(f"{path.name}: the column '{distance.name}' states no unit; taken as {assumed}.")
        stated_distance = replace(stated_distance, unit=assumed)
    scale = np.float64(factor(Column("r", "range", None, unit)))
    for start in range(0, len(arrays.ranges) if scale != 1 else 0, _BLOCK):
        # In float64 and back: a product of float32 would be off by its last digit.
        arrays.ranges[start : start + _BLOCK] = arrays.ranges[start : start + _BLOCK] * scale
    arrays.distance = arrays.distance * factor(stated_distance)
    if arrays.time is not None:
        column = replace_unit(columns[find(columns, "time", path) or 0], statements.units)
        if column.unit is None:
            notes.append(f"{path.name}: the column '{column.name}' states no unit; taken as seconds.")
        arrays.time = arrays.time * factor(column, "s")
    if arrays.no_return:
        notes.append(f"{path.name}: {arrays.no_return} readings of zero or infinity were taken as no return.")


def replace_unit(column: Column, units: Mapping[str, str]) -> Column:
    """Return the column with the unit that stands beside the table when its name has none."""
    return column if column.unit else replace(column, unit=units.get(base_quantity(column.quantity)))


def _check_distance(arrays: RingArrays, path: Path) -> None:
    missing = np.flatnonzero(~np.isfinite(arrays.distance))
    if missing.size:
        raise InputError(
            "the distance is missing", where=f"{path}, row {arrays.rows[missing[0]]}", expected="a finite number"
        )
    far = np.flatnonzero(np.abs(arrays.distance) > _FARTHEST)
    if far.size:
        raise InputError(
            f"the distance is {arrays.distance[far[0]]:g} m",
            where=f"{path}, row {arrays.rows[far[0]]}",
            expected=f"within {_FARTHEST / 1e3:g} km",
            mend="state the unit of the distance in its column's name, such as distance_mm",
        )
    steps = np.diff(arrays.distance)
    wrong = np.flatnonzero(steps <= 0)
    if not wrong.size or turn_of(arrays.distance) is not None:
        return
    k = int(wrong[0]) + 1
    word = "repeats" if steps[k - 1] == 0 else "goes back"
    whole = steps.size > 1 and (steps < 0).all()
    raise InputError(
        f"the distance {word}: {arrays.distance[k - 1]:g} m, then {arrays.distance[k]:g} m",
        where=f"{path}, row {arrays.rows[k]}",
        expected="distances that strictly increase",
        mend="reverse the order of the rings"
        if whole
        else f"a run may come back once, with {FEWEST} rings or more either way; split others, and drop rings taken "
        "at a standstill",
    )


def _dataset(
    arrays: RingArrays, path: Path, options: ReadOptions, statements: Statements, notes: list[str]
) -> xr.Dataset:
    zero = options.bearing_zero or statements.bearing_zero
    sense = options.bearing_sense or statements.bearing_sense
    assumed = zero is None or sense is None
    zero, sense = zero or "right", sense or "ccw"
    if assumed:
        notes.append(
            f"{path.name}: where the device's zero lies and which way it counts is not stated; assumed zero at the "
            f"{zero}, {sense} looking forward. Most devices start at the crown and run clockwise: if this one does, "
            f"say so with {statements.flags}, otherwise the pipe is read mirrored and turned."
        )
    bearing = BEARING_ZEROS[zero] + BEARING_SENSES[sense] * arrays.angle
    bearing = bearing % (2 * pi)
    bearing[2 * pi - bearing < 1e-9] = 0.0
    order = np.argsort(bearing, kind="stable")
    if (np.diff(bearing[order]) < 1e-9).any():
        raise InputError("two readings of a ring share one bearing", where=path, expected="bearings that differ")
    ranges = arrays.ranges if (np.diff(order) == 1).all() else arrays.ranges[:, order]
    variables = {
        "range": (("ring", "bearing"), ranges),
        "distance": ("ring", arrays.distance),
        "bearing": ("bearing", bearing[order]),
    }
    if arrays.time is not None:
        variables["time"] = ("ring", arrays.time)
    attrs = {
        "referred_to": "sensor",
        "distance_source": "odometer",
        "sensor_kind": "unknown",
        **statements.attrs,
        "bearing_zero": zero,
        "bearing_sense": sense,
        "bearing_assumed": int(assumed),
    }
    if options.sensor:
        attrs["sensor_kind"] = options.sensor
    return xr.Dataset(variables, attrs=attrs)
