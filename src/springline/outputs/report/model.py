"""What the report says, as plain values: any rendering (HTML now) draws this and computes nothing."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from math import ceil, floor, isfinite, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import __version__
from ...conventions import FIT_STATUS, MASK_REASONS, clock_from_bearing
from ..results import worst_station
from ..summary import summary
from ..tables import features_table
from ..unroll import REASON_WORDS
from .charts import Chart, make_charts
from .drawing import Drawing, clock_text, draw_section
from .maps import Map, make_maps
from .profiles import Axis, Profiles

if TYPE_CHECKING:
    from ..results import Results
    from ..unroll import Unrolled

_95 = 1.959964
_WORST = 10
_STRETCHES = 20


@dataclass(frozen=True)
class Headline:
    """One number at the top: value, unit, its 95 % interval and where it stands."""

    label: str
    value: str
    unit: str
    interval: str = ""
    note: str = ""
    chainage: float | None = None


@dataclass(frozen=True)
class Table:
    """A table of texts; columns of numbers are aligned right."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: frozenset[int] = frozenset({0})


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
    worst, words = _worst(results)
    features = features_table(results.survey)
    attrs = results.survey.attrs
    return Report(
        name=str(attrs.get("name") or "Pipe without a name"),
        facts=_facts(results),
        headlines=_headlines(results),
        warnings=tuple(results.survey.warnings),
        assumptions=tuple(results.survey.assumptions),
        rules=_rules(results),
        axis=profiles.axis,
        charts=tuple(charts),
        maps=tuple(make_maps(wall, profiles.axis)),
        gaps=_gaps(results, profiles),
        features=_features(features),
        marks=_marks(features),
        looked_for_features=results.survey.has("features"),
        worst_words=words,
        drawings=_drawings(results, worst),
        worst=_worst_table(results),
        stretches=_stretches(results),
        readings=_readings(results),
        statuses=_statuses(results),
        method=_method(results),
        inputs=tuple(results.provenance.get("inputs", ())),
        command=_command(results),
        config_toml=config_toml,
        version=str(results.provenance.get("version", __version__)),
        hover=_hover(profiles, charts),
    )


def measured(value: float, half: float, *, least: int = 0, most: int = 4) -> tuple[str, str]:
    """Return value and half interval as texts, to two significant digits of the half interval.

    >>> measured(299.9383, 1.4698)
    ('299.9', '1.5')
    """
    decimals = least
    if isfinite(half) and half > 0:
        decimals = min(max(1 - floor(log10(half) + 1e-9), least), most)
    return number(value, decimals), number(half, decimals)


def number(value: float, decimals: int) -> str:
    """Return a number as text; a dash when it is not available."""
    return f"{value + 0.0:.{decimals}f}".replace("-", "−") if value is not None and isfinite(value) else "–"


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


def _headlines(results: Results) -> tuple[Headline, ...]:
    return (
        _mean_diameter(results),
        _ovality(results),
        _largest_of(results, "deflection", "Largest deflection", "Needs a nominal or base diameter."),
        _largest_of(results, "area_loss", "Largest loss of area", "Needs a nominal or base diameter."),
        _deepest(results),
        _seen(results),
    )


def _mean_diameter(results: Results) -> Headline:
    mean, sigma, fit, scale = (
        results.metrics_attr(name) * 1e3
        for name in ("diameter_mean", "diameter_sigma", "diameter_sigma_fit", "diameter_sigma_scale")
    )
    value, half = measured(mean, _95 * sigma, least=1)
    parts = (
        f"fit ±\u00a0{measured(0, _95 * fit)[1]}\u00a0mm, sensor’s scale ±\u00a0{measured(0, _95 * scale)[1]}\u00a0mm"
    )
    note = f"Of this: {parts}." if isfinite(fit) and isfinite(scale) else ""
    interval = (
        f"±\u00a0{half}\u00a0mm (95\u00a0%)"
        if isfinite(sigma)
        else "uncertainty not available"
        if isfinite(mean)
        else ""
    )
    return Headline("Mean diameter (area)", value, "mm", interval, note)


