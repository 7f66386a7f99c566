"""EN 13508-2 exchange text: what was read is written back as it stood; results get a header of their own."""

from __future__ import annotations

import csv
import io
import json
from typing import TYPE_CHECKING

from ...io.en13508 import DIRECTIONS, HEAD, HEADER, LETTERS, cells_of
from ...io.trees import clean
from .coded import inspections, is_own

if TYPE_CHECKING:
    from pathlib import Path

    from ...io.observations import Inspection
    from ...survey import Survey

_COLUMNS = ("I", "J", *(letter for letter in LETTERS if letter != "J"), "G", "H")
_STANDARD = "EN 13508-2:2003+A1:2011"


def write_en13508(survey: Survey, path: Path) -> None:
    """Write observations, or the features of an inspection, as EN 13508-2 text.

    Letters that the file's encoding lacks make it UTF-8, which its head says.

    Raises:
        InputError: There is nothing to write, or it is coded by another system.
    """
    own = is_own(survey, "en13508")
    layout = json.loads(survey.observations.attrs["layout"]) if own else {}
    head = {**HEAD, **layout.get("head", {})}
    blocks = [_block(one, head, own=own) for one in inspections(survey, "en13508")]
    body = "".join(blocks)
    if not layout.get("closed", True):
        body = body.removesuffix("#Z\r\n")
    try:
        raw = body.encode(head["A1"])
    except (UnicodeEncodeError, LookupError):
        head["A1"] = "UTF-8"
        raw = body.encode("utf-8")
    first = "".join(f"#{key}={head[key]}\r\n" for key in sorted(head))
    path.write_bytes(first.encode(head["A1"]) + raw)


def _block(inspection: Inspection, head: dict[str, str], *, own: bool) -> str:
    if own:
        tables, columns = inspection.own["blocks"], inspection.own["columns"]
    else:
        fields = {HEADER[word]: value for word, value in inspection.common.items() if word in HEADER}
        codes = {said: letter for letter, said in DIRECTIONS.items()}
        if "direction" in inspection.common:
            fields[HEADER["direction"]] = codes.get(inspection.common["direction"], "")
        tables, columns = {"B01": {"ABA": _STANDARD, **fields}}, _COLUMNS
    lines = []
    for mark, fields in tables.items():
        lines += [f"#{mark}={_row(list(fields), head)}", _row(list(fields.values()), head)]
    lines.append(f"#C={_row(list(columns), head)}")
    for one in inspection.observed:
        cells = cells_of(one, head)
        lines.append(_row([cells.get(letter, "") for letter in columns], head))
    return "\r\n".join([*lines, "#Z"]) + "\r\n"


def _row(cells: list[str], head: dict[str, str]) -> str:
    """Return one line; line breaks in a cell become spaces, and a cell that looks like a mark is quoted."""
    flat = [" ".join(clean(str(cell)).splitlines()) for cell in cells]
    stream = io.StringIO()
    csv.writer(stream, delimiter=head["A3"], quotechar=head["A5"], lineterminator="").writerow(flat)
    line = stream.getvalue()
    if line.startswith("#"):
        return f"{head['A5']}{flat[0]}{head['A5']}{line[len(flat[0]) :]}"
    return line
