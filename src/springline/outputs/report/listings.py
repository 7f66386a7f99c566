"""The report's tables: verdicts, features, worst stations, stretches, and what became of readings and stations."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, isfinite, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from ...conventions import FIT_STATUS, MASK_REASONS, clock_from_bearing
from ..summary import summary
from ..unroll import REASON_WORDS
from .texts import SIGMAS_95, clock_text, number

if TYPE_CHECKING:
    from ..results import Results

_WORST = 10
_STRETCHES = 20


@dataclass(frozen=True)
class Table:
    """A table of texts; columns of numbers are aligned right."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: frozenset[int] = frozenset({0})


def rules_table(results: Results) -> Table:
    """Return the verdict of each rule that was asked for."""
    rows = summary(results.survey)["rules"]
    return Table(
        ("Rule", "Edition", "Verdict", "Where"),
        tuple(tuple(str(row.get(key) or "") for key in ("rule", "edition", "verdict", "where")) for row in rows),
        frozenset(range(4)),
    )


def features_listing(table: Any) -> Table:
    """Return the features, numbered as on the maps."""
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
            _placed(row.chainage_m, row.chainage_sigma_m),
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


def _placed(chainage: float, sigma: float) -> str:
    return f"{chainage:.2f} ± {SIGMAS_95 * sigma:.2f}" if sigma > 0 else f"{chainage:.2f}"


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


def worst_table(results: Results, stations: list[int]) -> Table:
    """Return the worst stations."""
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
        for at in stations
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


def stretches_table(results: Results) -> Table:
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


def readings_table(results: Results) -> Table:
    """Return how many readings were used, and why not the others."""
    counts = results.reason_counts
    total = max(sum(counts.values()), 1)
    rows = tuple(
        (REASON_WORDS[MASK_REASONS[flag]], f"{count:,}".replace(",", "\u2009"), f"{100 * count / total:.2f}")
        for flag, count in counts.items()
        if flag in MASK_REASONS
    )
    return Table(("Readings", "Number", "Share [%]"), rows)


def statuses_table(results: Results) -> Table:
    """Return how many stations have a section, and why not the others."""
    start, end = results.extents
    rows = tuple(
        (word, str(int((results.status == flag).sum())), f"{float((end - start)[results.status == flag].sum()):.2f}")
        for flag, word in FIT_STATUS.items()
        if (results.status == flag).any()
    )
    return Table(("Stations", "Number", "Length [m]"), rows)
