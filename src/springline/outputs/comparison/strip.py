"""The chainage axis of a comparison, values thinned onto it, and the walls as pictures on it."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...compare.edges import COMPARED, EDGE, SPIKE, UNPLACED, UNSEEN_A, UNSEEN_B, WHY_NOT
from ..colours import LEVELS, levels, nice_limit, rgb, scale_colours
from ..png import palette_png
from ..report.charts import Band, Chart, Line, axis_over, drawn
from ..report.profiles import Axis, make_axis

if TYPE_CHECKING:
    from ...compare.difference import Difference
    from ...compare.pair import Comparison

_POINTS = 700
_WIDTH = 1200
_SIGMAS_95 = 1.959964
_BLUE, _ORANGE, _GREEN, _PURPLE, _INK = "#0072b2", "#d55e00", "#009e73", "#b0599a", "#1d2733"
_DIFFERENCE_NOTE = "Averaged over 10 cm and 12 degrees; patches that are told are ringed and numbered."
_WHY_COLOURS = {UNSEEN_A: "#c9ccd1", UNSEEN_B: "#aeb4bb", EDGE: "#8e6bb0", UNPLACED: "#e8d9a8", SPIKE: "#d17fb0"}


class Strip:
    """Chainage of A thinned to what a page can show; serves the drawing of charts as `report.profiles.Profiles` does.

    Args:
        chainage: (n,) rising [m].
        extent: First and last chainage of A [m].
    """

    def __init__(self, chainage: np.ndarray, extent: tuple[float, float]) -> None:
        joined = -(-chainage.size // _POINTS)
        self._first = np.arange(0, chainage.size, joined)
        last = np.append(self._first[1:], chainage.size) - 1
        self.start, self.end = chainage[self._first], chainage[last]
        self.middle = 0.5 * (self.start + self.end)
        self.axis = make_axis(*extent, ticks=8, tight=True)

    def thin(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the smallest and the largest value of each group."""
        return np.fmin.reduceat(values, self._first), np.fmax.reduceat(values, self._first)

    def breaks(self) -> np.ndarray:
        """Return whether a gap lies before each group; values that are missing break lines here."""
        return np.zeros(self.middle.size, bool)


@dataclass(frozen=True)
class Picture:
    """One map on the chainage axis: clock 6, 3, 12, 9, 6 from the top."""

    key: str
    title: str
    note: str
    data: str
    limit_mm: float | None
    legend: tuple[tuple[str, str], ...]
    marked: bool


def pictures(found: Comparison, axis: Axis) -> list[Picture]:
    """Return the walls of A and of B on A's chainage, and their difference."""
    d = found.difference
    both = np.concatenate([w[np.isfinite(w)] for w in (d.wall_a, d.wall_b)])
    limit = nice_limit(both) if both.size else 1e-3
    unseen = np.full(d.why.shape, COMPARED, np.uint8)
    unseen[~np.isfinite(d.wall_a)] = UNSEEN_A
    second = np.full(d.why.shape, COMPARED, np.uint8)
    second[~np.isfinite(d.wall_b)] = UNSEEN_B
    turned = ", driven from the other end and turned round" if found.placed.reversed else ""
    smooth = _smooth(d)
    return [
        _picture("a", f"A: {found.a.name}", "Wall off its fitted section.", d, d.wall_a, unseen, limit, axis),
        _picture("b", f"B: {found.b.name}", f"On A’s chainage and clock{turned}.", d, d.wall_b, second, limit, axis),
        _picture(
            "difference", "Difference, B less A", _DIFFERENCE_NOTE, d, smooth, d.why, nice_limit(smooth), axis,
            marked=True,
        ),
    ]  # fmt: skip


def _smooth(d: Difference) -> np.ndarray:
    """Return the change averaged over 10 cm along and 12 degrees round, NaN where it cannot be told."""
    from scipy.ndimage import uniform_filter1d

    known = np.isfinite(d.change)
    sums = []
    for part in (np.where(known, d.change, 0.0), known.astype(np.float32)):
        along = uniform_filter1d(part, max(1, round(0.1 / d.step)), axis=0, mode="constant")
        sums.append(uniform_filter1d(along, max(1, round(d.change.shape[1] / 30)), axis=1, mode="wrap"))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(known, sums[0] / sums[1], np.nan)


