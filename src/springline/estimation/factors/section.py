"""The section: its values follow their trend, and the trend wanders."""

from __future__ import annotations

import numpy as np

from ..states import SECTION, TREND
from .base import Factor, local_columns

COLUMNS = local_columns(SECTION, TREND)


def section(intervals: int, step: float, trend: float, wander: float, tails: float) -> Factor:
    """Return the factor that joins sections from knot to knot; mean radius apart from ovality.

    Args:
        intervals: How many.
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
        value = after[:, SECTION] - before[:, SECTION] - step * before[:, TREND]
        change = after[:, TREND] - before[:, TREND]
        pairs = np.einsum("ij,njp->npi", whitener, np.stack([value, change], axis=1))
        return pairs.reshape(len(pairs), 6)

    return Factor(
        "section",
        np.arange(intervals),
        COLUMNS,
        residual,
        (slice(0, 2), slice(2, 4), slice(4, 6)),
        (tails,),
        (True, True, True),
    )
