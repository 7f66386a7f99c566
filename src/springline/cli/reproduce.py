"""`springline reproduce`: the dissertation's tables and figures made again, beside what was printed."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .options import Force

if TYPE_CHECKING:
    from ..reproduce.figure import Figure
    from ..reproduce.tables import ReproducedTable

app = typer.Typer(add_completion=False)


class What(StrEnum):
    """What to make again."""

    ALL = "all"
    TABLES = "tables"
    FIGURES = "figures"


@app.command(epilog="Examples:  springline reproduce tables  |  springline reproduce -o gallery")
def reproduce(
    what: Annotated[What, typer.Argument(help="Make again only tables or only figures.")] = What.ALL,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder for index.html and the figures.")
    ] = None,
    force: Force = False,
) -> None:
    """Make the dissertation's tables and figures again, beside what was printed.

    Prints each table cell by cell where it differs, and each statement about a figure that does not hold, with the
    reason; with -o also writes one page with everything, and every figure as SVG.
    """
    from ..reproduce.gallery import all_tables, gallery
    from ..survey.files import OwnFolder, replacing

    own = OwnFolder.of("a gallery", "index.html")
    if output is not None:
        own.check(output, force=force)
    tables = all_tables() if what is not What.FIGURES else []
    figures = _figures() if what is not What.TABLES else []
    for made in tables:
        _tell_table(made)
    for drawn in figures:
        _tell_figure(drawn)
    if output is not None:
        with replacing(output, force=force, own=own) as temporary:
            temporary.mkdir()
            for name, content in gallery(tables, figures).items():
                (temporary / name).write_text(content, encoding="utf-8")
        typer.echo(f"\n{output / 'index.html'}")


def _figures() -> list[Figure]:
    from rich.console import Console

    from ..reproduce.gallery import all_figures

    with Console(stderr=True).status("making figures") as status:
        return all_figures(lambda number: status.update(f"making figure {number}"))


def _tell_table(made: ReproducedTable) -> None:
    from ..reproduce.tables import REASONS

    size = made.matches_published.size
    typer.echo(
        f"Table {made.number} (printed as {made.printed_as}): {made.matches_published.sum()} of {size} cells as coded, "
        f"{made.matches_corrected.sum()} of {size} by the geometry"
    )
    for key in made.reasons:
        for i, name in enumerate(made.rows):
            for j, column in enumerate(made.columns):
                if made.reason(i, j) == key:
                    printed, right = made.printed[i][j], made.corrected_text[i][j]
                    typer.echo(f"  {made.row} = {name}, {column:<13} printed {printed:>6}, corrected {right:>6}")
        typer.echo(f"  {REASONS[key]}")


def _tell_figure(drawn: Figure) -> None:
    held = sum(check.holds for check in drawn.checks)
    typer.echo(f"Figure {drawn.number}: {held} of {len(drawn.checks)} statements hold")
    for check in drawn.checks:
        if not check.holds:
            printed = f" (printed: {check.printed})" if check.printed else ""
            typer.echo(f"  not so: {check.statement}{printed}: {check.found}. {check.why}")
