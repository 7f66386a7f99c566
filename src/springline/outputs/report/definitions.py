"""What the choice of a definition does: the four means and ovalities, and the chords, of one pipe side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..results import worst_station
from .listings import Table
from .texts import number

if TYPE_CHECKING:
    from ..results import Results
    from .scales import Scales

_MEANS = (
    ("axes", "the mean of the largest and the smallest diameter"),
    ("polar", "twice the mean, over all bearings, of the radius about the centre"),
    ("area", "the diameter of the circle of equal area"),
    ("caliper", "the perimeter of the convex hull over π: the mean of all caliper widths"),
)


def definitions_table(results: Results, scales: Scales) -> Table:
    """Return mean diameter and ovality by each of the four definitions, over the stations that speak for the pipe."""
    rows = []
    for name, words in _MEANS:
        mean, ovality = results.judged(f"diameter_{name}"), results.judged(f"ovality_{name}") * 1e2
        at = worst_station(ovality)
        rows.append(
            (
                name,
                words,
                scales.small.number(_mean(mean), 2),
                number(_mean(ovality), 3),
                "–" if at is None else number(ovality[at], 3),
                "–" if at is None else scales.length.number(results.chainage[at], 2),
            )
        )
    headings = (
        "Mean",
        "What it is",
        f"Diameter [{scales.small.name}]",
        "Ovality, mean [%]",
        "Largest [%]",
        f"At [{scales.length.name}]",
    )
    return Table(headings, tuple(rows), frozenset({0, 1}))


def _mean(values: np.ndarray) -> float:
    return float(np.nanmean(values)) if np.isfinite(values).any() else float("nan")
