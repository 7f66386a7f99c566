"""`springline design`: the thickness of a liner, from numbers or along an inspected pipe."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError, ParameterError
from . import design_options as given
from .options import Force, Json
from .quantities import quantity
from .run import as_json as print_json

if TYPE_CHECKING:
    from ..design import LinerDesign
    from ..survey import Survey

app = typer.Typer(add_completion=False)


@app.command(
    epilog="Examples:  springline design --diameter 48in --ovality 2% --modulus 125000psi --strength 4500psi "
    "--pressure 5.2psi  |  springline design report -o lined --modulus 1700MPa --strength 31MPa --pressure 36kPa "
    "--sizes 4.5mm,6mm,7.5mm"
)
def design(
    source: Annotated[
        Path | None,
        typer.Argument(metavar="DIR", help="What `springline inspect` wrote, or its survey.zarr.zip."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT", help="Folder to write; needed with DIR.")
    ] = None,
    diameter: given.Diameter = None,
    diameter_sigma: given.DiameterSigma = None,
    ovality: given.Ovality = None,
    ovality_sigma: given.OvalitySigma = None,
    modulus: given.Modulus = None,
    strength: given.Strength = None,
    pressure: given.Pressure = None,
    short_modulus: given.ShortModulus = None,
    tensile_strength: given.Tensile = None,
    internal_pressure: given.Internal = None,
    hole: given.Hole = None,
    soil_modulus: given.SoilModulus = None,
    cover: given.Cover = None,
    water: given.Water = None,
    unit_weight: given.UnitWeight = None,
    live_load: given.LiveLoad = None,
    gap: given.Gap = None,
    condition: given.Condition = "partially",
    method: given.Method = "f1216",
    edition: given.Edition = "2007b",
    convention: given.Convention = "outer",
    constants: given.Constants = "inch-pound",
    mean: given.Mean = "polar",
    safety: given.Safety = 2.0,
    enhancement: given.Enhancement = 7.0,
    poisson: given.Poisson = 0.3,
    ratio_limit: given.RatioLimit = 100.0,
    step: given.Step = "1.5mm",
    sizes: given.Sizes = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Size a liner by ASTM F1216 appendix X1 or after Glock: from numbers, or along an inspected pipe.

    With DIR, the thickness is given at every station with its sigma, the station and the check that govern, and the
    next thickness up that is made; OUT is DIR with the design added to it.
    """
    wanted = given.liner_design(
        {
            "modulus": modulus,
            "strength": strength,
            "water_pressure": pressure,
            "short_modulus": short_modulus,
            "tensile_strength": tensile_strength,
            "internal_pressure": internal_pressure,
            "hole": hole,
            "soil_modulus": soil_modulus,
            "cover": cover,
            "water": water,
            "unit_weight": unit_weight,
            "live_load": live_load,
            "gap": gap,
        },
        ratio_limit=ratio_limit,
        condition=condition,
        method=method,
        edition=edition,
        convention=convention,
        constants=constants,
        safety=safety,
        enhancement=enhancement,
        poisson=poisson,
    )
    made = {
        "step": quantity(step, "length", where="--step"),
        "sizes": None if sizes is None else [quantity(s, "length", where="--sizes") for s in sizes.split(",")],
    }
    from ..design.stations import MEANS
    from ..geometry.checks import choice

    try:
        choice("mean", mean, MEANS)
        if source is None:
            pipe = _numbers(diameter, diameter_sigma, ovality, ovality_sigma)
            found = _from_numbers(wanted, pipe, made, output, force=force)
        else:
            typed = {"--diameter": diameter, "--ovality": ovality}
            found = _along(wanted, source, output, typed, {"mean": mean, **made}, force=force)
    except ParameterError as error:
        raise given.in_flags(error) from None
    if as_json:
        print_json(found)
    else:
        tell(found, output)


def tell(found: dict[str, Any], output: Path | None) -> None:
    """Print a design in a few lines, warnings first on stderr."""
    for sentence in found["warnings"]:
        sys.stderr.write(f"warning: {sentence}\n")
    head = f"{found['rule']}, edition {found['edition']}, {found['condition']} deteriorated"
    if found["name"]:
        head = f"{found['name']}: {head}, {found['mean']} mean, {found['stations']} stations"
    lines = [head]
    if found["governing_chainage_m"] is not None:
        lines.append(f"  governing station  {found['governing_chainage_m']:.2f} m")
    lines.append(f"  diameter           {_length(found['diameter_mm'])}, ovality {found['ovality_pct']:.2f} %")
    for check, thickness in found["checks_mm"].items():
        governs = "   governs" if check == found["governing_check"] else ""
        lines.append(f"  {check:<18} {_length(thickness)}{governs}")
    sigma = "" if not found["sigma_mm"] else f" +- {found['sigma_mm']:.2f} mm"
    lines.append(f"  required           {_length(found['required_mm'])}{sigma}, DR {found['dimension_ratio']:.1f}")
    lines.append(f"  next made          {_length(found['standard_mm'])}")
    if found["standard_upper_mm"] != found["standard_mm"]:
        lines.append(f"  next made, 95 %    {_length(found['standard_upper_mm'])}, from the scan's uncertainty")
    typer.echo("\n".join(lines))
    if output is not None:
        typer.echo(f"  written            {output}")


