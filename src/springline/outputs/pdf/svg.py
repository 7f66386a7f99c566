"""Paths of the report's model as small SVG pictures, drawn for the size at which they are printed."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from ..report.charts import BOX
from ..report.drawing import RESIDUAL_BOX

if TYPE_CHECKING:
    from ..report.charts import Chart
    from ..report.drawing import Drawing, Residuals
    from ..report.layout import Plan
    from ..report.profiles import Axis

# One unit of these pictures is printed as one point, so that widths of lines are true.
_STEP = re.compile(r"([MLHVhZ])|(-?[\d.]+)")
_GRID = "#e6eaee"
_GAP = "#e3e6ea"


def scaled(path: str, width: float, height: float, box: tuple[float, float] = (BOX, BOX)) -> str:
    """Return a path of absolute moves (M, L, H, V), dots (h0) and closings (Z) drawn in a box of another size.

    >>> scaled("M0 0L1000 500V1000h0Z", 200, 40)
    'M0 0L200 20V40h0Z'
    """
    across, up = width / box[0], height / box[1]
    out: list[str] = []
    command, odd = "", False
    for letter, digits in _STEP.findall(path):
        if letter:
            command, odd = letter, False
            out.append(letter)
            continue
        factor = up if odd or command == "V" else across
        value = 0.0 if command == "h" else float(digits) * factor
        out.append(f"{' ' if out and out[-1] not in 'MLHVhZ' else ''}{round(value, 2):g}")
        odd = not odd if command in "ML" else odd
    return "".join(out)


def _path(d: str, **style: object) -> str:
    return f"<path d={quoteattr(d)} {_words(style)}/>" if d else ""


def _box(x: float, y: float, width: float, height: float, **style: object) -> str:
    return f'<rect x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}" {_words(style)}/>'


def _words(style: dict[str, object]) -> str:
    return " ".join(f"{key.replace('_', '-')}={quoteattr(str(value))}" for key, value in style.items() if value != "")


def _svg(parts: list[str], width: float, height: float, origin: tuple[float, float] = (0.0, 0.0)) -> str:
    box = f"{origin[0]:g} {origin[1]:g} {width:g} {height:g}"
    inner = "".join(parts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" viewBox="{box}">{inner}</svg>'
    )


def _dashes(dash: str) -> str:
    return " ".join(f"{float(part) * 0.7:g}" for part in dash.split())


def _stroke(colour: str, width: float, dash: str = "") -> dict[str, object]:
    return {
        "stroke": colour,
        "stroke_width": width,
        "fill": "none",
        "stroke_dasharray": _dashes(dash),
        "stroke_linecap": "butt" if dash else "round",
        "stroke_linejoin": "round",
    }


def chart_svg(
    chart: Chart,
    axis: Axis,
    gaps: tuple[tuple[float, float, str], ...],
    silent: tuple[float, ...],
    width: float,
    height: float,
) -> str:
    """Return the picture of a chart, `width` by `height` points, without its labels.

    Args:
        chart: The chart.
        axis: The chainage axis.
        gaps: Stretches to shade.
        silent: Chainages to mark at the top.
        width: Of the drawn area [pt].
        height: Of the drawn area [pt].
    """
    parts = []
    for low, high, _ in gaps:
        span = max((high - low) / (axis.high - axis.low) * width, 0.6)
        parts.append(_box(axis.share(low) * width, 0.0, span, height, fill=_GAP))
    parts += [_level(height * (1 - chart.axis.share(tick)), width, _stroke(_GRID, 0.5)) for tick in chart.axis.ticks]
    for band, path in zip(chart.bands, chart.band_paths, strict=True):
        parts.append(_path(scaled(path, width, height), fill=band.colour, fill_opacity=0.16))
    for _, value in chart.levels:
        parts.append(_level(height * (1 - chart.axis.share(value)), width, _stroke("#6b7480", 0.8, "5 4")))
    for line, path in reversed(list(zip(chart.lines, chart.paths, strict=True))):
        parts.append(_path(scaled(path, width, height), **_stroke(line.colour, 0.8, line.dash)))
    for at in silent:
        parts.append(_path(f"M{axis.share(at) * width - 2:.2f} 0h4l-2 3.4Z", fill="#7d8792"))
    return _svg(parts, width, height)


def _level(y: float, width: float, style: dict[str, object]) -> str:
    return _path(f"M0 {y:.2f}H{width:g}", **style)


def swatch_svg(kind: str, colour: str, dash: str = "") -> str:
    """Return the sample of a line, band, level, dot or chip that stands in a legend, 18 by 6 points."""
    if kind == "band":
        return _svg([_path("M0 3H18", stroke=colour, stroke_width=6, stroke_opacity=0.16)], 18, 6)
    if kind == "dot":
        return _svg([f'<circle cx="3" cy="3" r="1.6" fill={quoteattr(colour)}/>'], 6, 6)
    if kind == "chip":
        return _svg([_box(0.3, 0.3, 9.4, 5.4, fill=colour, stroke="#aab2bb", stroke_width=0.5)], 10, 6)
    return _svg([_path("M0 3H18", **_stroke(colour, 1.1, dash))], 18, 6)


def plan_svg(plan: Plan, width: float) -> str:
    """Return the picture of the plan, `width` points wide."""
    height = width * plan.aspect
    parts = [_level(height * (1 - plan.up.share(tick)), width, _stroke(_GRID, 0.5)) for tick in plan.up.ticks]
    across = [f"M{width * plan.across.share(tick):.2f} 0V{height:.2f}" for tick in plan.across.ticks]
    parts += [_path(line, **_stroke(_GRID, 0.5)) for line in across]
    parts.append(_path(scaled(plan.path, width, height), **_stroke("#1c4f7c", 1.6)))
    return _svg(parts, width, height)


def section_svg(drawing: Drawing) -> str:
    """Return the picture of a section: a square of 304 units about its centre, without its labels."""
    dots = {"stroke_width": 2.2, "stroke_linecap": "round", "fill": "none"}
    parts = [
        _path("M-140 0H140M0 -140V140", stroke="#eceff2", stroke_width=1, fill="none"),
        '<circle r="100" fill="none" stroke="#6b7480" stroke-width="1.2" stroke-dasharray="5 4"/>',
    ]
    for chord in drawing.chords:
        ends = f"M{chord.start[0]:.1f} {chord.start[1]:.1f}L{chord.end[0]:.1f} {chord.end[1]:.1f}"
        parts.append(_path(ends, stroke=chord.colour, stroke_width=1.2, stroke_dasharray="2.5 2.5", fill="none"))
    parts += [_path(path, stroke=colour, **dots) for _, colour, path in drawing.unused]
    parts.append(_path(drawing.used, stroke="#1d2733", **dots))
    parts.append(_path(drawing.fit, stroke="#c0392b", stroke_width=1.6, fill="none"))
    length = drawing.bar[0]
    parts.append(_path(f"M-146 -144h{length:.1f}m0 -3v6M-146 -147v6", stroke="#1d2733", stroke_width=1.2, fill="none"))
    return _svg(parts, 304, 304, (-152, -152))


def residuals_svg(residuals: Residuals, width: float, height: float) -> str:
    """Return the picture of residuals by clock, without its labels."""
    grid = f"M0 {height / 2:g}H{width:g}" + "".join(f"M{width * k / 4:g} 0V{height:g}" for k in (1, 2, 3))
    dots = scaled(residuals.dots, width, height, RESIDUAL_BOX)
    style = {"stroke": "#1d2733", "stroke_width": 0.9, "stroke_linecap": "round", "fill": "none"}
    frame = _box(0.25, 0.25, width - 0.5, height - 0.5, fill="none", stroke="#8b95a1", stroke_width=0.5)
    return _svg([_path(grid, **_stroke(_GRID, 0.5)), frame, _path(dots, **style)], width, height)
