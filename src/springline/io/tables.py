"""Text tables of numbers, read block by block, with every fault named by file, row and column.

Rows are counted as an editor shows them: the first line of the file is row 1. Empty cells and the usual words for
missing (NaN, N/A, null) become NaN.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError, InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

_BLOCK = 8 << 20
_SNIFF = 1 << 18
_PASSED = ("#", "//", "sep=")
_MISSING = frozenset(("", "nan", "-nan", "n/a", "na", "#n/a", "null", "none", "<na>", "-"))


@dataclass(frozen=True)
class Rows:
    """A block of a table: row numbers (n,) as an editor shows them and values (n, columns) in float64."""

    numbers: np.ndarray
    values: np.ndarray


@dataclass(frozen=True)
class TextTable:
    """A text table whose layout is known; `blocks` reads its numbers.

    Args:
        path: The file.
        names: Column names as in the file; empty when it has no header.
        width: Number of columns.
        delimiter: "," ";" tab, or a space for any run of white space.
        decimal: "." or ",".
        start: Byte at which the first row of numbers begins.
        first_row: Its row number.
    """

    path: Path
    names: tuple[str, ...]
    width: int
    delimiter: str
    decimal: str
    start: int
    first_row: int

    def blocks(self) -> Iterator[Rows]:
        """Yield the table's numbers.

        Raises:
            InputError: A cell is not a number, or a row has too many or too few cells; file, row, column named.
        """
        names = self.names or tuple(f"{i + 1}" for i in range(self.width))
        row = self.first_row
        for block in _line_blocks(self.path, self.start):
            yield parse_numbers(
                block, delimiter=self.delimiter, names=names, where=self.path, first_row=row, decimal=self.decimal
            )
            row += block.count(b"\n")


def open_table(path: Path) -> TextTable:
    """Return the layout of a text table: delimiter, decimal sign, header.

    Lines that are empty or begin with #, // or sep= before the first row are passed over; the last of them serves as
    header when the table has no other and it has as many names as there are columns.

    Raises:
        FormatError: The file is not text, or holds no row.
    """
    with path.open("rb") as stream:
        head = stream.read(_SNIFF)
        more = bool(stream.read(1))
    if b"\0" in head:
        raise FormatError("it is not a text table", where=path, expected="rows of numbers with a delimiter")
    lines = head.splitlines(keepends=True)
    if more and len(lines) > 1:
        lines.pop()
    start, comment = 0, ""
    for index, raw in enumerate(lines):
        line = raw.decode("utf-8-sig" if start == 0 else "utf-8", errors="replace").strip()
        if line and not line.startswith(_PASSED):
            return _layout(path, lines, index, start, line, comment)
        comment = line.lstrip("#/ ") or comment
        start += len(raw)
    raise FormatError("there is no row in it", where=path, expected="a table with at least one row of numbers")


def _layout(path: Path, lines: list[bytes], index: int, start: int, line: str, comment: str) -> TextTable:
    delimiter = next((d for d in ("\t", ";", ",") if d in line), " ")
    cells = split_line(line, delimiter)
    following = next((x.decode("utf-8", "replace") for x in lines[index + 1 :] if x.strip()), "")
    decimal = "," if delimiter in ";\t" and "," in (following or line) and "." not in (following or line) else "."
    if all(_is_number(cell, decimal) for cell in cells):
        names = tuple(split_line(comment, next((d for d in ("\t", ";", ",") if d in comment), " ")))
        return TextTable(
            path, names if len(names) == len(cells) else (), len(cells), delimiter, decimal, start, index + 1
        )
    return TextTable(path, tuple(cells), len(cells), delimiter, decimal, start + len(lines[index]), index + 2)


def split_line(line: str, delimiter: str) -> list[str]:
    """Return the cells of a line, stripped; quotes are understood."""
    if delimiter == " ":
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]


def _line_blocks(path: Path, start: int) -> Iterator[bytes]:
    """Yield blocks of whole lines."""
    with path.open("rb") as stream:
        stream.seek(start)
        rest = b""
        while data := stream.read(_BLOCK):
            data = rest + data
            end = data.rfind(b"\n") + 1
            rest = data[end:]
            if end:
                yield data[:end]
        if rest.strip():
            yield rest + b"\n"


def parse_numbers(
    block: bytes, *, delimiter: str, names: Sequence[str], where: Path, first_row: int, decimal: str = "."
) -> Rows:
    """Return the numbers of a block of whole lines; empty lines are passed over.

    Args:
        block: Lines, each with its line end.
        delimiter: As in `TextTable`.
        names: Column names, for messages; their count is the width.
        where: The file, for messages.
        first_row: Row number of the block's first line.
        decimal: "." or ",".

    Raises:
        InputError: A cell is not a number, or a row has too many or too few cells.
    """
    import pandas as pd

    cells = _cells_per_line(block, delimiter)
    numbers = first_row + np.flatnonzero(cells > 0)
    cells = cells[cells > 0]
    if not cells.size:
        return Rows(numbers, np.empty((0, len(names))))
    wrong = np.flatnonzero(cells != len(names))
    if wrong.size:
        k = int(wrong[0])
        raise InputError(
            f"the row has {cells[k]} cells",
            where=f"{where}, row {numbers[k]}",
            expected=f"{len(names)} cells as in the first row",
            mend="the file may be cut short: copy or export it again",
        )
    try:
        frame = pd.read_csv(
            io.BytesIO(block),
            header=None,
            sep=r"\s+" if delimiter == " " else delimiter,
            decimal=decimal,
            dtype=np.float64,
            skip_blank_lines=True,
            na_values=["-"],
            encoding="utf-8",
            encoding_errors="replace",
        )
    except (ValueError, OverflowError):
        raise _bad_cell(block, delimiter, names, where, first_row, decimal) from None
    return Rows(numbers, frame.to_numpy())


def _cells_per_line(block: bytes, delimiter: str) -> np.ndarray:
    """Return the number of cells in each line; 0 for an empty one."""
    if b'"' in block:
        lines = block.decode("utf-8", "replace").split("\n")[:-1]
        return np.array([len(split_line(line, delimiter)) if line.strip() else 0 for line in lines])
    text = np.frombuffer(block, np.uint8)
    ends = np.flatnonzero(text == 0x0A)
    blank = (text == 0x20) | (text == 0x09) | (text == 0x0D) | (text == 0x0A)
    if delimiter == " ":
        begins = np.flatnonzero(~blank & np.concatenate(([True], blank[:-1])))
        return np.diff(np.searchsorted(begins, ends), prepend=0)
    filled = np.diff(np.searchsorted(np.flatnonzero(~blank), ends), prepend=0) > 0
    delimiters = np.diff(np.searchsorted(np.flatnonzero(text == ord(delimiter)), ends), prepend=0)
    return np.where(filled | (delimiters > 0), delimiters + 1, 0)


def _bad_cell(
    block: bytes, delimiter: str, names: Sequence[str], where: Path, first_row: int, decimal: str
) -> InputError:
    for row, line in enumerate(block.decode("utf-8", "replace").split("\n"), first_row):
        for name, cell in zip(names, split_line(line, delimiter), strict=False):
            if not _is_number(cell, decimal):
                return InputError(
                    f"the cell '{cell}' is not a number",
                    where=f"{where}, row {row}, column {name}",
                    expected="a number, or an empty cell for no return",
                )
    return InputError("a cell is not a number", where=f"{where}, from row {first_row}")


def _is_number(cell: str, decimal: str = ".") -> bool:
    if cell.lower() in _MISSING:
        return True
    try:
        float(cell.replace(decimal, "."))
    except ValueError:
        return False
    return "_" not in cell
