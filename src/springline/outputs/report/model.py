"""What the report says, as plain values: any rendering (HTML now) draws this and computes nothing."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import __version__
from ..tables import features_table
from .charts import Chart, make_charts
from .drawing import Drawing, draw_section
from .headlines import Headline, make_headlines
from .listings import (
    Table,
    features_listing,
    readings_table,
    rules_table,
    statuses_table,
    stretches_table,
    worst_stations,
    worst_table,
)
from .maps import Map, make_maps
from .profiles import Axis, Profiles
from .texts import number

if TYPE_CHECKING:
    from ..results import Results
    from ..unroll import Unrolled


@dataclass(frozen=True)
class Report:
    """Everything that the report shows."""

    name: str
    facts: tuple[tuple[str, str], ...]
    headlines: tuple[Headline, ...]
    warnings: tuple[str, ...]
    assumptions: tuple[str, ...]
    rules: Table
    axis: Axis
    charts: tuple[Chart, ...]
    maps: tuple[Map, ...]
    gaps: tuple[tuple[float, float, str], ...]
    features: Table
    marks: tuple[tuple[float, float, str], ...]
    looked_for_features: bool
    worst_words: str
    drawings: tuple[Drawing, ...]
    worst: Table
    stretches: Table
    readings: Table
    statuses: Table
    method: dict[str, Any]
    inputs: tuple[dict[str, Any], ...]
    command: str
    config_toml: str
    version: str
    hover: dict[str, Any]


def make_report(results: Results, wall: Unrolled, config_toml: str) -> Report:
    """Return the report's model.

    Args:
        results: The finished survey.
        wall: Its unrolled wall.
        config_toml: The resolved settings as TOML.
    """
    profiles = Profiles(results)
    charts = make_charts(results, profiles)
    worst, words = worst_stations(results)
    features = features_table(results.survey)
    attrs = results.survey.attrs
    return Report(
        name=str(attrs.get("name") or "Pipe without a name"),
        facts=_facts(results),
        headlines=make_headlines(results),
        warnings=tuple(results.survey.warnings),
        assumptions=tuple(results.survey.assumptions),
        rules=rules_table(results),
        axis=profiles.axis,
        charts=tuple(charts),
        maps=tuple(make_maps(wall, profiles.axis)),
        gaps=_gaps(results, profiles),
        features=features_listing(features),
        marks=_marks(features),
        looked_for_features=results.survey.has("features"),
        worst_words=words,
        drawings=_drawings(results, worst),
        worst=worst_table(results, worst),
        stretches=stretches_table(results),
        readings=readings_table(results),
        statuses=statuses_table(results),
        method=_method(results),
        inputs=tuple(results.provenance.get("inputs", ())),
        command=_command(results),
        config_toml=config_toml,
        version=str(results.provenance.get("version", __version__)),
        hover=_hover(profiles, charts),
    )


def _facts(results: Results) -> tuple[tuple[str, str], ...]:
    attrs, rings = results.survey.attrs, results.survey.rings.attrs

    def millimetres(key: str) -> str:
        value = attrs.get(key)
        return f"{float(value) * 1e3:g} mm" if value is not None and isfinite(float(value)) else ""

    rows = (
        ("Nominal diameter", millimetres("nominal_diameter")),
        ("Base diameter", millimetres("base_diameter")),
        ("Wall thickness", millimetres("wall_thickness")),
        ("Material", attrs.get("material")),
        ("Direction", attrs.get("direction")),
        ("Date", attrs.get("date")),
        ("Operator", attrs.get("operator")),
        ("Equipment", attrs.get("equipment")),
        ("Sensor", str(rings.get("sensor_kind", "")).replace("-", " ")),
    )
    return tuple((label, str(value)) for label, value in rows if value)


def _gaps(results: Results, profiles: Profiles) -> tuple[tuple[float, float, str], ...]:
    without = [(a, b, "no section") for a, b in profiles.spans(~np.isfinite(results.metric("diameter_area")))]
    return tuple(without + [(a, b, "no readings") for a, b in profiles.gaps()])


def _marks(table: Any) -> tuple[tuple[float, float, str], ...]:
    """Return chainage, share from the top of a map, and number of each feature that can be placed on it."""
    return tuple(
        (float(row.chainage_m), ((6.0 - row.clock_h) / 12.0) % 1.0, str(k))
        for k, row in enumerate(table.itertuples(), 1)
        if isfinite(row.clock_h)
    )


def _drawings(results: Results, worst: list[int]) -> tuple[Drawing, ...]:
    if not worst:
        return ()
    reference = results.metrics_attr("reference_diameter")
    circle = reference if isfinite(reference) else results.circle_diameter
    plain, large = (draw_section(results, worst[0], circle, exaggerate=large) for large in (False, True))
    return (plain, large) if large.exaggeration > 1 else (plain,)


def _method(results: Results) -> dict[str, Any]:
    section, rings = results.survey.section.attrs, results.survey.rings.attrs
    scale = section.get("range_scale_sigma")
    return {
        "model": section.get("model", "ellipse"),
        "scale_pct": None if scale is None else f"{float(scale) * 1e2:g}",
        "scale_source": section.get("range_scale_source", ""),
        "bearings": results.bearing.size,
        "stations": results.stations,
        "spacing_mm": f"{results.spacing * 1e3:.1f}",
        "referred_to": rings.get("referred_to", "sensor"),
        "reference": number(results.metrics_attr("reference_diameter") * 1e3, 1),
        "reference_kind": results.survey.metrics.attrs.get("reference_kind", "none"),
    }


def _command(results: Results) -> str:
    names = [str(item.get("name", "INPUT")) for item in results.provenance.get("inputs", ())] or ["INPUT"]
    nominal = results.survey.attrs.get("nominal_diameter")
    size = f" --nominal {float(nominal) * 1e3:g}mm" if nominal is not None else ""
    return f"springline inspect {' '.join(shlex.quote(n) for n in names)}{size} --config config.toml -o DIR"


def _hover(profiles: Profiles, charts: list[Chart]) -> dict[str, Any]:
    """Return the thinned values that the page shows under the pointer; null where there is none."""

    def plain(values: np.ndarray, decimals: int) -> list[float | None]:
        return [round(v, decimals) if isfinite(v) else None for v in values.tolist()]

    return {
        "low": profiles.axis.low,
        "high": profiles.axis.high,
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
