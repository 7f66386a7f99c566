"""What `springline compare` takes: folders of inspect, surveys, and plain lists of features."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import FormatError, InputError, MissingExtraError, listed

if TYPE_CHECKING:
    from pathlib import Path

    from ..compare import Epoch, FeatureList

_SURVEY = "survey.zarr.zip"
_TABLES = (".csv", ".xlsx", ".xlsm")
_OWN = {
    "chainage": ("chainage_m", "chainage"), "kind": ("kind",),
    "clock": ("clock_h", "clock"), "size": ("size_mm", "size"),
}  # fmt: skip
_OWN_KINDS = {
    "joint": "joint", "lateral": "lateral", "bend": "bend", "manhole": "manhole", "dent": "defect",
    "deposit": "defect", "intrusion": "defect",
}  # fmt: skip
_PACP = ("InspectionID", "Inspection_ID"), ("PACP_Code", "Code")
_SHOWN = 8
_HEADING_UNIT = re.compile(r"(?:^|[\s\[(_,])(mm|cm|m|in|ft)[\])]?$", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"\s*[-+]?\d+,\d+\s*")
_HEADING_ROWS = 30  # of an Excel sheet, above which titles may stand


@dataclass(frozen=True)
class ListOptions:
    """How tables of features are to be read.

    Attributes:
        columns: Column map, chainage, kind, clock and size to the table's own headings; empty = by known headings.
        kinds: The table's words of the kind to ours; empty = they are ours.
        kind: Kind of all rows of a table without such a column.
        unit: Of chainages; empty = that of the format.
        size_unit: Of sizes; empty = that of the format.
        sort: Sort by chainage rather than refuse chainages that fall.
    """

    columns: dict[str, str]
    kinds: dict[str, str]
    kind: str = "joint"
    unit: str = ""
    size_unit: str = ""
    sort: bool = False


def read_epoch(path: Path, given: ListOptions) -> tuple[Epoch, bool]:
    """Return one inspection, and whether it was coded by eye.

    Args:
        path: A folder of `inspect`, a zarr survey, anything that `inspect` reads, or a table of features; one of
            several inspections in a PACP table is named after an @, as in Conditions.csv@123.
        given: How tables are to be read.

    Raises:
        InputError: There is no such file, or it holds nothing to compare; the message names file, row and column.
    """
    from ..compare import Epoch

    path, number = _split(path)
    if not path.exists():
        raise InputError("no such file or folder", where=path)
    if not (path.is_file() or path.is_dir()):
        raise InputError("it is neither a file nor a folder", where=path, mend="save the table to a file first")
    if path.suffix.lower() in _TABLES and not _rings(path, given):
        listed, coded = _listed(path, number, given)
        if listed.repeated:
            sys.stderr.write(f"note: {listed.name}: {listed.repeated} rows that repeat another are read once\n")
        return Epoch(listed.name, listed=listed), coded
    return _surveyed(path), False


def _split(path: Path) -> tuple[Path, str]:
    """Return a path and the inspection named after its @."""
    if path.exists() or "@" not in path.name:
        return path, ""
    stem, _, number = path.name.rpartition("@")
    return path.with_name(stem), number


def _rings(path: Path, given: ListOptions) -> bool:
    """Return whether a CSV holds readings of rings rather than features."""
    if given.columns or path.suffix.lower() != ".csv":
        return False
    with path.open(encoding="utf-8-sig", errors="replace") as stream:
        head = stream.readline().lower()
    return any(word in head for word in ("r_0", "bearing_deg", "radius_m", "range"))


def _surveyed(path: Path) -> Epoch:
    from ..compare import Epoch
    from ..io.options import ReadOptions
    from ..io.reading import read_one
    from ..survey import open_survey

    stored = path / _SURVEY
    if path.is_dir() and stored.exists():
        survey = open_survey(stored)
    elif path.is_dir() and (path / "summary.json").exists():
        raise InputError(f"{_SURVEY} is not in it", where=path, expected="a folder that springline inspect has written")
    else:
        survey = read_one(path, ReadOptions(), strict=False)
    if not (survey.has("section") and survey.has("metrics")):
        from ..pipeline import inspect

        survey = inspect(survey)
    return Epoch(str(survey.attrs.get("name") or path.stem), survey)


def _listed(path: Path, number: str, given: ListOptions) -> tuple[FeatureList, bool]:
    from ..compare import column_features, pacp_features

    table = _table(path, given)
    if not len(table):
        raise InputError("it has no rows", where=path, expected="a heading and one row per feature")
    common: dict[str, Any] = {"sort": given.sort}
    inspection, code = (next((c for c in names if c in table.columns), None) for names in _PACP)
    if inspection and code and not given.columns:
        number = number or _only(table, inspection, path)
        units = {"length_unit": given.unit or "ft", "size_unit": given.size_unit or "in"}
        name = f"{path.name}@{number}"
        return pacp_features(table, number, name=name, **units, **common), True
    columns, kinds = given.columns, given.kinds or None
    if not columns:
        headings = {str(c).strip().lower(): c for c in reversed(table.columns)}
        known = ((key, next((n for n in names if n in headings), "")) for key, names in _OWN.items())
        columns = {key: headings[name] for key, name in known if name}
        if "kind" in columns and not kinds:
            # A word that is not ours stands for itself, so that it is refused by name.
            kinds = {w: _OWN_KINDS.get(w, w) for w in (str(v).strip() for v in table[columns["kind"]])}
        if "chainage" not in columns:
            raise FormatError(
                "its columns are not known",
                where=path,
                expected="chainage, kind, clock and size, a table of PACP conditions, or a column map; there are "
                + ", ".join(map(str, table.columns)),
                mend='name them, as in --columns "chainage=Log distance,clock=o\'clock"',
            )
    units = {
        "length_unit": given.unit or _unit_of(columns.get("chainage", "")) or "m",
        "size_unit": given.size_unit or _unit_of(columns.get("size", "")) or "mm",
    }
    return column_features(table, columns, kinds=kinds, kind=given.kind, name=path.name, **units, **common), False


def _unit_of(heading: str) -> str:
    """Return the unit that ends a heading, as in "Log Dist. [ft]" or "size_mm"; empty when it names none.

    >>> _unit_of("Log Dist. [ft]"), _unit_of("Station (M)"), _unit_of("chainage")
    ('ft', 'm', '')
    """
    found = _HEADING_UNIT.search(str(heading).strip())
    return found[1].lower() if found else ""


def _only(table: Any, column: str, path: Path) -> str:
    """Return the inspection of a table that holds a single one."""
    there = list(dict.fromkeys(str(v).strip() for v in table[column]))
    if len(there) > 1:
        raise InputError(
            f"it holds {len(there)} inspections: {listed(there, _SHOWN, ', ')}",
            where=path,
            expected="one of them",
            mend=f"name it after an @, as in {path.name}@{there[0]}",
        )
    return there[0]


def _table(path: Path, given: ListOptions) -> Any:
    """Return a table of text, without its empty rows."""
    if not path.stat().st_size:
        raise InputError("the file is empty", where=path, expected="a heading and one row per feature")
    try:
        table = _csv(path) if path.suffix.lower() == ".csv" else _sheet(path, given)
    except ImportError as error:
        raise MissingExtraError.of("excel", "reading Excel tables") from error
    except Exception as error:
        raise FormatError(
            f"it cannot be read as a table: {error}", where=path, expected="CSV with a heading, or an Excel sheet"
        ) from error
    return table[(table.map(str.strip) != "").any(axis=1)]


def _csv(path: Path) -> Any:
    """Return a CSV; one between semicolons may write its decimals with a comma."""
    import pandas as pd

    text = {"dtype": str, "keep_default_na": False, "encoding": "utf-8-sig"}
    with path.open(encoding="utf-8-sig", errors="replace") as stream:
        heading = stream.readline()
    if ";" not in heading:
        return pd.read_csv(path, sep=None, engine="python", **text)
    table = pd.read_csv(path, sep=";", **text)
    return table.map(lambda cell: cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell) else cell)


def _sheet(path: Path, given: ListOptions) -> Any:
    """Return the first sheet of a workbook that has the headings asked for, below any title; else its first sheet."""
    import pandas as pd

    sheets = pd.read_excel(path, dtype=str, keep_default_na=False, header=None, sheet_name=None)
    for cells in sheets.values():
        for row in range(min(_HEADING_ROWS, len(cells))):
            if _is_heading([str(cell).strip() for cell in cells.iloc[row]], given):
                return _below(cells, row)
    return _below(next(iter(sheets.values())), 0)


def _is_heading(cells: list[str], given: ListOptions) -> bool:
    if given.columns:
        return set(given.columns.values()) <= set(cells)
    lower = {cell.lower() for cell in cells}
    return any(name in lower for name in _OWN["chainage"]) or all(any(c in cells for c in names) for names in _PACP)


def _below(cells: Any, row: int) -> Any:
    """Return the rows of a sheet below its heading."""
    table = cells.iloc[row + 1 :] if len(cells) else cells
    return table.set_axis([str(cell).strip() for cell in cells.iloc[row]] if len(cells) else [], axis=1)


def pairs_of(text: str | None, flag: str) -> dict[str, str]:
    """Return a map from text such as "chainage=Log distance,clock=o'clock".

    Raises:
        InputError: A part has no equals sign.
    """
    if not text:
        return {}
    found = {}
    for part in text.split(","):
        key, equals, value = part.partition("=")
        if not equals or not key.strip() or not value.strip():
            raise InputError(f"{part!r} is not understood", where=flag, expected="name=value, separated by commas")
        found[key.strip()] = value.strip()
    return found
