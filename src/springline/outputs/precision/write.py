"""The files of a precision study: `precision.csv`, `cells.csv`, `study.json` and `study.html`; lengths in mm."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...survey.files import OwnFolder, replacing
from ..html import environment
from .chart import consistency_chart

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...calibration import PrecisionStudy
    from ...calibration.verdicts import PrecisionVerdict

STUDY = OwnFolder.of("a precision study", "precision.csv", "study.json")

_HERE = Path(__file__).parent
_MM = 1e3
_SUMMARY = (
    ("mean_mm", "mean"),
    ("mean_deviation_mm", "mean_deviation"),
    ("repeatability_sd_mm", "repeatability"),
    ("reproducibility_sd_mm", "reproducibility"),
    ("repeatability_limit_mm", "repeatability_limit"),
    ("reproducibility_limit_mm", "reproducibility_limit"),
    ("reference_mm", "reference"),
    ("reference_sigma_mm", "reference_sigma"),
    ("bias_mm", "bias"),
    ("bias_sigma_mm", "bias_sigma"),
    ("bias_half_width_mm", "bias_half_width"),
)


def study_values(study: PrecisionStudy, verdicts: Sequence[PrecisionVerdict]) -> dict[str, Any]:
    """Return a study of diameters [m] as plain values: materials, cells and verdicts; None where not known."""
    materials = [
        {
            "material": name,
            **{key: _number(getattr(study, attribute)[k] * _MM) for key, attribute in _SUMMARY},
            "repeatability_pct": _number(100.0 * study.repeatability[k] / study.mean[k]),
            "bias_pct": _number(100.0 * study.bias[k] / study.reference[k]),
            "h_critical": _number(study.h_critical[k]),
            "k_critical": _number(study.k_critical[k]),
        }
        for k, name in enumerate(study.materials)
    ]
    cells = [
        {
            "laboratory": laboratory,
            "material": material,
            "results": int(study.count[i, j]),
            "mean_mm": _number(study.cell_mean[i, j] * _MM),
            "sd_mm": _number(study.cell_deviation[i, j] * _MM),
            "h": _number(study.h[i, j]),
            "k": _number(study.k[i, j]),
            "flagged": bool(study.flagged[i, j]),
        }
        for j, material in enumerate(study.materials)
        for i, laboratory in enumerate(study.laboratories)
        if study.count[i, j]
    ]
    judged = [
        {
            "material": one.material,
            "requirement": one.requirement,
            "value_pct": _number(100.0 * one.value),
            "low_pct": _number(100.0 * one.low),
            "high_pct": _number(100.0 * one.high),
            "limit_pct": _number(100.0 * one.limit),
            "verdict": one.verdict,
        }
        for one in verdicts
    ]
    return {
        "practice": "ASTM E691, E177",
        "laboratories": len(study.laboratories),
        "notes": _notes(study),
        "materials": materials,
        "cells": cells,
        "verdicts": judged,
    }


def write_study(
    study: PrecisionStudy, verdicts: Sequence[PrecisionVerdict], directory: Path, *, title: str, force: bool = False
) -> dict[str, Any]:
    """Write the study's tables and its page into a folder, whole or not at all, and return its values.

    Args:
        study: Of diameters [m].
        verdicts: On it.
        directory: The folder.
        title: Of the page.
        force: Replace what stands there.

    Raises:
        OutputError: The folder exists without `force`, or the disk refuses.
    """
    values = study_values(study, verdicts)
    with replacing(directory, force=force, own=STUDY) as temporary:
        temporary.mkdir()
        _table(values["materials"], temporary / "precision.csv")
        _table(values["cells"], temporary / "cells.csv")
        (temporary / "study.json").write_text(json.dumps(values, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
        page = environment(_HERE).get_template("page.html.j2")
        charts = [consistency_chart(values, statistic) for statistic in ("h", "k")]
        (temporary / "study.html").write_text(page.render(title=title, study=values, charts=charts), encoding="utf-8")
    return values


def _notes(study: PrecisionStudy) -> list[str]:
    from ...calibration.precision import FEWEST_LABORATORIES

    notes = []
    count = len(study.laboratories)
    if count == 1:
        notes.append("One laboratory alone: reproducibility and h are not known.")
    elif count < FEWEST_LABORATORIES:
        notes.append(f"{count} laboratories; the practice asks for {FEWEST_LABORATORIES} or more.")
    if (study.count == 0).any() or len(set(study.count[study.count > 0].tolist())) > 1:
        notes.append("Cells hold unequal numbers of results; they are pooled by their degrees of freedom.")
    return notes


def _table(rows: list[dict[str, Any]], path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        table = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows([{k: _cell(v) for k, v in row.items()} for row in rows])


def _cell(value: Any) -> Any:
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else value


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
