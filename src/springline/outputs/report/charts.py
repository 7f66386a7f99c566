"""Charts along the pipe, as plain SVG paths on one shared chainage axis.

A path's box is 1000 by 1000 and stretches with the page; labels are set beside it, so that they never distort.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .profiles import make_axis

if TYPE_CHECKING:
    from .profiles import Axis, Profiles

BOX = 1000.0
"""Width and height of the box in which paths are drawn."""

# Okabe and Ito's colours, told apart by colour-blind readers; dashes tell them apart in grey.
INK, BLUE, ORANGE, GREEN, PURPLE = "#1d2733", "#0072b2", "#d55e00", "#009e73", "#b0599a"


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
    """One chart: its lines, bands and limits, on its own value axis.

    Attributes:
        key: Short name, by which pages and tests find it.
        title: What it shows.
        unit: Of its values.
        axis: The value axis.
        decimals: Of values shown under the pointer.
        lines: Thinned values.
        bands: Intervals behind them.
        levels: Horizontal lines with their labels, such as limits.
        note: A sentence beside the title.
        paths: The lines drawn in the box, one each.
        band_paths: The bands drawn in the box, one each.
    """

    key: str
    title: str
    unit: str
    axis: Axis
    decimals: int
    lines: tuple[Line, ...]
    bands: tuple[Band, ...] = ()
    levels: tuple[tuple[str, float], ...] = ()
    note: str = ""
    paths: tuple[str, ...] = ()
    band_paths: tuple[str, ...] = ()


def line_path(profiles: Profiles, axis: Axis, low: np.ndarray, high: np.ndarray) -> str:
    """Return the path through the smallest and largest value of each group, broken where there is none."""
    x = np.round(profiles.axis.share(profiles.middle) * BOX, 1)
    bottom, top = (np.round((1.0 - axis.share(v)) * BOX, 1) for v in (low, high))
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
    x = np.round(profiles.axis.share(profiles.middle) * BOX, 1)
    bottom, top = (np.round((1.0 - np.clip(axis.share(v), 0, 1)) * BOX, 1) for v in (low, high))
    known = np.isfinite(bottom) & np.isfinite(top)
    run = np.cumsum(~known | profiles.breaks())
    parts = []
    for number in np.unique(run[known]):
        at = np.flatnonzero(known & (run == number))
        over = "L".join(f"{x[k]:g} {top[k]:g}" for k in at)
        under = "L".join(f"{x[k]:g} {bottom[k]:g}" for k in at[::-1])
        parts.append(f"M{over}L{under}Z")
    return "".join(parts)


def drawn(profiles: Profiles, chart: Chart) -> Chart:
    """Return the chart with the paths of its lines and bands."""
    paths = tuple(line_path(profiles, chart.axis, line.low, line.high) for line in chart.lines)
    bands = tuple(band_path(profiles, chart.axis, band.low, band.high) for band in chart.bands)
    return replace(chart, paths=paths, band_paths=bands)


def axis_over(
    lines: tuple[Line, ...],
    bands: tuple[Band, ...] = (),
    *,
    least: float,
    floor: float | None = None,
    levels: tuple[float, ...] = (),
) -> Axis:
    """Return a value axis that holds lines, bands and levels, and reaches down to `floor` when given.

    It spans at least `least`, so that what hardly varies does not look as if it did.
    """
    edges = [edge for part in (*lines, *bands) for edge in (part.low, part.high)]
    values = np.concatenate([*(edge[np.isfinite(edge)] for edge in edges), np.array(levels, float)])
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    low = low if floor is None else min(low, floor)
    more = max(least - (high - low), 0.0)
    if floor is None:
        return make_axis(low - more / 2, high + more / 2)
    return make_axis(low, high + more)
