"""Units as people write them: lengths with their unit become metres."""

from __future__ import annotations

import re

from ..errors import InputError

_LENGTH = re.compile(r"^\s*([0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)\s*(mm|cm|m|in|ft)\s*$")
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}
"""Metres in each unit of length that is understood."""


def length(text: str, *, where: str) -> float:
    """Return metres from a length with its unit, such as '400mm', '0.4 m' or '16in'.

    >>> length("400mm", where="--nominal")
    0.4

    Raises:
        InputError: No number, no unit, not positive, or a unit that is not understood.
    """
    found = _LENGTH.match(text)
    if not found or float(found[1]) <= 0:
        raise InputError(
            f"'{text}' is not a length", where=where, expected="a positive number with its unit, such as 400mm"
        )
    return round(float(found[1]) * METRES[found[2]], 12)
