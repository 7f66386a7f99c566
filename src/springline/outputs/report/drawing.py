"""A section drawn to scale: readings, fit and the circle it is judged against, seen looking forward."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...conventions import MASK_REASONS, clock_from_bearing
from ..colours import REASON_COLOURS
from ..unroll import REASON_WORDS
from .scales import Scale, Scales, make_scales
from .texts import clock_text

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..results import Results

_RADIUS = 100.0
_SHARE = 0.3
_STEPS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)
_DOTS = 720

RESIDUAL_BOX = (300.0, 60.0)
"""Width and height of the box in which residuals are drawn."""


@dataclass(frozen=True)
class Chord:
    """A diameter drawn across the section, in the drawing's units."""

    label: str
    colour: str
    start: tuple[float, float]
    end: tuple[float, float]


@dataclass(frozen=True)
class Residuals:
    """Departures of the used readings from the fitted section, by clock: 6, 9, 12, 3 and 6 h from left to right.

    Attributes:
        limit: End of the axis as a text with its unit; it runs from minus to plus that.
        dots: The readings in `RESIDUAL_BOX`; those beyond the limit stay at its edge.
        rms: Root mean square as a text with its unit.
    """

    limit: str
    dots: str
    rms: str


@dataclass(frozen=True)
class Drawing:
    """A drawn section: a circle of radius 100, with departures from it drawn as much larger as the caption says."""

    title: str
    caption: str
    bar: tuple[float, str]
    fit: str
    chords: tuple[Chord, ...]
    used: str
    unused: tuple[tuple[str, str, str], ...]
    residuals: Residuals | None = None


def draw_section(
    results: Results, station: int, reference: float, *, exaggerate: bool, scales: Scales | None = None
) -> Drawing:
    """Return the drawing of one station.

    Args:
        results: The finished survey.
        station: Which station.
        reference: Diameter of the circle that it is drawn against [m].
        exaggerate: Draw departures from that circle larger, by a stated round factor.
        scales: Printed units; metric when not given.
    """
    scales = scales or make_scales("si")
    block = next(iter(results.blocks(results.ring_of_station[[station]])))
    radius, bearing = (values[0] for values in block.about_centre(results.bearing))
    around = np.linspace(0.0, 2 * np.pi, 181)
    fit = block.fitted(around[None, :])[0]
    used = (block.reason[0] == 0) & np.isfinite(radius)
    factor = _factor(np.concatenate((fit, radius[used])), reference / 2) if exaggerate else 1.0

    def place(r: np.ndarray | float, phi: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        drawn = _RADIUS * (1.0 + factor * (np.asarray(r) / (reference / 2) - 1.0))
        # Far returns would leave the page; they stay at its rim.
        drawn = np.clip(drawn, 0.0, 1.38 * _RADIUS)
        return drawn * np.cos(phi), -drawn * np.sin(phi)

    unused = []
    for flag, name in MASK_REASONS.items():
        at = (block.reason[0] == flag) & np.isfinite(radius)
        # Far from the wall they would be thrown about by the exaggeration.
        if flag and at.any() and factor == 1.0:
            unused.append((REASON_WORDS[name], REASON_COLOURS[name], _dots(*place(radius[at], bearing[at]))))
    chainage = results.chainage[station]
    return Drawing(
        f"Section at {scales.length.text(chainage, 2)}",
        f"Departures from the circle ×{factor:g}." if factor > 1 else "True scale.",
        _bar(factor, reference, scales.small),
        "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in zip(*place(fit, around), strict=True)) + "Z",
        _chords(results, station, place, scales.small),
        _dots(*place(radius[used], bearing[used])),
        tuple(unused),
        _residuals(radius[used] - block.fitted(bearing[None, used])[0], bearing[used], scales.small),
    )


def _factor(radius: np.ndarray, circle: float) -> float:
    departure = np.abs(radius[np.isfinite(radius)] / circle - 1.0)
    most = float(np.quantile(departure, 0.95)) if departure.size else 0.0
    return max((s for s in _STEPS if s * most <= _SHARE), default=1.0)


def _residuals(departure: np.ndarray, bearing: np.ndarray, small: Scale) -> Residuals | None:
    known = np.isfinite(departure)
    if not known.any():
        return None
    departure, bearing = departure[known], bearing[known]
    limit = small.limit(departure)
    width, height = RESIDUAL_BOX
    x = ((1.5 * np.pi - bearing) % (2 * np.pi)) * (width / (2 * np.pi))
    y = (1.0 - np.clip(departure / limit, -1.0, 1.0)) * height / 2
    rms = small.text(float(np.sqrt(np.mean(departure**2))), 2)
    return Residuals(small.plain(limit), _dots(x, y), rms)


def _bar(factor: float, reference: float, small: Scale) -> tuple[float, str]:
    """Return length and label of the scale bar: of departures when they are exaggerated, of the section otherwise."""
    per_unit = factor * _RADIUS / (reference / 2 * small.factor)
    steps = [s * 10**e for e in range(-4, 4) for s in (1, 2, 5)]
    length = max((step for step in steps if step * per_unit <= 30.0), default=steps[0])
    return length * per_unit, f"{length:g} {small.name}" + (" of departure" if factor > 1 else "")


def _dots(x: np.ndarray, y: np.ndarray) -> str:
    step = -(-x.size // _DOTS) or 1
    x, y = x[::step], y[::step]
    return "".join(f"M{a:.1f} {b:.1f}h0" for a, b in zip(x, y, strict=True))


def _chords(results: Results, station: int, place: Callable[..., tuple[Any, Any]], small: Scale) -> tuple[Chord, ...]:
    turned = results.metric("diameter_max_bearing")[station]
    wanted = [("max", "largest", turned, "#d55e00")]
    if results.survey.section.attrs.get("model", "ellipse") == "ellipse":
        wanted.append(("min", "smallest", turned + np.pi / 2, "#0072b2"))
    chords = []
    for name, word, bearing, colour in wanted:
        value = results.metric(f"diameter_{name}")[station]
        if not (np.isfinite(value) and np.isfinite(bearing)):
            continue
        ends = [tuple(float(v) for v in place(value / 2, angle)) for angle in (bearing, bearing + np.pi)]
        clock = clock_text(float(clock_from_bearing(bearing)))
        chords.append(Chord(f"{word} {small.text(value, 1)} at {clock}", colour, *ends))
    return tuple(chords)
