"""The pipe's axis: it runs where its direction points, and its direction wanders, kinks and bends."""

from __future__ import annotations

import numpy as np

from ..rotations import dot, pipe_frame
from ..states import AXIS, DIRECTION
from .base import Factor, local_columns

_SLACK = 1e-5
"""How far the axis may stray between knots in any case [m]; tighter ones cost digits and tell nothing."""

COLUMNS = local_columns(AXIS, DIRECTION)


def axis(intervals: np.ndarray, step: float, kink: float, tails: float, *, straight: bool = False) -> Factor:
    """Return the factor that joins the axis from knot to knot.

    Direction walks at random by `kink` [rad per square root of m]; the point follows the mean direction, with the part
    of the walk within the interval that the two directions do not tell. Student's t lets joints and bends through:
    horizontally and vertically apart.

    Args:
        intervals: Knot at which each begins (n,).
        step: Between knots [m].
        kink: Random walk of the direction, a start; taken from the data from there on.
        tails: Of Student's t.
        straight: Whether nothing tells the pipe's direction, so that it is held straight.
    """
    turn = kink * np.sqrt(step)
    # Of a walk between two known ends the integral has one-sigma q sqrt(h^3 / 12).
    bulge = np.hypot(kink * np.sqrt(step**3 / 12.0), _SLACK)

    def residual(before, after, scalars):
        mean = 0.5 * (before[:, DIRECTION] + after[:, DIRECTION])
        _, y, z = pipe_frame(mean[:, 0], mean[:, 1])
        chord = before[:, AXIS]
        change = after[:, DIRECTION] - before[:, DIRECTION]
        return np.stack([dot(chord, z) / bulge, change[:, 0] / turn, dot(chord, y) / bulge, change[:, 1] / turn], 1)

    return Factor(
        "axis",
        intervals,
        COLUMNS,
        residual,
        (slice(0, 2), slice(2, 4)),
        (0.0,) if straight else (tails,),
        (False, False) if straight else (True, True),
    )
