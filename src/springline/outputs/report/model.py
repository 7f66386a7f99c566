"""What the report says, as plain values: page and PDF draw this and compute nothing."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import __version__
from ...conventions import NOT_SPEAKING, flagged
from ..tables import features_table
from . import listings
from .along import Missing, make_charts
from .definitions import definitions_table
from .drawing import Drawing, draw_section
from .facts import command, cover_facts
from .headlines import Headline, make_headlines
from .layout import Plan, make_layout
from .layout_lists import angles_table, bends_table, sags_table
from .maps import Map, make_maps
from .marks import Mark, make_marks
from .pictures import Picture, make_pictures
from .profiles import Axis, Profiles
from .scales import Scales, make_scales
from .sight import readings_table, statuses_table, unseen_table
from .words import Words, make_words

if TYPE_CHECKING:
    from ..results import Results
    from ..unroll import Unrolled
    from .charts import Chart
    from .listings import Table

_SILENT_MARKS = 400


@dataclass(frozen=True)
class Report:
    """Everything that the report shows, as texts, paths and pictures.

    Attributes:
        scales: Printed units.
        facts: Lines of the cover.
        axis: The chainage axis of all charts and maps.
        charts: Of section and liner along the pipe.
        plan: The pipe from above, None when it is not known.
        layout: Charts of the buried layout.
        layout_lists: Bends, sags and angles at joints, those that there are, each with its title.
        missing: Charts along the pipe that a complete report also shows, with the reason why this one does not.
        missing_layout: The same of the layout.
        gaps: Start, end [m] and reason of the stretches without values.
        silent: Chainages [m] of stations that charts and largest values leave out.
        marks: Where the features stand on the maps.
        worst_true: The worst section to scale, None when there is none.
        drawings: The worst sections with departures exaggerated, the worst first.
    """

    name: str
    scales: Scales
    facts: tuple[tuple[str, str], ...]
    headlines: tuple[Headline, ...]
    warnings: tuple[str, ...]
    assumptions: tuple[str, ...]
    rules: Table
    overrides: Table
    axis: Axis
    charts: tuple[Chart, ...]
    plan: Plan | None
    layout: tuple[Chart, ...]
    layout_lists: tuple[tuple[str, Table], ...]
    missing: tuple[Missing, ...]
    missing_layout: tuple[Missing, ...]
    maps: tuple[Map, ...]
    gaps: tuple[tuple[float, float, str], ...]
    silent: tuple[float, ...]
    features: Table
    marks: tuple[Mark, ...]
    pictures: tuple[Picture, ...]
    pictures_note: str
    worst_true: Drawing | None
    drawings: tuple[Drawing, ...]
    worst: Table
    definitions: Table
    stretches: Table
    readings: Table
    statuses: Table
    unseen: Table
    words: Words
    inputs: tuple[dict[str, Any], ...]
    command: str
    config_toml: str
    version: str
    hover: dict[str, Any]


def make_report(results: Results, wall: Unrolled, config_toml: str) -> Report:
    """Return the report's model, in the units of `results.units`.

    Args:
        results: The finished survey.
        wall: Its unrolled wall.
        config_toml: The resolved settings as TOML.
    """
    scales = make_scales(results.units)
    profiles = Profiles(results, scales.length.factor)
    features = features_table(results.survey)
    charts, missing = make_charts(results, profiles, scales)
    plan, layout, missing_layout = make_layout(results, profiles, scales, features)
    worst, ranked_by = listings.worst_stations(results)
    worst_true, drawings = _drawings(results, worst, scales)
    pictures, pictures_note = make_pictures(features, wall, scales)
    gaps, silent, marks = _gaps(results, profiles), _silent(results), make_marks(features, profiles.axis)
    return Report(
        name=str(results.survey.attrs.get("name") or "Pipe without a name"),
        scales=scales,
        facts=cover_facts(results, scales),
        headlines=make_headlines(results, scales),
        warnings=tuple(results.survey.warnings),
        assumptions=tuple(results.survey.assumptions),
        rules=listings.rules_table(results, scales),
        overrides=listings.overrides_table(results),
        axis=profiles.axis,
        charts=tuple(charts),
        plan=plan,
        layout=tuple(layout),
        layout_lists=_layout_lists(results, scales),
        missing=tuple(missing),
        missing_layout=tuple(missing_layout),
        maps=tuple(make_maps(wall, profiles.axis, scales.small)),
        gaps=gaps,
        silent=silent,
        features=listings.features_listing(results, features, scales),
        marks=marks,
        pictures=pictures,
        pictures_note=pictures_note,
        worst_true=worst_true,
        drawings=drawings,
        worst=listings.worst_table(results, worst, scales),
        definitions=definitions_table(results, scales),
        stretches=listings.stretches_table(results, scales),
        readings=readings_table(results),
        statuses=statuses_table(results, scales),
        unseen=unseen_table(results, scales),
        words=make_words(
            results,
            scales,
            ranked_by=ranked_by,
            gaps=bool(gaps),
            silent=bool(silent),
            marks=bool(marks),
            crowded=not all(mark.label for mark in marks),
        ),
        inputs=tuple(results.provenance.get("inputs", ())),
        command=command(results),
        config_toml=config_toml,
        version=str(results.provenance.get("version", __version__)),
        hover=_hover(profiles, [*charts, *layout], scales),
    )


def _layout_lists(results: Results, scales: Scales) -> tuple[tuple[str, Table], ...]:
    made = (
        ("Bends", bends_table(results, scales)),
        ("Sags", sags_table(results, scales)),
        ("Angles of the axis at joints", angles_table(results, scales)),
    )
    return tuple((title, table) for title, table in made if table.rows)


def _gaps(results: Results, profiles: Profiles) -> tuple[tuple[float, float, str], ...]:
    without = [(a, b, "no section") for a, b in profiles.spans(~np.isfinite(results.metric("diameter_area")))]
    return tuple(without + [(a, b, "no readings") for a, b in profiles.gaps()])


def _silent(results: Results) -> tuple[float, ...]:
    if "flags" not in results.survey.section:
        return ()
    at = np.flatnonzero(flagged(results.survey.section["flags"].values, *NOT_SPEAKING))
    # Neighbours share a mark.
    share = np.unique(np.round(results.chainage[at] / max(results.length, 1e-9) * _SILENT_MARKS), return_index=True)[1]
    return tuple(float(c) for c in results.chainage[at[share]])


def _drawings(results: Results, worst: list[int], scales: Scales) -> tuple[Drawing | None, tuple[Drawing, ...]]:
    if not worst:
        return None, ()
    reference = results.metrics_attr("reference_diameter")
    circle = reference if isfinite(reference) else results.circle_diameter
    plain = draw_section(results, worst[0], circle, exaggerate=False, scales=scales)
    return plain, tuple(draw_section(results, at, circle, exaggerate=True, scales=scales) for at in worst)


def _hover(profiles: Profiles, charts: list[Chart], scales: Scales) -> dict[str, Any]:
    """Return the thinned values that the page shows under the pointer; null where there is none."""

    def plain(values: np.ndarray, decimals: int) -> list[float | None]:
        return [round(v, decimals) if isfinite(v) else None for v in values.tolist()]

    return {
        "low": profiles.axis.low,
        "high": profiles.axis.high,
        "factor": scales.length.factor,
        "unit": scales.length.name,
        "start": plain(profiles.start, 3),
        "end": plain(profiles.end, 3),
        "charts": {
            chart.key: {
                "decimals": chart.decimals,
                "unit": chart.unit,
                "lines": [
                    {"low": plain(line.low, chart.decimals), "high": plain(line.high, chart.decimals)}
                    for line in chart.lines
                ],
            }
            for chart in charts
        },
    }
