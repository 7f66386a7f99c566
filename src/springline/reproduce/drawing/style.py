"""Colours, sizes and texts that all figures share."""

from __future__ import annotations

import re
from math import ceil, floor, log10
from typing import TYPE_CHECKING

import numpy as np

from springline.outputs.colours import rgb, scale_colours

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Palette = NDArray[np.uint8]

INK, SOFT, RULE, GRID = "#1d2733", "#56616e", "#8b95a1", "#e6eaee"

# Okabe and Ito's colours, told apart by colour-blind readers.
BLUE, ORANGE, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#b0599a"

FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue','Noto Sans','Liberation Sans',Arial,sans-serif"
TEXT, SMALL = 12.0, 11.0
"""Font sizes of titles and of everything else [px]."""

_SEQUENCE = ((0.0, "#a9cbe3"), (0.35, "#4f9ccc"), (0.7, "#1f6396"), (1.0, "#0d2f52"))


def ramp(count: int) -> list[str]:
    """Return colours for an ordered parameter, pale first; dark enough for lines.

    >>> ramp(1)
    ['#0d2f52']
    """
    return [_hex(c) for c in _between(_SEQUENCE, np.linspace(0.0, 1.0, count) if count > 1 else np.ones(1))]


def shades(count: int = 255) -> Palette:
    """Return a palette for a quantity that starts at zero, (count, 3), pale first."""
    ends = ((0.0, "#f6f4ee"), (0.3, "#bcd7e8"), (0.65, "#5b9dc6"), (1.0, "#12395f"))
    return np.rint(_between(ends, np.linspace(0.0, 1.0, count))).astype(np.uint8)


def departures() -> Palette:
    """Return the palette of reports for a signed quantity: negative red-brown, zero pale, positive blue."""
    return scale_colours()


def spread(text: str, size: float = SMALL) -> float:
    """Return about how wide a text is drawn [px]."""
    return 0.54 * size * len(text)


def number(value: float) -> str:
    """Return a coordinate with one decimal, in as few characters as it takes.

    >>> number(12.04), number(-0.01), number(7.5)
    ('12', '0', '7.5')
    """
    text = f"{value:.1f}".removesuffix(".0")
    return "0" if text == "-0" else text


def escaped(text: str) -> str:
    """Return a text for SVG: markup escaped, a proper minus before digits."""
    return proper_minus(text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))


def proper_minus(text: str) -> str:
    """Return a text whose negative numbers and differences have a minus sign; hyphens and exponents stay.

    >>> proper_minus("-0.32 to 1 - 1e-9, ring-wise")
    '−0.32 to 1 − 1e-9, ring-wise'
    """
    return re.sub(r"(?<![\w.])-(?=[\d.])|(?<= )-(?= )", "−", text)


def ticks(low: float, high: float, about: int) -> list[float]:
    """Return about so many round numbers within [low, high].

    >>> ticks(0.0, 1.0, 5)
    [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    """
    rough = (high - low) / about
    decade = 10.0 ** floor(log10(rough))
    step = next(s for s in (1.0, 2.0, 2.5, 5.0, 10.0) if s * decade >= rough * (1 - 1e-9)) * decade
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [round(k * step, 12) for k in range(first, last + 1)]


def _between(anchors: tuple[tuple[float, str], ...], at: NDArray[np.float64]) -> NDArray[np.float64]:
    where, colours = [a for a, _ in anchors], np.array([rgb(c) for _, c in anchors], float)
    return np.stack([np.interp(at, where, colours[:, k]) for k in range(3)], axis=-1)


def _hex(colour: NDArray[np.float64]) -> str:
    return "#" + "".join(f"{round(float(c)):02x}" for c in colour)
