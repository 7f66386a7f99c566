"""`springline formats`: what can be read and written."""

from __future__ import annotations

import json
from importlib.util import find_spec
from typing import TYPE_CHECKING

import typer

from .options import Json

if TYPE_CHECKING:
    from ..io.registry import Format

app = typer.Typer(add_completion=False)


@app.command()
def formats(as_json: Json = False) -> None:
    """List the formats that can be read and written.

    Formats are told by content; --format of other commands overrules the guess by the name in the first column. A
    format that needs an extra works after the command that stands beside it.

    Examples: springline formats | springline formats --json
    """
    from ..io.registry import FORMATS

    if as_json:
        typer.echo(json.dumps([_record(f) for f in FORMATS.values()], indent=2))
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table("format", "holds", "extensions", "reads", "writes", "what it is")
    for f in FORMATS.values():
        r = _record(f)
        title = f.title if r["installed"] else f"{f.title}; first: pip install 'springline[{f.extra}]'"
        table.add_row(
            f.key,
            f.holds,
            " ".join(f.extensions) or "(a folder)",
            "yes" if f.reader else "",
            "yes" if f.writer else "",
            escape(title),
        )
    Console().print(table)


def _record(f: Format) -> dict[str, object]:
    return {
        "format": f.key,
        "title": f.title,
        "holds": f.holds,
        "extensions": list(f.extensions),
        "reads": f.reader is not None,
        "writes": f.writer is not None,
        "extra": f.extra,
        "installed": all(find_spec(library) is not None for library in f.libraries),
    }