def _length(millimetres: float | None) -> str:
    if millimetres is None:
        return "none is thick enough"
    return f"{millimetres:.2f} mm ({millimetres / 25.4:.3f} in)"


def _numbers(
    diameter: str | None, diameter_sigma: str | None, ovality: str | None, ovality_sigma: str | None
) -> dict[str, float]:
    for flag, text, example in (("--diameter", diameter, "48in"), ("--ovality", ovality, "2%")):
        if text is None:
            raise InputError("not given", where=flag, mend=f"add {flag} {example}, or name what inspect wrote")

    def sigma(text: str | None, kind: str, where: str) -> float:
        return 0.0 if text is None else quantity(text, kind, where=where, zero=True)

    return {
        "diameter": quantity(diameter, "length", where="--diameter"),
        "ovality": quantity(ovality, "percentage", where="--ovality", zero=True),
        "diameter_sigma": sigma(diameter_sigma, "length", "--diameter-sigma"),
        "ovality_sigma": sigma(ovality_sigma, "percentage", "--ovality-sigma"),
    }


def _from_numbers(
    wanted: LinerDesign, pipe: dict[str, float], made: dict[str, Any], output: Path | None, *, force: bool
) -> dict[str, Any]:
    import numpy as np

    from ..design import design_liner, next_standard
    from ..design.along import Z_ONE_SIDED
    from ..outputs.design import numbers_summary

    result = design_liner(wanted, **pipe)
    upper = float(result.thickness + Z_ONE_SIDED * result.sigma)
    standards = next_standard(np.array([result.thickness, upper]), **made)
    if np.isnan(result.thickness):
        raise InputError("no thickness carries these loads", expected="a thickness up to a fifth of the diameter")
    found = numbers_summary(wanted, result, pipe["diameter"], pipe["ovality"], upper=upper, standards=standards)
    if output is not None:
        _write(found, output, force=force)
    return found


def _write(found: dict[str, Any], output: Path, *, force: bool) -> None:
    from ..survey.files import OwnFolder, replacing

    with replacing(output, force=force, own=OwnFolder.of("a design", "design.json", alone=True)) as temporary:
        temporary.mkdir()
        (temporary / "design.json").write_text(_as_text(found), encoding="utf-8")


def _as_text(found: dict[str, Any]) -> str:
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def _along(
    wanted: LinerDesign,
    source: Path,
    output: Path | None,
    typed: dict[str, str | None],
    choices: dict[str, Any],
    *,
    force: bool,
) -> dict[str, Any]:
    """Design along an inspected pipe and write its folder with the design in it; return the summary."""
    from ..config import dump_config, make_config
    from ..design import design_survey
    from ..outputs import tables
    from ..outputs.design import design_summary, design_table
    from ..outputs.write import INSPECTION, write_outputs

    for flag, text in typed.items():
        if text is not None:
            raise InputError("given twice", where=flag, expected="a diameter and an ovality from the scan or from you")
    if output is None:
        raise InputError("no output was named", mend="add -o OUT")
    INSPECTION.check(output, force=force)
    survey = design_survey(_inspected(source), wanted, **choices)
    found = design_summary(survey)
    table, decimals = design_table(survey)
    run = json.loads(survey.attrs.get("provenance", "{}"))
    write_outputs(
        survey,
        output,
        config_toml=dump_config(make_config(run.get("config", {}), where=f"{source}, provenance")),
        force=force,
        more={
            "design.json": lambda path: path.write_text(_as_text(found), encoding="utf-8"),
            "design.csv": lambda path: tables.write_csv(table, path, decimals),
        },
    )
    return found


def _inspected(source: Path) -> Survey:
    """Return the survey that an inspection wrote, from its folder or by itself."""
    from ..survey import open_survey

    path = source / "survey.zarr.zip" if (source / "survey.zarr.zip").exists() else source
    if not path.exists():
        raise InputError("no such file or folder", where=source, expected="what springline inspect wrote")
    survey = open_survey(path)
    for group in ("rings", "section", "metrics"):
        if not survey.has(group):
            raise InputError(
                f"it has no /{group}: it was not inspected",
                where=path,
                mend=f"run: springline inspect {source} -o DIR, and then springline design DIR",
            )
    return survey
