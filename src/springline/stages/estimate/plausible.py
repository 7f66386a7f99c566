"""What an inertial log and ties cannot be: mistakes of axes, units and columns that an estimate would swallow."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError

if TYPE_CHECKING:
    from ...estimation import Inertial, Ties

_GRAVITY = (8.0, 11.6)
"""What an accelerometer may read of gravity [m/s2], over the whole of a log."""
_BESIDE = 2.0
"""How far before the first ring or behind the last a tie may lie [m]: a robot starts inside its manhole."""
_LONGER, _SHORTER = 1.1, 0.05
"""How far apart two ties may lie over what the counter ran between them: a pipe may bend back, but not stretch."""
_LENGTH = 5.0
"""Run between two ties [m] from which on their distance is held against it."""


def check_log(log: Inertial) -> None:
    """Refuse a log whose specific force is not that of a robot on its wheels.

    Raises:
        InputError: It does not read gravity, or reads it downwards.
    """
    force = np.median(log.accel, axis=0)
    size = float(np.linalg.norm(force))
    expected = "specific force in m/s2, about +9.8 on y at rest"
    if not _GRAVITY[0] <= size <= _GRAVITY[1]:
        raise InputError(
            f"the accelerometer reads {size:.3g} m/s2 over the run",
            where="/inertial",
            expected=expected,
            mend="state its unit in the columns' names: accel_x_g where it is in g",
        )
    if force[1] <= 0.0:
        raise InputError(
            f"the accelerometer reads {force[1]:.3g} m/s2 on y, so the robot lies on its back",
            where="/inertial",
            expected=expected,
            mend="turn the log into robot axes: x ahead, y up, z right, specific force and not acceleration",
        )


def check_ties(ties: Ties, distance: np.ndarray) -> None:
    """Refuse ties that cannot be of this run.

    Args:
        ties: In order of distance.
        distance: Of the rings [m] (n,).

    Raises:
        InputError: A tie lies beyond the rings, or two lie further apart, or far nearer, than the counter ran.
    """
    at, points = np.asarray(ties.distance, float), np.asarray(ties.position, float)
    low, high = float(np.min(distance)), float(np.max(distance))
    for place in at:
        if not low - _BESIDE <= place <= high + _BESIDE:
            raise InputError(
                f"a tie stands at {place:g} m of the counter, the rings from {low:g} to {high:g} m",
                where="/ties",
                expected="what the counter read abreast of each tie",
                mend="check the column of distances and its unit",
            )
    for first, second in pairwise(range(len(at))):
        run, apart = float(at[second] - at[first]), float(np.linalg.norm(points[second] - points[first]))
        room = 5.0 * float(np.hypot(ties.sigma[first], ties.sigma[second]))
        if apart > _LONGER * run + room + 1.0 or (run > _LENGTH and apart + room < _SHORTER * run):
            raise InputError(
                f"the ties at {at[first]:g} and {at[second]:g} m lie {apart:.3g} m apart, the counter ran {run:.3g} m",
                where="/ties",
                expected="easting, northing and elevation in metres of one grid",
                mend="turn degrees of latitude and longitude into a grid; check the columns and the unit",
            )
