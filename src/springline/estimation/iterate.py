"""Gauss-Newton with robust weights, the noise scales taken from the data on the way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .problem import Problem
from .solver import Factored, Normal, solve
from .states import BLOCK, CLOCK, SCALARS, State

_NORMAL = 0.4549
"""Median of a squared standard normal."""
_SETTLING = 1
_TUNED = 6
"""Steps after which scales are first, and last, taken from the data: then the weights stand still."""


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


def iterate(problem: Problem, state: State, bend) -> Solution:
    """Return the estimate.

    Args:
        problem: The survey's factors.
        state: Where to start.
        bend: Function of a state: what bends add to the rings' ellipses [m] (n, 5).
    """
    scales: dict[str, np.ndarray] = {}
    converged = False
    for count in range(1, problem.options.iterations + 1):
        factors = problem.factors(float(state.scalars[CLOCK]), bend(state))
        normal = Normal.zeros(len(state.knots), BLOCK, SCALARS)
        linear, squares = {}, []
        for name, factor in factors.items():
            factor.scale = scales.get(name, factor.scale)
            for part in factor.windows():
                one = part.linearise(state)
                one.add(normal)
                if name == "rings":
                    squares.append(one.residual**2)
                else:
                    linear[name] = one
        found = solve(normal, problem.threads(state), state.along)
        if converged:
            break
        before = {name: factors[name].scale.copy() for name in linear}
        for name, one in linear.items():
            if _SETTLING < count <= _TUNED:
                one.tune(found)
            scales[name] = factors[name].scale
        state = State(state.distance, state.knots + found.knots, state.scalars + found.scalars)
        sigma = np.sqrt(np.einsum("kii->ki", found.diagonal))
        step = max(
            float(np.sqrt(np.mean((found.knots / sigma) ** 2, axis=0)).max()),
            0.3 * float(np.max(np.abs(found.scalars) / np.sqrt(np.diag(found.corner)))),
        )
        steady = all(np.allclose(before[name], scales[name], rtol=0.1) for name in scales)
        converged = count > _SETTLING + 1 and step < problem.options.tolerance and steady
    misfit = float(np.median(np.concatenate(squares)) / _NORMAL)
    return Solution(state, found, scales, misfit, count, converged)
