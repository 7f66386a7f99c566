"""`springline formats`: what can be read and written."""

from __future__ import annotations

import json
from importlib.util import find_spec
from typing import TYPE_CHECKING

import typer

from .options import Json

if TYPE_CHECKING:
    from ..io.registry import Format
    from ..outputs.exchange import Export

app = typer.Typer(add_completion=False)


@app.command()
def formats(as_json: Json = False) -> None:
    """List the formats that can be read and written.

    Formats are told by content; --format of other commands overrules the guess by the name in the first column. A
    format that needs an extra works after the command that stands beside it.

    Examples: springline formats | springline formats --json
    """
    from ..io.registry import FORMATS
    from ..outputs.exchange.registry import EXPORTS

    known = [*FORMATS.values(), *(e for e in EXPORTS.values() if e.key not in FORMATS)]
    if as_json:
        typer.echo(json.dumps([_record(f) for f in known], indent=2))
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table("format", "holds", "extensions", "reads", "writes", "what it is")
    for f in known:
        r = _record(f)
        title = f.title if r["installed"] else f"{f.title}; first: pip install 'springline[{f.extra}]'"
        table.add_row(
            f.key,
            f.holds,
            " ".join(f.extensions) or "(a folder)",
            "yes" if r["reads"] else "",
            "yes" if r["writes"] else "",
            escape(title),
        )
    Console().print(table)


def _record(f: Format | Export) -> dict[str, object]:
    from ..outputs.exchange.registry import EXPORTS

    return {
        "format": f.key,
        "title": f.title,
        "holds": f.holds,
        "extensions": list(f.extensions),
        "reads": getattr(f, "reader", None) is not None,
        "writes": f.writer is not None or f.key in EXPORTS,
        "extra": f.extra,
        "installed": all(find_spec(library) is not None for library in f.libraries),
    }
