"""The table of tilts at which scans of a reference were taken."""

from __future__ import annotations

import csv
from math import radians
from typing import TYPE_CHECKING

from ..errors import FormatError, InputError, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

_COLUMNS = ("scan", "pitch_deg", "yaw_deg", "roll_deg")


def read_tilts(path: Path, scans: Iterable[str]) -> dict[str, tuple[float, float, float]]:
    """Read a CSV with the columns scan, pitch_deg, yaw_deg and, when it was measured, roll_deg.

    Args:
        path: The table; `scan` is a scan's file name, its extension may be left out.
        scans: File names of the scans.

    Returns:
        Pitch, yaw and roll [rad] by file name.

    Raises:
        InputError: A column, a scan or a number is wrong or missing; row and column named.
        FormatError: It is not a text table.
    """
    names = {name.split(".")[0]: name for name in scans} | {name: name for name in scans}
    if not path.is_file():
        raise InputError("no such file", where=path, mend="check the path given to --tilts")
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            rows = list(csv.reader(stream))
    except (UnicodeDecodeError, csv.Error) as error:
        raise FormatError(f"it is not a text table: {error}", where=path) from None
    header = [cell.strip() for cell in rows[0]] if rows else []
    for name in _COLUMNS[:3]:
        if name not in header:
            raise InputError(f"the column '{name}' is missing", where=path, expected=", ".join(_COLUMNS))
    for name in header:
        if name not in _COLUMNS:
            raise InputError(f"unknown column '{name}'{nearest(name, _COLUMNS)}", where=path)
    found: dict[str, tuple[float, float, float]] = {}
    for number, row in enumerate(rows[1:], 2):
        if not any(cell.strip() for cell in row):
            continue
        cells = dict(zip(header, [*row, *[""] * len(header)], strict=False))
        scan = cells["scan"].strip()
        where = f"{path}, row {number}"
        if scan not in names:
            raise InputError(f"'{scan}' is none of the scans{nearest(scan, names)}", where=f"{where}, column scan")
        if names[scan] in found:
            raise InputError(f"'{scan}' stands in it twice", where=f"{where}, column scan")
        angles = [_angle(cells.get(name, "0"), f"{where}, column {name}") for name in _COLUMNS[1:]]
        found[names[scan]] = (angles[0], angles[1], angles[2])
    return found


def _angle(cell: str, where: str) -> float:
    try:
        return radians(float(cell))
    except ValueError:
        raise InputError(f"'{cell}' is not a number", where=where, expected="degrees") from None
