"""The report of a comparison and of a series: one HTML file each that asks nothing of any network."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import __version__
from ...compare.verdicts import QUANTITIES
from ...errors import listed
from ..html import environment
from ..report.listings import Table
from ..report.texts import SIGMAS_95, clock_text, measured, number
from .strip import Strip, change_charts, drift_chart, found_line, pictures
from .summary import comparison_summary
from .tables import clock

if TYPE_CHECKING:
    from ...compare.changes import Change
    from ...compare.pair import Comparison
    from ...compare.series import Series, Trend

_HERE = Path(__file__).parent
_STYLE = _HERE.parent / "report" / "report.css"
_MOST_ROWS = 60
_MOST_PAIRS = 200


def render_comparison(found: Comparison) -> str:
    """Return the report of two inspections, everything inlined, every text escaped."""
    told = [c for c in found.changes if c.verdict == "change"]
    d = found.difference
    strip = Strip(d.chainage if d is not None else np.linspace(*found.a.extent, 100), found.a.extent)
    drift_strip, drift = drift_chart(found)
    numbers = {id(c): str(k) for k, c in enumerate(told, 1)}
    return _page("comparison.html.j2").render(
        found=found,
        summary=comparison_summary(found),
        axis=strip.axis,
        facts=_facts(found),
        headlines=_headlines(found),
        changes=_changes(told, found, numbers),
        errors=_changes([c for c in found.changes if c.verdict == "measurement error"], found, {}),
        unclear=_changes([c for c in found.changes if c.verdict == "unclear"], found, {}),
        maps=pictures(found, strip.axis) if d is not None else [],
        marks=_marks(told, numbers),
        charts=change_charts(found, strip) if d is not None else [],
        drift=drift,
        dots=_dots(found, drift_strip, drift),
        gaps=[(s, e, why) for s, e, why in found.missing if not why.startswith("an edge")],
        pairs=_pairs(found),
        missing=_missing(found),
        detectable=_detectable(found),
        version=__version__,
        style=_STYLE.read_text(encoding="utf-8"),
    )


def render_series(found: Series, folders: list[str]) -> str:
    """Return the report of a series; `folders` hold the comparison of each inspection with the first."""
    told = [t for t in (*found.patches, *found.features, *found.stations) if t.significant]
    return _page("series.html.j2").render(
        found=found,
        rows=[
            (e.name, e.date.isoformat() if e.date else "–", number(t, 2) if found.dated else str(k + 1))
            for k, (e, t) in enumerate(zip(found.epochs, found.times, strict=True))
        ],
        compared=list(zip(found.pairs, folders, strict=True)),
        told=_trends(told, found),
        features=_trends(list(found.features), found),
        counts=(len(found.stations), len(found.patches), len(found.features)),
        version=__version__,
        style=_STYLE.read_text(encoding="utf-8"),
    )


def _page(name: str) -> Any:
    pages = environment(_HERE)
    pages.filters["pct"] = lambda share: f"{100.0 * share:.3f}%"
    return pages.get_template(name)


def _facts(found: Comparison) -> list[tuple[str, str]]:
    ends = "from opposite ends" if found.placed.reversed else "from the same end"
    slope, _ = found_line(found)
    rows = [
        ("A", found.a.name + (f", {found.a.date.isoformat()}" if found.a.date else "")),
        ("B", found.b.name + (f", {found.b.date.isoformat()}" if found.b.date else "")),
        ("Between them", f"{found.years:.2f} years" if isfinite(found.years) else "dates not known"),
        ("Driven", ends),
        ("Odometer of B over A", f"{abs(slope):.5f}"),
    ]
    if found.match is not None and found.match.accepted:
        rows.append(("Same pipe, by features", _sure(found.match.probability_same)))
    if isfinite(found.placed.agreement):
        rows.append(("Same pipe, by the wall’s relief", _sure(1.0 / (1.0 + np.exp(-found.placed.log_evidence)))))
        rows.append(("Relief in common", f"{100 * found.placed.agreement:.0f} % of what could be"))
    return rows


def _sure(probability: float) -> str:
    return "over 99.9 %" if probability > 0.999 else f"{100 * probability:.1f} %"


def _headlines(found: Comparison) -> list[tuple[str, str, str, str]]:
    """Return title, value, unit and a note of what stands at the top."""
    s = comparison_summary(found)
    rows = [
        (
            "Changes",
            str(s["changes"]),
            "",
            f"{s['measurement_errors']} more are taken for errors, {s['unclear']} unclear",
        )
    ]
    if found.difference is not None:
        patches = [c for c in found.changes if c.quantity == "patch" and c.verdict == "change"]
        worst = max(patches, key=lambda c: abs(c.change), default=None)
        if worst is not None:
            value, half = measured(1e3 * worst.change, SIGMAS_95 * 1e3 * worst.sigma)
            where = f"± {half} mm, at {worst.chainage:.2f} m, {clock_text(float(clock(np.array(worst.bearing))))} h"
            rows.append(("Largest change of the wall", value, "mm", where))
        else:
            rows.append(("Largest change of the wall", "none told", "", "above what chance shows"))
        least = found.detectable.get("patch", float("nan"))
        rows.append(("Dent that is told", number(1e3 * least, 2), "mm", "190 mm × 35° at half depth, in 95 % of cases"))
    else:
        rows.append(("Features in both", str(s["pairs"]), "", "matched one to one"))
    sigma = s["chainage_sigma_mm"]
    rows.append(("A’s chainage in B", f"± {number(SIGMAS_95 * sigma, 1)}" if sigma is not None else "–", "mm",
                 f"95 %, over {s['placed_pct']:g} % of the length"))  # fmt: skip
    return rows


def _value(value: float, sigma: float, c: Change) -> str:
    kind = QUANTITIES[c.quantity]
    if not isfinite(value):
        return "–"
    return measured(value * kind.factor, SIGMAS_95 * sigma * kind.factor)[0]


def _changes(changes: list[Change], found: Comparison, numbers: dict[int, str]) -> Table:
    """Return the clearest changes as a table, in the order of A."""
    kept = sorted(changes, key=lambda c: (c.false_alarms != c.false_alarms, c.false_alarms))[:_MOST_ROWS]
    kept.sort(key=lambda c: -1.0 if c.chainage != c.chainage else c.chainage)
    rows = []
    dated = isfinite(found.years)
    for c in kept:
        kind = QUANTITIES[c.quantity]
        half = SIGMAS_95 * c.sigma * kind.factor
        value, wide = measured(c.change * kind.factor, half)
        hours = float(clock(np.array(c.bearing)))
        row = [
            numbers.get(id(c), ""),
            kind.words,
            f"{c.chainage:.2f}" if isfinite(c.chainage) else "all",
            f"{c.length:.2f}" if c.length else "–",
            clock_text(hours) if isfinite(hours) else "–",
            _value(c.value_a, c.sigma, c),
            _value(c.value_b, c.sigma, c),
            f"{value} ± {wide} {kind.unit}" if isfinite(c.change) else "–",
            _rare(c.false_alarms),
        ]
        if dated:
            rate, rate_half = measured(c.change * kind.factor / found.years, half / abs(found.years))
            row.append(f"{rate} ± {rate_half}" if isfinite(c.change) else "–")
        row.append(c.reason)
        rows.append(tuple(row))
    headings = [
        "",
        "What",
        "At [m]",
        "Over [m]",
        "Clock [h]",
        "Before",
        "After",
        "Change, ± 95 %",
        "By chance in 100 m",
    ]
    headings += ["Per year"] if dated else []
    headings.append("Remark")
    return Table(tuple(headings), tuple(rows), frozenset({1, len(headings) - 1}))


def _rare(count: float) -> str:
    if not isfinite(count):
        return "–"
    return "under 0.001" if count < 0.001 else f"{count:.3f}"


def _marks(changes: list[Change], numbers: dict[int, str]) -> list[tuple[float, float, str]]:
    """Return chainage, share from the top of a map, and number of each local change of the wall."""
    return [
        (c.chainage, ((6.0 - float(clock(np.array(c.bearing)))) / 12.0) % 1.0, numbers[id(c)])
        for c in changes
        if c.quantity == "patch"
    ]


def _dots(found: Comparison, strip: Strip, drift: Any) -> list[tuple[float, float, str]]:
    """Return place and words of matched features on the drift chart."""
    if found.paired is None or found.a.features is None:
        return []
    slope, start = found_line(found)
    x = found.a.features.chainage[found.paired.index_a]
    y = (found.b.features.chainage[found.paired.index_b] - start - slope * x) * 1e3
    kinds = found.a.kinds()
    return [
        (float(strip.axis.share(u)), float(np.clip(1.0 - drift.axis.share(v), 0.0, 1.0)), f"{kinds[i]} at {u:.2f} m")
        for u, v, i in zip(x, y, found.paired.index_a, strict=True)
    ]


def _pairs(found: Comparison) -> Table:
    own = "Clock in B, as driven" if found.placed is not None and found.placed.reversed else "Clock in B"
    headings = ("Feature", "In A [m]", "In B [m]", "Off its place [mm]", "Probability", "Clock in A", own)
    if found.paired is None or found.a.features is None or found.b.features is None:
        return Table(headings, ())
    p, a, b, kinds = found.paired, found.a.features, found.b.features, found.a.kinds()
    rows = []
    for i, j, probability, residual in zip(p.index_a, p.index_b, p.probability, p.residual, strict=True):
        hours = [float(clock(np.array(f.bearing[k]))) for f, k in ((a, i), (b, j))]
        rows.append(
            (
                kinds[i], f"{a.chainage[i]:.3f}", f"{b.chainage[j]:.3f}", number(1e3 * residual, 0),
                number(probability, 3) if isfinite(probability) else "by place",
                *(clock_text(h) if isfinite(h) else "–" for h in hours),
            )
        )  # fmt: skip
    return Table(headings, tuple(rows[:_MOST_PAIRS]))


def _missing(found: Comparison) -> Table:
    stretches: dict[str, list[tuple[float, float]]] = {}
    for start, end, why in found.missing:
        stretches.setdefault(why, []).append((start, end))
    rows = tuple(
        (why, f"{sum(e - s for s, e in spans):.2f}", listed([f"{s:.2f}–{e:.2f}" for s, e in spans], 12, ", "))
        for why, spans in stretches.items()
    )  # fmt: skip
    return Table(("Why", "Length [m]", "Where [m of A]"), rows, frozenset({0, 2}))


def _detectable(found: Comparison) -> Table:
    rows = []
    for key, value in found.detectable.items():
        kind = QUANTITIES[key]
        where = "over 1 m"
        if key == "patch":
            where = "dent of 190 mm × 35° at half depth"
        elif " " in key:
            where = "each"
        if isfinite(value):
            rows.append((kind.words, where, f"{value * kind.factor:.3g} {kind.unit}"))
    if isfinite(found.detectable_edge):
        rows.append(("wall, local", "dent of 190 mm × 35° from edge to edge", f"{1e3 * found.detectable_edge:.3g} mm"))
    return Table(("Quantity", "Of what", "Change told in 95 % of cases"), tuple(rows), frozenset({0, 1}))


def _trends(trends: list[Trend], found: Series) -> Table:
    """Return trends as a table, the clearest first."""
    trends = sorted(trends, key=lambda t: -abs(t.rate) / t.rate_sigma)[:_MOST_ROWS]
    rows = []
    for t in trends:
        kind = QUANTITIES[t.quantity]
        value, half = measured(t.rate * kind.factor, SIGMAS_95 * t.rate_sigma * kind.factor)
        hours = float(clock(np.array(t.bearing)))
        cells = [
            measured(v * kind.factor, SIGMAS_95 * s * kind.factor)[0] if isfinite(v) else "–"
            for v, s in zip(t.values, t.sigmas, strict=True)
        ]
        rows.append(
            (kind.words, f"{t.chainage:.2f}", clock_text(hours) if isfinite(hours) else "–", *cells, kind.unit,
             f"{value} ± {half}", "yes" if t.significant else "no")
        )  # fmt: skip
    per = "Per year, ± 95 %" if found.dated else "Per inspection, ± 95 %"
    names = tuple(str(k) for k in range(1, len(found.epochs) + 1))
    return Table(("Quantity", "At [m]", "Clock [h]", *names, "", per, "Told"), tuple(rows), frozenset({0}))
