"""A second ring scanner behind the first: the same section is seen twice, from two places of one rigid body.

The rear ring that is taken now shows the section that the front ring showed a baseline ago. How the robot came from
there to here the track knows; how the two scanners stand on the robot is known too. So the rear ring's place is told
from the state at the section itself, and what it shows differs from what the front saw by the side-slip times the
baseline: pairs of rings tell the side-slip, and with it the tilt, without asking ovality. Without an inertial log the
track knows nothing of how the robot turned in between; then the pipe is straight and both centres lie on its axis at
one time, so the baseline shows the tilt itself.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from ..errors import InputError
from .data import Rings
from .factors.base import Factor, Linear, local_columns, robust_weight
from .factors.rings import COLUMNS
from .factors.sensor import Places
from .rotations import dot, pipe_frame, rotate
from .states import BASE_RIGHT, BASE_UP, BLOCK, CLOCK, DIRECTION, OFFSET, REAR_SCALE, SCALE, TILT, State, place
from .torus import added_at

if TYPE_CHECKING:
    from .problem import Problem
    from .windows import Window

NAME = "rings_rear"
_SHORTEST = 0.02
_SIGMAS = 4.0
_STEP = 1e-6
_OWN = 2 * BLOCK + np.array([BASE_UP, BASE_RIGHT, REAR_SCALE])
_NORMAL = 0.4549
"""Median of a squared standard normal."""


@dataclass(frozen=True)
class Rear:
    """The rings of a rear scanner.

    Attributes:
        rings: By odometer and time as those of the front, each with its ellipse; `lever` is the rear scanner's place.
        sigma: One-sigma of the direction from the rear scanner's centre to the front's, as the levers state it [rad].
        scale: One-sigma of its ranges over those of the front scanner.
        mounting: The rear scanner's axes x, y, z in columns, on the front scanner's (3, 3).
    """

    rings: Rings
    sigma: float
    scale: float = 0.005
    mounting: np.ndarray = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        for name, value in (("sigma", self.sigma), ("scale", self.scale)):
            if not value > 0.0:
                raise InputError(f"rear.{name} is {value}", expected="a one-sigma above zero")

    def arm(self, front: Rings) -> np.ndarray:
        """Return the way from the front scanner to the rear one on the front's axes [m] (3,).

        Raises:
            InputError: They stand less than 20 mm apart along the robot.
        """
        way = np.subtract(self.rings.lever, front.lever)
        if not abs(way[0]) >= _SHORTEST:
            raise InputError(
                f"the rear scanner stands {1e3 * abs(way[0]):.0f} mm from the front one along the robot",
                where="rear.rings.lever",
                expected="20 mm or more",
                mend="state where both scanners stand on the robot",
            )
        return way


class RearFactor(Factor):
    """The factor of rear rings; derivatives come from the compiled kernel of rings."""

    many = True

    def __init__(self, problem: Problem, creep: Factor | None, window: Window) -> None:
        """Make the factor.

        Args:
            problem: With its rear rings.
            creep: Factor of the odometry, whose second group is what the robot strays across its way.
            window: Where the sections are that the rear rings show.
        """
        columns = np.concatenate([COLUMNS, _OWN])
        super().__init__(NAME, np.arange(0), columns, None, (slice(0, 2), slice(2, 5)))
        self._problem, self._creep = problem, creep
        rear, knots = problem.rear.rings, problem.knots
        self._arm = problem.rear.arm(problem.rings)
        at = rear.distance + self._arm[0]
        within = rear.seen & (at >= knots[0]) & (at <= knots[-1])
        within &= (rear.distance >= knots[0]) & (rear.distance <= knots[-1])
        within = np.flatnonzero(within)
        self.chosen = within[window.rows(place(at[within], knots)[0])]

    def linearise(self, state: State) -> Linear:
        """Return residuals, derivatives and weights at a state."""
        chosen = self.chosen
        measured = self._problem.rear.rings.parameters[chosen]
        at, shown, slopes = self._shown(chosen, state)
        self.interval = at.interval
        whitener = np.linalg.inv(np.linalg.cholesky(self._covariance(chosen, state)))
        residual = np.einsum("nij,nj->ni", whitener, shown - measured)
        weight = np.empty_like(residual)
        for rows in self.groups:
            square = np.sum(residual[:, rows] ** 2, axis=1)
            weight[:, rows] = robust_weight(square, rows.stop - rows.start, 0.0)[:, None]
        return Linear(self, residual, whitener @ slopes, weight)

    def _shown(self, chosen: np.ndarray, state: State) -> tuple[Places, np.ndarray, np.ndarray]:
        """Return the rings' places, the ellipses that they show, and the slopes of these."""
        at = self._places(chosen, state, np.zeros(2))
        shown, slopes = at.evaluate(0, state, COLUMNS)
        turned = [self._places(chosen, state, _STEP * one).evaluate(0, state, COLUMNS[:0])[0] for one in np.eye(2)]
        base = [(other - shown) / _STEP for other in turned]
        shown, scaled = shown + added_at(at, state), 1.0 + state.scalars[REAR_SCALE]
        own = np.stack([*(scaled * one for one in base), shown], axis=2)
        return at, scaled * shown, np.concatenate([scaled * slopes, own], axis=2)

    def _places(self, chosen: np.ndarray, state: State, turned: np.ndarray) -> Places:
        """Return the rear scanner's places, told from the knots beside the section that each ring shows."""
        problem, clock = self._problem, float(state.scalars[CLOCK])
        taken = problem.rear.rings.distance[chosen]
        interval, share = place(taken + self._arm[0], problem.knots)
        first = int(interval.min())
        around = problem.knots[first : int(interval.max()) + 2]
        marks = problem.marks(np.concatenate([around, taken]), clock)
        before, after, here = interval - first, interval - first + 1, slice(len(around), None)
        arm = self._arm + self._arm[0] * np.array([0.0, *(state.scalars[[BASE_UP, BASE_RIGHT]] + turned)])
        reach = marks.reach[here] - marks.reach[before]
        by_clock = marks.reach_by_clock[here] - marks.reach_by_clock[before]
        # The first column of a reach counts by the odometer's scale, and the arm does not.
        reach[..., 0] += marks.axes[here] @ arm / (1.0 + state.scalars[SCALE])
        by_clock[..., 0] += marks.axes_by_clock[here] @ arm / (1.0 + state.scalars[SCALE])
        return Places(
            interval=interval,
            share=share,
            step=problem.step,
            reach=reach,
            reach_by_clock=by_clock,
            span=marks.reach[after] - marks.reach[before],
            span_by_clock=marks.reach_by_clock[after] - marks.reach_by_clock[before],
            axes=marks.axes[here] @ problem.rear.mounting,
            axes_by_clock=marks.axes_by_clock[here] @ problem.rear.mounting,
            clock=clock,
            lever=problem.rings.lever,
        )

    def _covariance(self, chosen: np.ndarray, state: State) -> np.ndarray:
        """Return the covariance of the ellipses (n, 5, 5) with that of the way between the two scanners' rings."""
        out = self._problem.rear.rings.covariance[chosen].copy()
        out[:, [0, 1], [0, 1]] += self.astray(state)
        return out

    def astray(self, state: State) -> float:
        """Return the variance of a rear ring's centre by what the robot strayed over the baseline [m2].

        Neighbouring rings share it, so each counts for as many as lie within a baseline.
        """
        problem, own, base = self._problem, self._problem.options, abs(self._arm[0])
        alike = _alike(problem.rear.rings, base)
        across = own.across * (1.0 if self._creep is None else float(self._creep.scale[1]))
        slope = np.diff(state.knots[:, OFFSET], axis=0) / problem.step
        tilt = float(np.mean(np.sum(slope**2, axis=1)))
        rings = problem.rings
        seconds = base * float(np.median(np.diff(rings.time) / np.diff(rings.distance)))
        turning = own.gyro_noise**2 * seconds * base**2 / 3.0
        return alike * ((across**2 + own.along**2 * tilt) * base + turning)


