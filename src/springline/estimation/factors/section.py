"""The section: its values follow their trend, and the trend wanders; a wall that ovals keeps its perimeter."""

from __future__ import annotations

import numpy as np

from ..states import SECTION, TREND
from .base import Factor, local_columns

COLUMNS = local_columns(SECTION, TREND)


def section(intervals: np.ndarray, step: float, trend: float, wander: float, tails: float) -> Factor:
    """Return the factor that joins sections from knot to knot; perimeter apart from ovality.

    The wall of a pipe that is pressed out of round bends and does not stretch, so that its mean radius shrinks by
    (oval_cos^2 + oval_sin^2)/(4 mean_radius); what wanders is the radius of its perimeter.

    Args:
        intervals: Knot at which each begins (n,).
        step: Between knots [m].
        trend: Random walk of the trend [m per m, per square root of m]; a start, then taken from the data.
        wander: Random walk of the values [m per square root of m], in proportion with `trend`.
        tails: Of Student's t, for steps at joints.
    """
    spread = np.array(
        [
            [trend**2 * step**3 / 3.0 + wander**2 * step, trend**2 * step**2 / 2.0],
            [trend**2 * step**2 / 2.0, trend**2 * step],
        ]
    )
    whitener = np.linalg.inv(np.linalg.cholesky(spread))

    def residual(before, after, scalars):
        (value, trend), (later, later_trend) = by_perimeter(before), by_perimeter(after)
        value = later - value - step * trend
        change = later_trend - trend
        pairs = np.einsum("ij,njp->npi", whitener, np.stack([value, change], axis=1))
        return pairs.reshape(len(pairs), 6)

    return Factor(
        "section",
        intervals,
        COLUMNS,
        residual,
        (slice(0, 2), slice(2, 4), slice(4, 6)),
        (tails,),
        (True, True, True),
    )


def by_perimeter(knots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return radius of the perimeter, oval_cos and oval_sin of knots, and their trends (n, 3)."""
    value, trend = knots[:, SECTION].copy(), knots[:, TREND].copy()
    mean, oval = knots[:, SECTION.start, None], value[:, 1:]
    value[:, 0] += np.sum(oval**2 / (4.0 * mean), axis=1)
    trend[:, 0] += np.sum(oval * trend[:, 1:] / (2.0 * mean), axis=1)
    return value, trend
