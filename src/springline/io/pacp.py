"""PACP observations as CSV tables: Conditions, with Inspections and Media_Inspections beside it when they are there.

A mapping to the columns of the exchange tables of PACP 6, not the certified database. Distances and sizes in them are
feet and inches, unless the user states another unit of distance.
"""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

from ..errors import FormatError, nearest
from ..survey import add_assumption
from .codes import pacp_kind
from .observations import Inspection, Observed, clock_hours, number, observations_survey
from .units import METRES

if TYPE_CHECKING:
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

CONDITIONS = (
    "ConditionID",
    "InspectionID",
    "Distance",
    "Counter",
    "PACP_Code",
    "Continuous",
    "Value_1st_Dimension",
    "Value_2nd_Dimension",
    "Value_Percent",
    "Joint",
    "Clock_At_From",
    "Clock_To",
    "Remarks",
    "VCR_Time",
)
"""Columns of Conditions.csv."""

TEXT_COLUMNS = {
    "PACP_Code": "code",
    "Continuous": "continuous",
    "Value_1st_Dimension": "quantification_1",
    "Value_2nd_Dimension": "quantification_2",
    "Joint": "joint",
    "Remarks": "remarks",
    "VCR_Time": "video",
}
"""Columns whose content is text, with their names in `/observations`."""

INSPECTIONS = {
    "name": "Pipe_Segment_Reference",
    "node_from": "Upstream_MH",
    "node_to": "Downstream_MH",
    "date": "Date",
    "time": "Time",
    "operator": "Surveyed_By",
    "direction": "Direction",
    "material": "Material",
    "height_mm": "Height",
    "width_mm": "Width",
    "length_m": "Length_Surveyed",
}
"""Columns of Inspections.csv by common word; Height and Width in inches, Length_Surveyed in the unit of Distance."""

DIRECTIONS = {"D": "downstream", "U": "upstream"}
INCH_MM = 25.4
_PLACES = ("Distance", "Clock_At_From", "Clock_To")
_NEEDED = ("InspectionID", "Distance", "PACP_Code")


def read_pacp(path: Path, options: ReadOptions) -> Survey:
    """Read Conditions.csv, alone or in its folder, into `/observations`; other columns are carried.

    Args:
        path: `Conditions.csv`, or the folder that holds it.
        options: `unit` is that of Distance; feet when not stated.

    Raises:
        FormatError: A column is missing or a cell cannot be used; file and row named.
    """
    file = path / "Conditions.csv" if path.is_dir() else path
    unit = options.unit or "ft"
    scale = METRES[unit]
    names, rows = read_table(file)
    missing = [name for name in _NEEDED if name not in names]
    if missing:
        raise FormatError(f"the column '{missing[0]}' is missing{nearest(missing[0], names)}", where=file)
    headers = _beside(file, "Inspections.csv")
    media = _beside(file, "Media_Inspections.csv")
    found: dict[str, Inspection] = {}
    for key in (*headers, *dict.fromkeys(row["InspectionID"] for _, row in rows)):
        if key not in found:
            header = headers.get(key, [{}])[0]
            own = {"InspectionID": key, "inspection": header, "media": media.get(key, [])}
            found[key] = Inspection(_common(header, key, scale), own)
    for number_of_row, row in rows:
        found[row["InspectionID"]].observed.append(_observed(row, scale, f"{file}, row {number_of_row}"))
    survey = observations_survey(
        list(found.values()), file, format="pacp", layout={"columns": names, "unit": unit, "tables": len(headers) > 0}
    )
    return survey if options.unit else add_assumption(survey, "Distances are taken as feet, as PACP codes them.")


def read_table(file: Path) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """Return the column names of a CSV table, and its rows with their numbers as an editor shows them."""
    with file.open(encoding="utf-8-sig", errors="replace", newline="") as stream:
        reader = csv.DictReader(stream, restkey="", restval="")
        names = [name for name in reader.fieldnames or [] if name]
        rows = [(reader.line_num, {k: _bare(v) for k, v in row.items() if k}) for row in reader]
    return names, rows


def _bare(cell: str) -> str:
    """Return a cell without the apostrophe that keeps a spreadsheet from running it as a formula."""
    return cell[1:] if cell[:1] == "'" and cell[1:2] in ("=", "+", "-", "@") else cell


def _beside(file: Path, name: str) -> dict[str, list[dict[str, str]]]:
    """Return the rows of a table in the same folder by InspectionID; none when it is not there."""
    table: dict[str, list[dict[str, str]]] = {}
    if (place := file.with_name(name)).is_file():
        for _, row in read_table(place)[1]:
            table.setdefault(row.get("InspectionID", ""), []).append(row)
    return table


def _observed(row: dict[str, str], scale: float, place: str) -> Observed:
    texts = {name: row.get(column, "") for column, name in TEXT_COLUMNS.items()}
    texts["kind"] = pacp_kind(texts["code"], texts["remarks"])
    return Observed(
        number(row["Distance"], f"{place}, column Distance") * scale,
        clock_hours(row.get("Clock_At_From", ""), f"{place}, column Clock_At_From"),
        clock_hours(row.get("Clock_To", ""), f"{place}, column Clock_To"),
        texts,
        {k: v for k, v in row.items() if k not in {*TEXT_COLUMNS, *_PLACES, "InspectionID"}},
    )


def _common(header: dict[str, str], key: str, scale: float) -> dict[str, str]:
    common = {word: header[column] for word, column in INSPECTIONS.items() if header.get(column)}
    common.setdefault("name", key)
    if "direction" in common:
        common["direction"] = DIRECTIONS.get(common["direction"], "")
    for word, factor in (("height_mm", INCH_MM), ("width_mm", INCH_MM), ("length_m", scale)):
        if word in common:
            common[word] = f"{number(common[word], INSPECTIONS[word]) * factor:.4f}".rstrip("0").rstrip(".")
    return common
