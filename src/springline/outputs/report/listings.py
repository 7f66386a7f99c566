"""The report's tables: verdicts, features, worst stations, stretches, and what became of readings and stations."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, isfinite, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from ...conventions import clock_from_bearing
from ..results import feature_count
from ..summary import summary
from .texts import SIGMAS_95, clock_text, measured, number

if TYPE_CHECKING:
    from ..results import Results
    from .scales import Scales

_WORST = 10
_STRETCHES = 20

_OPTIONAL = ("Further", "Image")
_WORDS = ("Kind", "Further", "Source", "Image")

LISTED = 2000
"""Features that the list holds at most, so that the page stays below 5 MB."""


@dataclass(frozen=True)
class Table:
    """A table of texts; columns of numbers are aligned right."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: frozenset[int] = frozenset({0})


def rules_table(results: Results, scales: Scales) -> Table:
    """Return the verdict of each rule that was asked for, with the reason and what else must be known."""
    rows = tuple(
        (
            str(row.get("rule") or ""),
            str(row.get("edition") or ""),
            str(row.get("verdict") or "").replace("_", " "),
            _where(row.get("where"), scales),
            " ".join(_sentence(part) for part in (row.get("why"), *row.get("remarks", ())) if part),
        )
        for row in summary(results.survey)["rules"]
    )
    return Table(("Rule", "Edition", "Verdict", f"At [{scales.length.name}]", "Why"), rows, frozenset({0, 1, 2, 4}))


def _sentence(words: str) -> str:
    return words[:1].upper() + words[1:] + ("" if words.endswith(".") else ".")


def _where(where: Any, scales: Scales) -> str:
    if isinstance(where, int | float):
        return scales.length.number(float(where), 2)
    return "–" if where is None else str(where)


def overrides_table(results: Results) -> Table:
    """Return every correction that people made, with who, when, why and what it did."""
    keys = ("action", "what", "effect", "author", "date", "reason")
    rows = tuple(tuple(str(one.get(key) or "–") for key in keys) for one in results.survey.overrides)
    return Table(("Correction", "What", "What it did", "By", "On", "Reason"), rows, frozenset(range(6)))


def features_listing(results: Results, table: Any, scales: Scales) -> Table:
    """Return the features, numbered as on the maps; `table` holds the rows of `features.csv`, of which 2000 at most."""
    table = table.iloc[:LISTED]
    small, length = scales.small, scales.length
    further = _further(results, scales)
    headings = (
        "No.",
        "Kind",
        f"Chainage [{length.name}]",
        "Clock",
        f"Size [{small.name}]",
        f"Length [{small.name}]",
        f"Depth [{small.name}]",
        "Further",
        "Confidence",
        "Source",
        "Image",
    )
    rows = tuple(
        (
            str(k),
            row.kind,
            placed_text(row.chainage_m, row.chainage_sigma_m, scales),
            clock_text(row.clock_h) if isfinite(row.clock_h) else "–",
            small.number(row.size_mm / 1e3, 0),
            small.number(row.length_mm / 1e3, 0),
            small.number(row.depth_mm / 1e3, 1),
            further[k - 1],
            number(row.confidence, 2),
            row.source,
            row.image or "–",
        )
        for k, row in enumerate(table.itertuples(), 1)
    )
    # Columns in which no feature has anything to say are left out.
    kept = [k for k, name in enumerate(headings) if name not in _OPTIONAL or any(row[k] != "–" for row in rows)]
    words = frozenset(place for place, k in enumerate(kept) if headings[k] in _WORDS)
    return Table(tuple(headings[k] for k in kept), tuple(tuple(row[k] for k in kept) for row in rows), words)


def _further(results: Results, scales: Scales) -> list[str]:
    """Return what else was measured of each feature, with its 95 % interval."""
    if not feature_count(results.survey):
        return []
    data = results.survey.features
    count = data.sizes["feature"]
    words: list[list[str]] = [[] for _ in range(count)]
    for variable, angle in (("step", False), ("kink", True), ("inclination", True), ("protrusion", False)):
        if variable not in data:
            continue
        sigma = data[f"{variable}_sigma"].values if f"{variable}_sigma" in data else np.full(count, np.nan)
        for k, (value, half) in enumerate(zip(data[variable].values, SIGMAS_95 * sigma, strict=True)):
            if isfinite(value):
                shown = degrees_text(value, half) if angle else _small(value, half, scales)
                words[k].append(f"{variable} {shown}")
    return ["; ".join(parts) or "–" for parts in words]


