"""The table of tilts at which scans of a reference were taken."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

from ..errors import InputError, nearest
from .named_columns import check_columns, number_of, read_named

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
    header, rows = read_named(path, mend="check the path given to --tilts")
    check_columns(header, _COLUMNS[:3], _COLUMNS, path)
    found: dict[str, tuple[float, float, float]] = {}
    for number, cells in rows:
        scan = cells["scan"]
        where = f"{path}, row {number}"
        if scan not in names:
            raise InputError(f"'{scan}' is none of the scans{nearest(scan, names)}", where=f"{where}, column scan")
        if names[scan] in found:
            raise InputError(f"'{scan}' stands in it twice", where=f"{where}, column scan")
        angles = [_angle(cells.get(name, "0"), f"{where}, column {name}") for name in _COLUMNS[1:]]
        found[names[scan]] = (angles[0], angles[1], angles[2])
    return found


def _angle(cell: str, where: str) -> float:
    return radians(number_of(cell, where, expected="degrees"))
