"""Numbers with their unit as people type them: pressures, lengths, unit weights and percentages become SI."""

from __future__ import annotations

import re
from math import isfinite

from ..errors import InputError
from ..io.units import METRES

_PSI = 6894.757293168361
_WATER = 9806.65

PASCALS = {
    "Pa": 1.0,
    "kPa": 1e3,
    "MPa": 1e6,
    "GPa": 1e9,
    "mbar": 1e2,
    "bar": 1e5,
    "psf": _PSI / 144,
    "psi": _PSI,
    "ksi": 1e3 * _PSI,
    "mH2O": _WATER,
    "ftH2O": 0.3048 * _WATER,
}
"""Pascals in each unit of pressure; heads are of water at 1000 kg/m3 and standard gravity."""

NEWTONS_PER_CUBIC_METRE = {"N/m3": 1.0, "kN/m3": 1e3, "pcf": 157.08746384, "lbf/ft3": 157.08746384}

_KINDS = {
    "length": (METRES, "48in"),
    "pressure": (PASCALS, "5.2psi"),
    "unit weight": (NEWTONS_PER_CUBIC_METRE, "120pcf"),
    "percentage": ({"%": 0.01}, "2%"),
}
_NUMBER = re.compile(r"^\s*([-+]?[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)\s*(\S*)\s*$")


def quantity(text: str, kind: str, *, where: str, zero: bool = False) -> float:
    """Return a quantity in SI.

    Args:
        text: A number with its unit.
        kind: "length", "pressure", "unit weight" or "percentage".
        where: The option, for the message.
        zero: Whether it may be zero.

    Raises:
        InputError: No number, no unit or a foreign one, or a number out of range; the message lists the units.

    >>> round(quantity("5.2psi", "pressure", where="--pressure"), 1), quantity("2%", "percentage", where="--ovality")
    (35852.7, 0.02)
    """
    units, example = _KINDS[kind]
    found = _NUMBER.match(text)
    low = "a number from 0" if zero else "a positive number"
    if not found or found[2] not in units or not isfinite(float(found[1])):
        raise InputError(
            f"'{text}' is not a {kind}",
            where=where,
            expected=f"{low} with its unit, such as {example}; units are {', '.join(units)}",
        )
    value = float(found[1])
    if value < 0.0 or (value == 0.0 and not zero):
        raise InputError(f"'{text}' is out of range", where=where, expected=f"{low} with its unit, such as {example}")
    return value * units[found[2]]