def degrees_text(value: float, half: float) -> str:
    """Return an angle [rad] in degrees, with its half interval [rad] when that is known."""
    shown, around = measured(np.degrees(value), np.degrees(half), least=1, most=2)
    return f"{shown}°" if around == "–" else f"{shown} ± {around}°"


def _small(value: float, half: float, scales: Scales) -> str:
    shown, around = scales.small.measured(value, half, least=1, most=1)
    return f"{shown}\u00a0{scales.small.name}" if around == "–" else f"{shown} ± {around}\u00a0{scales.small.name}"


def placed_text(chainage: float, sigma: float, scales: Scales) -> str:
    """Return a chainage [m] with its 95 % half interval when that is known."""
    at = scales.length.number(chainage, 2)
    return f"{at} ± {scales.length.number(SIGMAS_95 * sigma, 2)}" if sigma > 0 else at


def _severity(results: Results) -> tuple[np.ndarray, str]:
    deflection = results.judged("deflection")
    if np.isfinite(deflection).any():
        return deflection, "deflection"
    return results.judged("ovality_polar"), "ovality"


def worst_stations(results: Results) -> tuple[list[int], str]:
    """Return the worst stations, the worst first and each at least two diameters from those before it."""
    values, word = _severity(results)
    left = np.where(np.isfinite(values), values, -np.inf)
    apart, found = 2.0 * results.circle_diameter, []
    while len(found) < _WORST and np.isfinite(left).any():
        at = int(np.argmax(left))
        found.append(at)
        left[np.abs(results.chainage - results.chainage[at]) < apart] = -np.inf
    return found, word


def worst_table(results: Results, stations: list[int], scales: Scales) -> Table:
    """Return the worst stations."""
    small = scales.small
    lengths = [results.metric(name) for name in ("diameter_max", "diameter_min", "diameter_x", "diameter_y")]
    shares = [results.metric(name) * 1e2 for name in ("ovality_polar", "deflection")]
    clock = clock_from_bearing(results.metric("diameter_max_bearing"))
    rows = tuple(
        (
            str(k),
            scales.length.number(results.chainage[at], 2),
            *(small.number(values[at], 1) for values in lengths),
            *(number(values[at], 2) for values in shares),
            clock_text(float(clock[at])) if isfinite(clock[at]) else "–",
            number(results.coverage[at] * 1e2, 0),
        )
        for k, at in enumerate(stations, 1)
    )
    headings = (
        "No.",
        f"Chainage [{scales.length.name}]",
        *(f"{word} [{small.name}]" for word in ("Largest", "Smallest", "X", "Y")),
        "Ovality [%]",
        "Deflection [%]",
        "Largest at",
        "Coverage [%]",
    )
    return Table(headings, rows, frozenset())


def stretches_table(results: Results, scales: Scales) -> Table:
    """Return the survey cut into at most twenty stretches of a round length."""
    chainage = results.chainage * scales.length.factor
    rough = max((chainage[-1] - chainage[0]) / _STRETCHES, 1e-3)
    decade = 10.0 ** floor(log10(rough))
    step = next(s for s in (1, 2, 5, 10) if s * decade >= rough * (1 - 1e-9)) * decade
    first = floor(chainage[0] / step + 1e-9)
    decimals = max(0, ceil(-log10(step) - 1e-9))
    place = np.clip(np.floor(chainage / step + 1e-9).astype(int) - first, 0, None)
    area, ovality, deflection = (results.judged(n) for n in ("diameter_area", "ovality_polar", "deflection"))
    without = ~np.isfinite(results.metric("diameter_area"))
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
                str(int(without[at].sum())),
                scales.small.number(float(np.mean(area[at][known])) if known.any() else np.nan, 2),
                number(_largest(ovality[at]) * 1e2, 2),
                number(_largest(deflection[at]) * 1e2, 2),
            )
        )
    headings = (
        f"Chainage [{scales.length.name}]",
        "Stations",
        "Coverage [%]",
        "Without section",
        f"Mean diameter [{scales.small.name}]",
        "Largest ovality [%]",
        "Largest deflection [%]",
    )
    return Table(headings, tuple(rows), frozenset())


def _largest(values: np.ndarray) -> float:
    return float(np.nanmax(values)) if np.isfinite(values).any() else float("nan")
