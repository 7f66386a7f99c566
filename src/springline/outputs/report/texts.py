"""Numbers as the report prints them."""

from __future__ import annotations

from math import floor, isfinite, log10

SIGMAS_95 = 1.959964
"""Half width of a two-sided 95 % interval in sigmas."""


def measured(value: float, half: float, *, least: int = 0, most: int = 4) -> tuple[str, str]:
    """Return value and half interval as texts, to two significant digits of the half interval.

    >>> measured(299.9383, 1.4698)
    ('299.9', '1.5')
    """
    decimals = least
    if isfinite(half) and half > 0:
        decimals = min(max(1 - floor(log10(half) + 1e-9), least), most)
    return number(value, decimals), number(half, decimals)


def number(value: float, decimals: int) -> str:
    """Return a number as text; a dash when it is not available, and no minus before nothing but zeros.

    >>> number(-0.04, 1), number(-0.06, 1)
    ('0.0', '−0.1')
    """
    return f"{value:z.{decimals}f}".replace("-", "−") if value is not None and isfinite(value) else "–"


def clock_text(hours: float) -> str:
    """Return a clock position as hours and minutes.

    >>> clock_text(2.0517), clock_text(12.0)
    ('2:03', '12:00')
    """
    minutes = round(hours * 60) % 720
    return f"{minutes // 60 or 12}:{minutes % 60:02d}"
