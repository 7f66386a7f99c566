"""The summary of a comparison: the few numbers that stand at the top of everything."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import __version__
from ...compare.verdicts import QUANTITIES
from ..plain import plain_number
from .tables import clock

if TYPE_CHECKING:
    from ...compare.pair import Comparison
    from ...compare.series import Series


def comparison_summary(found: Comparison) -> dict[str, Any]:
    """Return the content of `summary.json`; None where a value is not available.

    `detectable` is the change that is told in 95 % of cases at the stated rate of false alarms: of a profile over 1 m,
    of the wall as the depth of a dent of 190 mm x 35 degrees, whose size is taken at half depth and from edge to edge.
    """
    placed, match, d = found.placed, found.match, found.difference
    verdicts = [c.verdict for c in found.changes]
    patches = [c for c in found.changes if c.quantity == "patch" and c.verdict == "change"]
    worst = max(patches, key=lambda c: abs(c.change), default=None)
    x = np.linspace(*found.a.extent, 501)
    good = placed.reliable(x)
    sigma = placed.at(x)[1]
    compared = None if d is None else float(np.isfinite(d.change).any(axis=1).sum() * d.step)
    missing = [{"start_m": plain_number(s), "end_m": plain_number(e), "why": why} for s, e, why in found.missing]
    return {
        "a": found.a.name,
        "b": found.b.name,
        "date_a": found.a.date.isoformat() if found.a.date else None,
        "date_b": found.b.date.isoformat() if found.b.date else None,
        "years": plain_number(found.years),
        "driven_from_the_other_end": placed.reversed,
        "probability_same_pipe": plain_number(match.probability_same) if match is not None else None,
        "relief_agreement": plain_number(placed.agreement),
        "relief_evidence_nats": plain_number(placed.log_evidence, decimals=1) if d is not None else None,
        "length_a_m": plain_number(found.a.extent[1] - found.a.extent[0]),
        "placed_pct": plain_number(100.0 * good.mean(), decimals=1),
        "chainage_sigma_mm": plain_number(1e3 * np.median(sigma[good]), decimals=2) if good.any() else None,
        "wall_compared_m": plain_number(compared),
        "pairs": 0 if found.paired is None else len(found.paired.index_a),
        "changes": verdicts.count("change"),
        "measurement_errors": verdicts.count("measurement error"),
        "unclear": verdicts.count("unclear"),
        "largest_wall_change_mm": plain_number(1e3 * worst.change, decimals=3) if worst else None,
        "largest_wall_change_sigma_mm": plain_number(1e3 * worst.sigma, decimals=3) if worst else None,
        "largest_wall_change_chainage_m": plain_number(worst.chainage) if worst else None,
        "largest_wall_change_clock_h": plain_number(float(clock(np.array(worst.bearing)))) if worst else None,
        "range_scale_b_over_a_pct": plain_number(100.0 * d.scale) if d is not None else None,
        "range_scale_sigma_pct": plain_number(100.0 * d.scale_sigma) if d is not None else None,
        "common_pattern_mm": plain_number(1e3 * np.abs(d.pattern).max()) if d is not None else None,
        "false_alarms_per_100m": found.rate,
        "detectable": _detectable(found),
        "not_compared": missing,
        "notes": list(found.notes),
        "version": __version__,
    }


def _detectable(found: Comparison) -> dict[str, dict[str, Any]]:
    rows = {}
    for key, value in found.detectable.items():
        kind = QUANTITIES[key]
        rows[kind.words] = {"value": plain_number(value * kind.factor), "unit": kind.unit}
    if math.isfinite(found.detectable_edge):
        rows["wall, local, dent from edge to edge"] = {"value": plain_number(1e3 * found.detectable_edge), "unit": "mm"}
    return rows


def series_summary(found: Series) -> dict[str, Any]:
    """Return the content of `summary.json` of a series; each comparison with the first has its own in its folder."""
    return {
        "inspections": [
            {
                "name": e.name,
                "date": e.date.isoformat() if e.date else None,
                "years": plain_number(t) if found.dated else None,
            }
            for e, t in zip(found.epochs, found.times, strict=True)
        ],
        "compared": [{"b": p.b.name, "compared": bool(p), "reason": p.reason} for p in found.pairs],
        "station_trends": len(found.stations),
        "station_trends_told": sum(t.significant for t in found.stations),
        "wall_trends": len(found.patches),
        "wall_trends_told": sum(t.significant for t in found.patches),
        "feature_trends": len(found.features),
        "feature_trends_told": sum(t.significant for t in found.features),
        "version": __version__,
    }
