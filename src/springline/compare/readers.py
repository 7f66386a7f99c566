"""Feature lists from tables that people have: PACP conditions, and plain columns with a map of their names.

Both take columns that are read already, by whatever reads CSV or XLSX; neither opens a file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..conventions import bearing_from_clock
from ..errors import FormatError, InputError, listed, nearest
from .features import FeatureList, feature_list

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}
"""Metres in each unit of length that is understood."""

COLUMNS = ("chainage", "kind", "clock", "size")
"""What a column map may name; `chainage` must be there."""

PACP_COLUMNS = {
    "inspection": ("InspectionID", "Inspection_ID"),
    "distance": ("Distance",),
    "code": ("PACP_Code", "Code"),
    "clock": ("Clock_At_From", "Clock_From"),
    "size": ("Value_1st_Dimension", "Value_1st"),
}
"""Columns of a PACP conditions table (NASSCO PACP exchange database), each with the names it goes by."""

_SHOWN = 8
_SIXTY = 60.0
_MINUTES_AND_SECONDS = 2
_CLOCK_END = 13.0  # 12:45 is a quarter to one

_PACP_KINDS = (("T", "lateral"), ("AMH", "manhole"), ("LL", "bend"), ("LR", "bend"), ("LU", "bend"), ("LD", "bend"))


def pacp_features(
    table: Mapping[str, ArrayLike],
    inspection: object,
    *,
    length_unit: str = "ft",
    size_unit: str = "in",
    name: str | None = None,
    sort: bool = False,
) -> FeatureList:
    """Return the taps, manholes and bends of one inspection of a PACP conditions table.

    Defects and remarks are left out: they come and go between inspections. Of a tap the clock (`Clock_At_From`) and
    the first dimension are kept. A row that repeats another is read once.

    Args:
        table: Columns by name, each (rows,), of text or numbers; a pandas DataFrame serves.
        inspection: Which inspection, as its column has it.
        length_unit: Of `Distance`.
        size_unit: Of the first dimension.
        name: What messages call the list; the inspection's number when not given.
        sort: Whether to sort by distance rather than to refuse distances that fall.

    Raises:
        FormatError: A column is missing.
        InputError: The table does not hold the inspection, a distance is not a number, a clock is not one, the
            inspection has no such feature, or distances fall.

    Source: NASSCO PACP 7, code groups T (tap), A (access point), L (alignment).

    >>> rows = {"InspectionID": [7, 7, 7], "Distance": ["0", "32.8084", "98.4252"], "PACP_Code": ["AMH", "TFA", "AMH"],
    ...         "Clock_At_From": ["", "3", ""], "Value_1st_Dimension": ["", "6", ""]}
    >>> pacp_features(rows, 7).chainage.round(3).tolist()
    [0.0, 10.0, 30.0]
    """
    columns = {key: _find(table, key, names) for key, names in PACP_COLUMNS.items()}
    title = name or f"inspection {inspection}"
    there = [str(v).strip() for v in np.asarray(columns["inspection"])]
    mine = np.flatnonzero([v == str(inspection).strip() for v in there])
    if not mine.size:
        raise InputError(
            "there is no such inspection" + nearest(str(inspection), dict.fromkeys(there)),
            where=title,
            expected="one of the table: " + listed(list(dict.fromkeys(there)), _SHOWN, ", "),
        )
    codes = [str(v).strip().upper() for v in np.asarray(columns["code"])[mine]]
    kinds = [_pacp_kind(code) for code in codes]
    kept = np.array([k is not None for k in kinds], dtype=bool)
    rows = mine[kept]
    kind = np.array([k for k in kinds if k is not None], dtype=object)
    distance = _numbers(columns["distance"], rows, title, "Distance") * _unit(length_unit)
    clock = np.where(kind == "lateral", _clocks(columns["clock"], rows, title, "Clock_At_From"), np.nan)
    size = np.where(kind == "lateral", _numbers(columns["size"], rows, title, "Value_1st_Dimension"), np.nan)
    return _listed(distance, kind, clock, size * _unit(size_unit), title, sort)


def column_features(
    table: Mapping[str, ArrayLike],
    columns: Mapping[str, str],
    *,
    kinds: Mapping[str, str] | None = None,
    kind: str = "joint",
    length_unit: str = "m",
    size_unit: str = "mm",
    name: str = "feature list",
    sort: bool = False,
) -> FeatureList:
    """Return the features of a plain table, such as an in-line inspection tally.

    Clocks are hours or hours and minutes ("4.5", "4:30"). A row that repeats another is read once.

    Args:
        table: Columns by name, each (rows,), of text or numbers; a pandas DataFrame serves.
        columns: Which column holds what: keys of `COLUMNS`, such as {"chainage": "Log distance", "clock": "o'clock"}.
        kinds: Words of the kind's column to `KINDS`; rows of other words are left out. Each word must be one of
            `KINDS` when not given.
        kind: Kind of all rows, when the map names no column of it.
        length_unit: Of chainages.
        size_unit: Of sizes.
        name: What messages call the list.
        sort: Whether to sort by chainage rather than to refuse chainages that fall.

    Raises:
        FormatError: The map names something else than `COLUMNS`, or a column that is not there.
        InputError: A cell is not a number, a clock is not one, no feature is left, or chainages fall.

    >>> tally = {"dist": [0, 12.1, 24.3], "what": ["GWD", "GWD", "Tee"]}
    >>> found = column_features(tally, {"chainage": "dist", "kind": "what"}, kinds={"GWD": "joint", "Tee": "lateral"})
    >>> found.kind.tolist()
    [0, 0, 1]
    """
    for key in columns:
        if key not in COLUMNS:
            raise FormatError(
                f"the column map has no {key!r}" + nearest(key, COLUMNS), where=name, expected=", ".join(COLUMNS)
            )
    found = {key: _find(table, key, (column,)) for key, column in columns.items()}
    if "chainage" not in found:
        raise FormatError("the column map does not say where the chainage is", where=name, expected="a 'chainage' key")
    rows = np.arange(len(np.asarray(found["chainage"])))
    words = np.full(rows.size, kind, dtype=object)
    if "kind" in found:
        words = np.array([str(w).strip() for w in np.asarray(found["kind"])], dtype=object)
        if kinds is not None:
            rows = np.flatnonzero([w in kinds for w in words])
            words = np.array([kinds[w] for w in words[rows]], dtype=object)
    values = {
        key: read(found[key], rows, name, columns[key]) if key in found else np.full(rows.size, np.nan)
        for key, read in (("chainage", _numbers), ("clock", _clocks), ("size", _numbers))
    }
    x, size = values["chainage"] * _unit(length_unit), values["size"] * _unit(size_unit)
    return _listed(x, words, values["clock"], size, name, sort)


def _pacp_kind(code: str) -> str | None:
    if code.startswith("LF"):
        return None  # lining failures share the letter of alignment
    return next((kind for start, kind in _PACP_KINDS if code.startswith(start)), None)


def _find(table: Mapping[str, ArrayLike], key: str, names: tuple[str, ...]) -> ArrayLike:
    for name in names:
        if name in table:
            return table[name]
    there = list(table)
    raise FormatError(
        f"there is no column '{names[0]}' for the {key}" + nearest(names[0], map(str, there)),
        expected="a header with it; there are " + ", ".join(map(str, there)),
    )


def _numbers(column: ArrayLike, rows: np.ndarray, name: str, title: str) -> np.ndarray:
    """Return numbers (rows,); empty cells are NaN."""
    return _values(column, rows, name, title, float, "a number")


def _clocks(column: ArrayLike, rows: np.ndarray, name: str, title: str) -> np.ndarray:
    """Return clocks (rows,) [h]; empty cells are NaN."""
    return _values(column, rows, name, title, _hours, "a clock: 0 to 12 hours, or hours and minutes as in 4:30")


def _hours(cell: object) -> float:
    """Return the hours of "4.5", "4:30" or a time of day; 12:30 is half past the crown.

    Raises:
        ValueError: It is none of them, or outside 0 to 13 h.
    """
    hours, *rest = (float(part) for part in str(cell).split(":"))
    if len(rest) > _MINUTES_AND_SECONDS or any(not 0.0 <= part < _SIXTY for part in rest):
        raise ValueError
    found = hours + sum(part / _SIXTY**n for n, part in enumerate(rest, 1))
    if not 0.0 <= found < _CLOCK_END:
        raise ValueError
    return found


def _values(
    column: ArrayLike, rows: np.ndarray, name: str, title: str, read: Callable[[object], float], what: str
) -> np.ndarray:
    cells = np.asarray(column, dtype=object)[rows]
    values = np.full(rows.size, np.nan)
    for i, cell in enumerate(cells):
        if cell is None or str(cell).strip().lower() in ("", "nan", "<na>", "nat", "none"):
            continue
        try:
            values[i] = read(cell)
        except (TypeError, ValueError):
            raise InputError(
                f"the cell {str(cell)!r} is not {what}",
                where=f"{name}, row {rows[i] + 1} of the table, column {title}",
            ) from None
    return values


def _unit(unit: str) -> float:
    if unit not in METRES:
        raise InputError(f"the unit {unit!r} is not known" + nearest(unit, METRES), expected=", ".join(METRES))
    return METRES[unit]


def _listed(x: np.ndarray, kind: np.ndarray, clock: np.ndarray, size: np.ndarray, name: str, sort: bool) -> FeatureList:
    order = np.argsort(x, kind="stable") if sort else np.arange(x.size)
    size = np.where(size > 0, size, np.nan)
    values = (v[order] for v in (x, kind, bearing_from_clock(clock), size))
    chainage, kinds, bearing, sizes = values
    return feature_list(chainage, kinds, bearing=bearing, size=sizes, name=name).once()
