"""The numbers at the top: each with its 95 % interval and where it stands."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from ...conventions import clock_from_bearing
from ..results import worst_station
from ..summary import summary
from .texts import SIGMAS_95, clock_text, measured, number

INWARD = ("dent", "deposit", "intrusion")
"""Kinds of features that stand inward of the wall."""

if TYPE_CHECKING:
    from ..results import Results
    from .scales import Scales


@dataclass(frozen=True)
class Headline:
    """One number at the top: value, unit, its 95 % interval and where it stands."""

    label: str
    value: str
    unit: str
    interval: str = ""
    note: str = ""
    chainage: float | None = None


def make_headlines(results: Results, scales: Scales) -> tuple[Headline, ...]:
    """Return the headlines, in the order in which they stand."""
    return (
        _mean_diameter(results, scales),
        _ovality(results),
        _largest_of(results, "deflection", "Largest deflection", "Needs a nominal or base diameter."),
        _largest_of(results, "area_loss", "Largest loss of area", "Needs a nominal or base diameter."),
        _deepest(results, scales),
        _seen(results, scales),
    )


def _mean_diameter(results: Results, scales: Scales) -> Headline:
    small = scales.small
    mean, sigma, fit, scale = (
        results.metrics_attr(name)
        for name in ("diameter_mean", "diameter_sigma", "diameter_sigma_fit", "diameter_sigma_scale")
    )
    if not isfinite(mean):
        return Headline("Mean diameter (area)", "–", small.name, note="Not available.")
    value, half = small.measured(mean, SIGMAS_95 * sigma, least=1)
    halves = [small.measured(0, SIGMAS_95 * part)[1] for part in (fit, scale)]
    parts = f"fit ±\u00a0{halves[0]}\u00a0{small.name}, sensor’s scale ±\u00a0{halves[1]}\u00a0{small.name}"
    note = f"Of this: {parts}." if isfinite(fit) and isfinite(scale) else ""
    interval = f"±\u00a0{half}\u00a0{small.name} (95\u00a0%)" if isfinite(sigma) else "uncertainty not available"
    return Headline("Mean diameter (area)", value, small.name, interval, note)


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


def _deepest(results: Results, scales: Scales) -> Headline:
    """Return the deepest feature that stands inward: single stray readings are none, however far off they lie."""
    label, small = "Deepest dent or deposit", scales.small
    if not results.survey.has("features"):
        return Headline(label, "–", small.name, note="Not assessed.")
    found = results.survey.features
    inward = np.isin(found["kind"].values, INWARD) & (found["depth"].values < 0)
    if not inward.any():
        return Headline(label, "–", small.name, note="None was found.")
    at = int(np.flatnonzero(inward)[np.argmin(found["depth"].values[inward])])
    kind, chainage = str(found["kind"].values[at]), float(found["chainage"].values[at])
    clock = float(clock_from_bearing(found["bearing"].values[at])) if "bearing" in found else float("nan")
    half = SIGMAS_95 * float(found["depth_sigma"].values[at]) if "depth_sigma" in found else float("nan")
    interval = f"±\u00a0{small.number(half, 1)}\u00a0{small.name} (95\u00a0%)" if isfinite(half) else ""
    note = f"A {kind}" + (f" at {clock_text(clock)}" if isfinite(clock) else "") + ", inward of the pipe's section."
    return Headline(label, small.number(-float(found["depth"].values[at]), 1), small.name, interval, note, chainage)


def _seen(results: Results, scales: Scales) -> Headline:
    coverage, length = summary(results.survey)["coverage_pct"], scales.length
    unseen, whole = length.text(results.unseen, 2), length.text(results.length, 2)
    note = f"{unseen} of {whole} unseen (under 50 %, or without stations)."
    return Headline("Coverage", "–" if coverage is None else f"{coverage:.1f}", "%", note=note)
