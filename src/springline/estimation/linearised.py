"""All factors at one state, window by window, and the steps that they ask for at one set of weights after another."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .factors.base import Factor, Linear
from .solver import Normal, Sweep
from .states import BLOCK, CLOCK, SCALARS, SLIP_RIGHT, SLIP_UP, State

if TYPE_CHECKING:
    from .covariance import Covariance
    from .problem import Problem
    from .spill import Spill
    from .tuning import Tuning

_TIMES, _TIMES_TUNING = 3, 6
"""How often robust weights, and with them the scales, are set anew before factors are linearised again."""


@dataclass(frozen=True)
class Step:
    """A step from the state at which factors were linearised.

    Attributes:
        knots: (knot, BLOCK).
        scalars: (SCALARS,).
        edge: One-sigma of the scalars (SCALARS,).
        sigma: One-sigma of the knots (knot, BLOCK); None when no covariance was asked.
    """

    knots: np.ndarray
    scalars: np.ndarray
    edge: np.ndarray
    sigma: np.ndarray | None


class Linearised:
    """Rings as they stand, and all other factors with weights that are set anew time after time.

    Args:
        problem: The survey's factors.
        state: Where they are linearised.
        bent: What bends add to the rings' ellipses there [m] (n, 5).
        scales: Factor name to its groups' noise over the stated one; other names have 1.
        aside: Where windows are put.

    Attributes:
        squares: Of the rings' residuals, (n, 5).
    """

    def __init__(
        self, problem: Problem, state: State, bent: np.ndarray, scales: dict[str, np.ndarray], aside: Spill
    ) -> None:
        self._windows, self._state, self._aside = problem.windows, state, aside
        self._threads = problem.threads(state)
        self._factors: list[list[Factor]] = []
        self._weights: list[list[np.ndarray]] = []
        squares = []
        size, corner = np.zeros_like(state.knots), np.zeros(SCALARS)
        for number, window in enumerate(self._windows):
            fixed = Normal.zeros(window.last - window.first + 1, BLOCK, SCALARS, window.first)
            others = []
            for name, factor in problem.factors(window, float(state.scalars[CLOCK]), bent).items():
                factor.scale = scales[name].copy() if name in scales else factor.scale
                one = factor.linearise(state)
                if factor.many:
                    one.add(fixed)
                else:
                    others.append(one)
                if name == "rings":
                    squares.append(one.residual**2)
            # What made the residuals holds the window's track, and is not asked again.
            self._factors.append([replace(one.factor, residual=None) for one in others])
            self._weights.append([one.weight for one in others])
            aside.put(("rings", number), *fixed.arrays)
            aside.put(("others", number), *(values for one in others for values in (one.residual, one.slopes)))
            whole = self._equations(number)
            size[window.knots] += np.einsum("kii->ki", whole.diagonal)
            corner += np.diag(whole.corner)
        self._scale, self._edge = (1.0 / np.sqrt(np.maximum(values, 1e-300)) for values in (size, corner))
        self.squares = np.concatenate(squares)

    def solve(self, tuning: Tuning, *, tune: bool) -> Step:
        """Return the step, weights and scales set anew a few times on the way."""
        for _ in range(_TIMES_TUNING if tune else _TIMES):
            sweep = self._sweep()
            knots, sigma, balances = self._back(sweep, tune=tune)
            if tune:
                tuning.follow(balances)
            self._weigh(sweep.scalars, knots, tuning.scales)
        return Step(knots, sweep.scalars, np.sqrt(np.diag(sweep.corner)), sigma if tune else None)

    def slip_variance(self) -> np.ndarray:
        """Return the variance (2,) of the slips up and right at the weights as they are [rad2]."""
        return np.diag(self._sweep().corner)[[SLIP_UP, SLIP_RIGHT]]

    def covariance(self, slips: np.ndarray) -> Covariance:
        """Return the covariance at the weights as they are; the slips' variance (2,) is `slips` [rad2] at least."""
        sweep = self._sweep()
        for column, variance in zip((SLIP_UP, SLIP_RIGHT), slips, strict=True):
            sweep.widen(column, float(variance))
        return sweep.covariance(self._state.along)

    def _others(self, number: int) -> list[Linear]:
        arrays = self._aside.get(("others", number))
        pairs = zip(arrays[::2], arrays[1::2], strict=True)
        return [
            Linear(factor, residual, slopes, weight)
            for factor, (residual, slopes), weight in zip(
                self._factors[number], pairs, self._weights[number], strict=True
            )
        ]

    def _equations(self, number: int) -> Normal:
        normal = Normal(*self._aside.get(("rings", number)), first=self._windows[number].first)
        for one in self._others(number):
            one.add(normal)
        return normal

    def _sweep(self) -> Sweep:
        sweep = Sweep(self._windows, self._scale, self._edge, self._threads, self._aside)
        sweep.forward(self._equations)
        return sweep

    def _back(self, sweep: Sweep, *, tune: bool) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
        """Return the knots' step and sigma, and the balance of every tuned factor's residuals."""
        knots, variance = np.empty_like(self._scale), np.empty_like(self._scale)
        balances: dict[str, np.ndarray] = {}
        for number, part in sweep.backward(covariance=tune):
            window = self._windows[number]
            knots[window.knots] = part.knots
            if not tune:
                continue
            blocks = (*part.covariance(sweep.mix, SCALARS), sweep.corner)
            variance[window.knots] = np.einsum("kii->ki", blocks[0])
            for one in self._others(number):
                if any(one.factor.tuned):
                    left = one.after(part.knots, sweep.scalars, window.first)
                    balance = one.balance(left, blocks, window.first)
                    balances[one.factor.name] = balances.get(one.factor.name, 0.0) + balance
        return knots, np.sqrt(variance) if tune else variance, balances

    def _weigh(self, scalars: np.ndarray, knots: np.ndarray, scales: dict[str, np.ndarray]) -> None:
        """Set the weights anew for the residuals after a step."""
        for number in range(len(self._windows)):
            for k, one in enumerate(self._others(number)):
                one.factor.scale = scales.get(one.factor.name, one.factor.scale)
                self._weights[number][k] = one.factor.weights(one.after(knots, scalars))