def rear_misfit(problem: Problem, state: State) -> float:
    """Return the median square of the rear rings' residuals of shape over that of normal noise; NaN without rings."""
    factors = (RearFactor(problem, None, window) for window in problem.windows)
    parts = [one.linearise(state).residual[:, 2:] for one in factors if one.chosen.size]
    return float(np.median(np.concatenate(parts) ** 2) / _NORMAL) if parts else np.nan


def rear_factor(problem: Problem, creep: Factor | None, window: Window) -> Factor | None:
    """Return the factor of a window's rear rings: with a track from the section that both saw, else from the chord.

    None where the window has no such rings.
    """
    if problem.track is None:
        return _chord(problem, window)
    factor = RearFactor(problem, creep, window)
    return factor if factor.chosen.size else None


def _chord(problem: Problem, window: Window) -> Factor | None:
    """Return the factor that lays the rear rings' centres on the straight axis abreast of the front scanner."""
    rear, knots = problem.rear.rings, problem.knots
    arm = problem.rear.arm(problem.rings)
    chosen = np.flatnonzero(rear.seen & (rear.distance >= knots[0]) & (rear.distance <= knots[-1]))
    chosen = chosen[window.rows(place(rear.distance[chosen], knots)[0])]
    if not chosen.size:
        return None
    interval, share = place(rear.distance[chosen], knots)
    axes = problem.marks(rear.distance[chosen], 0.0).axes
    mounted, centre = axes @ problem.rear.mounting, rear.parameters[chosen, :2]
    # The pipe bends in between, and its axis walks from its tangent; neighbouring rings share that.
    walk = _alike(rear, abs(arm[0])) * problem.options.kink**2 * abs(arm[0]) ** 3 / 3.0
    sigma = np.sqrt(rear.covariance[chosen][:, [1, 0], [1, 0]] + walk)
    seen = mounted[..., 2] * centre[:, :1] + mounted[..., 1] * centre[:, 1:]

    def residual(before, after, scalars):
        here = before + share[:, None] * (after - before)
        way = arm + arm[0] * np.array([0.0, scalars[BASE_UP], scalars[BASE_RIGHT]])
        _, y, z = pipe_frame(here[:, DIRECTION.start], here[:, DIRECTION.start + 1])
        far = rotate(here[:, TILT], axes @ way + seen)
        return (here[:, OFFSET] + np.stack([dot(far, y), dot(far, z)], axis=1)) / sigma

    columns = local_columns(OFFSET, TILT, DIRECTION, scalars=(BASE_UP, BASE_RIGHT))
    return Factor(NAME, interval, columns, residual, (slice(0, 2),))


