"""Numbers as JSON has them."""

from __future__ import annotations

import math
from typing import Any


def plain_number(value: Any, factor: float = 1.0, decimals: int = 4) -> float | None:
    """Return a number times a factor, rounded; None for what is missing, because JSON has no NaN.

    >>> plain_number(0.15, 1e3), plain_number(float("nan")), plain_number(-1e-9)
    (150.0, None, 0.0)
    """
    if value is None or not math.isfinite(value):
        return None
    return round(float(value) * factor, decimals) + 0.0
