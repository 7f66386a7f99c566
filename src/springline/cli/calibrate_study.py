"""`springline calibrate study`: how accurate and repeatable a method is, from repeated results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import InputError
from . import reading
from .options import Force, Json
from .run import as_json as print_json

EXAMPLES = (
    "Examples:  springline calibrate study results.csv --references references.csv -o study  |  "
    "springline calibrate study scans.csv --reference 300.1mm --reference 299.9mm --reference 300.2mm "
    "--reference 300.0mm --calibration calibration.toml -o study"
)


def study(
    table: Annotated[
        Path,
        typer.Argument(metavar="TABLE", help="CSV with laboratory, material and diameter_mm, or scan instead of it."),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write.")],
    reference: Annotated[
        list[str] | None,
        typer.Option("--reference", metavar="LENGTH", help="A measured diameter of the one material; four or more."),
    ] = None,
    references: Annotated[
        Path | None, typer.Option("--references", metavar="FILE", help="CSV with material and diameter_mm instead.")
    ] = None,
    calibration: Annotated[
        Path | None, typer.Option("--calibration", metavar="FILE", help="The sensor's calibration, for scans.")
    ] = None,
    unit: reading.Unit = None,
    bearing_zero: reading.BearingZero = None,
    bearing_sense: reading.BearingSense = None,
    sensor: reading.Sensor = None,
    check: Annotated[bool, typer.Option("--check", help="Exit with 3 unless every verdict is pass.")] = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Study accuracy, repeatability and reproducibility from repeated diameters, after ASTM E691 and E177.

    A laboratory is what changed between sessions (device, operator, day), a material is a reference pipe. Accuracy is
    judged at 0.5 % and repeatability at 0.12 %, as Florida DOT asks of laser profilers.
    """
    from ..calibration import study_precision
    from ..calibration.verdicts import judge_precision
    from ..io.precision_tables import read_results
    from ..outputs.precision import write_study
    from ..outputs.precision.write import STUDY

    STUDY.check(output, force=force)
    rows = read_results(table)
    measures = _references(reference, references, sorted({row.material for row in rows}))
    options = {"unit": unit, "bearing_zero": bearing_zero, "bearing_sense": bearing_sense, "sensor": sensor}
    diameters = [
        row.diameter if row.scan is None else _diameter(row.scan, options, measures.get(row.material), calibration)
        for row in rows
    ]
    found = study_precision(
        [row.laboratory for row in rows], [row.material for row in rows], diameters, reference=measures
    )
    verdicts = judge_precision(found)
    values = write_study(found, verdicts, output, title=f"Precision study: {table.stem}", force=force)
    if as_json:
        print_json(values)
    else:
        _tell_study(values, output)
    if check and any(one.verdict != "pass" for one in verdicts):
        raise typer.Exit(3)


def _references(given: list[str] | None, file: Path | None, materials: list[str]) -> dict[str, list[float]]:
    from ..io.precision_tables import read_references
    from ..io.units import length

    if given and file:
        raise InputError("both --reference and --references are given", mend="leave one out")
    if file is not None:
        return read_references(file)
    if not given:
        return {}
    if len(materials) > 1:
        raise InputError(
            f"there are {len(materials)} materials", where="--reference", mend="give their measures with --references"
        )
    return {materials[0]: [length(text, where="--reference") for text in given]}


def _diameter(scan: Path, options: dict[str, Any], measures: list[float] | None, calibration: Path | None) -> float:
    """Return the mean diameter that an inspection of the scan finds [m]."""
    from ..calibration import with_calibration
    from ..io.calibration_file import read_calibration
    from ..io.reading import read_one
    from ..pipeline import inspect

    nominal = f"{sum(measures) / len(measures):.9f}m" if measures else None
    survey = read_one(scan, reading.read_options(nominal=nominal, **options), strict=False)
    if calibration is not None:
        survey = with_calibration(survey, read_calibration(calibration))
    return float(inspect(survey).metrics.attrs["diameter_mean"])


def _tell_study(values: dict[str, Any], output: Path) -> None:
    lines = [*values["notes"]]
    for one in values["materials"]:
        lines.append(
            f"{one['material']}: mean {_shown(one['mean_mm'], ' mm')}, s_r {_shown(one['repeatability_sd_mm'], ' mm')},"
            f" s_R {_shown(one['reproducibility_sd_mm'], ' mm')}, bias {_shown(one['bias_mm'], ' mm')}"
            f" (95 % +- {_shown(one['bias_half_width_mm'], ' mm')})"
        )
        lines += [
            f"  {v['requirement']:<14} {_shown(v['value_pct'], ' %')} (limit {v['limit_pct']:g} %): {v['verdict']}"
            for v in values["verdicts"]
            if v["material"] == one["material"]
        ]
    for cell in values["cells"]:
        if cell["flagged"]:
            h, k = _shown(cell["h"]), _shown(cell["k"])
            lines.append(f"look at {cell['laboratory']}, {cell['material']}: h {h}, k {k}")
    typer.echo("\n".join([*lines, f"page  {output / 'study.html'}"]))


def _shown(value: float | None, unit: str = "") -> str:
    return "not known" if value is None else f"{value:.3f}{unit}"
