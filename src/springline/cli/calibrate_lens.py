"""`springline calibrate lens`: a lens from a checkerboard, from pairs of angle and radius, or from the pipe itself."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError
from .options import Force, Json
from .run import as_json as print_json

if TYPE_CHECKING:
    from ..geometry.lenses import BoardFit, LensFit

EXAMPLES = (
    "Examples:  springline calibrate lens board/*.png --board 9x6 --square 25mm -o lens.toml  |  "
    "springline calibrate lens pairs.csv --size 1920x1080 -o lens.toml  |  "
    "springline calibrate lens joints.csv --diameter 300mm --size 640x480 -o lens.toml"
)


def lens(
    inputs: Annotated[
        list[Path],
        typer.Argument(
            metavar="INPUT...",
            help="Pictures of a checkerboard; or one CSV with zenith_deg, radius_px; or one with joint, distance_m, "
            "radius_px.",
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help=".toml, .zarr or .zarr.zip to write.")],
    board: Annotated[
        str | None, typer.Option("--board", metavar="9x6", help="Inner corners in a row and in a column.")
    ] = None,
    square: Annotated[str | None, typer.Option("--square", metavar="LENGTH", help="Side of a square.")] = None,
    diameter: Annotated[
        str | None,
        typer.Option("--diameter", metavar="LENGTH", help="Inside diameter, with sights of joints."),
    ] = None,
    size: Annotated[
        str | None, typer.Option("--size", metavar="1920x1080", help="Width and height of a picture, with tables.")
    ] = None,
    name: Annotated[str, typer.Option("--name", help="Name of the lens, as frames.csv has it.")] = "camera",
    model: Annotated[
        list[str] | None, typer.Option("--model", help="Consider this model only; repeat it for several.")
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find a camera's lens model, its scale and its principal point; a lens that is not determined is refused.

    The file holds a table [lens.NAME], as survey.toml has it, with sigmas; give it to inspect with --calibration.
    """
    import json

    import xarray as xr

    from ..geometry.lenses import LENS_MODELS
    from ..io.calibration_file import write_calibration

    models = tuple(model) if model else LENS_MODELS
    if board is not None and diameter is not None:
        raise InputError("--board and --diameter do not go together", mend="give one of them")
    if board is not None:
        table, told = _by_board(inputs, board, square, models)
    else:
        table, told = _by_table(inputs, diameter, size, models)
    table["source"] = "checkerboard" if board else "joints" if diameter else "pairs"
    write_calibration(xr.Dataset(attrs={"lens": json.dumps({name: table})}), output, force=force)
    if as_json:
        print_json({"lens": {name: table}})
    else:
        typer.echo("\n".join([*told, f"written          {output}"]))


def _by_board(
    inputs: list[Path], board: str, square: str | None, models: tuple[str, ...]
) -> tuple[dict[str, Any], list[str]]:
    import sys

    from ..geometry.lenses import fit_boards
    from ..imaging.boards import board_points, find_boards
    from ..imaging.frames import find_frames
    from ..io.units import length

    columns, rows = _pair(board, "--board", "9x6")
    if square is None:
        raise InputError("the side of a square is missing", mend="give it with --square 25mm")
    points = board_points(columns, rows, length(square, where="--square"))
    corners, size, troubles = find_boards(find_frames(inputs), columns, rows)
    for sentence in troubles:
        sys.stderr.write(f"note: {sentence}\n")
    found = fit_boards(corners, points, size, models=models)
    if not found:
        raise InputError(f"no lens: {found.reason}", where=f"{len(corners)} pictures")
    return _board_table(found, size), _board_told(found)


