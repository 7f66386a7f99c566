"""Charts along the pipe, as plain SVG paths on one shared chainage axis.

A path's box is 1000 by 1000 and stretches with the page; labels are HTML beside it, so that they never distort.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from .profiles import Axis, Profiles, make_axis
from .texts import SIGMAS_95

if TYPE_CHECKING:
    from ..results import Results

_BOX = 1000.0

# Okabe and Ito's colours, told apart by colour-blind readers; dashes tell them apart in grey.
_INK, _BLUE, _ORANGE, _GREEN, _PURPLE = "#1d2733", "#0072b2", "#d55e00", "#009e73", "#b0599a"


@dataclass(frozen=True)
class Line:
    """One line of a chart: thinned values in the chart's unit."""

    label: str
    colour: str
    dash: str
    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True)
class Band:
    """A 95 % interval behind a line."""

    label: str
    colour: str
    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True)
class Chart:
    """One chart: its lines, bands and limits, on its own value axis."""

    key: str
    title: str
    unit: str
    axis: Axis
    decimals: int
    lines: tuple[Line, ...]
    bands: tuple[Band, ...] = ()
    levels: tuple[tuple[str, float], ...] = ()
    note: str = ""
    paths: tuple[str, ...] = field(default=())
    band_paths: tuple[str, ...] = field(default=())


def line_path(profiles: Profiles, axis: Axis, low: np.ndarray, high: np.ndarray) -> str:
    """Return the path through the smallest and largest value of each group, broken where there is none."""
    x = np.round(profiles.axis.share(profiles.middle) * _BOX, 1)
    bottom, top = (np.round((1.0 - axis.share(v)) * _BOX, 1) for v in (low, high))
    breaks, parts, drawing, last = profiles.breaks(), [], False, 0.0
    for k in range(x.size):
        if not np.isfinite(bottom[k]):
            drawing = False
            continue
        pair = (bottom[k], top[k]) if abs(bottom[k] - last) <= abs(top[k] - last) else (top[k], bottom[k])
        if drawing and not breaks[k]:
            parts.append(f"L{x[k]:g} {pair[0]:g}")
        else:
            # A point of its own still shows, thanks to round line ends.
            parts.append(f"M{x[k]:g} {pair[0]:g}h0")
        if pair[0] != pair[1]:
            parts.append(f"V{pair[1]:g}")
        drawing, last = True, pair[1]
    return "".join(parts)


def band_path(profiles: Profiles, axis: Axis, low: np.ndarray, high: np.ndarray) -> str:
    """Return the closed outline between two profiles, one piece per unbroken run."""
    x = np.round(profiles.axis.share(profiles.middle) * _BOX, 1)
    bottom, top = (np.round((1.0 - np.clip(axis.share(v), 0, 1)) * _BOX, 1) for v in (low, high))
    known = np.isfinite(bottom) & np.isfinite(top)
    run = np.cumsum(~known | profiles.breaks())
    parts = []
    for number in np.unique(run[known]):
        at = np.flatnonzero(known & (run == number))
        over = "L".join(f"{x[k]:g} {top[k]:g}" for k in at)
        under = "L".join(f"{x[k]:g} {bottom[k]:g}" for k in at[::-1])
        parts.append(f"M{over}L{under}Z")
    return "".join(parts)


def make_charts(results: Results, profiles: Profiles) -> list[Chart]:
    """Return the charts for which the survey has values."""
    made = (
        _diameters(results, profiles),
        _ovalities(results, profiles),
        _deflections(results, profiles),
        _losses(results, profiles),
        _coverage(results, profiles),
    )
    return [_drawn(profiles, chart) for chart in made if chart is not None]


def _drawn(profiles: Profiles, chart: Chart) -> Chart:
    paths = tuple(line_path(profiles, chart.axis, line.low, line.high) for line in chart.lines)
    bands = tuple(band_path(profiles, chart.axis, band.low, band.high) for band in chart.bands)
    return Chart(**{**chart.__dict__, "paths": paths, "band_paths": bands})


def _lines(results: Results, profiles: Profiles, factor: float, rows: tuple[tuple[str, ...], ...]) -> tuple[Line, ...]:
    lines = []
    for variable, label, colour, dash in rows:
        values = results.metric(variable)
        if np.isfinite(values).any():
            lines.append(Line(label, colour, dash, *profiles.thin(values * factor)))
    return tuple(lines)


