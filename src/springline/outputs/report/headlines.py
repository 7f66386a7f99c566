"""The numbers at the top: each with its 95 % interval and where it stands."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from ...conventions import clock_from_bearing
from ..results import worst_station
from ..summary import summary
from .texts import SIGMAS_95, clock_text, measured, number

if TYPE_CHECKING:
    from ..results import Results


@dataclass(frozen=True)
class Headline:
    """One number at the top: value, unit, its 95 % interval and where it stands."""

    label: str
    value: str
    unit: str
    interval: str = ""
    note: str = ""
    chainage: float | None = None


def make_headlines(results: Results) -> tuple[Headline, ...]:
    """Return the headlines, in the order in which they stand."""
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
    if not isfinite(mean):
        return Headline("Mean diameter (area)", "–", "mm", note="Not available.")
    value, half = measured(mean, SIGMAS_95 * sigma, least=1)
    halves = [measured(0, SIGMAS_95 * part)[1] for part in (fit, scale)]
    parts = f"fit ±\u00a0{halves[0]}\u00a0mm, sensor’s scale ±\u00a0{halves[1]}\u00a0mm"
    note = f"Of this: {parts}." if isfinite(fit) and isfinite(scale) else ""
    interval = f"±\u00a0{half}\u00a0mm (95\u00a0%)" if isfinite(sigma) else "uncertainty not available"
    return Headline("Mean diameter (area)", value, "mm", interval, note)


def _ovality(results: Results) -> Headline:
    values = results.judged("ovality_polar") * 1e2
    at = worst_station(values)
    if at is None:
        return Headline("Largest ovality", "–", "%", note="No station has a section.")
    low, high = (results.metric(f"ovality_polar_{end}")[at] * 1e2 for end in ("low", "high"))
    value, _ = measured(values[at], (high - low) / 2, least=2, most=2)
    interval = f"{number(max(low, 0.0), 2)} to {number(high, 2)} % (95 %)" if isfinite(high) else ""
    note = "A circle lies within the interval." if low <= 0 else ""
    return Headline("Largest ovality", value, "%", interval, note, float(results.chainage[at]))


def _largest_of(results: Results, variable: str, label: str, otherwise: str) -> Headline:
    values = results.judged(variable) * 1e2
    at = worst_station(values)
    if at is None:
        return Headline(label, "–", "%", note=otherwise)
    half = SIGMAS_95 * results.metric(f"{variable}_sigma")[at] * 1e2
    value, text = measured(values[at], half, least=1, most=2)
    interval = f"±\u00a0{text}\u00a0% (95\u00a0%)" if isfinite(half) else ""
    note = "Zero lies within the interval." if abs(values[at]) < half else ""
    return Headline(label, value, "%", interval, note, float(results.chainage[at]))


def _deepest(results: Results) -> Headline:
    label = "Deepest local dent or deposit"
    inward = -results.judged("deviation_in", "section") * 1e3
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
