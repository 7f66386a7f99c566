"""Tables of a precision study: test results, and the measures that are the references."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError
from .named_columns import Rows, check_columns, number_of, read_named
from .units import METRES

_DIAMETERS = {f"diameter_{unit}": factor for unit, factor in METRES.items()}


@dataclass(frozen=True)
class StudyResult:
    """One row: the diameter that one laboratory found on one material [m], or the scan that shows it."""

    laboratory: str
    material: str
    diameter: float | None
    scan: Path | None


def read_results(path: Path) -> list[StudyResult]:
    """Read a CSV with the columns laboratory, material and either diameter_mm (or _cm, _m, _in, _ft) or scan.

    A scan is a path beside the table. A table without the column `material` is of one material, `reference`.

    Raises:
        InputError: A column or a cell is wrong or missing; row and column named.
        FormatError: It is not a text table.
    """
    header, rows = _rows(path)
    column = _quantity(header, path, ("scan",))
    check_columns(header, ("laboratory",), ("laboratory", "material", *_DIAMETERS, "scan"), path)
    found = []
    for number, cells in rows:
        where = f"{path}, row {number}"
        laboratory, material = cells["laboratory"], cells.get("material", "reference")
        for name, cell in (("laboratory", laboratory), ("material", material), (column, cells[column])):
            if not cell:
                raise InputError("the cell is empty", where=f"{where}, column {name}")
        if column == "scan":
            found.append(StudyResult(laboratory, material, None, path.parent / cells[column]))
        else:
            value = _number(cells[column], f"{where}, column {column}") * _DIAMETERS[column]
            found.append(StudyResult(laboratory, material, value, None))
    return found


def read_references(path: Path) -> dict[str, list[float]]:
    """Read a CSV with the columns material and diameter_mm (or _cm, _m, _in, _ft): the measures [m] by material.

    Raises:
        InputError: A column or a cell is wrong or missing; row and column named.
        FormatError: It is not a text table.
    """
    header, rows = _rows(path)
    column = _quantity(header, path, ())
    check_columns(header, ("material",), ("material", *_DIAMETERS), path)
    found: dict[str, list[float]] = {}
    for number, cells in rows:
        value = _number(cells[column], f"{path}, row {number}, column {column}") * _DIAMETERS[column]
        found.setdefault(cells["material"], []).append(value)
    return found


def _rows(path: Path) -> tuple[list[str], Rows]:
    header, rows = read_named(path)
    if not rows:
        raise InputError("there is no row in it", where=path, expected="a header and at least one row")
    return header, rows


def _quantity(header: list[str], path: Path, others: tuple[str, ...]) -> str:
    found = [name for name in header if name in _DIAMETERS or name in others]
    if len(found) != 1:
        raise InputError(
            f"the columns {', '.join(found) or 'with a result'} {'contradict one another' if found else 'are missing'}",
            where=path,
            expected=f"one of {', '.join([*_DIAMETERS, *others])}",
        )
    return found[0]


def _number(cell: str, where: str) -> float:
    value = number_of(cell, where)
    if not 0.0 < value < float("inf"):
        raise InputError(f"{cell} is not a diameter", where=where, expected="a number above zero")
    return value
