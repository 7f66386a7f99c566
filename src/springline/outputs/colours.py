"""One palette for report, viewer and mesh: departures from blue (outward) over pale to red-brown (inward).

Readers who do not tell red from green tell these apart, and print in grey keeps both ends darker than the middle.
Readings that were not used have colours of their own, outside the scale.
"""

from __future__ import annotations

from math import floor, log10

import numpy as np

LEVELS = 201
"""Steps of the scale of departures; the middle one is no departure."""

_INWARD_TO_OUTWARD = (
    (0.00, "#7a2a12"),
    (0.12, "#b5502a"),
    (0.27, "#e39a63"),
    (0.40, "#f3dcc4"),
    (0.50, "#f6f4ee"),
    (0.60, "#d5e3eb"),
    (0.73, "#7fb1d3"),
    (0.88, "#2f74a8"),
    (1.00, "#12395f"),
)

REASON_COLOURS = {
    "no_return": "#c9ccd1",
    "outlier": "#8e6bb0",
    "water": "#2fa394",
    "occluded": "#6f757d",
    "lateral": "#c8b400",
    "out_of_range": "#d17fb0",
    "by_hand": "#3f8f4f",
    "no_section": "#e4e0ea",
    "no_station": "#ffffff",
}
"""Colours of readings that show no departure, by reason."""


def rgb(colour: str) -> tuple[int, int, int]:
    """Return the three parts of a colour such as '#7a2a12'."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def scale_colours() -> np.ndarray:
    """Return the scale of departures, inward first, (LEVELS, 3) uint8 in sRGB."""
    at = np.array([a for a, _ in _INWARD_TO_OUTWARD])
    anchors = np.array([rgb(c) for _, c in _INWARD_TO_OUTWARD], float)
    level = np.linspace(0.0, 1.0, LEVELS)
    return np.rint(np.stack([np.interp(level, at, anchors[:, k]) for k in range(3)], axis=1)).astype(np.uint8)


def levels(departure: np.ndarray, limit: float) -> np.ndarray:
    """Return the step of the scale for departures [m], clipped at plus and minus `limit` [m]; NaN gives the middle."""
    half = (LEVELS - 1) // 2
    return np.rint(np.clip(np.nan_to_num(departure) / limit, -1.0, 1.0) * half + half).astype(np.uint8)


def nice_limit(departure: np.ndarray) -> float:
    """Return a round number [m] that all but the largest 0.2 % of the departures stay below; at least 0.1 mm.

    >>> nice_limit(np.linspace(-0.0041, 0.0041, 1000))
    0.005
    """
    finite = np.abs(departure[np.isfinite(departure)])
    most = max(float(np.quantile(finite, 0.998)) if finite.size else 0.0, 1e-4)
    decade = 10.0 ** floor(log10(most))
    step = next(s for s in (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0) if s * decade >= most * (1 - 1e-9))
    return round(step * decade, 9)
