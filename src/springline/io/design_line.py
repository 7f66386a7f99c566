"""The design line: where a pipe was to be laid, from a table or a LandXML alignment."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Literal

import numpy as np
import xarray as xr

from ..errors import InputError, nearest
from .columns import parse_column
from .named_columns import read_named
from .units import METRES

if TYPE_CHECKING:
    from pathlib import Path

Runs = Literal["axis", "invert"]

REFERENCES: tuple[Runs, ...] = ("axis", "invert")
"""What may run along a design line."""
_HEIGHTS = ("invert_elevation", "axis_elevation", "elevation")
_KNOWN = ("chainage", "easting", "northing", *_HEIGHTS)
_EXPECTED = "chainage_m and invert_elevation_m (or axis_elevation_m), or easting_m, northing_m and one of these"
_LANDXML = (".xml", ".landxml")


def read_design_line(path: Path, *, of: Runs | None = None) -> xr.Dataset:
    """Read a design line into `/design_line` [m]; it runs straight from point to point.

    Args:
        path: A table with `chainage_m` and `invert_elevation_m` or `axis_elevation_m`, or with `easting_m`,
            `northing_m` and one of these, each with its own unit (mm, cm, m, in, ft); or a LandXML file with one
            alignment of lines, irregular lines and curves and its design profile.
        of: axis or invert, for files that do not say what runs along the line: LandXML, and tables whose column is
            plain `elevation_m`.

    Returns:
        The group: `elevation`, and `chainage`, or `easting` and `northing`, or all of them.

    Raises:
        FormatError: It is neither a table nor XML.
        InputError: A column is missing, unknown or without unit, a cell is no number, points repeat or go back, or
            nothing says whether axis or invert is meant; file, row and column are named.

    >>> from pathlib import Path; from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder) / "line.csv"
    ...     _ = file.write_text("chainage_ft,invert_elevation_m\\n0,50\\n100,49.5\\n")
    ...     line = read_design_line(file)
    >>> line.attrs["refers_to"], line["chainage"].values.round(3).tolist()
    ('invert', [0.0, 30.48])
    """
    if of is not None and of not in REFERENCES:
        raise InputError(
            f"'{of}' is unknown{nearest(of, REFERENCES)}", where="--design-line-of", expected="axis, invert"
        )
    if path.suffix.lower() in _LANDXML:
        from .alignment import read_alignment

        columns, runs, places = read_alignment(path), None, None
    else:
        columns, runs, places = _table(path)
    if runs is not None and of is not None and runs != of:
        raise InputError(
            f"the table holds {runs} elevations, and {of} was asked for", where=path, mend="leave out --design-line-of"
        )
    if runs is None and of is None:
        raise InputError(
            "it does not say whether its elevations are of the axis or of the invert",
            where=path,
            expected="a column invert_elevation_m or axis_elevation_m",
            mend="or say it: --design-line-of invert",
        )
    _check(columns, path, places)
    return xr.Dataset(
        {name: ("vertex", values) for name, values in columns.items()},
        attrs={"refers_to": runs or of, "source": path.name},
    )


def _table(path: Path) -> tuple[dict[str, np.ndarray], Runs | None, list[int]]:
    """Return the columns [m], what runs along the line where the header says so, and the rows' numbers."""
    header, rows = read_named(path)
    found: dict[str, tuple[str, float]] = {}
    for name in header:
        quantity, unit = _split(name)
        if quantity not in _KNOWN:
            raise InputError(f"unknown column '{name}'{nearest(quantity, _KNOWN)}", where=path, expected=_EXPECTED)
        if unit not in METRES:
            raise InputError(
                f"the column '{name}' states no unit of length",
                where=path,
                expected=f"{', '.join(METRES)} at the end of its name, such as {quantity}_m",
            )
        if quantity in found:
            raise InputError(f"the columns '{found[quantity][0]}' and '{name}' hold the same", where=path)
        found[quantity] = (name, METRES[unit])
    heights = [name for name in _HEIGHTS if name in found]
    if len(heights) != 1:
        what = "there is no column of elevations" if not heights else f"there are both {heights[0]} and {heights[1]}"
        raise InputError(what, where=path, expected=_EXPECTED)
    if "chainage" not in found and "easting" not in found:
        raise InputError("there is neither a chainage nor an easting", where=path, expected=_EXPECTED)
    if ("easting" in found) != ("northing" in found):
        raise InputError("there is one coordinate without the other", where=path, expected=_EXPECTED)
    columns = {
        "elevation" if quantity in _HEIGHTS else quantity: np.array(
            [_number(cells[name], path, number, name) * metres for number, cells in rows]
        )
        for quantity, (name, metres) in found.items()
    }
    runs = heights[0].removesuffix("_elevation")
    return columns, (runs if runs in REFERENCES else None), [number for number, _ in rows]


def _split(name: str) -> tuple[str, str | None]:
    """Return the quantity and the unit that a column's name says."""
    for height in _HEIGHTS[:2]:
        if name.lower().startswith(height):
            column = parse_column(name[height.index("_") + 1 :])
            return height, column.unit
    column = parse_column(name)
    return ("chainage" if column.word in ("chainage", "station") else column.quantity), column.unit


def _number(cell: str, path: Path, row: int, name: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise InputError(f"'{cell}' is not a number", where=f"{path}, row {row}, column {name}", expected="a number")
    return value


def _check(columns: dict[str, np.ndarray], path: Path, places: list[int] | None) -> None:
    """Refuse lines of one point, and points that repeat or go back."""
    count = len(columns["elevation"])
    if count < 2:
        raise InputError(f"the line has {count} points", where=path, expected="two or more")
    names = ("chainage",) if "chainage" in columns else ("easting", "northing")
    steps = np.diff(np.stack([columns[name] for name in names], axis=1), axis=0)
    wrong = np.flatnonzero(steps[:, 0] <= 0.0 if len(names) == 1 else ~steps.any(axis=1))
    if wrong.size:
        at = int(wrong[0]) + 1
        what = "the chainage does not increase" if len(names) == 1 else "the point stands where the one before does"
        place = f", row {places[at]}" if places else f", point {at + 1}"
        raise InputError(
            f"{what}: {', '.join(f'{columns[name][at]:.12g}' for name in names)} m",
            where=f"{path}{place}, column {names[0]}",
            expected="points in the order in which they lie along the pipe, each once",
        )
