"""Options about the input that every command which reads a scan shares."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import InputError

if TYPE_CHECKING:
    from ..io import ReadOptions

_PANEL = "About the input"


def _option(flag: str, metavar: str, text: str) -> typer.models.OptionInfo:
    return typer.Option(flag, metavar=metavar, help=text, rich_help_panel=_PANEL)


Nominal = Annotated[
    str | None, _option("--nominal", "LENGTH", "Nominal diameter with its unit, such as 400mm or 16in.")
]
InputFormat = Annotated[
    str | None, _option("--format", "FORMAT", "Format of the input, instead of the guess; see: springline formats")
]
Unit = Annotated[
    str | None, _option("--unit", "mm|cm|m|in|ft", "Unit of coordinates or ranges where the file does not state it.")
]
BearingZero = Annotated[
    str | None,
    _option("--bearing-zero", "right|crown|left|invert", "Where the device's zero lies; many start at the crown."),
]
BearingSense = Annotated[
    str | None,
    _option("--bearing-sense", "ccw|cw", "Which way the device counts, looking forward; many run clockwise."),
]
Intrinsics = Annotated[
    str | None, _option("--intrinsics", "FX,FY,CX,CY", "Pinhole intrinsics of a depth image, in pixels.")
]
DepthUnit = Annotated[
    str | None, _option("--depth-unit", "mm|cm|m|in|ft", "Unit of one count of a depth image; mm when not given.")
]
Axes = Annotated[
    str | None,
    _option(
        "--axes", "X,Y,Z", "Which file axes make x forward, y up, z right, such as --axes=-z,y,x for a camera's cloud."
    ),
]
Sensor = Annotated[
    str | None,
    _option("--sensor", "KIND", "Kind of range sensor: ring-laser, depth-camera, lidar or unknown."),
]
Name = Annotated[str | None, _option("--name", "TEXT", "Asset name; the file's own or its stem when not given.")]
KeepGoing = Annotated[bool, typer.Option("--keep-going", help="Pass over inputs that cannot be read.")]


def read_options(
    *,
    nominal: str | None = None,
    format: str | None = None,  # noqa: A002 -- the word that the command line uses
    unit: str | None = None,
    bearing_zero: str | None = None,
    bearing_sense: str | None = None,
    intrinsics: str | None = None,
    depth_unit: str | None = None,
    axes: str | None = None,
    sensor: str | None = None,
    name: str | None = None,
) -> ReadOptions:
    """Return what the user stated as `io.ReadOptions`, lengths in metres and intrinsics as numbers.

    Raises:
        InputError: A value cannot be understood; the message names the option and what it may be.
    """
    from ..io.options import ReadOptions, parse_intrinsics
    from ..io.registry import by_key
    from ..io.units import length

    try:
        if format is not None:
            by_key(format)
        return ReadOptions(
            nominal_diameter=None if nominal is None else length(nominal, where="--nominal"),
            format=format,
            unit=unit,
            bearing_zero=bearing_zero,
            bearing_sense=bearing_sense,
            intrinsics=None if intrinsics is None else parse_intrinsics(intrinsics),
            depth_unit=depth_unit,
            axes=axes,
            sensor=sensor,
            name=name,
        )
    except InputError as error:
        # The library names its own parameter; people typed a flag.
        parameter = str(error.where).removeprefix("--").removesuffix("_diameter").replace("_", "-")
        raise InputError(error.what, where=f"--{parameter}", expected=error.expected, mend=error.mend) from None
