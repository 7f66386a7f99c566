"""Odometry: the sensor moves along the robot's forward axis, up to misalignment, lever and creep."""

from __future__ import annotations

import numpy as np

from ..rotations import dot, rotate
from ..states import AXIS, AXLES, CLOCK, DIRECTION, LEVER, LEVER_UP, OFFSET, SCALE, SLIP_RIGHT, SLIP_UP, TILT
from .base import Factor, local_columns
from .sensor import Places, off_axis, way

COLUMNS = local_columns(
    AXIS, OFFSET, TILT, DIRECTION, scalars=(SCALE, SLIP_UP, SLIP_RIGHT, LEVER, LEVER_UP, AXLES, CLOCK)
)


def odometry(
    knots: Places, along: np.ndarray, across: float, tails: float, across_tails: float, *, swings: bool = False
) -> Factor:
    """Return the factor that closes the sensor's way from knot to knot.

    Args:
        knots: The intervals' starts, with the reach over each as `span`.
        along: One-sigma along the way of each interval [m] (n,).
        across: One-sigma across it, up and to the right [m]; taken from the data from there on.
        tails: Of Student's t along the way, for slips.
        across_tails: The same across it, for knocks and for axles that the wall of a bend pushes aside.
        swings: Whether the track does not know how the robot turns, so that its error does: the sensor's lever turns
            with that.
    """

    def residual(before, after, scalars):
        middle = 0.5 * (before[:, TILT] + after[:, TILT])
        expected = way(knots.span, knots.span_by_clock, middle, scalars, knots)
        error = before[:, AXIS] + off_axis(after) - off_axis(before) - expected
        if swings:
            lever = np.asarray(knots.lever) + np.array([scalars[LEVER], scalars[LEVER_UP], 0.0])
            turned = rotate(middle, knots.axes @ lever)
            error = error - np.cross(after[:, TILT] - before[:, TILT], turned)
        robot = [dot(error, rotate(middle, knots.axes[..., k])) for k in range(3)]
        return np.stack([robot[0] / along, robot[1] / across, robot[2] / across], axis=1)

    return Factor(
        "odometry", knots.interval, COLUMNS, residual, (slice(0, 1), slice(1, 3)), (tails, across_tails), (False, True)
    )
