"""A folder of CSV tables with the columns of PACP 6: a mapping of what we know, not the certified database."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from ...io.observations import plain
from ...io.pacp import CONDITIONS, DIRECTIONS, INCH_MM, INSPECTIONS, TEXT_COLUMNS
from ...io.units import METRES
from ..tables import write_csv
from .coded import inspections, is_own

if TYPE_CHECKING:
    from pathlib import Path

    from ...io.observations import Inspection, Observed
    from ...survey import Survey

_MEDIA = ("MediaID", "InspectionID", "Video_Name", "Video_Location")


def write_pacp(survey: Survey, path: Path) -> None:
    """Write `Conditions.csv`, `Inspections.csv` and `Media_Inspections.csv` into a new folder: feet and inches.

    Kinds of feature that PACP has no plain code for, as joints and laterals of unknown make, become general remarks.

    Raises:
        InputError: There is nothing to write, or it is coded by another system.
    """
    own = is_own(survey, "pacp")
    layout = json.loads(survey.observations.attrs["layout"]) if own else {}
    columns, scale = layout.get("columns", list(CONDITIONS)), METRES[layout.get("unit", "ft")]
    found = inspections(survey, "pacp")
    rows: list[dict[str, str]] = []
    heads: list[dict[str, str]] = []
    media: list[dict[str, str]] = []
    for k, one in enumerate(found, 1):
        key = one.own["InspectionID"] if own else str(k)
        rows += [_condition(seen, key, len(rows) + 1 + n, scale) for n, seen in enumerate(one.observed)]
        heads.append(one.own["inspection"] if own else _header(one, key, scale))
        media += one.own["media"] if own else []
    path.mkdir()
    _write(rows, columns, path / "Conditions.csv")
    if any(heads):
        _write([h for h in heads if h], list(dict.fromkeys(c for h in heads for c in h)), path / "Inspections.csv")
    if media or not own:
        _write(media, list(media[0]) if media else list(_MEDIA), path / "Media_Inspections.csv")


def _write(rows: list[dict[str, str]], columns: list[str], path: Path) -> None:
    table: dict[str, Any] = {name: [str(row.get(name, "")) for row in rows] for name in columns}
    write_csv(pd.DataFrame(table, columns=columns, dtype=object), path, {})


def _condition(seen: Observed, key: str, row: int, scale: float) -> dict[str, str]:
    return {
        "ConditionID": str(row),
        **{name: str(value) for name, value in seen.fields.items()},
        "InspectionID": key,
        "Distance": plain(seen.distance / scale, 3),
        "Clock_At_From": _clock(seen.clock),
        "Clock_To": _clock(seen.clock_to),
        **{column: seen[name] for column, name in TEXT_COLUMNS.items()},
    }


def _clock(hours: float) -> str:
    """Return a clock position in whole hours, as PACP codes it."""
    if not np.isfinite(hours):
        return ""
    return plain(round(hours) or 12.0)


def _header(one: Inspection, key: str, scale: float) -> dict[str, str]:
    codes = {said: letter for letter, said in DIRECTIONS.items()}
    header = {"InspectionID": key}
    for word, column in INSPECTIONS.items():
        value = one.common.get(word, "")
        if word == "direction":
            value = codes.get(value, "")
        elif value and word in ("height_mm", "width_mm"):
            value = plain(float(value) / INCH_MM, 2)
        elif value and word == "length_m":
            value = plain(float(value) / scale, 2)
        header[column] = value
    return header