def _ovality(results: Results) -> Headline:
    values = results.metric("ovality_polar") * 1e2
    at = worst_station(values)
    if at is None:
        return Headline("Largest ovality", "–", "%", note="No station has a section.")
    low, high = (results.metric(f"ovality_polar_{end}")[at] * 1e2 for end in ("low", "high"))
    value, _ = measured(values[at], (high - low) / 2, least=1, most=2)
    decimals = len(value.split(".")[1])
    interval = f"{number(max(low, 0.0), decimals)} to {number(high, decimals)} % (95 %)" if isfinite(high) else ""
    note = "A circle lies within the interval." if low <= 0 else ""
    return Headline("Largest ovality", value, "%", interval, note, float(results.chainage[at]))


def _largest_of(results: Results, variable: str, label: str, otherwise: str) -> Headline:
    values = results.metric(variable) * 1e2
    at = worst_station(values)
    if at is None:
        return Headline(label, "–", "%", note=otherwise)
    half = _95 * results.metric(f"{variable}_sigma")[at] * 1e2
    value, text = measured(values[at], half, least=1, most=2)
    interval = f"±\u00a0{text}\u00a0% (95\u00a0%)" if isfinite(half) else ""
    note = "Zero lies within the interval." if abs(values[at]) < half else ""
    return Headline(label, value, "%", interval, note, float(results.chainage[at]))


def _deepest(results: Results) -> Headline:
    label = "Deepest local dent or deposit"
    inward = -results.station("section", "deviation_in") * 1e3
    at = worst_station(inward)
    if at is None:
        return Headline(label, "–", "mm", note="Not assessed.")
    clock = float(clock_from_bearing(results.station("section", "deviation_in_bearing")[at]))
    where = f" at {clock_text(clock)}" if isfinite(clock) else ""
    note = f"Inward of the fitted section{where}, averaged over 10° of arc."
    return Headline(label, number(inward[at], 1), "mm", "", note, float(results.chainage[at]))


def _seen(results: Results) -> Headline:
    coverage = summary(results.survey)["coverage_pct"]
    note = f"{results.unseen:.2f} m of {results.length:.2f} m unseen (under 50 %, or without stations)."
    return Headline("Coverage", "–" if coverage is None else f"{coverage:.1f}", "%", note=note)


def _rules(results: Results) -> Table:
    rows = summary(results.survey)["rules"]
    return Table(
        ("Rule", "Edition", "Verdict", "Where"),
        tuple(tuple(str(row.get(key) or "") for key in ("rule", "edition", "verdict", "where")) for row in rows),
        frozenset(range(4)),
    )


def _gaps(results: Results, profiles: Profiles) -> tuple[tuple[float, float, str], ...]:
    without = [(a, b, "no section") for a, b in profiles.spans(~np.isfinite(results.metric("diameter_area")))]
    return tuple(without + [(a, b, "no readings") for a, b in profiles.gaps()])


def _features(table: Any) -> Table:
    headings = (
        "No.",
        "Kind",
        "Chainage [m]",
        "Clock",
        "Size [mm]",
        "Length [mm]",
        "Depth [mm]",
        "Confidence",
        "Source",
    )
    rows = tuple(
        (
            str(k),
            row.kind,
            f"{row.chainage_m:.2f}" + (f" ± {_95 * row.chainage_sigma_m:.2f}" if row.chainage_sigma_m > 0 else ""),
            clock_text(row.clock_h) if isfinite(row.clock_h) else "–",
            number(row.size_mm, 0),
            number(row.length_mm, 0),
            number(row.depth_mm, 1),
            number(row.confidence, 2),
            row.source,
        )
        for k, row in enumerate(table.itertuples(), 1)
    )
    return Table(headings, rows, frozenset({1, 8}))


def _marks(table: Any) -> tuple[tuple[float, float, str], ...]:
    """Return chainage, share from the top of a map, and number of each feature that can be placed on it."""
    return tuple(
        (float(row.chainage_m), ((6.0 - row.clock_h) / 12.0) % 1.0, str(k))
        for k, row in enumerate(table.itertuples(), 1)
        if isfinite(row.clock_h)
    )


def _severity(results: Results) -> tuple[np.ndarray, str]:
    deflection = results.metric("deflection")
    if np.isfinite(deflection).any():
        return deflection, "deflection"
    return results.metric("ovality_polar"), "ovality"


def _worst(results: Results) -> tuple[list[int], str]:
    """Return the worst stations, the worst first and each at least two diameters from those before it."""
    values, word = _severity(results)
    left = np.where(np.isfinite(values), values, -np.inf)
    apart, found = 2.0 * results.circle_diameter, []
    while len(found) < _WORST and np.isfinite(left).any():
        at = int(np.argmax(left))
        found.append(at)
        left[np.abs(results.chainage - results.chainage[at]) < apart] = -np.inf
    return found, word


