"""The robot's own track: the gyro and the odometer integrated once, before anything is estimated.

What the integration yields, less its slow errors, is exact at every frequency of the robot's weaving; the estimator
then needs knots for the slow errors alone.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from .attitude import Attitude
from .data import Inertial, Rings
from .rotations import cross, matrix
from .standstill import still_samples

REACH = 7
"""Columns of a reach: the integrals over distance of the forward axis and of the ways up and right of it, which do not
roll with the robot; the robot's three axes; and the turning."""
_TURN = 0.02
_SPEED = 0.25
_GAP = 3.0
_STRICTLY = 1e-9
_PART = 2000
"""Intervals whose samples are held at once."""


@dataclass(frozen=True)
class Marks:
    """The track at given distances.

    Attributes:
        axes: Robot axes x, y, z in columns, on Earth (n, 3, 3).
        reach: Columns as REACH says, on Earth (n, 3, REACH), from a place that all of one call share.
        axes_by_clock: Change of `axes` per second of clock offset.
        reach_by_clock: The same of `reach`.
    """

    axes: np.ndarray
    reach: np.ndarray
    axes_by_clock: np.ndarray
    reach_by_clock: np.ndarray


@dataclass(frozen=True)
class Felt:
    """What the inertial unit felt over consecutive intervals.

    Attributes:
        seconds: Length of each [s] (n,).
        force: Integral of specific force on Earth over time [m/s] (n, 3).
        still: Integral of the axes over time [s] (n, 3, 3).
        moving: Integral of the axes over the time of moving [s] (n, 3, 3).
        spread: Integral of the gyro's error variance, in units of its random walk squared [s], and of what gaps add
            [rad2] (n, 2).
        change: Of the velocity on Earth, by the odometer [m/s] (n, 3).
    """

    seconds: np.ndarray
    force: np.ndarray
    still: np.ndarray
    moving: np.ndarray
    spread: np.ndarray
    change: np.ndarray


