"""Tables of an inspection: stations, their one-sigma, features; empty means not available, never 0."""

from __future__ import annotations

import csv
import math
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from ..conventions import DESIGN_LINE_COLUMNS, FEATURE_COLUMNS, STATION_COLUMNS, clock_from_bearing
from .results import Results, text
from .units import converted

if TYPE_CHECKING:
    from pathlib import Path

    from ..conventions import Column
    from ..survey import Survey
    from .units import System

_HOURS_PER_RADIAN = 6.0 / math.pi
_TEXT = frozenset(c.name for c in STATION_COLUMNS if c.decimals == 0)
_ROWS = 4096

FEATURE_DECIMALS = {
    "chainage_m": 4,
    "chainage_sigma_m": 4,
    "clock_h": 3,
    "size_mm": 2,
    "length_mm": 2,
    "depth_mm": 2,
    "confidence": 3,
}
"""Decimals of the numbers in `features.csv`; the other columns hold text."""

STATION_DECIMALS = {c.name: c.decimals for c in (*STATION_COLUMNS, *DESIGN_LINE_COLUMNS) if c.name not in _TEXT}
"""Decimals of the numbers in `stations.csv`; the other columns hold text."""


def station_columns(survey: Survey) -> tuple[Column, ...]:
    """Return the columns of a survey's stations: those of `conventions.STATION_COLUMNS`, and after them those of
    `DESIGN_LINE_COLUMNS` where it was held against a design line."""
    held = survey.has("layout") and "deviation_up" in survey.layout
    return (*STATION_COLUMNS, *DESIGN_LINE_COLUMNS) if held else STATION_COLUMNS


def stations_table(survey: Survey) -> pd.DataFrame:
    """Return the results at each station, in the columns of `station_columns` and their edge units.

    Args:
        survey: A finished survey.

    Returns:
        One row per station; NaN, or an empty text, where a value is not available.

    Raises:
        ContractError: The survey is not finished.
    """
    results = Results(survey)
    return pd.DataFrame({c.name: _values(results, c) for c in station_columns(survey)})


def stations_sigma_table(survey: Survey) -> pd.DataFrame:
    """Return the one-sigma of each value of `stations_table`: same rows and columns, NaN where there is none.

    Args:
        survey: A finished survey.

    Raises:
        ContractError: The survey is not finished.
    """
    results = Results(survey)
    return pd.DataFrame({c.name: _sigmas(results, c) for c in station_columns(survey)})


def features_table(survey: Survey) -> pd.DataFrame:
    """Return the features in the columns of `conventions.FEATURE_COLUMNS`; without rows when there are none.

    Args:
        survey: A survey; `/features` may be missing.
    """
    if not survey.has("features"):
        return pd.DataFrame({name: [] for name in FEATURE_COLUMNS})
    data = survey.features
    count = data.sizes.get("feature", 0)

    def number(variable: str, factor: float = 1.0) -> np.ndarray:
        return data[variable].values * factor if variable in data.variables else np.full(count, np.nan)

    columns = {
        "kind": text(data, "kind", count),
        "chainage_m": number("chainage"),
        "chainage_sigma_m": number("chainage_sigma"),
        "clock_h": clock_from_bearing(number("bearing")),
        "size_mm": number("size", 1e3),
        "length_mm": number("length", 1e3),
        "depth_mm": number("depth", 1e3),
        "confidence": number("confidence"),
        "source": text(data, "source", count),
        "image": text(data, "image", count),
    }
    return pd.DataFrame({name: columns[name] for name in FEATURE_COLUMNS})


def _values(results: Results, column: Column) -> np.ndarray | list[str]:
    if column.name in _TEXT:
        survey = results.survey
        if not survey.has(column.group):
            return [""] * results.stations
        return text(survey.group(column.group), column.variable, results.stations)
    values = results.station(column.group, column.variable)
    if math.isnan(column.factor):
        # What rounds to 0 o'clock is 12 o'clock.
        clock = np.round(clock_from_bearing(values), column.decimals)
        return np.where(clock == 0.0, 12.0, clock)
    return values * column.factor


def _sigmas(results: Results, column: Column) -> np.ndarray | list[str]:
    if column.name in _TEXT:
        return [""] * results.stations
    factor = _HOURS_PER_RADIAN if math.isnan(column.factor) else column.factor
    return results.station(column.group, f"{column.variable}_sigma") * factor


def write_csv(table: pd.DataFrame, path: Path, decimals: dict[str, int], *, units: System = "si") -> None:
    """Write a table as CSV (UTF-8, comma, point): numbers with their decimals, nothing where a value is missing.

    Text that a spreadsheet would run as a formula is led by an apostrophe. Rows are formatted in blocks, several
    columns at once, because a survey may hold hundreds of thousands.

    Args:
        table: The table.
        path: Where to write.
        decimals: Decimals by column; columns that are not named hold text.
        units: "us" turns millimetres into inches and metres into feet, in the numbers and in the columns' names.
    """
    table, decimals = converted(table, decimals, units)
    runs = _runs(list(table.columns), decimals)
    with path.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerow(table.columns)
        for start in range(0, len(table), _ROWS):
            block = table.iloc[start : start + _ROWS]
            parts = [
                _text_cells(block[names[0]].tolist())
                if names[0] not in decimals
                else _number_cells(block[names].to_numpy(float), [decimals[n] for n in names])
                for names in runs
            ]
            stream.writelines(f"{','.join(row)}\n" for row in zip(*parts, strict=True))


def _runs(names: list[str], decimals: dict[str, int]) -> list[list[str]]:
    """Group neighbouring number columns, so that one format call serves them all."""
    runs: list[list[str]] = []
    for name in names:
        if runs and name in decimals and runs[-1][0] in decimals:
            runs[-1].append(name)
        else:
            runs.append([name])
    return runs


def _number_cells(values: np.ndarray, decimals: list[int]) -> list[str]:
    known = ~np.isnan(values).all(axis=0)
    # Adding 0 turns -0 into 0 after rounding.
    rounded = [np.round(values[:, k], d) + 0.0 for k, d in enumerate(decimals) if known[k]]
    pattern = ",".join(f"%.{d}f" if known[k] else "" for k, d in enumerate(decimals))
    rows = zip(*(column.tolist() for column in rounded), strict=True) if rounded else [()] * len(values)
    return [(pattern % row).replace("nan", "") for row in rows]


def _text_cells(values: list[str]) -> list[str]:
    cells = {value: _text_cell(value) for value in set(values)}
    return [cells[value] for value in values]


def _text_cell(value: str) -> str:
    if value[:1] in ("=", "+", "-", "@", "\t", "\r"):
        value = f"'{value}"
    return '"' + value.replace('"', '""') + '"' if any(c in value for c in ',"\n\r') else value
