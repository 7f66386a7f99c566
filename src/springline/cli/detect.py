"""`springline detect`: joints in frames, without a survey."""

from __future__ import annotations

import csv
import math
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError, OutputError
from .options import Force, Json
from .run import as_json as print_json

if TYPE_CHECKING:
    from ..imaging.detections import Detection

app = typer.Typer(add_completion=False)

_TABLE = "detections.csv"
_COLUMNS = ("image", "kind", "cx_px", "cy_px", "semi_major_px", "semi_minor_px", "angle_deg", "confidence")


@app.command(
    epilog="Examples:  springline detect frames/ -o found  |  springline detect 'run1/*.jpg' extra.png -o found"
)
def detect(
    frames: Annotated[
        list[Path], typer.Argument(metavar="FRAMES...", help="Images, folders of images, or quoted patterns.")
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write.")],
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find joints in CCTV frames, from the images alone.

    Laterals need lens and pose to be told from stains: `springline inspect` looks for them in a survey with frames.

    Writes DIR/detections.csv, one row per object, and DIR/<frame>.png, each frame with what was found drawn on it;
    whole or not at all. Pixels count from the centre of the top left one, rows downwards; the angle of the major axis
    is counter-clockwise on the screen. Images that cannot be read are named, skipped and counted.
    """
    from ..imaging.frames import find_frames
    from ..survey.files import replacing

    paths = find_frames(frames)
    _check_replaceable(output, force)
    rows: list[tuple[str, Detection]] = []
    warnings: list[str] = []
    with replacing(output, force=force) as temporary:
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
    _tell(output, read, rows, warnings, as_json)


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


def _check_replaceable(output: Path, force: bool) -> None:
    """Refuse to throw away a folder that is not ours."""
    if not force or not output.exists():
        return
    if not output.is_dir():
        raise OutputError("it is a file, not a folder", where=output, mend="choose another folder")
    if any(output.iterdir()) and not (output / _TABLE).exists():
        raise OutputError(
            f"it holds other files and no {_TABLE}, and --force would remove them",
            where=output,
            mend="choose another folder",
        )


def _tell(output: Path, read: int, rows: list[tuple[str, Detection]], warnings: list[str], as_json: bool) -> None:
    kinds = Counter(one.kind for _, one in rows)
    if as_json:
        found = {"frames": read, "skipped": len(warnings), "joints": kinds["joint"], "laterals": kinds["lateral"]}
        print_json(found | {"warnings": warnings, "output": str(output)})
        return
    for sentence in warnings:
        sys.stderr.write(f"warning: skipped: {sentence}\n")
    skipped = f", {len(warnings)} skipped" if warnings else ""
    typer.echo(f"{read} frames{skipped}: {kinds['joint']} joints, {kinds['lateral']} laterals")
    typer.echo(f"  table            {output / _TABLE}")
