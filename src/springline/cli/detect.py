"""`springline detect`: joints in frames, and joints and laterals of a filmed pipe, without a scan."""

from __future__ import annotations

import csv
import math
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from .options import Force, Json
from .run import as_json as print_json

if TYPE_CHECKING:
    from ..imaging.detections import Detection
    from ..survey import Survey

app = typer.Typer(add_completion=False)

_TABLE, _PLACED = "detections.csv", "features.csv"
_COLUMNS = ("image", "kind", "cx_px", "cy_px", "semi_major_px", "semi_minor_px", "angle_deg", "confidence")


@app.command(
    epilog="Examples:  springline detect frames/ -o found  |  springline detect 'run1/*.jpg' extra.png -o found  |  "
    "springline detect survey-folder/ --nominal 300mm -o found"
)
def detect(
    frames: Annotated[
        list[Path],
        typer.Argument(
            metavar="FRAMES...", help="Images, folders of images, or quoted patterns; or one survey folder with frames."
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write.")],
    nominal: Annotated[
        str | None, typer.Option("--nominal", metavar="LENGTH", help="The pipe's diameter, as 300mm, for a survey.")
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find joints in CCTV frames, from the images alone.

    Laterals need lens and pose to be told from stains. Of a survey folder whose frames have a lens and distances,
    joints and laterals are placed on the pipe and written to DIR/features.csv, no scan needed; where there is one,
    `springline inspect` uses both.

    Writes DIR/detections.csv, one row per object, and DIR/<frame>.png, each frame with what was found drawn on it;
    whole or not at all. Pixels count from the centre of the top left one, rows downwards; the angle of the major axis
    is counter-clockwise on the screen. Images that cannot be read are named, skipped and counted.
    """
    from ..imaging.frames import find_frames
    from ..survey.files import OwnFolder, replacing

    survey = _survey(frames, nominal)
    paths = find_frames(frames) if survey is None else _frames_of(survey)
    own = OwnFolder.of("a detection", _TABLE)
    own.check(output, force=force)
    placed, why = (None, "") if survey is None else _placed(survey)
    rows: list[tuple[str, Detection]] = []
    warnings: list[str] = []
    with replacing(output, force=force, own=own) as temporary:
        temporary.mkdir()
        read = _detect_into(temporary, paths, rows, warnings)
        if not read:
            raise InputError(
                f"none of the {len(paths)} images could be read; the first: {warnings[0]}",
                mend="give images that open in a viewer",
            )
        with (temporary / _TABLE).open("w", newline="", encoding="utf-8") as table:
            writer = csv.writer(table, lineterminator="\n")
            writer.writerow(_COLUMNS)
            writer.writerows(_row(name, one) for name, one in rows)
        if placed is not None:
            from ..outputs import tables

            tables.write_csv(tables.features_table(placed), temporary / _PLACED, tables.FEATURE_DECIMALS)
    _tell(output, read, rows, warnings, as_json, placed, why)


def _survey(frames: list[Path], nominal: str | None) -> Survey | None:
    """Read the survey folder that was given; None where images were."""
    from .reading import read_options

    if len(frames) == 1 and (frames[0] / "survey.toml").is_file():
        from ..io.reading import read_one

        return read_one(frames[0], read_options(nominal=nominal), strict=False)
    if nominal is not None:
        raise InputError("only a survey folder is placed on the pipe", where="--nominal", expected="one with frames")
    return None


def _frames_of(survey: Survey) -> list[Path]:
    if not survey.has("frames"):
        raise InputError(
            "the survey has no frames", where=survey.attrs.get("name", "survey"), expected="frames.csv",
            mend="name it under [parts] in survey.toml",
        )  # fmt: skip
    folder = Path(survey.frames.attrs.get("folder", "."))
    return [folder / path for path in survey.frames["path"].values.astype(str)]


def _placed(survey: Survey) -> tuple[Survey | None, str]:
    """Return the survey with its frames' features, or why it cannot be had."""
    from ..config import Config
    from ..stages.images.alone import images_alone

    try:
        return images_alone(survey, Config()), ""
    except InputError as missing:
        return None, f"joints and laterals are not placed on the pipe: {missing}"


def _detect_into(folder: Path, paths: list[Path], rows: list[tuple[str, Detection]], warnings: list[str]) -> int:
    """Detect in every frame that can be read and draw it; return how many could."""
    from rich.console import Console
    from rich.progress import track

    from ..imaging.detections import detect_frame
    from ..imaging.drawing import draw_detections
    from ..imaging.frames import read_frame, write_picture

    names = Counter(path.name for path in paths)
    drawn: Counter[str] = Counter()
    read = 0
    for path in track(paths, "detecting", console=Console(stderr=True), transient=True):
        try:
            image = read_frame(path)
        except InputError as error:
            warnings.append(str(error))
            continue
        read += 1
        found = detect_frame(image)
        # frames of several folders may share a name: then the folder tells them apart
        name = path.name if names[path.name] == 1 else path.as_posix()
        rows += [(name, one) for one in found]
        drawn[path.name] += 1
        picture = path.name if drawn[path.name] == 1 else f"{path.name}-{drawn[path.name]}"
        write_picture(folder / f"{picture}.png", draw_detections(image, found))
    return read


def _row(name: str, one: Detection) -> list[Any]:
    return [
        name,
        one.kind,
        f"{one.column:.2f}",
        f"{one.row:.2f}",
        f"{one.semi_major:.2f}",
        f"{one.semi_minor:.2f}",
        f"{math.degrees(one.angle):.2f}",
        f"{one.confidence:.3f}",
    ]


def _tell(
    output: Path,
    read: int,
    rows: list[tuple[str, Detection]],
    warnings: list[str],
    as_json: bool,
    placed: Survey | None,
    why: str,
) -> None:
    kinds = Counter(one.kind for _, one in rows)
    more = ([why] if why else []) + ([] if placed is None else placed.warnings)
    on_pipe = Counter() if placed is None else Counter(placed.features["kind"].values.astype(str).tolist())
    if as_json:
        found = {"frames": read, "skipped": len(warnings), "joints": kinds["joint"], "laterals": kinds["lateral"]}
        if placed is not None:
            found["placed"] = {"joints": on_pipe["joint"], "laterals": on_pipe["lateral"]}
            found["assumptions"] = placed.assumptions
        print_json(found | {"warnings": warnings + more, "output": str(output)})
        return
    for sentence in warnings:
        sys.stderr.write(f"warning: skipped: {sentence}\n")
    for sentence in more:
        sys.stderr.write(f"warning: {sentence}\n")
    for sentence in () if placed is None else placed.assumptions:
        sys.stderr.write(f"assumed: {sentence}\n")
    skipped = f", {len(warnings)} skipped" if warnings else ""
    typer.echo(f"{read} frames{skipped}: {kinds['joint']} joints, {kinds['lateral']} laterals")
    typer.echo(f"  table            {output / _TABLE}")
    if placed is not None:
        typer.echo(f"  on the pipe      {on_pipe['joint']} joints, {on_pipe['lateral']} laterals: {output / _PLACED}")
