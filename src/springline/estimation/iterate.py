"""Gauss-Newton with robust weights, the noise scales taken from the data on the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .linearised import Linearised, Step
from .mixing import Mixing
from .slow import slip_prior, slip_variance
from .states import State
from .tuning import Tuning

if TYPE_CHECKING:
    from .covariance import Covariance
    from .problem import Problem
    from .spill import Spill

_NORMAL = 0.4549
"""Median of a squared standard normal."""
_SETTLING = 1
"""Steps before noise scales are taken from the data: the start is too far off to tell them."""
_TUNED = 8
"""Steps after which they stand still in any case."""


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
    covariance: Covariance
    scales: dict[str, np.ndarray]
    misfit: float
    iterations: int
    converged: bool


def iterate(problem: Problem, state: State, bend, aside: Spill) -> Solution:
    """Return the estimate.

    Args:
        problem: The survey's factors.
        state: Where to start.
        bend: Function of a state: what bends add to the rings' ellipses [m] (n, 5).
        aside: Where windows are put; the covariance stays there.
    """
    tuning = Tuning(float(np.log(problem.options.unsure)))
    state, count, converged = _to_rest(problem, state, bend, tuning, aside)
    last = Linearised(problem, state, bend(state), tuning.scales, aside)
    stated = last.slip_variance()
    slips = slip_variance(problem, state, tuning.scales, stated)
    problem.slips = slip_prior(problem.options.slip, stated, slips)
    if problem.slips is not None:
        state, more, converged = _to_rest(problem, state, bend, tuning, aside)
        last, count = Linearised(problem, state, bend(state), tuning.scales, aside), count + more
    misfit = float(np.median(last.squares) / _NORMAL)
    return Solution(state, last.covariance(slips), tuning.scales, misfit, count, converged)


def _to_rest(problem: Problem, state: State, bend, tuning: Tuning, aside: Spill) -> tuple[State, int, bool]:
    """Return the estimate, how many steps it took, and whether it stands."""
    mixing, sigma, converged = Mixing(), np.ones_like(state.knots), False
    for count in range(1, problem.options.iterations + 1):
        tune = _SETTLING < count <= _TUNED and not tuning.settled
        step = Linearised(problem, state, bend(state), tuning.scales, aside).solve(tuning, tune=tune)
        sigma = sigma if step.sigma is None else step.sigma
        state = _moved(state, step, mixing, sigma)
        if not (tuning.settled or count >= _TUNED):
            mixing = Mixing()
        size = max(
            float(np.sqrt(np.mean((step.knots / sigma) ** 2, axis=0)).max()),
            0.3 * float(np.max(np.abs(step.scalars) / step.edge)),
        )
        converged = (tuning.settled or count > _TUNED) and size < problem.options.tolerance
        if converged:
            break
    return state, count, converged


def _moved(state: State, step: Step, mixing: Mixing, sigma: np.ndarray) -> State:
    """Return the state after a step, hastened by the steps before it."""
    place, change, scale = (
        np.concatenate([knots.ravel(), scalars])
        for knots, scalars in ((state.knots, state.scalars), (step.knots, step.scalars), (sigma, step.edge))
    )
    there = mixing.next(place, change, scale)
    return State(state.distance, there[: state.knots.size].reshape(state.knots.shape), there[state.knots.size :])
