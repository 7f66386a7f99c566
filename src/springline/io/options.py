"""What a user may say about a file that the file does not say itself."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

from ..conventions import BEARING_SENSES, BEARING_ZEROS, SENSOR_KINDS
from ..errors import InputError, ParameterError, nearest
from .axes import parse_axes
from .units import METRES

if TYPE_CHECKING:
    from collections.abc import Iterable

DIAMETER_LIMITS = (0.01, 30.0)
"""Nominal diameters [m] that a pipe may have."""


@dataclass(frozen=True)
class ReadOptions:
    """Statements about an input; None = not stated, so the file's own word or a stated default holds.

    Args:
        nominal_diameter: Nominal diameter [m].
        format: Key of a format of `io.registry`, instead of the guess by content.
        unit: Unit of the coordinates of a cloud or of the ranges of a ring table: mm, cm, m, in or ft.
        bearing_zero: Where the device's zero lies: right, crown, left or invert.
        bearing_sense: ccw or cw, seen looking forward.
        intrinsics: Pinhole fx, fy, cx, cy [pixel] of a depth image.
        depth_unit: Unit of one count of a depth image.
        axes: Which file axes make x forward, y up, z right, such as "-z,y,x".
        sensor: One of `conventions.SENSOR_KINDS`.
        name: Asset name; the file's stem when not given.

    Raises:
        ParameterError: A value lies outside its range or choices.

    >>> ReadOptions(bearing_zero="top")
    Traceback (most recent call last):
    springline.errors.ParameterError: bearing_zero: 'top' is unknown; expected right, crown, left or invert
    """

    nominal_diameter: float | None = None
    format: str | None = None
    unit: str | None = None
    bearing_zero: str | None = None
    bearing_sense: str | None = None
    intrinsics: tuple[float, float, float, float] | None = None
    depth_unit: str | None = None
    axes: str | None = None
    sensor: str | None = None
    name: str | None = None

    def __post_init__(self) -> None:
        _choice("unit", self.unit, METRES)
        _choice("depth_unit", self.depth_unit, METRES)
        _choice("bearing_zero", self.bearing_zero, BEARING_ZEROS)
        _choice("bearing_sense", self.bearing_sense, BEARING_SENSES)
        _choice("sensor", self.sensor, SENSOR_KINDS)
        low, high = DIAMETER_LIMITS
        if self.nominal_diameter is not None:
            object.__setattr__(self, "nominal_diameter", _number("nominal_diameter", self.nominal_diameter))
        if self.nominal_diameter is not None and not low <= self.nominal_diameter <= high:
            raise ParameterError(
                f"{self.nominal_diameter:g} m is not the diameter of a pipe",
                where="nominal_diameter",
                expected=f"metres, from {low:g} to {high:g}",
                mend="check its unit: 300 mm is 0.3",
            )
        if self.name is not None and not self.name.isprintable():
            raise ParameterError(
                f"{self.name!r} cannot stand in a report", where="name", expected="a name of printable characters"
            )
        if self.axes is not None:
            parse_axes(self.axes)
        if self.intrinsics is not None:
            object.__setattr__(self, "intrinsics", _intrinsics(self.intrinsics))

    def stated(self) -> tuple[str, ...]:
        """Names of the options that are stated."""
        return tuple(f.name for f in fields(self) if getattr(self, f.name) is not None)

    def values(self) -> dict[str, Any]:
        """Return the options that are stated, by name."""
        return {name: getattr(self, name) for name in self.stated()}

    def only(self, names: Iterable[str]) -> ReadOptions:
        """Return these options with all but the named ones left unstated."""
        return replace(self, **{f.name: None for f in fields(self) if f.name not in names})


def parse_intrinsics(text: str) -> tuple[float, float, float, float]:
    """Return fx, fy, cx, cy [pixel] from text such as '421.139,421.139,426.176,237.017'.

    Raises:
        InputError: Not four numbers.
    """
    try:
        fx, fy, cx, cy = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f"'{text}' is not four numbers", where="intrinsics", expected="fx,fy,cx,cy in pixels"
        ) from None
    return fx, fy, cx, cy


def _choice(name: str, value: str | None, known: Iterable[str]) -> None:
    if value is not None and value not in known:
        *first, last = known
        raise ParameterError(
            f"'{value}' is unknown{nearest(value, known)}", where=name, expected=f"{', '.join(first)} or {last}"
        )


def _number(name: str, value: object) -> float:
    """Return a number of any type as a plain float, as it is kept in the survey's provenance."""
    try:
        if isinstance(value, (str, bytes, bool)):
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise ParameterError(f"{value!r} is not a number", where=name, expected="a number, such as 0.4") from None


def _intrinsics(given: Iterable[float]) -> tuple[float, float, float, float]:
    values = parse_intrinsics(given) if isinstance(given, str) else tuple(_number("intrinsics", v) for v in given)
    if len(values) != 4 or not all(abs(v) < 1e6 for v in values) or min(values[:2]) <= 0:
        raise ParameterError(
            f"{values} are no pinhole intrinsics",
            where="intrinsics",
            expected="fx,fy,cx,cy in pixels with positive focal lengths",
        )
    return values
