"""Excel workbook: summary, stations, one-sigma, features and corrections, a sheet each, the unit in every heading."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from .. import tables
from ..results import Results
from ..summary import summary
from ..units import column, converted, heading

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd

    from ...survey import Survey

_LONGEST = 32_000
_MOST_ROWS = 1_048_575
_OVERRIDE = ("action", "what", "author", "date", "reason", "effect")


def write_excel(survey: Survey, path: Path) -> None:
    """Write the results as a workbook, in the units of the run's configuration; a text never becomes a formula.

    Surveys with more stations than a sheet has rows keep every n-th of them, which the summary says.

    Args:
        survey: A finished survey.
        path: Where to write.
    """
    from openpyxl import Workbook

    results = Results(survey)
    book = Workbook(write_only=True)
    step = -(-results.stations // _MOST_ROWS)
    _summary_sheet(book, survey, step)
    columns = tables.station_columns(survey)
    for name, make in (("Stations", tables.stations_table), ("One-sigma", tables.stations_sigma_table)):
        table, decimals = converted(make(survey).iloc[::step], tables.STATION_DECIMALS, results.units)
        headings = [heading(c.heading, results.units) for c in columns]
        _table_sheet(book, name, headings, table, decimals)
    table, decimals = converted(tables.features_table(survey), tables.FEATURE_DECIMALS, results.units)
    _table_sheet(book, "Features", list(table.columns), table, decimals)
    _rows_sheet(book, "Corrections", _OVERRIDE, [[one.get(k, "") for k in _OVERRIDE] for one in survey.overrides])
    book.save(path)


def _summary_sheet(book: Any, survey: Survey, step: int) -> None:
    units = Results(survey).units
    rows: list[list[Any]] = []
    for key, value in summary(survey).items():
        if isinstance(value, list):
            rows += [[key, one if isinstance(one, str) else json.dumps(one, ensure_ascii=False)] for one in value]
        elif isinstance(value, float):
            one, shown = _convert(key, value, units)
            rows.append([shown, one])
        else:
            rows.append([key, value])
    if step > 1:
        rows.append(["rows", f"every {step}. station is listed; survey.zarr.zip holds all"])
    _rows_sheet(book, "Summary", ("quantity", "value"), rows)


def _convert(key: str, value: float, units: Any) -> tuple[float, str]:
    from ..units import unit

    found = unit(key.rpartition("_")[2], units)
    return value * found.factor, column(key, units)


def _table_sheet(book: Any, name: str, headings: list[str], table: pd.DataFrame, decimals: dict[str, int]) -> None:
    columns = [
        [None if math.isnan(v) else round(v, decimals[c]) for v in table[c].tolist()]
        if c in decimals
        else table[c].tolist()
        for c in table.columns
    ]
    _rows_sheet(book, name, headings, zip(*columns, strict=True))


def _rows_sheet(book: Any, name: str, headings: Any, rows: Any) -> None:
    sheet = book.create_sheet(name)
    sheet.freeze_panes = "A2"
    sheet.append([_cell(sheet, one) for one in headings])
    for row in rows:
        sheet.append([_cell(sheet, one) for one in row])


def _cell(sheet: Any, value: Any) -> Any:
    """Return a value for a sheet; a text is typed as such, so that '=1+1' stays what it is."""
    if not isinstance(value, str):
        return value
    from openpyxl.cell import WriteOnlyCell
    from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE

    cell = WriteOnlyCell(sheet, ILLEGAL_CHARACTERS_RE.sub("", value)[:_LONGEST])
    cell.data_type = "s"
    return cell