def _axis_over(*profiles: np.ndarray, floor: float | None = None, levels: tuple[float, ...] = ()) -> Axis:
    values = np.concatenate([*(p[np.isfinite(p)] for p in profiles), np.array(levels)])
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    return make_axis(low if floor is None else min(low, floor), high)


def _diameters(results: Results, profiles: Profiles) -> Chart | None:
    lines = _lines(
        results,
        profiles,
        1e3,
        (
            ("diameter_max", "largest", _ORANGE, ""),
            ("diameter_min", "smallest", _BLUE, ""),
            ("diameter_x", "horizontal (X)", _GREEN, "7 3"),
            ("diameter_y", "vertical (Y)", _PURPLE, "2 3"),
        ),
    )
    if not lines:
        return None
    levels = _reference(results)
    axis = _axis_over(*(line.low for line in lines), *(line.high for line in lines), levels=tuple(v for _, v in levels))
    return Chart("diameter", "Diameters", "mm", axis, 2, lines, levels=levels, note="Chords of the fitted section.")


def _reference(results: Results) -> tuple[tuple[str, float], ...]:
    value = results.metrics_attr("reference_diameter")
    kind = results.survey.metrics.attrs.get("reference_kind", "reference")
    return ((f"{kind} {value * 1e3:g} mm", value * 1e3),) if np.isfinite(value) else ()


def _ovalities(results: Results, profiles: Profiles) -> Chart | None:
    lines = _lines(
        results,
        profiles,
        1e2,
        (
            ("ovality_polar", "polar mean", _INK, ""),
            ("ovality_axes", "axes mean", _BLUE, "7 3"),
            ("ovality_area", "area mean", _GREEN, "2 3"),
            ("ovality_caliper", "caliper mean", _ORANGE, "9 3 2 3"),
        ),
    )
    if not lines:
        return None
    low, high = (results.metric(f"ovality_polar_{end}") * 1e2 for end in ("low", "high"))
    bands: tuple[Band, ...] = ()
    if np.isfinite(low).any():
        bands = (Band("95 % interval of the polar one", _INK, profiles.thin(low)[0], profiles.thin(high)[1]),)
    edges = [edge for part in (*lines, *bands) for edge in (part.low, part.high)]
    return Chart(
        "ovality",
        "Ovality, (largest − mean) / mean",
        "%",
        _axis_over(*edges, floor=0.0),
        3,
        lines,
        bands,
        note="By each of the four mean diameters.",
    )


def _deflections(results: Results, profiles: Profiles) -> Chart | None:
    lines = _lines(
        results,
        profiles,
        1e2,
        (
            ("deflection", "deflection", _INK, ""),
            ("deflection_x", "horizontal, signed", _GREEN, "7 3"),
            ("deflection_y", "vertical, signed", _PURPLE, "2 3"),
        ),
    )
    if not lines:
        return None
    value, sigma = results.metric("deflection"), results.metric("deflection_sigma")
    bands: tuple[Band, ...] = ()
    if np.isfinite(sigma).any():
        low, high = ((value + side * SIGMAS_95 * sigma) * 1e2 for side in (-1, 1))
        bands = (Band("95 % interval", _INK, profiles.thin(low)[0], profiles.thin(high)[1]),)
    edges = [edge for part in (*lines, *bands) for edge in (part.low, part.high)]
    kind = results.survey.metrics.attrs.get("reference_kind", "reference")
    return Chart(
        "deflection",
        "Deflection",
        "%",
        _axis_over(*edges, floor=0.0),
        3,
        lines,
        bands,
        note=f"Against the {kind} diameter of {results.metrics_attr('reference_diameter') * 1e3:g} mm.",
    )


def _losses(results: Results, profiles: Profiles) -> Chart | None:
    lines = _lines(
        results,
        profiles,
        1e2,
        (("area_loss", "area", _BLUE, ""), ("capacity_loss", "full-flow capacity (Manning)", _ORANGE, "7 3")),
    )
    if not lines:
        return None
    edges = [edge for line in lines for edge in (line.low, line.high)]
    return Chart("loss", "Loss of area and capacity", "%", _axis_over(*edges, floor=0.0), 3, lines)


def _coverage(results: Results, profiles: Profiles) -> Chart | None:
    if not np.isfinite(results.coverage).any():
        return None
    line = Line("used readings", _BLUE, "", *profiles.thin(results.coverage * 1e2))
    return Chart(
        "coverage",
        "Coverage, used over possible readings",
        "%",
        Axis(0.0, 100.0, (0.0, 50.0, 100.0), 0),
        1,
        (line,),
        levels=(("50 %: below it a station counts as unseen", 50.0),),
    )
