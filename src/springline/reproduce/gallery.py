"""All tables and figures on one page that asks nothing of any network, and each figure as a file of its own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from springline.outputs.html import environment
from springline.reproduce.drawing.style import proper_minus
from springline.reproduce.figures import MAKERS, figure
from springline.reproduce.tables import REASONS, TABLES, table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from springline.reproduce.figure import Figure
    from springline.reproduce.tables import ReproducedTable

_HERE = Path(__file__).parent

CHAPTERS = {
    "2": "Fits and lenses",
    "3": "Cross-sections",
    "4": "Distorted geometry",
    "5": "Orientation and section from rings",
    "6": "Laterals and joints in images",
    "7": "Liners",
}
"""Chapters that have figures here."""


def all_tables() -> list[ReproducedTable]:
    """Return every table, made again."""
    return [table(number) for number in TABLES]


def all_figures(progress: Callable[[str], None] | None = None) -> list[Figure]:
    """Return every figure, made again; `progress` is called with the number of each before it is made."""
    made = []
    for number in MAKERS:
        if progress is not None:
            progress(number)
        made.append(figure(number))
    return made


def gallery(tables: Iterable[ReproducedTable], figures: Iterable[Figure]) -> dict[str, str]:
    """Return the gallery's files by name: `index.html`, which holds everything, and an SVG of each figure.

    Args:
        tables: Those to show; may be empty.
        figures: Likewise.

    >>> sorted(gallery([table("3.1")], [figure("5.7")]))
    ['figure-5.7.svg', 'index.html']
    """
    tables, figures = list(tables), list(figures)
    pages = environment(_HERE)
    pages.filters["minus"] = proper_minus
    page = pages.get_template("gallery.html.j2")
    chapters = [
        (f"Chapter {number}: {title}", [f for f in figures if f.number.partition(".")[0] == number])
        for number, title in CHAPTERS.items()
    ]
    html = page.render(
        tables=tables,
        reasons=REASONS,
        chapters=[(title, held) for title, held in chapters if held],
        cells=sum(t.matches_published.size for t in tables),
        published=sum(int(t.matches_published.sum()) for t in tables),
        corrected=sum(int(t.matches_corrected.sum()) for t in tables),
        checks=[check for f in figures for check in f.checks],
        style=(_HERE / "gallery.css").read_text(encoding="utf-8"),
    )
    return {"index.html": html, **{f"figure-{f.number}.svg": f.svg for f in figures}}
