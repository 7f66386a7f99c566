"""The buried layout: plan, profile, gradient, sag and bends, or why the survey cannot tell."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from .along import Missing, chart_lines, interval
from .charts import BLUE, BOX, INK, ORANGE, Chart, Line, axis_over, drawn
from .profiles import Axis, make_axis

if TYPE_CHECKING:
    import pandas as pd

    from ..results import Results
    from .profiles import Profiles
    from .scales import Scales

_POINTS = 600
_SLIMMEST, _TALLEST = 0.28, 0.6
_APART = 0.05


@dataclass(frozen=True)
class Plan:
    """The pipe seen from above, to one scale in both directions.

    Attributes:
        unit: Of both axes.
        across: Easting.
        up: Northing.
        aspect: Height over width of the drawn box.
        path: The centreline in the box.
        marks: Share of the width, share of the height from the top, and label of ends and features; no label where
            another one stands already.
        note: What the coordinates refer to.
    """

    unit: str
    across: Axis
    up: Axis
    aspect: float
    path: str
    marks: tuple[tuple[float, float, str], ...]
    note: str


def make_layout(
    results: Results, profiles: Profiles, scales: Scales, features: pd.DataFrame
) -> tuple[Plan | None, list[Chart], list[Missing]]:
    """Return the plan, the charts of the layout, and what is missing with the reason.

    Args:
        results: The finished survey; `/layout` may be missing.
        profiles: The chainage axis.
        scales: Printed units.
        features: Rows of `features.csv`, marked on the plan by their number.
    """
    plan = _plan(results, scales, features)
    held = (_deviation, _deviation_gradient) if results.survey.has("design_line") else ()
    made = [maker(results, profiles, scales) for maker in (_elevation, _sag, _gradient, _bend, *held)]
    charts = [drawn(profiles, one) for one in made if isinstance(one, Chart)]
    missing = [one for one in made if isinstance(one, Missing)]
    if plan is None:
        missing.insert(0, Missing("plan", "Plan", _why(results, "axis")))
    return plan, charts, missing


def _why(results: Results, quantity: str) -> str:
    """Return why the layout lacks something: its own reason, or what was not recorded."""
    survey = results.survey
    if survey.has("layout"):
        reasons = json.loads(survey.layout.attrs.get("why_missing", "{}"))
        reason = str(reasons.get(quantity) or reasons.get("axis") or "The layout that was solved for does not hold it.")
        return reason[:1].upper() + reason[1:]
    if survey.has("inertial"):
        return "An inertial log was recorded, but the layout was not solved for."
    if survey.has("ties"):
        return "There are tie points but no inertial log, so the way between them is unknown."
    return "There is neither an inertial log nor a tie point, so the way through the ground is unknown."


def _elevation(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    length = scales.length
    lines = chart_lines(results, profiles, length.factor, (("elevation", "pipe’s axis", INK, ""),), "layout")
    if not lines:
        return Missing("elevation", "Elevation", _why(results, "elevation"))
    bands = interval(results, profiles, length.factor, "elevation", "95 % interval", "layout")
    z = results.judged("elevation", "layout") * length.factor
    known = np.flatnonzero(np.isfinite(z))
    first, last = known[0], known[-1]
    if last > first:
        grade = np.interp(results.chainage, results.chainage[[first, last]], z[[first, last]], np.nan, np.nan)
        lines += (Line("straight between its ends", ORANGE, "7 3", *profiles.thin(grade)),)
    axis = axis_over(lines, bands, least=0.01 * length.factor)
    return Chart("elevation", "Elevation", length.name, axis, 3, lines, bands, note=_datum(results))


def _sag(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title, small = "Sag", scales.small
    elevation = results.judged("elevation", "layout")
    if np.isfinite(elevation).sum() < 2:
        return Missing("sag", title, _why(results, "elevation"))
    depth = standing_water(elevation) * small.factor
    lines = (Line("depth of standing water", BLUE, "", *profiles.thin(depth)),)
    axis = axis_over(lines, floor=0.0, least=1e-3 * small.factor)
    note = "How deep water would stand, by the elevation above; what its interval holds is no sag."
    return Chart("sag", title, small.name, axis, 1 + small.decimals, lines, note=note)


def standing_water(elevation: np.ndarray) -> np.ndarray:
    """Return how deep water stands at each station when the pipe is filled and drains at both ends [m].

    Args:
        elevation: Of the stations in their order [m]; NaN where unknown.

    >>> standing_water(np.array([2.0, 1.0, 1.5, 0.5])).tolist()
    [0.0, 0.5, 0.0, 0.0]
    """
    before, after = np.fmax.accumulate(elevation), np.fmax.accumulate(elevation[::-1])[::-1]
    return np.minimum(before, after) - elevation


def _gradient(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    lines = chart_lines(results, profiles, 1e2, (("gradient", "gradient", INK, ""),), "layout")
    if not lines:
        return Missing("gradient", "Gradient", _why(results, "gradient"))
    bands = interval(results, profiles, 1e2, "gradient", "95 % interval", "layout")
    axis = axis_over(lines, bands, levels=(0.0,), least=0.1)
    return Chart("gradient", "Gradient", "%", axis, 3, lines, bands, note="Positive where the pipe rises along travel.")


def _bend(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title, length = "Bend, radius of the axis", scales.length
    lines = chart_lines(results, profiles, length.factor, (("bend_radius", "radius", INK, ""),), "layout")
    if not lines:
        if results.survey.has("layout") and "bend_radius" in results.survey.layout:
            return Missing("bend", title, "The pipe has no bend that could be told from a straight run.")
        return Missing("bend", title, _why(results, "bend_radius"))
    bands = interval(results, profiles, length.factor, "bend_radius", "95 % interval", "layout")
    axis = axis_over(lines, floor=0.0, least=0.1 * length.factor)
    return Chart(
        "bend", title, length.name, axis, 2, lines, bands, note="Nothing is drawn where the pipe runs straight."
    )


def _deviation(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title, small = "Deviation from the design line", scales.small
    rows = (("deviation_up", "up", INK, ""), ("deviation_right", "to the right", ORANGE, "7 3"))
    lines = chart_lines(results, profiles, small.factor, rows, "layout")
    if not lines:
        return Missing("deviation", title, _why(results, "deviation_up"))
    bands = interval(results, profiles, small.factor, "deviation_up", "95 % interval of up", "layout")
    attrs = results.survey.layout.attrs
    note = f"Of the {attrs.get('design_line', 'axis')}."
    if (datum := attrs.get("design_datum", "absolute")) != "absolute":
        note += f" Nothing tells the height: up counts from the station at {scales.length.text(float(datum), 2)}."
    if reason := json.loads(attrs.get("why_missing", "{}")).get("deviation_right"):
        note += f" To the right it is not known: {reason}."
    axis = axis_over(lines, bands, levels=(0.0,), least=1e-3 * small.factor)
    return Chart("deviation", title, small.name, axis, 1 + small.decimals, lines, bands, note=note)


def _deviation_gradient(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title = "Gradient less that of the design line"
    lines = chart_lines(results, profiles, 1e2, (("deviation_gradient", "difference", INK, ""),), "layout")
    if not lines:
        return Missing("deviation_gradient", title, _why(results, "deviation_gradient"))
    bands = interval(results, profiles, 1e2, "deviation_gradient", "95 % interval", "layout")
    axis = axis_over(lines, bands, levels=(0.0,), least=0.1)
    return Chart("deviation_gradient", title, "%", axis, 3, lines, bands, note="Positive where the pipe rises more.")


def _datum(results: Results) -> str:
    attrs = results.survey.layout.attrs
    if attrs.get("frame", "ties") == "local":
        return "From where the first ring was taken, ahead as the robot did: nothing tells the way north."
    crs = attrs.get("crs") or results.survey.attrs.get("crs")
    return f"Tied to known points{f', {crs}' if crs else ''}."


def _plan(results: Results, scales: Scales, features: pd.DataFrame) -> Plan | None:
    factor = scales.length.factor
    east, north = (results.judged(name, "layout") * factor for name in ("easting", "northing"))
    known = np.flatnonzero(np.isfinite(east + north))
    if known.size < 2:
        return None
    x, y = east[known], north[known]
    low_x, high_x, low_y, high_y = float(x.min()), float(x.max()), float(y.min()), float(y.max())
    width, height = high_x - low_x, high_y - low_y
    size = max(width, height, 0.5 * factor)
    width = max(1.16 * width, 1.16 * size if width >= height else size * 1.1, (height * 1.16) / _TALLEST)
    height = max(1.16 * (high_y - low_y), _SLIMMEST * width)
    across = make_axis((low_x + high_x - width) / 2, (low_x + high_x + width) / 2, ticks=6, tight=True)
    up = make_axis((low_y + high_y - height) / 2, (low_y + high_y + height) / 2, ticks=3, tight=True)
    take = known[np.unique(np.linspace(0, known.size - 1, _POINTS).astype(int))]
    path = "M" + "L".join(
        f"{a:.1f} {b:.1f}"
        for a, b in zip(across.share(east[take]) * BOX, (1 - up.share(north[take])) * BOX, strict=True)
    )

    def place(station: int, label: str) -> tuple[float, float, str]:
        return float(across.share(east[station])), float(1 - up.share(north[station])), label

    marks = [place(known[0], "start"), place(known[-1], "end")]
    for number, (at, clock) in enumerate(zip(features["chainage_m"], features["clock_h"], strict=True), 1):
        # What goes all the way round, such as every joint, would hide the line.
        if not (isfinite(at) and isfinite(clock)):
            continue
        mark = place(known[np.argmin(np.abs(results.chainage[known] - at))], str(number))
        near = any(label and abs(mark[0] - a) < _APART and abs(mark[1] - b) < 2 * _APART for a, b, label in marks)
        marks.append((*mark[:2], "" if near else mark[2]))
    return Plan(scales.length.name, across, up, height / width, path, tuple(marks), _datum(results))
