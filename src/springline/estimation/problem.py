"""The factors of one survey, made anew whenever the clocks' offset has moved."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.ndimage import median_filter

from .data import Rings, Ties
from .factors.axis import axis
from .factors.base import Factor
from .factors.inertial import gravity, gyro
from .factors.odometry import odometry
from .factors.priors import known, scalars
from .factors.rings import RingFactor
from .factors.section import section
from .factors.sensor import Places
from .options import JointOptions
from .rear import Rear, rear_factor
from .solver import Threads
from .states import (
    ACCEL,
    AXIS,
    AXLES,
    BASE_RIGHT,
    BASE_UP,
    CLOCK,
    DIRECTION,
    GYRO,
    LEVER,
    LEVER_UP,
    ORIGIN,
    REAR_SCALE,
    SCALARS,
    SCALE,
    SLIP_RIGHT,
    SLIP_UP,
    TILT,
    State,
    place,
)
from .track import REACH, Marks, Track
from .windows import Window, cut

_FIXED = 1e-6
_NEARBY = 1.0
_SPINNING = 0.25
"""Share of an interval that must be counted too much before wheels are thought to have spun."""
_SPUN = 0.4
"""One-sigma over what was counted too much; all of it would leave those intervals without any length."""
_LEVEL = 0.1
_NORTH = 0.05
"""One-sigma of the first attitude after alignment [rad]; looser ones only cost digits along a thousand knots."""


@dataclass
class Problem:
    """Everything the estimate stands on.

    Attributes:
        rings: The rings.
        options: Settings.
        knots: Odometer reading at each knot [m].
        track: The integrated inertial log; None when there is none.
        ties: Known points with positions in the working frame; None when there are none.
        origin: Where the axis is thought to begin, in the working frame [m] (3,).
        north: Whether the ties tell the way north.
        rear: Rings of a rear scanner; None when there is none.
        slips: Prior of the slip up and to the right [rad] (2,) where it is not that of the options.
    """

    rings: Rings
    options: JointOptions
    knots: np.ndarray
    track: Track | None
    ties: Ties | None
    origin: np.ndarray
    north: bool
    rear: Rear | None = None
    slips: np.ndarray | None = None

    @property
    def step(self) -> float:
        """Odometer reading between knots [m]."""
        return float(self.knots[1] - self.knots[0])

    def marks(self, distance: np.ndarray, clock: float) -> Marks:
        """Return the track at odometer readings."""
        return self.track.at(distance, clock) if self.track is not None else level_marks(distance)

    def places(self, distance: np.ndarray, clock: float, within: tuple[np.ndarray, np.ndarray] | None = None) -> Places:
        """Return places between the knots, in order; `within` tells interval and share where they are known."""
        interval, share = place(distance, self.knots) if within is None else within
        first = int(interval.min())
        around = self.knots[first : int(interval.max()) + 2]
        # One call, so that places and knots are told from the same place.
        marks = self.marks(np.concatenate([around, distance]), clock)
        before, after = interval - first, interval - first + 1
        here = slice(len(around), None)
        return Places(
            interval=interval,
            share=share,
            step=self.step,
            reach=marks.reach[here] - marks.reach[before],
            reach_by_clock=marks.reach_by_clock[here] - marks.reach_by_clock[before],
            span=marks.reach[after] - marks.reach[before],
            span_by_clock=marks.reach_by_clock[after] - marks.reach_by_clock[before],
            axes=marks.axes[here],
            axes_by_clock=marks.axes_by_clock[here],
            clock=clock,
            lever=self.rings.lever,
        )

    @cached_property
    def intervals(self) -> np.ndarray:
        """Knot before each ring (n,)."""
        return place(self.rings.distance, self.knots)[0]

    @cached_property
    def windows(self) -> list[Window]:
        """What is linearised, eliminated and told at once."""
        return cut(self.intervals, len(self.knots) - 1)

    def factors(self, window: Window, clock: float, bent: np.ndarray) -> dict[str, Factor]:
        """Return the factors of a window with the inertial clock near `clock`; `bent` as in `rings` (n, 5)."""
        own, intervals = self.options, window.intervals
        out: list[Factor] = []
        rows = window.rows(self.intervals)
        seen = rows.start + np.flatnonzero(self._seen[rows])
        if seen.size:
            at = self.places(self.rings.distance[seen], clock)
            out.append(RingFactor(at, self.rings.parameters[seen], self.rings.covariance[seen], bent[seen]))
        out.append(section(intervals, self.step, own.trend, own.wander, own.tails))
        out.append(axis(intervals, self.step, own.kink, own.kink_tails, straight=self.track is None))
        creep = None
        if self.rings.odometer:
            # By number: rounding must not put a knot into the interval before it.
            starts = self.places(self.knots[intervals], clock, (intervals, np.zeros(len(intervals))))
            root = np.sqrt(self.step)
            along = np.hypot(own.along * root, _SPUN * self._spun[intervals])
            # Without a log it is a rear scanner that tells the attitude, if anything does.
            swings = self.track is None and self.rear is not None
            creep = odometry(starts, along, own.across * root, own.tails, own.across_tails, swings=swings)
            # Creep and wander of an attitude that nothing else tells cannot both be taken from the data.
            creep.tuned = (False, self.track is not None or swings)
            out.append(creep)
        out += self._felt_over(intervals) if self.track is not None else self._blind(window)
        value = np.zeros(SCALARS)
        value[ORIGIN] = self.origin
        out += self._gauge(window)
        if window.first == 0:
            out.append(scalars(value, self._priors()))
        factors = {factor.name: factor for factor in out}
        if self.rear is not None and (seen_twice := rear_factor(self, creep, window)) is not None:
            factors[seen_twice.name] = seen_twice
        return factors

    @cached_property
    def _seen(self) -> np.ndarray:
        """Whether each ring has an ellipse (n,)."""
        return self.rings.seen

    @cached_property
    def _spun(self) -> np.ndarray:
        """What the odometer counted over each interval beyond the usual speed nearby [m]: wheels may have spun."""
        if self.rings.time is None:
            return np.zeros(len(self.knots) - 1)
        seconds = np.maximum(np.diff(np.interp(self.knots, self.rings.distance, self.rings.time)), 1e-6)
        usual = median_filter(self.step / seconds, 2 * round(_NEARBY / self.step) + 1, mode="nearest")
        more = self.step - usual * seconds
        return np.where(more > _SPINNING * self.step, more, 0.0)

    @cached_property
    def _inertial(self) -> tuple[np.ndarray, ...]:
        """What the inertial log tells of each interval, which does not ask what the rings' clock shows."""
        felt = self.track.between(self.knots)
        walk = np.sqrt(self.options.gyro_noise**2 * felt.spread[:, 0] + felt.spread[:, 1] + (1e-7) ** 2)
        force = (felt.force - felt.change) / felt.seconds[:, None]
        return felt.moving, walk, force, felt.still / felt.seconds[:, None, None], felt.seconds

    def _felt_over(self, intervals: np.ndarray) -> list[Factor]:
        """Return the inertial log's own factors."""
        own = self.options
        moving, walk, force, mean, seconds = (values[intervals] for values in self._inertial)
        noise = own.accel_noise / np.sqrt(seconds)
        return [gyro(intervals, moving, walk), gravity(intervals, force, mean, noise, own.tails)]

    def _blind(self, window: Window) -> list[Factor]:
        """Return what takes the place of an inertial log: attitude wanders, roll and the pipe's direction stay."""
        intervals = window.intervals
        walk = np.full(len(intervals), self.options.turning * np.sqrt(self.step))
        wanders = gyro(intervals, np.zeros((len(intervals), 3, 3)), walk)
        wanders.tuned = (True,)
        # The working frame's north is the pipe's own direction: roll is about it.
        level = known("level", _own(window), np.array([TILT.start + 1]), np.zeros(1), np.array([_FIXED]))
        return [wanders, level]

    def _gauge(self, window: Window) -> list[Factor]:
        first, tilt = np.zeros(1, np.int64), np.arange(TILT.start, TILT.stop)
        out = []
        if window.ends:
            # Beyond the last knot the axis goes nowhere: a state without a meaning.
            ways = np.arange(AXIS.start, AXIS.stop)
            out.append(known("end", np.array([window.last]), ways, np.zeros(3), np.ones(3)))
        if self.track is None:
            states = np.arange(DIRECTION.start, DIRECTION.stop)
            out.append(known("straight", _own(window), states, np.zeros(2), np.full(2, _FIXED)))
            if not self.rings.odometer:
                forward = np.array([0.0, self.step, 0.0])
                ways = np.arange(AXIS.start, AXIS.stop)
                knots = _own(window)
                knots = knots[knots < len(self.knots) - 1]
                out.append(known("spacing", knots, ways, forward, np.full(3, self.step)))
        if window.first == 0:
            free = np.array([_LEVEL, _LEVEL, _NORTH if self.north else 1e-6])
            out.append(known("attitude", first, tilt, np.zeros(3), free if self.track is not None else np.full(3, 0.1)))
        return out

    def _priors(self) -> np.ndarray:
        own = self.options
        sigma = np.empty(SCALARS)
        sigma[GYRO], sigma[ACCEL] = own.gyro_bias, own.accel_bias
        if self.track is not None and self.track.bias_time > 0.0:
            sigma[GYRO] = own.gyro_noise / np.sqrt(self.track.bias_time)
        sigma[[SCALE, SLIP_UP, SLIP_RIGHT, LEVER, LEVER_UP, AXLES, CLOCK]] = (
            own.scale,
            *((own.slip, own.slip) if self.slips is None else self.slips),
            own.lever,
            own.lever,
            own.axles,
            own.clock,
        )
        sigma[[BASE_UP, BASE_RIGHT]] = _FIXED if self.rear is None else self.rear.sigma
        sigma[REAR_SCALE] = _FIXED if self.rear is None else self.rear.scale
        sigma[ORIGIN] = 1.0 if self.ties is not None else 1e-6
        if self.track is None:
            sigma[[*range(GYRO.start, ACCEL.stop), CLOCK, SCALE]] = _FIXED
        return sigma

    def threads(self, state: State) -> Threads:
        """Return the ties as the long threads from the origin along the axis that they are."""
        if self.ties is None:
            return Threads.none()
        interval, share = place(np.asarray(self.ties.distance, float), self.knots)
        point = state.axis[interval] + share[:, None] * state.knots[interval, AXIS]
        return Threads(interval, share, self.ties.position - point, np.asarray(self.ties.sigma, float))


def level_marks(distance: np.ndarray) -> Marks:
    """Return the track of a robot that drives straight north and level: the stand-in for a missing inertial log."""
    count = len(distance)
    axes = np.broadcast_to(np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), (count, 3, 3))
    reach = np.zeros((count, 3, REACH))
    reach[:, :, :3], reach[:, :, 3:6] = axes * distance[:, None, None], axes
    return Marks(axes, reach, np.zeros((count, 3, 3)), np.zeros_like(reach))


def _own(window: Window) -> np.ndarray:
    """Return the numbers of a window's knots; the border knot is the earlier window's."""
    return np.arange(window.first + (window.first > 0), window.last + 1)