def _by_table(
    inputs: list[Path], diameter: str | None, size: str | None, models: tuple[str, ...]
) -> tuple[dict[str, Any], list[str]]:
    from math import radians

    from ..geometry.lenses import MODELS, fit_joints, fit_lens
    from ..io.lens_tables import PAIRS, SIGHTS, read_lens_table
    from ..io.units import length

    if len(inputs) != 1:
        raise InputError(
            f"{len(inputs)} inputs were given", expected="one table, or pictures with --board",
            mend="for pictures of a checkerboard add --board 9x6 --square 25mm",
        )  # fmt: skip
    if size is None:
        raise InputError("the pictures' size is missing", mend="give it with --size 1920x1080")
    width, height = _pair(size, "--size", "1920x1080")
    if diameter is None:
        table = read_lens_table(inputs[0], PAIRS)
        found = fit_lens(table["zenith_deg"] * radians(1.0), table["radius_px"], models=models)
    else:
        table = read_lens_table(inputs[0], SIGHTS)
        five = tuple(one for one in models if one in MODELS)
        across = length(diameter, where="--diameter")
        found = fit_joints(table["joint"], table["distance_m"], table["radius_px"], across / 2.0, models=five)
    if not found:
        raise InputError(f"no lens: {found.reason}", where=inputs[0])
    return _table(found, (width, height)), _told(found)


def _pair(text: str, where: str, example: str) -> tuple[int, int]:
    first, mark, second = text.lower().partition("x")
    if not (mark and first.strip().isdigit() and second.strip().isdigit()) or int(first) < 1 or int(second) < 1:
        raise InputError(f"'{text}' cannot be used", where=where, expected=f"two whole numbers, such as {example}")
    return int(first), int(second)


def _board_table(found: BoardFit, size: tuple[int, int]) -> dict[str, Any]:
    from math import degrees

    assert found.lens is not None
    table: dict[str, Any] = {
        "model": found.lens.model, "k_px": found.lens.k, "centre_px": list(found.centre),
        "width_px": size[0], "height_px": size[1], "view_angle_deg": degrees(2.0 * found.zenith),
        "sigma": {"k_px": found.sigma[0], "centre_px": found.sigma[1:3].tolist()},
    }  # fmt: skip
    if found.lens.coefficients:
        table["coefficients"] = list(found.lens.coefficients)
    return _plain(table)


def _table(found: LensFit, size: tuple[int, int]) -> dict[str, Any]:
    from math import degrees

    assert found.best is not None
    chosen = found.best.lens
    table: dict[str, Any] = {
        "model": chosen.model, "k_px": chosen.k, "width_px": size[0], "height_px": size[1],
        "sigma": {"k_px": found.best.sigma[0]},
    }  # fmt: skip
    if chosen.coefficients:
        table["coefficients"] = list(chosen.coefficients)
    if chosen.view_angle is not None:
        table["view_angle_deg"] = degrees(chosen.view_angle)
    return _plain(table)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_plain(one) for one in value]
    return value if isinstance(value, str | int) else float(value)


def _board_told(found: BoardFit) -> list[str]:
    from math import degrees

    assert found.lens is not None
    (column, row), (_, column_sigma, row_sigma, *_) = found.centre, found.sigma
    seen = f"{found.used} pictures, to {degrees(found.zenith):.0f} deg"
    return [
        f"model            {found.lens.model}  ({_others(found.probabilities)})",
        f"k                {found.lens.k:.3f} +- {found.sigma[0]:.3f} px",
        f"principal point  {column:.2f}, {row:.2f} +- {column_sigma:.2f}, {row_sigma:.2f} px",
        f"residual         {found.residual_rms:.3f} px rms in {seen}",
    ]


def _told(found: LensFit) -> list[str]:
    assert found.best is not None
    chances = {one.lens.model: one.probability for one in found.candidates}
    return [
        f"model            {found.best.lens.model}  ({_others(chances)})",
        f"k                {found.best.lens.k:.3f} +- {found.best.sigma[0]:.3f} px",
        f"residual         {found.best.residual_rms:.3f} px rms in {found.n_used} readings",
    ]


def _others(chances: dict[str, float]) -> str:
    first, *rest = sorted(chances.items(), key=lambda one: -one[1])
    second = f", next {rest[0][0]} {rest[0][1]:.2g}" if rest else ""
    return f"probability {first[1]:.3f}{second}"
