"""`springline compare`: what changed between two inspections or more."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError, nearest
from .compare_inputs import ListOptions, pairs_of, read_epoch
from .options import Force, Json

if TYPE_CHECKING:
    from ..compare import Comparison, Epoch, MatchOptions, Series

app = typer.Typer(add_completion=False)

_LISTS = "About lists of features"
_FEWEST = 2


def _list_option(flag: str, metavar: str, text: str) -> Any:
    return typer.Option(flag, metavar=metavar, help=text, rich_help_panel=_LISTS)


@app.command(
    epilog="Examples:  springline compare report-2022 report-2026 -o changes  |  "
    "springline compare Conditions.csv@5531 Conditions.csv@6120 -o changes  |  "
    'springline compare run-2019.xlsx run-2024.xlsx --columns "chainage=Log dist,kind=Event,clock=Clock" '
    '--kinds "GWD=joint,TEE=lateral" --unit ft -o changes  |  springline compare 2018 2022 2026 -o trends'
)
def compare(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="A B [C...]",
            help="Inspections, the earliest first: folders of inspect, surveys, or lists of features (CSV, XLSX).",
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write.")],
    false_alarms: Annotated[
        float, typer.Option("--false-alarms", metavar="N", help="False alarms per 100 m of unchanged pipe.")
    ] = 1.0,
    works: Annotated[
        bool, typer.Option("--works", help="The pipe was cleaned, repaired or lined in between: things may shrink.")
    ] = False,
    columns: Annotated[
        str | None, _list_option("--columns", "MAP", "Headings of chainage, kind, clock, size: chainage=Log dist,...")
    ] = None,
    kinds: Annotated[
        str | None, _list_option("--kinds", "MAP", "Words of the kind's column: GWD=joint,TEE=lateral,...")
    ] = None,
    kind: Annotated[str, _list_option("--kind", "KIND", "Kind of all rows where no column says it.")] = "joint",
    unit: Annotated[str, _list_option("--unit", "m|ft|...", "Unit of chainages; m, or ft in PACP tables.")] = "",
    size_unit: Annotated[
        str, _list_option("--size-unit", "mm|in|...", "Unit of sizes; mm, or in in PACP tables.")
    ] = "",
    sort: Annotated[
        bool,
        typer.Option(
            "--sort", help="Sort lists by chainage instead of refusing those that fall.", rich_help_panel=_LISTS
        ),
    ] = False,
    by_eye: Annotated[
        bool | None,
        typer.Option(
            "--by-eye/--by-instrument",
            help="Whether lists were coded by eye from CCTV or by an instrument; PACP tables are by eye.",
            rich_help_panel=_LISTS,
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Place two inspections of one pipe on each other and say what changed, and what cannot be said.

    More than two give trends, each inspection placed on the first. Inspections of different pipes are refused.
    """
    from ..compare import KINDS
    from ..outputs.comparison.write import check_replaceable

    if len(inputs) < _FEWEST:
        raise InputError("one inspection alone", where=str(inputs[0]), expected="two inspections or more")
    if not 0.0 < false_alarms <= 100.0:
        raise InputError(
            f"it is {false_alarms:g}",
            where="--false-alarms",
            expected="a number above 0, at most 100: changes told by chance per 100 m of unchanged pipe",
            mend="leave it out for one in 100 m",
        )
    if kind not in KINDS:
        raise InputError(
            f"there is no kind of feature {kind!r}{nearest(kind, KINDS)}", where="--kind", expected=", ".join(KINDS)
        )
    check_replaceable(output, force=force)
    given = ListOptions(pairs_of(columns, "--columns"), pairs_of(kinds, "--kinds"), kind, unit, size_unit, sort)
    read = [read_epoch(path, given) for path in inputs]
    coded = any(eye for _, eye in read) if by_eye is None else by_eye
    asked = {"options": _options(coded), "false_alarms": false_alarms, "works": works}
    epochs = _named([epoch for epoch, _ in read], inputs)
    found = _run(epochs, output, asked, force=force)
    if as_json:
        from .run import as_json as print_json

        print_json(found)


