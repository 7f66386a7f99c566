"""Lengths, angles and shares as a scenario may write them, and the base of its tables."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from .profiles import Profile, as_profile

_UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}
_LENGTH = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(mm|cm|m|in|ft)\s*")


def as_metres(value: object) -> object:
    """Return metres for a text such as "300mm"; anything else as it is, but a truth value is no length.

    >>> as_metres("300 mm"), as_metres(0.3)
    (0.3, 0.3)
    """
    if isinstance(value, bool):
        raise ValueError("a number or a text such as '300mm'")
    if isinstance(value, str) and (found := _LENGTH.fullmatch(value)):
        return round(float(found[1]) * _UNITS[found[2]], 12)
    return value


def as_varying_metres(value: object) -> object:
    """Return a profile of lengths with every text such as "5mm" turned into metres."""
    if isinstance(value, list | tuple):
        return {"points": [[as_metres(x) for x in pair] if isinstance(pair, list | tuple) else pair for pair in value]}
    if isinstance(value, dict):
        waves = value.get("waves")
        inner = {"waves": [as_varying_metres(wave) for wave in waves]} if isinstance(waves, list | tuple) else {}
        return {k: as_metres(v) if k in ("mean", "amplitude") else v for k, v in value.items()} | inner
    return as_metres(value)


_finite = Field(allow_inf_nan=False)
Number = Annotated[float, _finite]
Length = Annotated[float, _finite, BeforeValidator(as_metres)]
PositiveLength = Annotated[float, Field(gt=0.0, allow_inf_nan=False), BeforeValidator(as_metres)]
NonNegativeLength = Annotated[float, Field(ge=0.0, allow_inf_nan=False), BeforeValidator(as_metres)]
NonNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Varying = Annotated[Profile, BeforeValidator(as_profile)]
VaryingLength = Annotated[Profile, BeforeValidator(as_varying_metres)]
Clock = Annotated[float, Field(gt=0.0, le=12.0)]
Slant = Annotated[float, Field(ge=-60.0, le=60.0)]
Small = Annotated[float, Field(ge=-30.0, le=30.0)]
Triple = tuple[Number, Number, Number]


class Part(BaseModel):
    """Base of every table of a scenario: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)
