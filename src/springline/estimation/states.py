"""What is estimated: the states of one knot, and the scalars that hold for the whole survey.

Knots stand at equal steps of the odometer. Every factor joins two neighbouring knots and the scalars at most, so that
the information matrix is block tridiagonal with a border. Earth is east, north, up; lengths metres, angles radians.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

AXIS = slice(0, 3)
"""Way of the pipe's axis from this knot to the next, east, north, up [m]; at the last knot nothing."""
OFFSET = slice(3, 5)
"""Sensor above and right of the axis, on the pipe's y and z [m]."""
TILT = slice(5, 8)
"""Rotation on Earth from the integrated attitude to the true one [rad]: the inertial error."""
DIRECTION = slice(8, 10)
"""Heading clockwise from north and grade above the horizontal of the pipe [rad]."""
SECTION = slice(10, 13)
"""mean_radius, oval_cos, oval_sin of the true section in the pipe's frame [m]."""
TREND = slice(13, 16)
"""Change of SECTION per metre."""
BLOCK = 16
"""States per knot."""

GYRO = slice(0, 3)
"""Gyro bias [rad/s] on the robot's axes, less what was taken off before integration."""
ACCEL = slice(3, 6)
"""Accelerometer bias [m/s2] on the robot's axes."""
SCALE = 6
"""Odometer scale: true length over counted length, less one."""
SLIP_UP, SLIP_RIGHT = 7, 8
"""Travel direction against the forward axis [rad], upwards and level to the right, however the robot rolls."""
LEVER = 9
"""How far the sensor stands ahead of the point that moves along the travel direction, beyond its stated place [m]."""
LEVER_UP = 10
"""How far it stands above that point, beyond its stated place [m]: a body that rolls turns about its wheels."""
AXLES = 11
"""Area by which the change of turning moves that point across [m2]: wheelbase^2/12 when both axles follow the wall."""
CLOCK = 12
"""What the inertial unit's clock shows too much against the rings' clock [s]."""
ORIGIN = slice(13, 16)
"""Point of the axis at the first knot, east, north, up in the working frame [m]."""
BASE_UP, BASE_RIGHT = 16, 17
"""Direction from a rear scanner's centre to the front's against the one stated [rad], towards the robot's y and z."""
REAR_SCALE = 18
"""Ranges of a rear scanner over those of the front one, less one."""
SCALARS = 19

STEPS = np.full(BLOCK, 1e-6)
"""Steps of the numerical derivatives by each state of a knot."""
SCALAR_STEPS = np.array([1e-7] * 3 + [1e-4] * 3 + [1e-6] * 6 + [1e-4] + [1e-6] * 6)
"""The same for the scalars."""


@dataclass
class State:
    """Estimate at all knots.

    Attributes:
        distance: Odometer reading at each knot [m] (knot,).
        knots: (knot, BLOCK).
        scalars: (SCALARS,).
    """

    distance: np.ndarray
    knots: np.ndarray
    scalars: np.ndarray

    @property
    def axis(self) -> np.ndarray:
        """Points of the axis at the knots, in the working frame [m] (knot, 3)."""
        ways = np.cumsum(self.knots[:-1, AXIS], axis=0)
        return self.scalars[ORIGIN] + np.concatenate([np.zeros((1, 3)), ways])

    @property
    def along(self) -> np.ndarray:
        """Unit vectors of the ways from knot to knot, east, north, up (knot - 1, 3)."""
        ways = self.knots[:-1, AXIS]
        return ways / np.linalg.norm(ways, axis=1, keepdims=True)

    @property
    def step(self) -> float:
        """Odometer reading between knots [m]."""
        return float(self.distance[1] - self.distance[0])


def knots_over(first: float, last: float, step: float) -> np.ndarray:
    """Return knots at equal steps close to `step` that end at `first` and `last`; at least two.

    >>> knots_over(0.0, 0.16, 0.05).round(3).tolist()
    [0.0, 0.053, 0.107, 0.16]
    """
    count = max(round((last - first) / step), 1)
    return np.linspace(first, last, count + 1)


def place(distance: np.ndarray, knots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return each distance's interval (n,), and the share (n,) of it that is passed; beyond the ends outside 0..1."""
    step = knots[1] - knots[0]
    where = (distance - knots[0]) / step
    interval = np.clip(np.floor(where).astype(np.int64), 0, len(knots) - 2)
    return interval, where - interval
