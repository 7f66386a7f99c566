"""Units as people write them: lengths with their unit become metres."""

from __future__ import annotations

import re

from ..errors import InputError

_LENGTH = re.compile(r"^\s*([-+]?\s*[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)\s*(mm|cm|m|in|ft)\s*$")
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}
"""Metres in each unit of length that is understood."""


def length(text: str, *, where: str, signed: bool = False) -> float:
    """Return metres from a length with its unit, such as '400mm', '0.4 m' or '16in'.

    Args:
        text: The length.
        where: Where it stands, for the message.
        signed: Whether it may be zero or negative, as a place is.

    >>> length("400mm", where="--nominal")
    0.4
    >>> length("-0.35 m", where="sensor.offset_x", signed=True)
    -0.35

    Raises:
        InputError: No number, no unit, not positive, or a unit that is not understood.
    """
    found = _LENGTH.match(text)
    number = float(found[1].replace(" ", "")) if found else 0.0
    if not found or not (signed or number > 0):
        kind = "number" if signed else "positive number"
        raise InputError(f"'{text}' is not a length", where=where, expected=f"a {kind} with its unit, such as 400mm")
    return round(number * METRES[found[2]], 12) + 0.0
