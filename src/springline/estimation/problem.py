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
    """

    rings: Rings
    options: JointOptions
    knots: np.ndarray
    track: Track | None
    ties: Ties | None
    origin: np.ndarray
    north: bool
    rear: Rear | None = None

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

    def factors(self, clock: float, bent: np.ndarray) -> dict[str, Factor]:
        """Return all factors with the inertial clock near `clock`; `bent` as in `rings` (n, 5)."""
        own, intervals = self.options, len(self.knots) - 1
        seen = self.rings.seen
        distance = self.rings.distance[seen]
        out = [
            RingFactor(
                lambda rows: self.places(distance[rows], clock),
                self.rings.parameters[seen],
                self.rings.covariance[seen],
                bent[seen],
            ),
            section(intervals, self.step, own.trend, own.wander, own.tails),
            axis(intervals, self.step, own.kink, own.kink_tails, straight=self.track is None),
        ]
        if self.rings.odometer:
            # By number: rounding must not put a knot into the interval before it.
            every = (np.arange(intervals), np.zeros(intervals))
            starts = self.places(self.knots[:-1], clock, every)
            root = np.sqrt(self.step)
            along = np.hypot(own.along * root, _SPUN * self._spun)
            # Without a log it is a rear scanner that tells the attitude, if anything does.
            swings = self.track is None and self.rear is not None
            out.append(odometry(starts, along, own.across * root, own.tails, own.across_tails, swings=swings))
            # Creep and wander of an attitude that nothing else tells cannot both be taken from the data.
            out[-1].tuned = (False, self.track is not None or swings)
        if self.rear is not None:
            out.append(rear_factor(self, out[-1] if self.rings.odometer else None))
        out += self._inertial if self.track is not None else self._blind(intervals)
        value = np.zeros(SCALARS)
        value[ORIGIN] = self.origin
        out += [*self._gauge(), scalars(value, self._priors())]
        return {factor.name: factor for factor in out}

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
    def _inertial(self) -> list[Factor]:
        """The inertial log's own factors, which do not ask what the rings' clock shows."""
        own = self.options
        felt = self.track.between(self.knots)
        walk = np.sqrt(own.gyro_noise**2 * felt.spread[:, 0] + felt.spread[:, 1] + (1e-7) ** 2)
        force = (felt.force - felt.change) / felt.seconds[:, None]
        mean = felt.still / felt.seconds[:, None, None]
        return [
            gyro(felt.moving, walk),
            gravity(force, mean, felt.seconds, own.accel_noise / np.sqrt(felt.seconds), own.tails),
        ]

    def _blind(self, intervals: int) -> list[Factor]:
        """Return what takes the place of an inertial log: attitude wanders, roll and the pipe's direction stay."""
        walk = np.full(intervals, self.options.turning * np.sqrt(self.step))
        wanders = gyro(np.zeros((intervals, 3, 3)), walk)
        wanders.tuned = (True,)
        # The working frame's north is the pipe's own direction: roll is about it.
        level = known("level", np.arange(intervals + 1), np.array([TILT.start + 1]), np.zeros(1), np.array([_FIXED]))
        return [wanders, level]

    def _gauge(self) -> list[Factor]:
        first = np.zeros(1, np.int64)
        out = []
        # Beyond the last knot the axis goes nowhere: a state without a meaning.
        last = np.array([len(self.knots) - 1])
        out.append(known("end", last, np.arange(AXIS.start, AXIS.stop), np.zeros(3), np.ones(3)))
        if self.track is None:
            states = np.arange(DIRECTION.start, DIRECTION.stop)
            out.append(known("straight", np.arange(len(self.knots)), states, np.zeros(2), np.full(2, _FIXED)))
            if not self.rings.odometer:
                forward = np.array([0.0, self.step, 0.0])
                ways = np.arange(AXIS.start, AXIS.stop)
                out.append(known("spacing", np.arange(len(self.knots) - 1), ways, forward, np.full(3, self.step)))
            out.append(known("attitude", first, np.arange(TILT.start, TILT.stop), np.zeros(3), np.full(3, 0.1)))
        else:
            sigma = np.array([_LEVEL, _LEVEL, _NORTH if self.north else 1e-6])
            out.append(known("attitude", first, np.arange(TILT.start, TILT.stop), np.zeros(3), sigma))
        return out

    def _priors(self) -> np.ndarray:
        own = self.options
        sigma = np.empty(SCALARS)
        sigma[GYRO], sigma[ACCEL] = own.gyro_bias, own.accel_bias
        if self.track is not None and self.track.bias_time > 0.0:
            sigma[GYRO] = own.gyro_noise / np.sqrt(self.track.bias_time)
        sigma[[SCALE, SLIP_UP, SLIP_RIGHT, LEVER, LEVER_UP, AXLES, CLOCK]] = (
            own.scale,
            own.slip,
            own.slip,
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

    def threads(self, state: State) -> Threads | None:
        """Return the ties as the long threads from the origin along the axis that they are."""
        if self.ties is None:
            return None
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
