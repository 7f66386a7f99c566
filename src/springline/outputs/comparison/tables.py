"""Tables of a comparison: pairs, changes, where A lies in B; empty means not available, never 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from ...compare.verdicts import QUANTITIES
from ...conventions import clock_from_bearing

if TYPE_CHECKING:
    from ...compare.pair import Comparison
    from ...compare.series import Series, Trend

PAIR_DECIMALS = {
    "chainage_a_m": 4,
    "chainage_b_m": 4,
    "residual_mm": 1,
    "probability": 4,
    "clock_a_h": 3,
    "clock_b_h": 3,
    "size_a_mm": 2,
    "size_b_mm": 2,
}
"""Decimals of the numbers in `pairs.csv`; the other columns hold text."""

CHANGE_DECIMALS = {
    "chainage_a_m": 4,
    "chainage_b_m": 4,
    "length_m": 3,
    "clock_h": 3,
    "width_deg": 1,
    "before": 4,
    "after": 4,
    "change": 4,
    "sigma": 4,
    "false_alarms_per_100m": 6,
    "rate_per_year": 4,
    "rate_sigma": 4,
}
"""Decimals of the numbers in `changes.csv`; the other columns hold text."""

PLACE_DECIMALS = {"chainage_a_m": 4, "chainage_b_m": 4, "sigma_mm": 2, "roll_deg": 2, "roll_sigma_deg": 2}
"""Decimals of the numbers in `placing.csv`; the other columns hold text."""


def pairs_table(found: Comparison) -> pd.DataFrame:
    """Return the features seen in both inspections; `residual_mm` is B's chainage less where A's feature lies in B.

    `probability` is the match's posterior, empty where the wall's place alone paired the two. `clock_b_h` is as B's own
    operator would call it.
    """
    columns = ["kind", *PAIR_DECIMALS]
    if found.paired is None or found.a.features is None or found.b.features is None:
        return pd.DataFrame({name: [] for name in columns})
    p, a, b = found.paired, found.a, found.b
    kinds = a.kinds()
    return pd.DataFrame(
        {
            "kind": [kinds[i] for i in p.index_a],
            "chainage_a_m": a.features.chainage[p.index_a],
            "chainage_b_m": b.features.chainage[p.index_b],
            "residual_mm": 1e3 * p.residual,
            "probability": p.probability,
            "clock_a_h": clock(a.features.bearing[p.index_a]),
            "clock_b_h": clock(b.features.bearing[p.index_b]),
            "size_a_mm": 1e3 * a.measured("size")[0][p.index_a],
            "size_b_mm": 1e3 * b.measured("size")[0][p.index_b],
        }
    )


def clock(bearing: np.ndarray) -> np.ndarray:
    """Return clock hours of bearings, 12 rather than 0; NaN where there is none."""
    hours = np.round(clock_from_bearing(np.asarray(bearing, float)), 3)
    return np.where(hours == 0.0, 12.0, hours)


def changes_table(found: Comparison) -> pd.DataFrame:
    """Return every change in the edge unit of its quantity, in the order of A.

    `false_alarms_per_100m` is how many as clear appear by chance in 100 m of unchanged pipe; `verdict` is change,
    measurement error or unclear.
    """
    rows = []
    for c in found.changes:
        kind = QUANTITIES[c.quantity]
        placed = c.chainage == c.chainage
        rows.append(
            {
                "quantity": kind.words,
                "chainage_a_m": c.chainage,
                "chainage_b_m": float(found.placed.at(np.array(c.chainage))[0]) if placed else np.nan,
                "length_m": c.length or np.nan,
                "clock_h": float(clock(np.array(c.bearing))),
                "width_deg": float(np.degrees(c.width)),
                "before": c.value_a * kind.factor,
                "after": c.value_b * kind.factor,
                "change": c.change * kind.factor,
                "sigma": c.sigma * kind.factor,
                "unit": kind.unit,
                "false_alarms_per_100m": c.false_alarms,
                "verdict": c.verdict,
                "reason": c.reason,
                "rate_per_year": c.change * kind.factor / found.years,
                "rate_sigma": c.sigma * kind.factor / found.years,
            }
        )
    columns = (
        "quantity", "chainage_a_m", "chainage_b_m", "length_m", "clock_h", "width_deg", "before", "after", "change",
        "sigma", "unit", "false_alarms_per_100m", "verdict", "reason", "rate_per_year", "rate_sigma",
    )  # fmt: skip
    return pd.DataFrame(rows, columns=list(columns))


def placing_table(found: Comparison) -> pd.DataFrame:
    """Return where A lies in B: chainage and roll at the nodes, and what told it."""
    placed = found.placed
    by = np.where(
        placed.refined, "relief", "features" if found.match is not None and found.match.accepted else "interpolation"
    )
    return pd.DataFrame(
        {
            "chainage_a_m": placed.drift.chainage_a,
            "chainage_b_m": placed.drift.chainage_b,
            "sigma_mm": 1e3 * placed.drift.sigma,
            "roll_deg": np.degrees(placed.roll),
            "roll_sigma_deg": np.degrees(placed.roll_sigma),
            "by": by,
        }
    )


def trends_table(found: Series, trends: tuple[Trend, ...]) -> tuple[pd.DataFrame, dict[str, int]]:
    """Return trends in edge units, and the decimals of its numbers: one column of values per inspection."""
    names = [f"value_{k}" for k in range(1, len(found.epochs) + 1)]
    per = "rate_per_year" if found.dated else "rate_per_inspection"
    rows = []
    for t in trends:
        kind = QUANTITIES[t.quantity]
        rows.append(
            {
                "quantity": kind.words,
                "feature": t.kind,
                "chainage_a_m": t.chainage,
                "clock_h": float(clock(np.array(t.bearing))),
                **{name: v * kind.factor for name, v in zip(names, t.values, strict=True)},
                **{f"{name}_sigma": v * kind.factor for name, v in zip(names, t.sigmas, strict=True)},
                "unit": kind.unit,
                per: t.rate * kind.factor,
                "rate_sigma": t.rate_sigma * kind.factor,
                "significant": "yes" if t.significant else "no",
            }
        )
    sigmas = [f"{name}_sigma" for name in names]
    columns = [
        "quantity", "feature", "chainage_a_m", "clock_h", *names, *sigmas, "unit", per, "rate_sigma", "significant",
    ]  # fmt: skip
    text = ("quantity", "feature", "unit", "significant")
    return pd.DataFrame(rows, columns=columns), {name: 4 for name in columns if name not in text}