def crooked(problem: Problem, state: State) -> np.ndarray:
    """Return how far the pipe bends between the two scanners where no log tells it: up and right at each ring (n, 2).

    The chord's tilt against that of the sensor's drift, at its worst within a baseline; 0 where they agree as usual.

    Args:
        problem: Without a track, with an odometer and rear rings.
        state: The estimate.
    """
    bent, across = np.zeros((len(problem.rings.distance), 5)), np.empty((len(problem.knots) - 1, 2))
    for window in problem.windows:
        factor, rows = problem.factors(window, 0.0, bent)["odometry"], window.intervals
        across[rows] = factor.residual(state.knots[rows], state.knots[rows + 1], state.scalars)[:, 1:]
    tilt = across * problem.options.across / np.sqrt(problem.step)
    within = max(round(abs(problem.rear.arm(problem.rings)[0]) / problem.step), 1)
    mean = uniform_filter1d(tilt, within, axis=0, mode="nearest")
    usual = _SIGMAS * 1.4826 * np.median(np.abs(mean - np.median(mean, axis=0)), axis=0)
    interval, _ = place(problem.rings.distance, problem.knots)
    worst = maximum_filter1d(np.where(np.abs(mean) > usual, np.abs(mean), 0.0), within, axis=0, mode="nearest")
    return worst[interval]


def _alike(rings: Rings, length: float) -> float:
    """Return how many rings lie within a length, one at least."""
    return max(length / float(np.median(np.diff(rings.distance))), 1.0)
