"""The unrolled wall as pictures: shape, surface, and what was seen."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..colours import LEVELS, REASON_COLOURS, levels, nice_limit, rgb, scale_colours
from ..png import palette_png
from ..unroll import NO_STATION, REASON_WORDS, REASONS

if TYPE_CHECKING:
    from ..unroll import Unrolled
    from .profiles import Axis

_WIDTH = 1200
_USED = "#dfe8ef"


@dataclass(frozen=True)
class Map:
    """One picture of the unrolled wall, chainage to the right, clock 6, 3, 12, 9, 6 from the top."""

    key: str
    title: str
    note: str
    picture: str
    limit_mm: float | None
    legend: tuple[tuple[str, str], ...]


def make_maps(wall: Unrolled, axis: Axis) -> list[Map]:
    """Return the maps on the chainage axis that the charts share."""
    seen = wall.columns(np.linspace(axis.low, axis.high, _WIDTH + 1))
    diameter = wall.circle_diameter * 1e3
    return [
        _departures(
            "shape",
            "Shape: departure from a circle",
            f"From a circle of {diameter:.2f} mm about the section’s centre; a smooth swing with the clock is ovality.",
            seen.shape,
            seen.reason,
        ),
        _departures(
            "surface",
            "Surface: departure from the fitted section",
            "What remains when the fitted section is taken away: dents, joints, deposits, roughness and noise.",
            seen.surface,
            seen.reason,
        ),
        _sight(seen.reason),
    ]


def _departures(key: str, title: str, note: str, departure: np.ndarray, reason: np.ndarray) -> Map:
    limit = nice_limit(departure)
    indices = np.where(reason == 0, levels(departure, limit), _reason_indices(reason))
    return Map(key, title, note, _picture(indices), limit * 1e3, _legend(reason, with_used=False))


def _sight(reason: np.ndarray) -> Map:
    return Map(
        "readings",
        "What was seen",
        "Where readings were used, and why not elsewhere.",
        _picture(np.where(reason == 0, LEVELS + len(REASON_COLOURS), _reason_indices(reason))),
        None,
        _legend(reason, with_used=True),
    )


def _reason_indices(reason: np.ndarray) -> np.ndarray:
    """Return palette indices: reasons stand behind the scale, in the order of `REASON_COLOURS`."""
    place = {name: k for k, name in enumerate(REASON_COLOURS)}
    table = np.full(256, LEVELS, np.uint8)
    for flag, name in {**REASONS, NO_STATION: "no_station"}.items():
        table[flag] = LEVELS + place.get(name, 0)
    return table[reason]


def _picture(indices: np.ndarray) -> str:
    rows = indices.shape[1]
    # Bearing grows downwards from the invert: 6, 3, 12, 9 and 6 o'clock again.
    upright = indices.T[(np.arange(rows) - rows // 4) % rows].astype(np.uint8)
    extra = [rgb(colour) for colour in (*REASON_COLOURS.values(), _USED)]
    palette = np.concatenate((scale_colours(), np.array(extra, np.uint8)))
    return "data:image/png;base64," + base64.b64encode(palette_png(upright, palette)).decode("ascii")


def _legend(reason: np.ndarray, *, with_used: bool) -> tuple[tuple[str, str], ...]:
    present = {{**REASONS, NO_STATION: "no_station"}[int(flag)] for flag in np.unique(reason)}
    used = (("used", _USED),) if with_used else ()
    rows = (*used, *((name, colour) for name, colour in REASON_COLOURS.items() if name in present))
    return tuple((REASON_WORDS[name], colour) for name, colour in rows)
