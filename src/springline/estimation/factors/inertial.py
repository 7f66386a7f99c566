"""Gyro and gravity: how the inertial error walks, and which way is up."""

from __future__ import annotations

import numpy as np

from ..data import GRAVITY
from ..rotations import rotate
from ..states import ACCEL, GYRO, TILT
from .base import Factor, local_columns


def gyro(intervals: np.ndarray, turned: np.ndarray, sigma: np.ndarray) -> Factor:
    """Return the factor of the inertial error from knot to knot.

    Args:
        intervals: Knot at which each begins (n,).
        turned: Integral of the integrated axes over the time of moving, interval by interval [s] (n, 3, 3).
        sigma: One-sigma of the error's walk over each interval [rad] (n,).
    """

    def residual(before, after, scalars):
        drift = turned @ scalars[GYRO]
        return (after[:, TILT] - before[:, TILT] + drift) / sigma[:, None]

    columns = local_columns(TILT, scalars=tuple(range(GYRO.start, GYRO.stop)))
    return Factor("gyro", intervals, columns, residual, (slice(0, 3),))


def gravity(intervals: np.ndarray, force: np.ndarray, axes: np.ndarray, sigma: np.ndarray, tails: float) -> Factor:
    """Return the factor of gravity's direction, averaged over each interval.

    Args:
        intervals: Knot at which each begins (n,).
        force: Mean specific force on Earth as integrated, less the change of velocity by the odometer [m/s2] (n, 3).
        axes: Mean of the integrated axes over the time of each interval (n, 3, 3).
        sigma: One-sigma of each mean [m/s2] (n,), a start; taken from the data from there on.
        tails: Of Student's t, for knocks.
    """
    up = np.array([0.0, 0.0, GRAVITY])

    def residual(before, after, scalars):
        middle = 0.5 * (before[:, TILT] + after[:, TILT])
        shown = rotate(middle, force - axes @ scalars[ACCEL])
        return (shown - up)[:, :2] / sigma[:, None]

    columns = local_columns(TILT, scalars=tuple(range(ACCEL.start, ACCEL.stop)))
    return Factor("gravity", intervals, columns, residual, (slice(0, 2),), (tails,), (True,))