def _options(coded: bool) -> MatchOptions:
    from ..compare import MatchOptions

    return MatchOptions.cctv() if coded else MatchOptions()


def _named(epochs: list[Epoch], inputs: list[Path]) -> list[Epoch]:
    """Return the inspections with their files' names where their own do not tell them apart."""
    from dataclasses import replace

    if len({e.name for e in epochs}) == len(epochs):
        return epochs
    return [replace(e, name=f"{e.name} ({path.name})") for e, path in zip(epochs, inputs, strict=True)]


def _run(epochs: list[Epoch], output: Path, asked: dict[str, Any], *, force: bool) -> dict[str, Any]:
    from rich.console import Console

    from ..compare import compare_epochs, compare_series
    from ..outputs.comparison.summary import comparison_summary, series_summary
    from ..outputs.comparison.write import write_comparison, write_series

    with Console(stderr=True).status("comparing"):
        if len(epochs) == _FEWEST:
            found: Any = compare_epochs(*epochs, **asked)
            _check(found)
            write_comparison(found, output, force=force)
            summary = comparison_summary(found)
        else:
            found = compare_series(epochs, **asked)
            for pair in found.pairs:
                if not pair:
                    sys.stderr.write(f"warning: {pair.b.name} is left out: {pair.reason}\n")
            if not found:
                raise InputError("none of the inspections could be compared with the first", where=epochs[0].name)
            write_series(found, output, force=force)
            summary = series_summary(found)
    if len(epochs) == _FEWEST:
        _tell(found, summary, output)
    else:
        _tell_series(found, output)
    return summary


def _check(found: Comparison) -> None:
    if not found:
        raise InputError(
            f"they are not compared: {found.reason}",
            where=f"{found.a.name} and {found.b.name}",
            expected="two inspections of one pipe",
        )


def _tell(found: Comparison, summary: dict[str, Any], output: Path) -> None:
    for sentence in found.notes:
        sys.stderr.write(f"note: {sentence}\n")
    ends = "the other end" if summary["driven_from_the_other_end"] else "the same end"
    errors, depth = summary["measurement_errors"], summary["largest_wall_change_mm"]
    lines = [
        f"{found.a.name} -> {found.b.name}: driven from {ends}, {summary['placed_pct']:g} % of the length placed",
        f"  features in both {summary['pairs']}",
        f"  changes          {summary['changes']} ({errors} more taken for errors of measurement,"
        f" {summary['unclear']} unclear)",
    ]
    if depth is not None:
        lines.append(
            f"  largest of wall  {depth:.2f} +- {summary['largest_wall_change_sigma_mm']:.2f}"
            f" mm at {summary['largest_wall_change_chainage_m']:.2f} m"
        )
    least = summary["detectable"].get("wall, local")
    if least is not None and least["value"] is not None:
        lines.append(f"  dent told from   {least['value']:.2f} mm (190 mm x 35 degrees at half depth)")
    lines.append(f"  report           {output / 'report.html'}")
    sys.stderr.flush()
    typer.echo("\n".join(lines), err=False)


def _tell_series(found: Series, output: Path) -> None:
    trends = (*found.stations, *found.patches, *found.features)
    told = sum(t.significant for t in trends)
    lines = [
        f"{found.epochs[0].name}: {len(found.epochs)} inspections, {sum(map(bool, found.pairs))} placed on the first"
    ]
    for pair in filter(None, found.pairs):
        ends = "the other end" if pair.placed.reversed else "the same end"
        both = 0 if pair.paired is None else len(pair.paired.index_a)
        lines.append(f"  {pair.b.name}: driven from {ends}, features in both {both}")
    lines += [f"  trends told      {told} of {len(trends)}", f"  report           {output / 'report.html'}"]
    typer.echo("\n".join(lines))
