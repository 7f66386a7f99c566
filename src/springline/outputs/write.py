"""All files of an inspection, written whole or not at all."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from ..survey import save_survey
from ..survey.files import OwnFolder, replacing
from . import tables
from .mesh import write_glb
from .pdf import render_pdf
from .report import make_report, render_html
from .results import Results
from .summary import summary
from .unroll import unroll
from .viewer import render_viewer

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import pandas as pd

    from ..survey import Survey

INSPECTION = OwnFolder.of("an inspection", "summary.json", "stations.csv")


def write_outputs(
    survey: Survey,
    directory: str | Path,
    *,
    config_toml: str,
    force: bool = False,
    more: Mapping[str, Callable[[Path], object]] | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Path]:
    """Write the files of an inspection into a new folder, which appears only when all of them are complete.

    Report and tables are in the units of `Results.units`. `report.pdf` is among them when the extra `pdf` is installed.

    Args:
        survey: A finished survey.
        directory: The folder to make.
        config_toml: The resolved settings as TOML.
        force: Replace the folder when it holds an earlier inspection.
        more: Further files by name, each with what writes it.
        progress: Called with the name of each file before it is written.

    Returns:
        The files.

    Raises:
        ContractError: The survey is not finished.
        OutputError: The folder exists and `force` is not given, or it holds something else than an inspection, or
            the disk refuses.
    """
    directory = Path(directory)
    INSPECTION.check(directory, force=force)
    results = Results(survey)
    with replacing(directory, force=force, own=INSPECTION) as temporary:
        temporary.mkdir()
        for name, write in (_writers(results, config_toml) | dict(more or {})).items():
            if progress is not None:
                progress(name)
            write(temporary / name)
        names = sorted(path.name for path in temporary.iterdir())
    return [directory / name for name in names]


def _writers(results: Results, config_toml: str) -> dict[str, Callable[[Path], object]]:
    survey = results.survey
    name = str(survey.attrs.get("name") or "pipe")
    wall = unroll(results)
    report = make_report(results, wall, config_toml)

    def text(content: str) -> Callable[[Path], object]:
        return lambda path: path.write_text(content, encoding="utf-8")

    def table(make: Callable[[Survey], pd.DataFrame], decimals: dict[str, int]) -> Callable[[Path], object]:
        return lambda path: tables.write_csv(make(survey), path, decimals, units=results.units)

    writers = {
        "summary.json": lambda path: text(json.dumps(summary(survey), indent=2, ensure_ascii=False) + "\n")(path),
        "stations.csv": table(tables.stations_table, tables.STATION_DECIMALS),
        "stations_sigma.csv": table(tables.stations_sigma_table, tables.STATION_DECIMALS),
        "features.csv": table(tables.features_table, tables.FEATURE_DECIMALS),
        "config.toml": text(config_toml),
        "pipe.glb": lambda path: write_glb(wall, path, name=name),
        "report.html": lambda path: text(render_html(report))(path),
        "report.pdf": lambda path: path.write_bytes(render_pdf(report)),
        "viewer.html": lambda path: text(render_viewer(results, wall))(path),
        "survey.zarr.zip": lambda path: save_survey(survey, path),
    }
    if find_spec("typst") is None:
        del writers["report.pdf"]
    return writers
