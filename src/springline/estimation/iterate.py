"""Gauss-Newton with robust weights, the noise scales taken from the data on the way."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .elimination import add_products
from .factors.base import Factor, Linear
from .mixing import Mixing
from .problem import Problem
from .rear import RearFactor
from .solver import Factored, Normal, solve
from .states import BLOCK, CLOCK, OFFSET, SCALARS, SECTION, SLIP_RIGHT, SLIP_UP, State

_NORMAL = 0.4549
"""Median of a squared standard normal."""
_SETTLING = 1
_TUNED = 9
"""Steps after which scales are first, and last, taken from the data: then the weights stand still."""
_EAGER = 1.0
"""First gain of a scale."""
_GROWTH, _MOST = 1.4, 4.0
"""How a gain grows while its scale is asked on, and the largest."""
_CALM = 0.35
"""What a gain is multiplied by when its scale is asked back."""
_ENOUGH = 0.1
"""Change of a scale's logarithm that is let be."""


@dataclass(frozen=True)
class Solution:
    """Where the iteration came to rest.

    Attributes:
        state: The estimate.
        covariance: Blocks of its covariance.
        scales: Factor name to its groups' one-sigma over the stated one.
        misfit: Median squared residual of the rings over that of normal noise.
        iterations: Steps taken.
        converged: Whether the last step was within the tolerance.
    """

    state: State
    covariance: Factored
    scales: dict[str, np.ndarray]
    misfit: float
    iterations: int
    converged: bool


@dataclass
class Tuning:
    """Noise scales on their way to where the data put them.

    Two scales that explain the same residuals push one another to and fro; so each has its own gain, which falls
    whenever it is asked back.

    Attributes:
        scales: Factor name to its groups' one-sigma over the stated one.
        settled: Whether all rest.
    """

    scales: dict[str, np.ndarray] = field(default_factory=dict)
    settled: bool = False
    _gains: dict[str, np.ndarray] = field(default_factory=dict)
    _last: dict[str, np.ndarray] = field(default_factory=dict)

    def follow(self, linear: list[Linear], found: Factored) -> None:
        """Move every scale as its residuals ask."""
        self.settled = True
        for one in linear:
            name, asked = one.factor.name, one.asked(found)
            gain = self._gains.get(name, np.full(len(asked), _EAGER))
            back = asked * self._last.get(name, asked) < 0.0
            gain = np.where(back, _CALM * gain, np.minimum(_GROWTH * gain, _MOST))
            change = np.exp(np.clip(gain * asked, -2.3, 2.3))
            self.scales[name] = np.clip(one.factor.scale * change, 1e-3, 1e3)
            self._gains[name], self._last[name] = gain, asked
            self.settled &= bool((np.abs(asked) < _ENOUGH).all())


def iterate(problem: Problem, state: State, bend) -> Solution:
    """Return the estimate.

    Args:
        problem: The survey's factors.
        state: Where to start.
        bend: Function of a state: what bends add to the rings' ellipses [m] (n, 5).
    """
    tuning, mixing = Tuning(), Mixing()
    sigma = np.ones_like(state.knots)
    converged = False
    for count in range(1, problem.options.iterations + 1):
        tune = count > _SETTLING and not tuning.settled and count <= _TUNED
        step = _step(problem, state, bend, tuning.scales, covariance=tune)
        found = step.found
        if tune:
            tuning.follow(step.linear, found)
            sigma = np.sqrt(np.einsum("kii->ki", found.diagonal))
        edge = np.sqrt(np.diag(found.corner))
        state = _moved(state, found, mixing, sigma, edge)
        if not (tuning.settled or count >= _TUNED):
            mixing = Mixing()
        size = max(
            float(np.sqrt(np.mean((found.knots / sigma) ** 2, axis=0)).max()),
            0.3 * float(np.max(np.abs(found.scalars) / edge)),
        )
        converged = (tuning.settled or count > _TUNED) and size < problem.options.tolerance
        if converged:
            break
    last = _step(problem, state, bend, tuning.scales, covariance=True)
    doubt_slip(last.found, state, problem)
    misfit = float(np.median(last.squares) / _NORMAL)
    return Solution(state, last.found, tuning.scales, misfit, count, converged)


def doubt_slip(found: Factored, state: State, problem: Problem) -> None:
    """Widen the covariance by what the rings' shapes are in doubt by all along, where they tell the side-slip.

    A slip of s fakes an ovality of radius times tilt times s while the robot weaves; a doubt in ovality is one in slip,
    and in whatever hangs on slip.
    """
    tilt = weaving(problem, state)
    if not tilt > 0.0:
        return
    slip = problem.options.shape / (float(np.median(state.knots[:, SECTION.start])) * tilt)
    rear = 0.0 if problem.rear is None else RearFactor(problem, None).slip_information(state)
    for column in (SLIP_UP, SLIP_RIGHT):
        variance = found.corner[column, column]
        # What a change of slip by one, with all that hangs on it, does to every state.
        along, corner = found.border[:, :, column] / variance, found.corner[:, column] / variance
        # What pairs of rings tell of the slip does not hang on their shape.
        more = max((slip * max(1.0 - rear * variance, 0.0)) ** 2 - variance, 0.0)
        add_products(found.diagonal, found.beside, more * along[:, :, None], along[:, :, None])
        found.border += more * along[:, :, None] * corner
        found.corner = found.corner + more * np.outer(corner, corner)


def weaving(problem: Problem, state: State) -> float:
    """Return how much the robot's direction weaves about the pipe's: root mean square tilt less its mean [rad]."""
    if problem.track is None:
        return 0.0
    # The way of the offset along the pipe is the tilt, slip apart.
    slope = np.diff(state.knots[:, OFFSET], axis=0) / np.diff(state.distance)[:, None]
    return float(np.sqrt(np.sum(np.var(slope, axis=0))))


def _moved(state: State, found: Factored, mixing: Mixing, sigma: np.ndarray, edge: np.ndarray) -> State:
    """Return the state after a step, hastened by the steps before it."""
    place, step, scale = (
        np.concatenate([knots.ravel(), scalars])
        for knots, scalars in ((state.knots, state.scalars), (found.knots, found.scalars), (sigma, edge))
    )
    there = mixing.next(place, step, scale)
    return State(state.distance, there[: state.knots.size].reshape(state.knots.shape), there[state.knots.size :])


class _Step(NamedTuple):
    found: Factored
    factors: dict[str, Factor]
    linear: list[Linear]
    squares: np.ndarray


def _step(problem: Problem, state: State, bend, scales: dict[str, np.ndarray], *, covariance: bool) -> _Step:
    """Return the step from a state, the factors, all but the rings' as they are there, and the rings' squares."""
    normal = Normal.zeros(len(state.knots), BLOCK, SCALARS)
    linear, squares = [], []
    factors = problem.factors(float(state.scalars[CLOCK]), bend(state))
    for name, factor in factors.items():
        factor.scale = scales[name].copy() if name in scales else factor.scale
        for part in factor.windows():
            one = part.linearise(state)
            one.add(normal)
            if name == "rings":
                squares.append(one.residual.ravel() ** 2)
            elif covariance and any(factor.tuned):
                linear.append(one)
    found = solve(normal, problem.threads(state), state.along, covariance=covariance)
    return _Step(found, factors, linear, np.concatenate(squares))
