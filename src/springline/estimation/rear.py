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

from ..errors import InputError
from .data import Rings
from .factors.base import Factor, Linear, robust_weight
from .factors.rings import COLUMNS, WINDOW
from .factors.sensor import Places
from .states import BASE_RIGHT, BASE_UP, BLOCK, CLOCK, OFFSET, SCALE, State, place
from .torus import added_at

if TYPE_CHECKING:
    from .problem import Problem

NAME = "rings_rear"
_SHORTEST = 0.02
_STEP = 1e-6
_BASE = np.array([2 * BLOCK + BASE_UP, 2 * BLOCK + BASE_RIGHT])
_FREE = 1e6
"""Factor on the variance of what is not asked of a ring."""
_NORMAL = 0.4549
"""Median of a squared standard normal."""


@dataclass(frozen=True)
class Rear:
    """The rings of a rear scanner.

    Attributes:
        rings: By odometer and time as those of the front, each with its ellipse; `lever` is the rear scanner's place.
        sigma: One-sigma of the direction from the rear scanner's centre to the front's, as the levers state it [rad].
        mounting: The rear scanner's axes x, y, z in columns, on the front scanner's (3, 3).
    """

    rings: Rings
    sigma: float
    mounting: np.ndarray = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        if not self.sigma > 0.0:
            raise InputError(f"rear.sigma is {self.sigma}", expected="a one-sigma above zero [rad]")

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

    def __init__(self, problem: Problem, creep: Factor | None, rows: slice | None = None) -> None:
        """Make the factor.

        Args:
            problem: With its rear rings.
            creep: Factor of the odometry, whose second group is what the robot strays across its way.
            rows: Which of the rear rings that show a section between the knots; all unless given.
        """
        columns = np.concatenate([COLUMNS, _BASE])
        super().__init__(NAME, np.arange(0), columns, None, (slice(0, 2), slice(2, 5)))
        self._problem, self._creep = problem, creep
        rear, knots = problem.rear.rings, problem.knots
        self._arm = problem.rear.arm(problem.rings)
        # Seen now, or a baseline ago: where the section is that the ring shows.
        self._behind = self._arm[0] if problem.track is not None else 0.0
        at = rear.distance + self._behind
        within = rear.seen & (at >= knots[0]) & (at <= knots[-1])
        within &= (rear.distance >= knots[0]) & (rear.distance <= knots[-1])
        self._all = np.flatnonzero(within)
        self._rows = rows or slice(0, len(self._all))

    def windows(self) -> list[Factor]:
        """Return the rings in windows that are small enough to linearise at once."""
        cuts = range(0, len(self._all), WINDOW)
        return [RearFactor(self._problem, self._creep, slice(first, first + WINDOW)) for first in cuts]

    def linearise(self, state: State) -> Linear:
        """Return residuals, derivatives and weights at a state."""
        chosen = self._all[self._rows]
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
        base = np.stack([(other - shown) / _STEP for other in turned], axis=2)
        if self._problem.track is not None:
            shown = shown + added_at(at, state)
        return at, shown, np.concatenate([slopes, base], axis=2)

    def _places(self, chosen: np.ndarray, state: State, turned: np.ndarray) -> Places:
        """Return the rear scanner's places, told from the knots beside the section that each ring shows."""
        problem, clock = self._problem, float(state.scalars[CLOCK])
        taken = problem.rear.rings.distance[chosen]
        interval, share = place(taken + self._behind, problem.knots)
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
        if self._problem.track is None:
            # The section is that of a baseline ago, where the robot stood otherwise: only the centre is used.
            out[:, :2, 2:] = out[:, 2:, :2] = 0.0
            out[:, 2:, 2:] *= _FREE
        return out

    def astray(self, state: State) -> float:
        """Return the variance of a rear ring's centre by what the robot strayed over the baseline [m2].

        Neighbouring rings share it, so each counts for as many as lie within a baseline.
        """
        problem, own, base = self._problem, self._problem.options, abs(self._arm[0])
        distance = problem.rear.rings.distance
        alike = max(base / float(np.median(np.diff(distance))), 1.0)
        if problem.track is None:
            # Both centres are seen at once; but the pipe bends in between, and its axis walks from its tangent.
            return alike * own.kink**2 * base**3 / 3.0
        across = own.across * (1.0 if self._creep is None else float(self._creep.scale[1]))
        slope = np.diff(state.knots[:, OFFSET], axis=0) / problem.step
        tilt = float(np.mean(np.sum(slope**2, axis=1)))
        rings = problem.rings
        seconds = base * float(np.median(np.diff(rings.time) / np.diff(rings.distance)))
        turning = own.gyro_noise**2 * seconds * base**2 / 3.0
        return alike * ((across**2 + own.along**2 * tilt) * base + turning)

    def misfit(self, state: State) -> tuple[float, float]:
        """Return the median squares of the residuals of centre and shape over those of normal noise; NaN unasked."""
        parts = [part.linearise(state).residual for part in self.windows()]
        if not parts:
            return np.nan, np.nan
        square = np.median(np.concatenate(parts) ** 2, axis=0) / _NORMAL
        return float(square[:2].max()), float(square[2:].max()) if self._problem.track is not None else np.nan
