"""Column names as people write them: a quantity, perhaps an index, perhaps a unit."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

from ..errors import InputError, nearest
from .units import METRES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

_LENGTHS = {
    **METRES, "inch": 0.0254, "inches": 0.0254, "feet": 0.3048, "foot": 0.3048, "metre": 1.0, "metres": 1.0,
    "meter": 1.0, "meters": 1.0, "millimetre": 1e-3, "millimetres": 1e-3, "millimeters": 1e-3,
}  # fmt: skip
_ANGLES = {"deg": pi / 180, "degree": pi / 180, "degrees": pi / 180, "rad": 1.0, "gon": pi / 200, "h": pi / 6}
_TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
_RATES = {"rad_s": 1.0, "deg_s": pi / 180}
_ACCELERATIONS = {"m_s2": 1.0, "g": 9.80665}

UNITS = {
    "distance": _LENGTHS,
    "range": _LENGTHS,
    "time": _TIMES,
    "bearing": _ANGLES,
    "easting": _LENGTHS,
    "northing": _LENGTHS,
    "elevation": _LENGTHS,
    "sigma": _LENGTHS,
    "gyro": _RATES,
    "accel": _ACCELERATIONS,
    "heading": _ANGLES,
    "inclination": _ANGLES,
    "bank": _ANGLES,
    "x": _LENGTHS,
    "y": _LENGTHS,
    "z": _LENGTHS,
}
"""Units of each quantity, each with its factor to SI and radians."""

_WORDS = {
    "r": "range", "range": "range", "radius": "range", "radii": "range", "distance": "distance",
    "dist": "distance", "chainage": "distance", "station": "distance", "position": "distance", "time": "time",
    "timestamp": "time", "bearing": "bearing", "angle": "bearing", "theta": "bearing", "azimuth": "bearing",
    "clock": "bearing",
}  # fmt: skip
_INDEXED = re.compile(r"^(?P<word>.*?)_?(?P<index>\d+)(?:_(?P<unit>[a-z]+))?$")


@dataclass(frozen=True)
class Column:
    """What a column's name says: the quantity, its index among like ones, and its unit's name if it has one."""

    name: str
    quantity: str
    index: int | None = None
    unit: str | None = None
    word: str = ""


def parse_column(name: str) -> Column:
    """Return what a column's name says; the quantity is the plain name when it is not known.

    >>> parse_column("R_7 [mm]")
    Column(name='R_7 [mm]', quantity='range', index=7, unit='mm', word='r')
    >>> parse_column("Distance (ft)").unit, parse_column("gyro_x_rad_s").quantity
    ('ft', 'gyro_x')
    """
    plain = unit_name(name)
    indexed = _INDEXED.match(plain)
    if indexed and _WORDS.get(indexed["word"]) == "range" and (indexed["unit"] or "mm") in _LENGTHS:
        return Column(name, "range", int(indexed["index"]), indexed["unit"], indexed["word"])
    for cut in range(len(plain), 0, -1):
        stem, rest = plain[:cut], plain[cut:]
        if rest and not rest.startswith("_"):
            continue
        quantity = _WORDS.get(stem, stem)
        units = UNITS.get(base_quantity(quantity))
        if units is not None and (not rest or rest[1:] in units):
            return Column(name, quantity, None, rest[1:] or None, stem)
    return Column(name, plain, None, None, plain)


def base_quantity(quantity: str) -> str:
    """Return the quantity that a component belongs to.

    >>> base_quantity("gyro_x"), base_quantity("x")
    ('gyro', 'x')
    """
    return quantity[:-2] if quantity[-2:] in ("_x", "_y", "_z") else quantity


def unit_name(text: str) -> str:
    """Return a unit as column names spell it.

    >>> unit_name("deg/s"), unit_name("m/s²")
    ('deg_s', 'm_s2')
    """
    return re.sub(r"[^a-z0-9]+", "_", text.strip().lower().replace("²", "2")).strip("_")


def factor(column: Column, unit: str | None = None) -> float:
    """Return the factor to SI of a column, whose own unit wins over `unit`; KeyError when there is neither."""
    return UNITS[base_quantity(column.quantity)][column.unit or unit]


def find(columns: Sequence[Column], quantity: str, path: Path, *, required: bool = True) -> int | None:
    """Return the position of the one column of a quantity.

    Raises:
        InputError: There is none although it is required, or there are two.
    """
    found = [i for i, c in enumerate(columns) if c.quantity == quantity and c.index is None]
    if len(found) > 1:
        raise InputError(
            f"the columns '{columns[found[0]].name}' and '{columns[found[1]].name}' both hold the {quantity}",
            where=path,
            mend="keep one of them",
        )
    if not found and required:
        raise InputError(
            f"there is no column for the {quantity}{nearest(quantity, [c.name for c in columns])}",
            where=path,
            expected=f"a column such as {quantity}_{next(iter(UNITS.get(quantity, {'m': 1})))}",
        )
    return found[0] if found else None
