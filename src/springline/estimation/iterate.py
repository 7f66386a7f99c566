"""Gauss-Newton with robust weights, the noise scales taken from the data on the way."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .factors.base import Linear
from .mixing import Mixing
from .problem import Problem
from .solver import Factored, Normal, solve
from .states import BLOCK, CLOCK, SCALARS, State

_NORMAL = 0.4549
"""Median of a squared standard normal."""
_SETTLING = 1
"""Steps before noise scales are taken from the data: the start is too far off to tell them."""
_TUNED = 8
"""Steps after which they stand still in any case."""
_TIMES, _TIMES_TUNING = 3, 6
"""How often robust weights, and with them the scales, are set anew before factors are linearised again."""
_GROWTH, _MOST = 1.4, 2.0
"""How a scale's gain grows while it is asked on, and the largest."""
_CALM = 0.4
"""What a gain is multiplied by when its scale is asked back."""
_FURTHEST = 1.0
"""Largest change of a scale's logarithm at once."""
_ENOUGH = 0.05
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
    """Noise scales on their way to where the data, and what is thought of them beforehand, put them.

    Two scales that explain the same residuals push one another to and fro; so each has its own gain, which falls
    whenever it is asked back.

    Attributes:
        unsure: One-sigma of a scale's logarithm beforehand. A noise that the data say nothing of stays near its start,
            instead of falling to nothing, which no real pipe or robot keeps to.
        scales: Factor name to its groups' one-sigma over the stated one.
        settled: Whether all rest.
    """

    unsure: float
    scales: dict[str, np.ndarray] = field(default_factory=dict)
    settled: bool = False
    _gains: dict[str, np.ndarray] = field(default_factory=dict)
    _last: dict[str, np.ndarray] = field(default_factory=dict)

    def follow(self, balances: dict[str, np.ndarray], tuned: dict[str, tuple[bool, ...]]) -> None:
        """Move every scale as the balance of its residuals asks: squares left over, and how many are free (g, 2)."""
        self.settled = True
        for name, balance in balances.items():
            scale = self.scales.get(name, np.ones(len(balance)))
            back = -np.log(scale) / self.unsure**2
            left, free = balance[:, 0] + np.maximum(back, 0.0), balance[:, 1] + np.maximum(-back, 0.0)
            asked = np.where(tuned[name], 0.5 * np.log(np.maximum(left, 1e-9) / np.maximum(free, 1e-9)), 0.0)
            asked = np.clip(asked, -_FURTHEST, _FURTHEST)
            gain, last = self._gains.get(name, np.ones(len(asked))), self._last.get(name, asked)
            gain = np.where(asked * last < 0.0, _CALM * gain, np.minimum(_GROWTH * gain, _MOST))
            self.scales[name] = scale * np.exp(np.clip(gain * asked, -_FURTHEST, _FURTHEST))
            self._gains[name], self._last[name] = gain, asked
            self.settled &= bool((np.abs(asked) < _ENOUGH).all())


def iterate(problem: Problem, state: State, bend) -> Solution:
    """Return the estimate.

    Args:
        problem: The survey's factors.
        state: Where to start.
        bend: Function of a state: what bends add to the rings' ellipses [m] (n, 5).
    """
    tuning, mixing = Tuning(np.log(problem.options.unsure)), Mixing()
    sigma = None
    converged = False
    for count in range(1, problem.options.iterations + 1):
        tune = _SETTLING < count <= _TUNED and not tuning.settled
        linear = Linearised(problem, state, bend, tuning.scales)
        found = linear.solve(tuning, tune=tune)
        if tune or sigma is None:
            sigma = np.sqrt(np.einsum("kii->ki", found.diagonal)) if tune else np.ones_like(state.knots)
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
    last = Linearised(problem, state, bend, tuning.scales)
    found = last.once(covariance=True)
    misfit = float(np.median(last.squares) / _NORMAL)
    return Solution(state, found, tuning.scales, misfit, count, converged)


def _moved(state: State, found: Factored, mixing: Mixing, sigma: np.ndarray, edge: np.ndarray) -> State:
    """Return the state after a step, hastened by the steps before it."""
    place, step, scale = (
        np.concatenate([knots.ravel(), scalars])
        for knots, scalars in ((state.knots, state.scalars), (found.knots, found.scalars), (sigma, edge))
    )
    there = mixing.next(place, step, scale)
    return State(state.distance, there[: state.knots.size].reshape(state.knots.shape), there[state.knots.size :])


class Linearised:
    """All factors at a state: rings as they stand, and the others with weights that are set anew time after time."""

    def __init__(self, problem: Problem, state: State, bend, scales: dict[str, np.ndarray]) -> None:
        self._state, self._threads = state, problem.threads(state)
        self._rings = Normal.zeros(len(state.knots), BLOCK, SCALARS)
        self._others: dict[str, Linear] = {}
        squares = []
        for name, factor in problem.factors(float(state.scalars[CLOCK]), bend(state)).items():
            factor.scale = scales[name].copy() if name in scales else factor.scale
            for part in factor.windows():
                one = part.linearise(state)
                if factor.many:
                    one.add(self._rings)
                else:
                    self._others[name] = one
                if name == "rings":
                    squares.append(one.residual.ravel() ** 2)
        self.squares = np.concatenate(squares)

    def solve(self, tuning: Tuning, *, tune: bool) -> Factored:
        """Return the step, weights and scales set anew a few times on the way."""
        for _ in range(_TIMES_TUNING if tune else _TIMES):
            found = self.once(covariance=tune)
            left = {name: one.after(found) for name, one in self._others.items()}
            if tune:
                balances = {
                    name: one.balance(found, left[name]) for name, one in self._others.items() if any(one.factor.tuned)
                }
                tuning.follow(balances, {name: self._others[name].factor.tuned for name in balances})
            for name, one in self._others.items():
                one.factor.scale = tuning.scales.get(name, one.factor.scale)
                one.weight = one.factor.weights(left[name])
        return found

    def once(self, *, covariance: bool) -> Factored:
        """Return the step at the weights as they are."""
        normal = self._rings.copy()
        for one in self._others.values():
            one.add(normal)
        return solve(normal, self._threads, self._state.along, covariance=covariance)
