"""The unrolled wall as pictures: shape, surface, and what was seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..colours import LEVELS, REASON_COLOURS, levels, rgb, scale_colours
from ..photo import UNSEEN
from ..png import palette_png, rgb_png
from ..unroll import NO_STATION, REASON_WORDS, REASONS

if TYPE_CHECKING:
    from ..photo import Photo
    from ..unroll import Unrolled
    from .profiles import Axis
    from .scales import Scale

_WIDTH = 1200
_USED = "#dfe8ef"


@dataclass(frozen=True)
class Map:
    """One picture of the unrolled wall, chainage to the right, clock 6, 3, 12, 9, 6 from the top.

    Attributes:
        key: Short name, by which pages and tests find it.
        title: What it shows.
        note: A sentence beside the title.
        picture: PNG.
        limit: Ends of its scale of colours as texts, inward and outward, or None.
        legend: Label and colour of what stands outside that scale.
    """

    key: str
    title: str
    note: str
    picture: bytes
    limit: tuple[str, str] | None
    legend: tuple[tuple[str, str], ...]


def make_maps(wall: Unrolled, axis: Axis, small: Scale) -> list[Map]:
    """Return the maps on the chainage axis that the charts share; `small` is the printed unit of departures."""
    edges = np.linspace(axis.low, axis.high, _WIDTH + 1)
    seen = wall.columns(edges)
    diameter = small.text(wall.circle_diameter, 2)
    return [
        _departures(
            "shape",
            "Shape: departure from a circle",
            f"From a circle of {diameter} about the section’s centre; a smooth swing with the clock is ovality.",
            seen.shape,
            seen.reason,
            small,
        ),
        _departures(
            "surface",
            "Surface: departure from the fitted section",
            "What remains when the fitted section is taken away: dents, joints, deposits, roughness and noise.",
            seen.surface,
            seen.reason,
            small,
        ),
        _sight(seen.reason),
        *([_photograph(wall.photo.columns(edges))] if wall.photo else []),
    ]


def _departures(key: str, title: str, note: str, departure: np.ndarray, reason: np.ndarray, small: Scale) -> Map:
    limit = small.limit(departure)
    indices = np.where(reason == 0, levels(departure, limit), _reason_indices(reason))
    ends = (f"inward −{small.plain(limit)}", f"+{small.plain(limit)} outward")
    return Map(key, title, note, _picture(_upright(indices)), ends, _legend(reason, with_used=False))


def wall_picture(wall: Unrolled, limit: float) -> bytes:
    """Return the surface of a piece of wall as PNG, chainage to the right and bearing downwards, pixel by cell.

    Args:
        wall: The piece, as `Unrolled.piece` cuts it.
        limit: End of the scale of colours [m].
    """
    indices = np.where(wall.reason == 0, levels(wall.surface, limit), _reason_indices(wall.reason))
    return _picture(indices.T)


def _photograph(photo: Photo) -> Map:
    unseen = (("no frame shows it", "#" + bytes(UNSEEN).hex()),) if (photo.seen == 0).any() else ()
    return Map(
        "photo",
        "Photograph: the frames laid on the wall",
        "Projected onto the measured wall and blended; the lamp’s fall of light is taken away.",
        rgb_png(np.ascontiguousarray(_upright(photo.colour))),
        None,
        unseen,
    )


def _sight(reason: np.ndarray) -> Map:
    return Map(
        "readings",
        "What was seen",
        "Where readings were used, and why not elsewhere.",
        _picture(_upright(np.where(reason == 0, LEVELS + len(REASON_COLOURS), _reason_indices(reason)))),
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


def _upright(indices: np.ndarray) -> np.ndarray:
    """Return rows of bearing that grow downwards from the invert: 6, 3, 12, 9 and 6 o'clock again."""
    rows = indices.shape[1]
    return indices.swapaxes(0, 1)[(np.arange(rows) - rows // 4) % rows]


def _picture(indices: np.ndarray) -> bytes:
    extra = [rgb(colour) for colour in (*REASON_COLOURS.values(), _USED)]
    palette = np.concatenate((scale_colours(), np.array(extra, np.uint8)))
    return palette_png(indices.astype(np.uint8), palette)


def _legend(reason: np.ndarray, *, with_used: bool) -> tuple[tuple[str, str], ...]:
    present = {{**REASONS, NO_STATION: "no_station"}[int(flag)] for flag in np.unique(reason)}
    used = (("used", _USED),) if with_used else ()
    rows = (*used, *((name, colour) for name, colour in REASON_COLOURS.items() if name in present))
    return tuple((REASON_WORDS[name], colour) for name, colour in rows)
