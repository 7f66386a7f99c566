"""EN 13508-2 exchange files: text with a head of #A lines, then a #B header, a #C table and #Z for each inspection.

Source: EN 13508-2:2003+A1:2011, annex on data transfer; field letters and header codes as published with the example of
the package kwb.en13508.2.
"""

from __future__ import annotations

import csv
import io
import re
from typing import TYPE_CHECKING

from ..errors import FormatError
from .codes import en_kind
from .observations import Inspection, Observed, clock_hours, number, observations_survey, plain

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

LETTERS = {
    "A": "code",
    "B": "characterisation_1",
    "C": "characterisation_2",
    "D": "quantification_1",
    "E": "quantification_2",
    "F": "remarks",
    "J": "continuous",
    "K": "joint",
    "M": "photo",
    "N": "video",
}
"""Letters of #C whose content is text; I is the distance, G and H are the clock positions."""

HEADER = {
    "name": "AAA",
    "node_from": "AAD",
    "node_to": "AAF",
    "direction": "AAK",
    "date": "ABF",
    "time": "ABG",
    "operator": "ABH",
    "length_m": "ABQ",
    "height_mm": "ACB",
    "width_mm": "ACC",
    "material": "ACD",
}
"""Header code of each common word."""

DIRECTIONS = {"A": "downstream", "B": "upstream"}
HEAD = {"A1": "ISO-8859-1", "A2": "en", "A3": ",", "A4": ".", "A5": '"', "A6": "2010"}
"""Head of a file: encoding, language, separator, decimal sign, quote, edition."""

_LINE = re.compile(r"#([A-Z]\d*)=?(.*)")


def read_en13508(path: Path, options: ReadOptions) -> Survey:
    """Read an EN 13508-2 exchange file into `/observations`; what it says beyond that is carried.

    Raises:
        FormatError: A line does not follow the format; file and row are named.
    """
    head, lines = _head(path)
    found: list[Inspection] = []
    blocks: dict[str, dict[str, str]] = {}
    columns: list[str] = []
    pending, closed = None, True
    for row, line in lines:
        place = f"{path}, row {row}"
        mark = _LINE.fullmatch(line) if line.startswith("#") else None
        if mark is None:
            cells = _cells(line, head)
            if pending is not None:
                blocks[pending[0]] = dict(_pairs(pending[1], cells, place))
                pending = None
            elif columns:
                found[-1].observed.append(_observed(dict(_pairs(columns, cells, place)), head, place))
            else:
                raise FormatError("a row stands before the line #C", where=place)
        elif mark[1].startswith("B"):
            pending = (mark[1], _cells(mark[2], head))
        elif mark[1] == "C":
            columns, closed = _cells(mark[2], head), False
            flat = {code: value for block in blocks.values() for code, value in block.items()}
            found.append(Inspection(_common(flat), {"blocks": blocks, "columns": columns}))
        elif mark[1] == "Z":
            blocks, columns, closed = {}, [], True
        else:
            raise FormatError(f"the line {line!r} is not known", where=place, expected="#A, #B, #C or #Z")
    return observations_survey(found, path, format="en13508", layout={"head": head, "closed": closed})


def _head(path: Path) -> tuple[dict[str, str], Iterator[tuple[int, str]]]:
    raw = path.read_bytes()
    head = dict(HEAD)
    said = re.findall(rb"^#(A\d)=([^\r\n]*)", raw, flags=re.M)
    head |= {key.decode("ascii"): value.decode("latin-1") for key, value in said}
    try:
        text = raw.decode(head["A1"] or "ISO-8859-1")
    except (UnicodeDecodeError, LookupError) as error:
        raise FormatError(f"it cannot be read as {head['A1']}: {error}", where=path) from None
    for key in ("A3", "A4", "A5"):
        if len(head[key]) != 1:
            raise FormatError(f"#{key} is {head[key]!r}", where=path, expected="one character")
    rows = ((k, line) for k, line in enumerate(text.splitlines(), 1))
    return head, ((k, line) for k, line in rows if line.strip() and not re.match(r"#A\d=", line))


def _cells(line: str, head: dict[str, str]) -> list[str]:
    return next(csv.reader(io.StringIO(line), delimiter=head["A3"], quotechar=head["A5"]), [])


def _pairs(names: list[str], cells: list[str], place: str) -> list[tuple[str, str]]:
    if len(cells) > len(names):
        raise FormatError(f"there are {len(cells)} cells under {len(names)} names", where=place)
    return list(zip(names, cells + [""] * (len(names) - len(cells)), strict=True))


def _observed(cells: dict[str, str], head: dict[str, str], place: str) -> Observed:
    texts = {name: cells.get(letter, "") for letter, name in LETTERS.items()}
    texts["kind"] = en_kind(texts["code"], texts["remarks"])
    return Observed(
        number(cells.get("I", ""), f"{place}, column I", decimal=head["A4"]),
        clock_hours(cells.get("G", ""), f"{place}, column G"),
        clock_hours(cells.get("H", ""), f"{place}, column H"),
        texts,
        {letter: value for letter, value in cells.items() if letter not in {*LETTERS, "I", "G", "H"}},
    )


def _common(flat: dict[str, str]) -> dict[str, str]:
    common = {word: flat[code] for word, code in HEADER.items() if flat.get(code)}
    if "direction" in common:
        common["direction"] = DIRECTIONS.get(common["direction"], "")
    return common


def cells_of(one: Observed, head: dict[str, str]) -> dict[str, str]:
    """Return an observation by the letters of #C."""
    return {
        "I": plain(one.distance).replace(".", head["A4"]),
        "G": plain(one.clock),
        "H": plain(one.clock_to),
        **{letter: one[name] for letter, name in LETTERS.items()},
        **{letter: str(value) for letter, value in one.fields.items()},
    }