def _drawings(results: Results, worst: list[int]) -> tuple[Drawing, ...]:
    if not worst:
        return ()
    reference = results.metrics_attr("reference_diameter")
    circle = reference if isfinite(reference) else results.circle_diameter
    plain, large = (draw_section(results, worst[0], circle, exaggerate=large) for large in (False, True))
    return (plain, large) if large.exaggeration > 1 else (plain,)


def _worst_table(results: Results) -> Table:
    columns = (
        ("diameter_max", 1e3, 1),
        ("diameter_min", 1e3, 1),
        ("diameter_x", 1e3, 1),
        ("diameter_y", 1e3, 1),
        ("ovality_polar", 1e2, 2),
        ("deflection", 1e2, 2),
    )
    data = [(results.metric(name) * factor, decimals) for name, factor, decimals in columns]
    clock = clock_from_bearing(results.metric("diameter_max_bearing"))
    rows = tuple(
        (
            number(results.chainage[at], 2),
            *(number(values[at], decimals) for values, decimals in data),
            clock_text(float(clock[at])) if isfinite(clock[at]) else "–",
            number(results.coverage[at] * 1e2, 0),
        )
        for at in _worst(results)[0]
    )
    headings = (
        "Chainage [m]",
        "Largest [mm]",
        "Smallest [mm]",
        "X [mm]",
        "Y [mm]",
        "Ovality [%]",
        "Deflection [%]",
        "Largest at",
        "Coverage [%]",
    )
    return Table(headings, rows, frozenset())


def _stretches(results: Results) -> Table:
    """Return the survey cut into at most twenty stretches of a round length."""
    low, high = results.chainage[0], results.chainage[-1]
    rough = max((high - low) / _STRETCHES, 1e-3)
    decade = 10.0 ** floor(log10(rough))
    step = next(s for s in (1, 2, 5, 10) if s * decade >= rough * (1 - 1e-9)) * decade
    first = floor(low / step + 1e-9)
    decimals = max(0, ceil(-log10(step) - 1e-9))
    place = np.clip(np.floor(results.chainage / step + 1e-9).astype(int) - first, 0, None)
    area, ovality, deflection = (results.metric(n) for n in ("diameter_area", "ovality_polar", "deflection"))
    rows = []
    for k in range(int(place[-1]) + 1):
        at = place == k
        span = (f"{(first + k) * step:.{decimals}f} – {(first + k + 1) * step:.{decimals}f}", str(int(at.sum())))
        if not at.any():
            rows.append((*span, "–", "–", "–", "–", "–"))
            continue
        known = np.isfinite(area[at])
        rows.append(
            (
                *span,
                number(float(np.mean(np.nan_to_num(results.coverage[at]))) * 1e2, 1),
                str(int((~known).sum())),
                number(float(np.mean(area[at][known])) * 1e3 if known.any() else np.nan, 2),
                number(_largest(ovality[at]) * 1e2, 2),
                number(_largest(deflection[at]) * 1e2, 2),
            )
        )
    headings = (
        "Chainage [m]",
        "Stations",
        "Coverage [%]",
        "Without section",
        "Mean diameter [mm]",
        "Largest ovality [%]",
        "Largest deflection [%]",
    )
    return Table(headings, tuple(rows), frozenset())


def _largest(values: np.ndarray) -> float:
    return float(np.nanmax(values)) if np.isfinite(values).any() else float("nan")


def _readings(results: Results) -> Table:
    counts = results.reason_counts
    total = max(sum(counts.values()), 1)
    rows = tuple(
        (REASON_WORDS[MASK_REASONS[flag]], f"{count:,}".replace(",", "\u2009"), f"{100 * count / total:.2f}")
        for flag, count in counts.items()
        if flag in MASK_REASONS
    )
    return Table(("Readings", "Number", "Share [%]"), rows)


def _statuses(results: Results) -> Table:
    start, end = results.extents
    rows = tuple(
        (word, str(int((results.status == flag).sum())), f"{float((end - start)[results.status == flag].sum()):.2f}")
        for flag, word in FIT_STATUS.items()
        if (results.status == flag).any()
    )
    return Table(("Stations", "Number", "Length [m]"), rows)


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
