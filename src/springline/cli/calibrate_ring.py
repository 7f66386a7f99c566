"""`springline calibrate ring`: range scale, boresight and noise law from scans of a known reference."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from . import reading
from .options import Force, Json
from .run import as_json as print_json

if TYPE_CHECKING:
    import xarray as xr

    from ..survey import Survey

EXAMPLES = (
    "Examples:  springline calibrate ring ring-*.csv --diameter 300mm --sigma 0.05mm --tilts tilts.csv "
    "-o calibration.toml  |  springline calibrate ring a.csv b.csv --diameter 300.1mm --diameter 299.9mm "
    "--diameter 300.2mm --diameter 300.0mm -o calibration.toml  |  "
    "springline inspect survey.csv --calibration calibration.toml -o report"
)


def ring(
    scans: Annotated[list[Path], typer.Argument(metavar="SCAN...", help="Scans of the reference, one file each.")],
    diameter: Annotated[
        list[str],
        typer.Option("--diameter", metavar="LENGTH", help="Inside diameter of the reference; repeat it per measure."),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help=".toml, .zarr or .zarr.zip to write.")],
    sigma: Annotated[
        str | None,
        typer.Option("--sigma", metavar="LENGTH", help="One-sigma of the diameter; from repeated measures otherwise."),
    ] = None,
    tilts: Annotated[
        Path | None,
        typer.Option("--tilts", metavar="FILE", help="Table with scan, pitch_deg, yaw_deg and, if known, roll_deg."),
    ] = None,
    tilt_sigma: Annotated[
        float, typer.Option("--tilt-sigma", min=0.0, metavar="DEG", help="One-sigma of each tilt by itself.")
    ] = 0.1,
    common_tilt_sigma: Annotated[
        float,
        typer.Option("--common-tilt-sigma", min=0.0, metavar="DEG", help="One-sigma of what all tilts err alike."),
    ] = 0.0,
    input_format: reading.InputFormat = None,
    unit: reading.Unit = None,
    bearing_zero: reading.BearingZero = None,
    bearing_sense: reading.BearingSense = None,
    intrinsics: reading.Intrinsics = None,
    depth_unit: reading.DepthUnit = None,
    axes: reading.Axes = None,
    sensor: reading.Sensor = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find range scale, boresight and noise law from scans of a reference ring or pipe of known diameter.

    Boresight shows at known tilts only: take scans at about 20 degrees of either sign about both axes.
    """
    from math import radians

    from ..calibration import calibrate_ring
    from ..io.calibration_file import write_calibration
    from ..io.tilts import read_tilts
    from ..io.units import length

    options = {
        "format": input_format,
        "unit": unit,
        "bearing_zero": bearing_zero,
        "bearing_sense": bearing_sense,
        "intrinsics": intrinsics,
        "depth_unit": depth_unit,
        "axes": axes,
        "sensor": sensor,
    }
    measured = [length(text, where="--diameter") for text in diameter]
    surveys = _read(scans, options, sum(measured) / len(measured))
    found = calibrate_ring(
        surveys,
        measured,
        diameter_sigma=None if sigma is None else length(sigma, where="--sigma"),
        tilts=None if tilts is None else read_tilts(tilts, surveys),
        tilt_sigma=radians(tilt_sigma),
        common_tilt_sigma=radians(common_tilt_sigma),
    )
    write_calibration(found, output, force=force)
    if as_json:
        print_json(_summary(found))
    else:
        _tell(found, output)


def _read(paths: list[Path], options: dict[str, Any], diameter: float) -> dict[str, Survey]:
    """Return the scans by file name; the reference's diameter tells the unit of bare ranges, as a nominal one does."""
    from ..config import Config
    from ..io.reading import read_one
    from ..stages.ring_video import ring_video
    from ..stages.rings import rings

    wanted = reading.read_options(nominal=f"{diameter:.9f}m", **options)
    surveys: dict[str, Survey] = {}
    for path in paths:
        if path.name in surveys:
            raise InputError("two scans have this name", where=path.name, mend="rename one of them")
        survey = ring_video(read_one(path, wanted, strict=False), Config())
        # A cloud is cut into rings about its own axis: it shows the scale, and no boresight.
        surveys[path.name] = survey if survey.has("rings") else rings(survey, Config())
    return surveys


def _summary(found: xr.Dataset) -> dict[str, Any]:
    from ..io.calibration_file import as_values

    return as_values(found)


def _tell(found: xr.Dataset, output: Path) -> None:
    import json
    import sys
    from math import degrees

    for sentence in json.loads(found.attrs["notes"]):
        sys.stderr.write(f"note: {sentence}\n")
    scale, sigma = float(found["range_scale"]), float(found["range_scale_sigma"])
    lines = [f"range scale      {scale:.6f} +- {sigma:.6f}  ({100 * (scale - 1):+.3f} %)"]
    why = json.loads(found.attrs["why_missing"])
    for name in ("boresight_pitch", "boresight_yaw", "boresight_roll"):
        text = name.replace("_", " ")
        if name in why:
            lines.append(f"{text:<16} not observable: {why[name]}")
        else:
            value, spread = degrees(float(found[name])), degrees(float(found[f"{name}_sigma"]))
            lines.append(f"{text:<16} {value:+.3f} +- {spread:.3f} deg")
    noise = f"{1e3 * float(found['noise_constant']):.3f} mm"
    if "noise_constant" in why:
        lines.append(f"noise            not known: {why['noise_constant']}")
    elif "noise_relative" in why:
        lines.append(f"noise            {noise}; its growth with range is not observable: {why['noise_relative']}")
    else:
        lines.append(f"noise            {noise} and {100 * float(found['noise_relative']):.3f} % of the range")
    typer.echo("\n".join([*lines, f"written          {output}"]))
