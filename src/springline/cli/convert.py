"""`springline convert`: from one format to another."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import InputError
from . import reading
from .options import Force, Json

if TYPE_CHECKING:
    from ..survey import Survey

app = typer.Typer(add_completion=False)

_TO = typer.Option("--to", metavar="FORMAT", help="Format of the output, instead of its extension's.")


@app.command(
    epilog="Examples:  springline convert scan.laz scan.ply  |  "
    "springline convert rings.csv rings.parquet --unit mm --bearing-zero crown --bearing-sense cw  |  "
    "springline convert depth.png cloud.ply --intrinsics 421.1,421.1,426.2,237.0  |  "
    "springline convert survey.zarr.zip FOLDER --to folder  |  "
    "springline convert report/survey.zarr.zip stations.gpkg"
)
def convert(
    source: Annotated[Path, typer.Argument(metavar="IN", help="File, survey folder or zarr store.")],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="Where to write; without extension a survey folder.")],
    to: Annotated[str | None, _TO] = None,
    input_format: reading.InputFormat = None,
    nominal: reading.Nominal = None,
    unit: reading.Unit = None,
    bearing_zero: reading.BearingZero = None,
    bearing_sense: reading.BearingSense = None,
    intrinsics: reading.Intrinsics = None,
    depth_unit: reading.DepthUnit = None,
    axes: reading.Axes = None,
    sensor: reading.Sensor = None,
    name: reading.Name = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Convert a scan from one format to another, or export the results of an inspection.

    Writes whole or not at all. Told on stderr: what was assumed while reading, what the output cannot hold.
    """
    from ..io.reading import read_one
    from ..io.writing import left_out, output_format
    from ..outputs.exchange.writing import SHARED, export_of, known_format, own_format, write

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
    key = None if to is None else known_format(to, where="--to")
    if (key is not None or target.suffix.lower() not in SHARED) and export_of(target, key) is None:
        output_format(target, key)
    if source.exists() and target.exists() and source.samefile(target):
        raise InputError("the output is the input", where=target, mend="choose another name")
    survey = read_one(source, options)
    key = key or own_format(survey, target)
    export = export_of(target, key)
    kind = export or output_format(target, key)
    write(survey, target, format=kind.key, force=force)
    lost = [] if export else left_out(survey, kind)
    if as_json:
        record = {"input": str(source), "output": str(target), "format": kind.key, "groups": _sizes(survey)}
        typer.echo(json.dumps({**record, "assumptions": survey.assumptions, "left_out": lost}, indent=2))
        return
    for sentence in survey.assumptions:
        sys.stderr.write(f"assumed: {sentence}\n")
    if export:
        sys.stderr.write(f"held by {export.key}: {export.holds}\n")
    if lost:
        sys.stderr.write(f"not held by {kind.key}: {', '.join(lost)}\n")
    typer.echo(f"{target}: {kind.title}")


def _sizes(survey: Survey) -> dict[str, dict[str, int]]:
    return {group: {str(d): int(n) for d, n in survey.group(group).sizes.items()} for group in survey.groups}
