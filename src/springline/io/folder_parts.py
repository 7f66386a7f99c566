"""The tables of a survey folder beside its rings: inertial log, ties, frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..errors import FormatError, InputError, nearest
from .columns import factor, find, parse_column
from .rings import replace_unit
from .tables import open_table

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from .columns import Column
    from .tables import TextTable

_AXES = "xyz"
_ATTITUDE = ("heading", "inclination", "bank")
_TIES = ("distance", "easting", "northing", "elevation", "sigma")


def read_inertial(path: Path, units: Mapping[str, str]) -> tuple[xr.Dataset, list[str]]:
    """Read an inertial log into `/inertial`: rates [rad/s] and specific force [m/s2] in robot axes, or attitude [rad].

    Args:
        path: Columns `time_s` and `gyro_x_rad_s ... accel_z_m_s2`, or `heading_deg, inclination_deg, bank_deg`.
        units: Unit by quantity, for columns whose name has none.

    Returns:
        The group, and sentences on what was assumed.

    Raises:
        InputError: A column is missing, unknown or without unit, a cell cannot be used, or time goes back.
    """
    rates = tuple(f"{name}_{axis}" for name in ("gyro", "accel") for axis in _AXES)
    columns, values, rows = _numbers(path, ("time", *rates, *_ATTITUDE))
    have = {c.quantity for c in columns}
    groups = [g for g in (rates, _ATTITUDE) if have & set(g)]
    if not groups:
        raise InputError(
            "there are neither rates nor attitude",
            where=path,
            expected="gyro_x_rad_s ... accel_z_m_s2, or heading_deg, inclination_deg, bank_deg",
        )
    si = {q: _si(columns, values, q, units, path) for q in ("time", *(q for g in groups for q in g))}
    _check_finite(si, rows, path)
    back = np.flatnonzero(np.diff(si["time"]) <= 0)
    if back.size:
        raise InputError(
            f"the time does not increase: {si['time'][back[0]]:g} s, then {si['time'][back[0] + 1]:g} s",
            where=f"{path}, row {rows[back[0] + 1]}",
            expected="times that strictly increase",
        )
    variables = {"time": ("sample", si["time"])}
    if rates in groups:
        for name in ("gyro", "accel"):
            variables[name] = (("sample", "axis"), np.column_stack([si[f"{name}_{axis}"] for axis in _AXES]))
    if _ATTITUDE in groups:
        variables |= {q: ("sample", si[q]) for q in _ATTITUDE}
    return xr.Dataset(variables), []


def read_ties(path: Path, units: Mapping[str, str]) -> tuple[xr.Dataset, list[str]]:
    """Read known points into `/ties` [m]: columns `distance_m, easting_m, northing_m, elevation_m, sigma_m`.

    Raises:
        InputError: A column is missing, unknown or without unit, a cell is empty, or a sigma is not positive.
    """
    columns, values, rows = _numbers(path, _TIES)
    si = {q: _si(columns, values, q, units, path) for q in _TIES}
    _check_finite(si, rows, path)
    wrong = np.flatnonzero(si["sigma"] <= 0)
    if wrong.size:
        raise InputError(
            f"the sigma {si['sigma'][wrong[0]]:g} m is not positive",
            where=f"{path}, row {rows[wrong[0]]}",
            expected="a one-sigma above 0",
        )
    return xr.Dataset({q: ("tie", v) for q, v in si.items()}), []


def read_frames(path: Path, units: Mapping[str, str]) -> tuple[xr.Dataset, list[str]]:
    """Read the list of CCTV frames into `/frames`: `file`, and `time_s`, `distance_m`, `lens` where known.

    Raises:
        InputError: The column `file` or a file name is missing, a column is unknown, or a cell is not a number.
    """
    import pandas as pd

    table = open_table(path)
    try:
        frame = pd.read_csv(path, sep=table.delimiter, dtype=str, keep_default_na=False, skipinitialspace=True)
    except (pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeDecodeError) as error:
        raise FormatError(f"it is not a table: {error}", where=path) from None
    columns = [parse_column(str(name)) for name in frame.columns]
    _known(columns, ("time", "distance", "file", "lens"), path)
    at = {c.quantity: i for i, c in enumerate(columns)}
    if "file" not in at:
        raise InputError("there is no column 'file'", where=path, expected="time_s, distance_m, file, lens")
    files = frame.iloc[:, at["file"]].str.strip()
    if frame.empty or (files == "").any():
        row = 2 if frame.empty else int(np.flatnonzero(files == "")[0]) + 2
        raise InputError("the file's name is missing", where=f"{path}, row {row}, column file")
    variables = {"path": ("frame", files.to_numpy(str))}
    if "lens" in at:
        variables["lens"] = ("frame", frame.iloc[:, at["lens"]].str.strip().to_numpy(str))
    for quantity in ("time", "distance"):
        if quantity in at:
            cells = frame.iloc[:, at[quantity]].str.strip()
            numbers = pd.to_numeric(cells, errors="coerce").to_numpy(np.float64)
            wrong = np.flatnonzero(np.isnan(numbers) & ~cells.str.lower().isin(["", "nan"]).to_numpy())
            if wrong.size:
                raise InputError(
                    f"the cell '{cells.iloc[wrong[0]]}' is not a number",
                    where=f"{path}, row {wrong[0] + 2}, column {columns[at[quantity]].name}",
                )
            variables[quantity] = ("frame", numbers * _factor(columns[at[quantity]], units, path))
    return xr.Dataset(variables), []


def _numbers(path: Path, known: Iterable[str]) -> tuple[list[Column], np.ndarray, np.ndarray]:
    """Return the columns, all values and row numbers of a table of numbers."""
    table: TextTable = open_table(path)
    if not table.names:
        raise FormatError("the table has no header", where=path)
    columns = [parse_column(name) for name in table.names]
    _known(columns, known, path)
    parts = list(table.blocks())
    if not sum(len(p.values) for p in parts):
        raise InputError("there are no rows below the header", where=path)
    return columns, np.concatenate([p.values for p in parts]), np.concatenate([p.numbers for p in parts])


def _known(columns: list[Column], known: Iterable[str], path: Path) -> None:
    for column in columns:
        if column.quantity not in known:
            raise InputError(
                f"the column '{column.name}' is unknown{nearest(column.quantity, known)}",
                where=path,
                expected=", ".join(known),
            )


def _si(columns: list[Column], values: np.ndarray, quantity: str, units: Mapping[str, str], path: Path) -> np.ndarray:
    at = find(columns, quantity, path)
    assert at is not None
    return values[:, at] * _factor(columns[at], units, path)


def _factor(column: Column, units: Mapping[str, str], path: Path) -> float:
    settled = replace_unit(column, units)
    if settled.unit is None:
        raise InputError(
            f"the column '{column.name}' states no unit",
            where=path,
            expected="a unit in its name, or in the table [units] of survey.toml",
        )
    return factor(settled)


def _check_finite(si: Mapping[str, np.ndarray], rows: np.ndarray, path: Path) -> None:
    for quantity, values in si.items():
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size:
            raise InputError(
                f"the {quantity} is missing or not finite", where=f"{path}, row {rows[wrong[0]]}", expected="a number"
            )
