"""`springline inspect`: the main job."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from . import reading
from .options import Force, Json
from .run import as_json as print_json
from .run import finish, inspect_into, refuse_existing, tell

if TYPE_CHECKING:
    from ..config import Config
    from ..io import ReadOptions
    from ..survey import Survey

app = typer.Typer(add_completion=False)


@app.command(
    epilog="Examples:  springline inspect scan.laz --nominal 400mm -o report  |  "
    "springline inspect depth.png --intrinsics 421.1,421.1,426.2,237.0 --nominal 200mm -o report  |  "
    "springline inspect rings.csv --unit mm --bearing-zero crown --bearing-sense cw -o report --check deflection-5  |  "
    "springline inspect FOLDER -o reports --keep-going"
)
def inspect(
    inputs: Annotated[
        list[Path],
        typer.Argument(metavar="INPUT...", help="A scan, parts of one scan, or a folder of scans."),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write.")],
    nominal: reading.Nominal = None,
    base: Annotated[
        str | None, typer.Option("--base", metavar="LENGTH", help="Base (inside) diameter that deflection refers to.")
    ] = None,
    config: Annotated[Path | None, typer.Option("--config", metavar="FILE", help="Settings in TOML.")] = None,
    calibration: Annotated[
        Path | None,
        typer.Option("--calibration", metavar="FILE", help="The sensor's calibration, from: springline calibrate ring"),
    ] = None,
    check: Annotated[
        list[str] | None, typer.Option("--check", metavar="RULE", help="Acceptance rule to judge; may be repeated.")
    ] = None,
    spacing: Annotated[
        str | None, typer.Option("--spacing", metavar="LENGTH", help="Distance between the stations of a cloud.")
    ] = None,
    liner: Annotated[
        bool, typer.Option("--liner", help="The pipe is lined: look for lobes where the liner has left its host.")
    ] = False,
    overrides: Annotated[
        Path | None,
        typer.Option("--overrides", metavar="FILE", help="Corrections by people, instead of overrides.toml beside."),
    ] = None,
    design_line: Annotated[
        Path | None,
        typer.Option("--design-line", metavar="FILE", help="Where the pipe was to be laid: a table, or LandXML."),
    ] = None,
    design_line_of: Annotated[
        str | None, typer.Option("--design-line-of", help="axis or invert, where that file does not say it.")
    ] = None,
    back: Annotated[
        Path | None,
        typer.Option("--back", metavar="FILE", help="The same pipe driven from its other end; joined with INPUT."),
    ] = None,
    units: Annotated[str | None, typer.Option("--units", help="si, or us: inches and feet to read.")] = None,
    input_format: reading.InputFormat = None,
    unit: reading.Unit = None,
    bearing_zero: reading.BearingZero = None,
    bearing_sense: reading.BearingSense = None,
    intrinsics: reading.Intrinsics = None,
    depth_unit: reading.DepthUnit = None,
    axes: reading.Axes = None,
    sensor: reading.Sensor = None,
    name: reading.Name = None,
    keep_going: reading.KeepGoing = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Read a scan, find the section at every station, and write numbers and a report into DIR.

    A folder of scans gives one result each, in a folder of its own below DIR.
    """
    options = reading.read_options(
        nominal=nominal,
        format=input_format,
        unit=unit,
        bearing_zero=bearing_zero,
        bearing_sense=bearing_sense,
        intrinsics=intrinsics,
        depth_unit=depth_unit,
        axes=axes,
        sensor=sensor,
        name=name,
    )
    settings = _settings(config, spacing, liner=liner, units=units)
    refuse_existing(output, force=force)
    base_diameter = _length(base, "--base")
    surveys = {
        key: survey.with_attrs(base_diameter=base_diameter) if base_diameter else survey
        for key, survey in _read(inputs, options, keep_going=keep_going).items()
    }
    if overrides is not None:
        surveys = _corrected(surveys, overrides)
    if calibration is not None:
        surveys = _calibrated(surveys, calibration)
    if design_line is None and design_line_of is not None:
        raise InputError("there is no design line", where="--design-line-of", expected="--design-line FILE with it")
    if design_line is not None:
        surveys = _designed(surveys, design_line, design_line_of)
    returned = None
    if back is not None:
        surveys, returned = _with_back(surveys, back, options, calibration)
    checks = tuple(check or ())
    if len(surveys) == 1:
        found: Any = inspect_into(
            next(iter(surveys.values())), output, settings, back=returned, checks=checks, force=force
        )
        results = [found]
    else:
        found = _inspect_each(surveys, output, settings, checks, force=force, keep_going=keep_going)
        results = found["scans"]
    if as_json:
        print_json(found)
    else:
        for one in results:
            tell(one, output / one["folder"] if "folder" in one else output)
    finish(results)


