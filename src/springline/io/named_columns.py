"""Small text tables whose cells are told by the name of their column; faults name file, row and column."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

from ..errors import FormatError, InputError, nearest

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

Rows = list[tuple[int, dict[str, str]]]
"""Each row's number, as an editor shows it, and its cells by column."""


def read_named(path: Path, *, mend: str | None = "check the path") -> tuple[list[str], Rows]:
    """Read a CSV: its header, and its rows that are not empty; a cell that is not there is empty.

    Raises:
        InputError: There is no such file; `mend` says how to mend it.
        FormatError: It is not a text table.
    """
    if not path.is_file():
        raise InputError("no such file", where=path, mend=mend)
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            rows = list(csv.reader(stream))
    except (UnicodeDecodeError, csv.Error) as error:
        raise FormatError(f"it is not a text table: {error}", where=path) from None
    header = [cell.strip() for cell in rows[0]] if rows else []
    body = [
        (number, {name: cell.strip() for name, cell in zip(header, [*row, *[""] * len(header)], strict=False)})
        for number, row in enumerate(rows[1:], 2)
        if any(cell.strip() for cell in row)
    ]
    return header, body


def check_columns(header: Sequence[str], needed: Sequence[str], known: Sequence[str], path: Path) -> None:
    """Refuse a header that lacks a column of `needed`, or has one that is not `known`."""
    for name in needed:
        if name not in header:
            raise InputError(f"the column '{name}' is missing", where=path, expected=", ".join(known))
    for name in header:
        if name not in known:
            raise InputError(f"unknown column '{name}'{nearest(name, known)}", where=path)


def number_of(cell: str, where: str, *, expected: str | None = None) -> float:
    """Return the number in a cell.

    Raises:
        InputError: There is none.
    """
    try:
        return float(cell)
    except ValueError:
        raise InputError(f"the cell '{cell}' is not a number", where=where, expected=expected) from None
