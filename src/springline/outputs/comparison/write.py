"""All files of a comparison, written whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from ...survey.files import OwnFolder, replacing
from ..tables import write_csv
from ..viewer import compared, render_viewer
from . import tables
from .page import render_comparison, render_series
from .summary import comparison_summary, series_summary

if TYPE_CHECKING:
    from typing import Any

    from ...compare.pair import Comparison
    from ...compare.series import Series, Trend

_COMPARISON = OwnFolder(
    "a comparison", (frozenset({"summary.json", "changes.csv"}), frozenset({"summary.json", "station_trends.csv"}))
)


def write_comparison(found: Comparison, directory: str | Path, *, force: bool = False) -> list[Path]:
    """Write the files of a comparison into a new folder, which appears only when all of them are complete.

    Args:
        found: The comparison; it must not be refused.
        directory: The folder to make.
        force: Replace the folder when it holds an earlier comparison.

    Returns:
        The files.

    Raises:
        OutputError: The folder exists and `force` is not given, or it holds something else than a comparison, or the
            disk refuses.
    """
    directory = Path(directory)
    check_replaceable(directory, force=force)
    with replacing(directory, force=force, own=_COMPARISON) as temporary:
        _write(found, temporary)
        names = sorted(path.name for path in temporary.iterdir())
    return [directory / name for name in names]


def _write(found: Comparison, folder: Path) -> None:
    folder.mkdir()
    _json(comparison_summary(found), folder / "summary.json")
    write_csv(tables.pairs_table(found), folder / "pairs.csv", tables.PAIR_DECIMALS)
    write_csv(tables.changes_table(found), folder / "changes.csv", tables.CHANGE_DECIMALS)
    write_csv(tables.placing_table(found), folder / "placing.csv", tables.PLACE_DECIMALS)
    (folder / "report.html").write_text(render_comparison(found), encoding="utf-8")
    shown = compared(found)
    if shown:
        (folder / "viewer.html").write_text(render_viewer(*shown), encoding="utf-8")


def write_series(found: Series, directory: str | Path, *, force: bool = False) -> list[Path]:
    """Write the files of a series into a new folder: trends, and the comparison of each inspection with the first.

    Args:
        found: The series.
        directory: The folder to make.
        force: Replace the folder when it holds an earlier series.

    Raises:
        OutputError: As `write_comparison`.
    """
    directory = Path(directory)
    check_replaceable(directory, force=force)
    with replacing(directory, force=force, own=_COMPARISON) as temporary:
        temporary.mkdir()
        _json(series_summary(found), temporary / "summary.json")
        for name, trends in _trends(found).items():
            table, decimals = tables.trends_table(found, trends)
            write_csv(table, temporary / f"{name}.csv", decimals)
        folders = [f"1-{k}" for k in range(2, len(found.epochs) + 1)]
        for folder, pair in zip(folders, found.pairs, strict=True):
            if pair:
                _write(pair, temporary / folder)
        (temporary / "report.html").write_text(render_series(found, folders), encoding="utf-8")
        names = sorted(path.name for path in temporary.iterdir())
    return [directory / name for name in names]


def _trends(found: Series) -> dict[str, tuple[Trend, ...]]:
    return {"station_trends": found.stations, "wall_trends": found.patches, "feature_trends": found.features}


def check_replaceable(directory: Path, *, force: bool) -> None:
    """Refuse a folder that exists, and one that is not ours even with `force`.

    Raises:
        OutputError: As said.
    """
    _COMPARISON.check(directory, force=force)


def _json(content: dict[str, Any], path: Path) -> None:
    path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