def _picture(
    key: str, title: str, note: str, d: Difference, values: np.ndarray, why: np.ndarray, limit: float, axis: Axis,
    *, marked: bool = False,
) -> Picture:  # fmt: skip
    edges = np.linspace(axis.low, axis.high, _WIDTH + 1)
    first = np.clip(np.searchsorted(d.chainage, edges[:-1] - 0.5 * d.step), 0, len(d.chainage) - 1)
    last = np.maximum(np.searchsorted(d.chainage, edges[1:] - 0.5 * d.step), first + 1)
    pixels = np.full((_WIDTH, values.shape[1]), LEVELS, np.uint8)
    colours = {code: LEVELS + k for k, code in enumerate(_WHY_COLOURS)}
    blank = LEVELS + len(_WHY_COLOURS)
    for k, (i, j) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
        if edges[k] > d.chainage[-1] + d.step or edges[k + 1] < d.chainage[0] - d.step:
            pixels[k] = blank
            continue
        part = values[i:j]
        at = np.argmax(np.nan_to_num(np.abs(part), nan=-1.0), axis=0)[None]
        value = np.take_along_axis(part, at, 0)[0]
        reason = np.take_along_axis(why[i:j], at, 0)[0]
        index = levels(value, limit)
        for code, colour in colours.items():
            index = np.where(~np.isfinite(value) & (reason == code), colour, index)
        pixels[k] = index
    extra = [rgb(c) for c in (*_WHY_COLOURS.values(), "#ffffff")]
    palette = np.concatenate((scale_colours(), np.array(extra, np.uint8)))
    rows = values.shape[1]
    png = palette_png(pixels.T[(np.arange(rows) - rows // 4) % rows], palette)
    legend = tuple((WHY_NOT[c], colour) for c, colour in _WHY_COLOURS.items() if (why == c).any())
    data = "data:image/png;base64," + base64.b64encode(png).decode("ascii")
    return Picture(key, title, note, data, limit * 1e3, legend, marked)


def change_charts(found: Comparison, strip: Strip) -> list[Chart]:
    """Return the changes of diameters, ovality and gradient along the pipe."""
    by = {p.quantity: p for p in found.profiles}
    rows = (
        ("diameters", "Change of diameter", "mm", 1e3, 3, 0.2, (
            ("diameter_x", "horizontal (X)", _GREEN, ""), ("diameter_y", "vertical (Y)", _PURPLE, "7 3"),
            ("diameter_mean", "mean", _INK, "2 3"))),
        ("ovality", "Change of ovality", "%", 1e2, 3, 0.1, (("ovality", "ovality", _ORANGE, ""),)),
        ("gradient", "Change of gradient", "%", 1e2, 3, 0.1, (("gradient", "gradient", _BLUE, ""),)),
        ("elevation", "Change of elevation", "mm", 1e3, 1, 5.0, (("elevation", "elevation", _BLUE, ""),)),
    )  # fmt: skip
    charts = []
    for key, title, unit, factor, decimals, least, parts in rows:
        shown = [(by[name], label, colour, dash) for name, label, colour, dash in parts if name in by]
        if not shown:
            continue
        lines, bands = [], []
        for profile, label, colour, dash in shown:
            value = _mean(profile.change, found.difference.step) * factor
            lines.append(Line(label, colour, dash, *strip.thin(value)))
        first = shown[0][0]
        half = _SIGMAS_95 * factor * np.where(np.isfinite(first.change), first.fixed, np.nan)
        bands.append(
            Band(
                "95 % interval of what tilt and scale leave open",
                shown[0][2],
                strip.thin(-half)[0],
                strip.thin(half)[1],
            )
        )
        chart = Chart(
            key, title, unit, axis_over(tuple(lines), tuple(bands), least=least), decimals, tuple(lines), tuple(bands),
            note="B less A, averaged over half a metre.",
        )  # fmt: skip
        charts.append(drawn(strip, chart))
    return charts


def _mean(values: np.ndarray, step: float) -> np.ndarray:
    """Return values averaged over half a metre; NaN where they are."""
    from scipy.ndimage import uniform_filter1d

    width = max(1, round(0.5 / step))
    known = np.isfinite(values)
    total = uniform_filter1d(np.where(known, values, 0.0), width, mode="constant")
    share = uniform_filter1d(known.astype(float), width, mode="constant")
    return np.where(known, total / np.maximum(share, 1e-9), np.nan)


def drift_chart(found: Comparison) -> tuple[Strip, Chart]:
    """Return the drift of B's odometer against A's, about a straight line, with its 95 % interval."""
    x = np.linspace(*found.a.extent, 4 * _POINTS)
    strip = Strip(x, found.a.extent)
    y, sigma = found.placed.at(x)
    slope, start = found_line(found)
    off = (y - start - slope * x) * 1e3
    off = np.where(found.placed.reliable(x), off, np.nan)
    half = _SIGMAS_95 * 1e3 * sigma
    line = Line("drift", _INK, "", *strip.thin(off))
    band = Band("95 % interval", _INK, strip.thin(off - half)[0], strip.thin(off + half)[1])
    sign = "−" if slope < 0 else ""
    note = f"B’s chainage less {sign}{abs(slope):.5f} × A’s {'+' if start >= 0 else '−'} {abs(start):.3f} m."
    chart = Chart(
        "drift", "Drift of the odometers", "mm", axis_over((line,), (band,), least=10.0), 1, (line,), (band,), note=note
    )
    return strip, drawn(strip, chart)


def found_line(found: Comparison) -> tuple[float, float]:
    """Return slope and start [m] of the straight line nearest to the drift."""
    x, y = found.placed.drift.chainage_a, found.placed.drift.chainage_b
    if len(x) < 2:
        return 1.0, float(y[0] - x[0]) if len(x) else 0.0
    slope, start = np.polyfit(x, y, 1)
    return float(slope), float(start)
