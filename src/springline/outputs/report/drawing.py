"""A section drawn to scale: readings, fit and the circle it is judged against, seen looking forward."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...conventions import MASK_REASONS, clock_from_bearing
from ..colours import REASON_COLOURS
from ..unroll import REASON_WORDS
from .texts import clock_text

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..results import Results

_RADIUS = 100.0
_SHARE = 0.3
_STEPS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)


@dataclass(frozen=True)
class Chord:
    """A diameter drawn across the section, in the drawing's units."""

    label: str
    colour: str
    start: tuple[float, float]
    end: tuple[float, float]


@dataclass(frozen=True)
class Drawing:
    """A drawn section: a box of 1 : `scale`, with departures from the circle drawn `exaggeration` times as large."""

    title: str
    caption: str
    exaggeration: float
    bar: tuple[float, str]
    fit: str
    chords: tuple[Chord, ...]
    used: str
    unused: tuple[tuple[str, str, str], ...]


def draw_section(results: Results, station: int, reference: float, *, exaggerate: bool) -> Drawing:
    """Return the drawing of one station.

    Args:
        results: The finished survey.
        station: Which station.
        reference: Diameter of the circle that it is drawn against [m].
        exaggerate: Draw departures from that circle larger, by a stated round factor.
    """
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
        f"Section at {chainage:.2f} m",
        f"Departures from the circle drawn {factor:g} times as large." if factor > 1 else "True scale.",
        factor,
        _bar(factor, reference),
        "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in zip(*place(fit, around), strict=True)) + "Z",
        _chords(results, station, place),
        _dots(*place(radius[used], bearing[used])),
        tuple(unused),
    )


def _factor(radius: np.ndarray, circle: float) -> float:
    departure = np.abs(radius[np.isfinite(radius)] / circle - 1.0)
    most = float(np.quantile(departure, 0.95)) if departure.size else 0.0
    return max((s for s in _STEPS if s * most <= _SHARE), default=1.0)


def _bar(factor: float, reference: float) -> tuple[float, str]:
    """Return length and label of the scale bar: of departures when they are exaggerated, of the section otherwise."""
    unit = factor * _RADIUS / (reference / 2 * 1e3)
    length = max((s * 10**e for e in range(-2, 4) for s in (1, 2, 5) if s * 10**e * unit <= 30.0), default=0.01)
    return length * unit, f"{length:g} mm" + (" of departure" if factor > 1 else "")


def _dots(x: np.ndarray, y: np.ndarray) -> str:
    return "".join(f"M{a:.1f} {b:.1f}h0" for a, b in zip(x, y, strict=True))


def _chords(results: Results, station: int, place: Callable[..., tuple[Any, Any]]) -> tuple[Chord, ...]:
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
        chords.append(Chord(f"{word} {value * 1e3:.1f} mm at {clock}", colour, *ends))
    return tuple(chords)
