"""The charts of section, losses, coverage and liner along the pipe, for which the survey has values.

Stations that do not speak for the pipe (joints, misread rings) are left out of the lines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .charts import BLUE, GREEN, INK, ORANGE, PURPLE, Band, Chart, Line, axis_over, drawn
from .limits import rule_limits
from .profiles import Axis
from .texts import SIGMAS_95

if TYPE_CHECKING:
    from ..results import Results
    from .profiles import Profiles
    from .scales import Scales


@dataclass(frozen=True)
class Missing:
    """Something that a complete report shows and this one cannot, with the reason."""

    key: str
    title: str
    reason: str


def by_reason(missing: tuple[Missing, ...]) -> list[tuple[str, str]]:
    """Return what is missing as titles joined and their common reason, in the order in which the reasons come."""
    titles: dict[str, list[str]] = {}
    for one in missing:
        titles.setdefault(one.reason, []).append(one.title)
    return [("; ".join(names), reason) for reason, names in titles.items()]


def make_charts(results: Results, profiles: Profiles, scales: Scales) -> tuple[list[Chart], list[Missing]]:
    """Return the charts, and what is missing with the reason."""
    makers = (_diameters, _ovalities, _deflections, _losses, _coverage, _liner)
    made = [maker(results, profiles, scales) for maker in makers]
    if results.stations == 1:
        reason = "There is a single station; its values stand in the tables."
        return [], [Missing(one.key, one.title, one.reason if isinstance(one, Missing) else reason) for one in made]
    charts = [drawn(profiles, one) for one in made if isinstance(one, Chart)]
    return charts, [one for one in made if isinstance(one, Missing)]


def chart_lines(
    results: Results,
    profiles: Profiles,
    factor: float,
    rows: tuple[tuple[str, str, str, str], ...],
    group: str = "metrics",
) -> tuple[Line, ...]:
    """Return a line for each variable (name, label, colour, dash) of a station group that has values."""
    lines = []
    for variable, label, colour, dash in rows:
        values = results.judged(variable, group)
        if np.isfinite(values).any():
            lines.append(Line(label, colour, dash, *profiles.thin(values * factor)))
    return tuple(lines)


def interval(
    results: Results, profiles: Profiles, factor: float, variable: str, label: str, group: str = "metrics"
) -> tuple[Band, ...]:
    """Return the 95 % interval of a variable as a band, or nothing when it has no sigma."""
    value, sigma = results.judged(variable, group), results.judged(f"{variable}_sigma", group)
    if not np.isfinite(value + sigma).any():
        return ()
    low, high = ((value + side * SIGMAS_95 * sigma) * factor for side in (-1, 1))
    return (Band(label, INK, profiles.thin(low)[0], profiles.thin(high)[1]),)


def _no_section(results: Results) -> str:
    return "No station has a section." if not np.isfinite(results.metric("diameter_area")).any() else ""


def _no_reference(results: Results) -> str:
    return _no_section(results) or "It needs a nominal or base diameter, and none was given."


def _diameters(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title, small = "Diameters", scales.small
    lines = chart_lines(
        results,
        profiles,
        small.factor,
        (
            ("diameter_max", "largest", ORANGE, ""),
            ("diameter_min", "smallest", BLUE, ""),
            ("diameter_x", "horizontal (X)", GREEN, "7 3"),
            ("diameter_y", "vertical (Y)", PURPLE, "2 3"),
        ),
    )
    if not lines:
        return Missing("diameter", title, _no_section(results) or "No station that speaks for the pipe has diameters.")
    value = results.metrics_attr("reference_diameter")
    kind = results.survey.metrics.attrs.get("reference_kind", "reference")
    levels = ((f"{kind} {small.plain(value)}", value * small.factor),) if np.isfinite(value) else ()
    axis = axis_over(lines, levels=tuple(v for _, v in levels), least=2e-4 * small.factor)
    note = "Chords of the fitted section."
    return Chart("diameter", title, small.name, axis, 2 + small.decimals, lines, levels=levels, note=note)


def _ovalities(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title = "Ovality, (largest − mean) / mean"
    lines = chart_lines(
        results,
        profiles,
        1e2,
        (
            ("ovality_polar", "polar mean", INK, ""),
            ("ovality_axes", "axes mean", BLUE, "7 3"),
            ("ovality_area", "area mean", GREEN, "2 3"),
            ("ovality_caliper", "caliper mean", ORANGE, "9 3 2 3"),
        ),
    )
    if not lines:
        return Missing("ovality", title, _no_section(results) or "No station that speaks for the pipe has an ovality.")
    low, high = (results.judged(f"ovality_polar_{end}") * 1e2 for end in ("low", "high"))
    bands: tuple[Band, ...] = ()
    if np.isfinite(low).any():
        bands = (Band("95 % interval of the polar one", INK, profiles.thin(low)[0], profiles.thin(high)[1]),)
    axis = axis_over(lines, bands, floor=0.0, least=0.1)
    return Chart("ovality", title, "%", axis, 3, lines, bands, note="By each of the four mean diameters.")


def _deflections(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    lines = chart_lines(
        results,
        profiles,
        1e2,
        (
            ("deflection", "deflection", INK, ""),
            ("deflection_x", "horizontal, signed", GREEN, "7 3"),
            ("deflection_y", "vertical, signed", PURPLE, "2 3"),
        ),
    )
    if not lines:
        return Missing("deflection", "Deflection", _no_reference(results))
    bands = interval(results, profiles, 1e2, "deflection", "95 % interval")
    levels = tuple((label, limit * 1e2) for label, limit in rule_limits(results.survey, "deflection"))
    kind = results.survey.metrics.attrs.get("reference_kind", "reference")
    note = f"Against the {kind} diameter of {scales.small.plain(results.metrics_attr('reference_diameter'))}."
    if not levels:
        note += " No limit is drawn, because no rule was asked for."
    axis = axis_over(lines, bands, floor=0.0, levels=tuple(v for _, v in levels), least=0.1)
    return Chart("deflection", "Deflection", "%", axis, 3, lines, bands, levels, note=note)


def _losses(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title = "Loss of area and capacity"
    lines = chart_lines(
        results,
        profiles,
        1e2,
        (("area_loss", "area", BLUE, ""), ("capacity_loss", "full-flow capacity (Manning)", ORANGE, "7 3")),
    )
    if not lines:
        return Missing("loss", title, _no_reference(results))
    return Chart(
        "loss", title, "%", axis_over(lines, floor=0.0, least=0.1), 3, lines, note="Negative where the pipe is larger."
    )


def _coverage(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title = "Coverage, used over possible readings"
    if not np.isfinite(results.coverage).any():
        return Missing("coverage", title, "The survey does not say which readings were used.")
    line = Line("used readings", BLUE, "", *profiles.thin(results.coverage * 1e2))
    levels = (("50 %: below it a station counts as unseen", 50.0),)
    axis = Axis(0.0, 100.0, (0.0, 50.0, 100.0), 0)
    return Chart("coverage", title, "%", axis, 1, (line,), levels=levels)


def _liner(results: Results, profiles: Profiles, scales: Scales) -> Chart | Missing:
    title, small = "Required liner thickness", scales.small
    rows = (("liner_thickness", "required", INK, ""), ("liner_standard", "next thickness made", BLUE, "7 3"))
    lines = chart_lines(results, profiles, small.factor, rows, group="design")
    if not lines:
        return Missing(
            "liner", title, "No liner was designed; the command springline design does so along an inspected pipe."
        )
    bands = interval(results, profiles, small.factor, "liner_thickness", "95 % interval of the required one", "design")
    attrs = results.survey.design.attrs
    note = f"By {attrs.get('rule', 'the chosen rule')}, edition {attrs.get('edition', 'not stated')}."
    return Chart(
        "liner",
        title,
        small.name,
        axis_over(lines, bands, floor=0.0, least=1e-3 * small.factor),
        2,
        lines,
        bands,
        note=note,
    )
