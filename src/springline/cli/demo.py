"""`springline demo`: the main job on the built-in survey."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import Force, Json
from .run import as_json as print_json
from .run import inspect_into, refuse_existing, tell

app = typer.Typer(add_completion=False)


@app.command(epilog="Example:  springline demo -o demo-report")
def demo(
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write.")] = Path(
        "demo-report"
    ),
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Run the main job on the built-in survey: 30 m of simulated 300 mm pipe with known truth."""
    refuse_existing(output, force=force)
    from ..config import Config
    from ..data import builtin_survey
    from ..io import read

    found = inspect_into(read(builtin_survey()), output, Config(), force=force)
    if as_json:
        print_json(found)
    else:
        tell(found, output)