class Track:
    """The inertial log integrated to attitudes on Earth, heading counted from an arbitrary north.

    Args:
        rings: For the odometer against time.
        inertial: The log.

    Attributes:
        still: Whether the robot stood still at each sample (m,).
        bias: Gyro bias that was taken off before integration [rad/s] (3,).
        bias_time: How long the standstills lasted that gave it [s].
        derived: Whether the log was made from attitudes.
    """

    def __init__(self, rings: Rings, inertial: Inertial) -> None:
        self._rings, self._log = rings, inertial
        self.derived = inertial.derived
        self.still = still_samples(inertial, rings.time)
        steps = np.diff(inertial.time)
        usual = np.median(steps)
        self._gap = steps > _GAP * usual
        self.bias_time = float(self.still.sum() * usual)
        self.bias = inertial.gyro[self.still].mean(axis=0) if self.bias_time else np.zeros(3)
        self._attitudes = Attitude(inertial, self.still, self.bias, self._level())
        self._moves = ~(self.still[1:] & self.still[:-1])
        self._active = _sum(steps * self._moves)
        # Standstills last no time of moving, but a place must be found in it.
        self._strictly = self._active + _STRICTLY * np.arange(len(self._active))
        self._typical = self._mean_square() if self._gap.any() else 0.0

    def _level(self) -> np.ndarray:
        """Return the robot's axes at the first sample, level by the accelerometer's first second, heading north."""
        log = self._log
        rows = self.still if self.still[: len(log.time) // 2].any() else log.time < log.time[0] + 1.0
        first = np.flatnonzero(rows)[0]
        up = log.accel[first : first + max(int(np.sum(rows[first:])), 1)][: int(np.sum(rows))].mean(axis=0)
        up = up / np.linalg.norm(up)
        forward = np.array([1.0, 0.0, 0.0]) - up[0] * up
        forward = forward / np.linalg.norm(forward)
        # Rows east, north, up on the robot's axes: forward points north, and east is to its right.
        return np.stack([np.cross(forward, up), forward, up])

    def _mean_square(self) -> float:
        """Return the usual square of a rate [rad2/s2], which stands for what a gap hides."""
        rate = np.where(self.still[:, None], 0.0, self._log.gyro - self.bias)
        return float(np.mean(rate**2))

    def turned(self, heading: float) -> None:
        """Turn the whole track clockwise by `heading` [rad]."""
        self._attitudes.turned(heading)

    def at(self, distance: np.ndarray, clock: float) -> Marks:
        """Return the track at odometer readings (n,) [m], the inertial clock showing `clock` seconds too much."""
        here, later = self._reaches(distance, clock), self._reaches(distance, clock + 1e-3)
        return Marks(here[0], here[1], (later[0] - here[0]) / 1e-3, (later[1] - here[1]) / 1e-3)

    def between(self, distance: np.ndarray) -> Felt:
        """Return what was felt between neighbouring odometer readings (n,) [m], by the inertial clock."""
        time = self._when(distance, 0.0)
        parts = [self._felt(time[first : first + _PART + 1]) for first in range(0, len(time) - 1, _PART)]
        return Felt(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Felt)))

    def _felt(self, time: np.ndarray) -> Felt:
        rows = self._rows(time)
        log, axes = self._log.time[rows], self._attitudes.at(rows)
        within = slice(rows.start, rows.stop - 1)
        steps, moves = np.diff(log), self._moves[within]
        both = 0.5 * (axes[1:] + axes[:-1]) * steps[:, None, None]
        force = np.einsum("nij,nj->ni", axes, self._log.accel[rows])
        gap = np.where(self._gap[within], self._typical * steps**2, 0.0)

        def over(values: np.ndarray) -> np.ndarray:
            return np.diff(_up_to(time, log, _sum(values)), axis=0)

        speed = (self._distance(time + _SPEED, 0.0) - self._distance(time - _SPEED, 0.0)) / (2.0 * _SPEED)
        return Felt(
            seconds=np.maximum(np.diff(time), 1e-6),
            force=over(0.5 * (force[1:] + force[:-1]) * steps[:, None]),
            still=over(both),
            moving=over(both * moves[:, None, None]),
            spread=over(np.stack([steps * moves, gap], axis=1)),
            change=np.diff(speed[:, None] * self._attitude(time)[0][..., 0], axis=0),
        )

    def _rows(self, time: np.ndarray) -> slice:
        """Return the samples that hold all times between them."""
        low, high = np.searchsorted(self._log.time, (time.min(), time.max()))
        return slice(max(int(low) - 2, 0), min(int(high) + 2, len(self._log.time)))

    def _reaches(self, distance: np.ndarray, clock: float) -> tuple[np.ndarray, np.ndarray]:
        time = self._when(distance, clock)
        rows = self._rows(time)
        counted = _extended(self._active[rows], self._motion(self._rings.time + clock), self._rings.distance)
        sampled = _upright(self._attitudes.at(rows))
        cumulated = _sum(0.5 * (sampled[1:] + sampled[:-1]) * np.diff(counted)[:, None, None])
        axes, row = self._attitude(time)
        start = row - rows.start
        within = 0.5 * (sampled[start] + _upright(axes))
        reach = cumulated[start] + within * (distance - counted[start])[:, None, None]
        ahead, behind = (self._attitude(self._when(distance + step, clock))[0][..., 0] for step in (_TURN, -_TURN))
        turning = (ahead - behind) / (2.0 * _TURN)
        return axes, np.concatenate([reach, axes, turning[..., None]], axis=2)

    def _attitude(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        row = np.clip(np.searchsorted(self._log.time, time, side="right") - 1, 0, len(self._log.time) - 2)
        since = np.clip(time - self._log.time[row], 0.0, None)
        rows = slice(int(row.min()), int(row.max()) + 2)
        before = row - rows.start
        axes, rate = self._attitudes.at(rows), self._attitudes.rates(rows)
        return axes[before] @ matrix(rate[before] * since[:, None]), row

    def _distance(self, time: np.ndarray, clock: float) -> np.ndarray:
        """Return the odometer reading at inertial times; standstills do not move it."""
        return _extended(self._motion(time), self._motion(self._rings.time + clock), self._rings.distance)

    def _when(self, distance: np.ndarray, clock: float) -> np.ndarray:
        active = _extended(distance, self._rings.distance, self._motion(self._rings.time + clock))
        # Arriving comes before standing still: the earliest time at which so much motion is done.
        return np.interp(active, self._strictly, self._log.time)

    def _motion(self, time: np.ndarray) -> np.ndarray:
        """Return how long the robot has been moving at each inertial time [s]."""
        return np.interp(time, self._log.time, self._active)


def _upright(axes: np.ndarray) -> np.ndarray:
    """Return the forward axis and the ways up and right of it (n, 3, 3), from robot axes in columns: no roll."""
    x = axes[..., 0]
    right = np.stack([x[..., 1], -x[..., 0], np.zeros(len(x))], axis=-1)
    right = right / np.linalg.norm(right, axis=-1, keepdims=True)
    return np.stack([x, cross(right, x), right], axis=-1)


def _up_to(time: np.ndarray, log: np.ndarray, cumulated: np.ndarray) -> np.ndarray:
    """Return running sums (m, ...) at the samples `log` (m,), at times between them."""
    row = np.clip(np.searchsorted(log, time, side="right") - 1, 0, len(log) - 2)
    share = ((time - log[row]) / (log[row + 1] - log[row])).reshape(-1, *([1] * (cumulated.ndim - 1)))
    return cumulated[row] + share * (cumulated[row + 1] - cumulated[row])


def _sum(steps: np.ndarray) -> np.ndarray:
    """Return running sums that start at zero."""
    return np.concatenate([np.zeros((1, *steps.shape[1:])), np.cumsum(steps, axis=0)])


def _extended(x: np.ndarray, at: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return `values` interpolated at x; beyond the first and last by at most what the ends' usual speed covers."""
    inside = np.interp(x, at, values)
    span = min(len(at) - 1, 50)
    first = (values[span] - values[0]) / (at[span] - at[0])
    last = (values[-1] - values[-1 - span]) / (at[-1] - at[-1 - span])
    return inside + first * np.minimum(x - at[0], 0.0) + last * np.maximum(x - at[-1], 0.0)