def _calibrated(surveys: dict[str, Survey], path: Path) -> dict[str, Survey]:
    from ..calibration import with_calibration
    from ..io.calibration_file import read_calibration
    from ..survey import add_inputs, add_provenance, fingerprint

    found = read_calibration(path)
    file = fingerprint(path)
    return {
        key: add_provenance(add_inputs(with_calibration(survey, found), file), calibration=path.name)
        for key, survey in surveys.items()
    }


def _with_back(
    surveys: dict[str, Survey], path: Path, options: ReadOptions, calibration: Path | None
) -> tuple[dict[str, Survey], Survey]:
    """Return the surveys, naming the back pass among their inputs, and the back pass."""
    from ..io.reading import read_one
    from ..survey import add_inputs, add_provenance, fingerprint

    if len(surveys) > 1:
        raise InputError(f"it is one back pass for {len(surveys)} scans", where="--back", expected="one scan")
    if not path.exists():
        raise InputError("no such file", where=path, mend="check the path given to --back")
    returned = {"back": read_one(path, options)}
    if calibration is not None:
        returned = _calibrated(returned, calibration)
    file = fingerprint(path)
    named = {key: add_provenance(add_inputs(one, file), back=path.name) for key, one in surveys.items()}
    return named, returned["back"]


def _designed(surveys: dict[str, Survey], path: Path, of: str | None) -> dict[str, Survey]:
    from ..io.design_line import read_design_line
    from ..survey import Survey, add_inputs, add_provenance, fingerprint

    line, file = read_design_line(path, of=of), fingerprint(path)
    return {
        key: add_provenance(
            add_inputs(
                Survey({**{name: one.group(name) for name in one.groups}, "design_line": line}, one.attrs), file
            ),
            design_line=path.name,
            design_line_of=of,
        )
        for key, one in surveys.items()
    }


def _read(inputs: list[Path], options: ReadOptions, *, keep_going: bool) -> dict[str, Survey]:
    from ..io.reading import combine, expand, read_many, read_one

    if len(inputs) > 1 and not any(path.is_dir() and expand([path]) != [path] for path in inputs):
        parts = [read_one(path, options, strict=False) for path in inputs]
        return {"all": combine(parts, inputs, options)}
    surveys, unreadable = read_many(inputs, options, keep_going=keep_going)
    for one in unreadable:
        sys.stderr.write(f"left out: {one.reason}\n")
    return surveys


def _inspect_each(
    surveys: dict[str, Survey],
    output: Path,
    settings: Config,
    checks: tuple[str, ...],
    *,
    force: bool,
    keep_going: bool,
) -> dict[str, Any]:
    """Inspect several scans into a folder each, the whole appearing at once."""
    from ..survey.files import OwnFolder, replacing

    scans, failed = [], []
    with replacing(output, force=force, own=OwnFolder.of("inspections", "summary.json")) as temporary:
        temporary.mkdir()
        for key, survey in surveys.items():
            try:
                found = inspect_into(survey, temporary / key, settings, checks=checks)
            except InputError as error:
                if not keep_going:
                    raise
                failed.append({"folder": key, "reason": str(error)})
                sys.stderr.write(f"left out: {error}\n")
                continue
            scans.append({"folder": key, **found})
        if not scans:
            raise InputError("none of the scans could be inspected", where=output)
        index = {"scans": scans, "left_out": failed}
        (temporary / "summary.json").write_text(json.dumps(index, indent=2, ensure_ascii=False) + "\n", "utf-8")
    return index


def _corrected(surveys: dict[str, Survey], path: Path) -> dict[str, Survey]:
    from ..survey import add_provenance
    from ..survey.overrides import with_overrides

    if len(surveys) > 1:
        raise InputError(f"it is one file for {len(surveys)} scans", where="--overrides", expected="one scan")
    return {key: add_provenance(with_overrides(survey, path), overrides=path.name) for key, survey in surveys.items()}


def _settings(path: Path | None, spacing: str | None, *, liner: bool, units: str | None) -> Config:
    from ..config import Config, load_config
    from ..outputs.units import unit

    settings = load_config(path) if path else Config()
    if units is not None:
        unit("m", units)
        settings = settings.model_copy(update={"outputs": settings.outputs.model_copy(update={"units": units})})
    if liner:
        settings = settings.model_copy(update={"liner": settings.liner.model_copy(update={"fit": True})})
    if spacing is None:
        return settings
    rings = settings.rings.model_copy(update={"spacing": _length(spacing, "--spacing")})
    return settings.model_copy(update={"rings": rings})


def _length(text: str | None, where: str) -> float | None:
    from ..io.units import length

    return None if text is None else length(text, where=where)
