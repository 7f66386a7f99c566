"""What every factor is: whitened residuals of two knots and the scalars, their derivatives, their robust weights."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numba import njit

from ..states import BLOCK, SCALAR_STEPS, SCALARS, STEPS, State

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..solver import Normal

WIDTH = 2 * BLOCK + SCALARS
"""Columns of a factor's derivative: knot k, knot k + 1, scalars."""

DERIVATIVE_STEPS = np.concatenate([STEPS, STEPS, SCALAR_STEPS])
"""Steps of numerical derivatives, by column of WIDTH."""


@dataclass
class Factor:
    """One kind of measurement or prior at many places.

    Attributes:
        name: For messages and for the table of what was left over.
        interval: Knot before each place (n,).
        columns: Columns (c,) of WIDTH on which the residual depends.
        residual: Function of knots (n, BLOCK) before and after and scalars (SCALARS,): whitened residuals (n, r).
        groups: Slices of the residual; each is one vector for its robust weight.
        tails: Degrees of freedom of Student's t for each group; 0 = normal with a limit beyond which weight falls.
        scale: One-sigma of each group against the one stated, by which its residuals are divided.
        tuned: Whether each group's scale is taken from the data.
        many: Whether its residuals are too many to be held: their weights are those of the state until the next one.
    """

    many: ClassVar[bool] = False

    name: str
    interval: np.ndarray
    columns: np.ndarray
    residual: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray] | None
    groups: tuple[slice, ...]
    tails: tuple[float, ...] = (0.0,)
    tuned: tuple[bool, ...] = ()
    scale: np.ndarray = field(default_factory=lambda: np.ones(1))

    def __post_init__(self) -> None:
        self.scale = np.ones(len(self.groups))
        self.tails = self.tails if len(self.tails) == len(self.groups) else self.tails * len(self.groups)
        self.tuned = self.tuned or (False,) * len(self.groups)

    def linearise(self, state: State) -> Linear:
        """Return residuals, derivatives and weights at a state."""
        before, after = state.knots[self.interval], state.knots[self.interval + 1]
        now = self.residual(before, after, state.scalars)
        slopes = np.empty((*now.shape, len(self.columns)))
        for k, column in enumerate(self.columns):
            step = DERIVATIVE_STEPS[column]
            slopes[..., k] = (self.residual(*_moved(before, after, state.scalars, column, step)) - now) / step
        return Linear(self, now, slopes, self.weights(now))

    def weights(self, residual: np.ndarray) -> np.ndarray:
        """Return the robust weights (n, r) of residuals (n, r)."""
        weight = np.empty_like(residual)
        for rows, tail, scale in zip(self.groups, self.tails, self.scale, strict=True):
            square = np.sum((residual[:, rows] / scale) ** 2, axis=1)
            weight[:, rows] = (robust_weight(square, rows.stop - rows.start, tail) / scale**2)[:, None]
        return weight


@dataclass
class Linear:
    """A factor at a state: residuals (n, r), slopes (n, r, c), weights (n, r)."""

    factor: Factor
    residual: np.ndarray
    slopes: np.ndarray
    weight: np.ndarray

    def add(self, normal: Normal) -> None:
        """Add to the normal equations."""
        _add(
            self.factor.interval - normal.first,
            self.factor.columns,
            self.residual,
            self.slopes,
            self.weight,
            normal.diagonal,
            normal.beside,
            normal.border,
            normal.corner,
            normal.right,
            normal.right_corner,
        )

    def after(self, knots: np.ndarray, scalars: np.ndarray, first: int = 0) -> np.ndarray:
        """Return the residuals (n, r) after a step of the knots from `first` on and of the scalars, were all linear."""
        factor = self.factor
        return _after(factor.interval - first, factor.columns, self.residual, self.slopes, knots, scalars)

    def balance(self, residual: np.ndarray, blocks: tuple[np.ndarray, ...], first: int = 0) -> np.ndarray:
        """Return by group (g, 2): weighted squares that are left over, and how many residuals are free.

        These are the residuals less what the estimate itself explains; a noise is right when the two are equal. NaN
        where it is not taken from the data.

        Args:
            residual: After the step (n, r).
            blocks: Covariance of each knot, with the next, with the scalars, and of the scalars.
            first: Number of the first of these knots.
        """
        out = np.full((len(self.factor.groups), 2), np.nan)
        used = _used(self.factor.interval - first, self.factor.columns, self.slopes, self.weight, *blocks)
        for k, (rows, tuned) in enumerate(zip(self.factor.groups, self.factor.tuned, strict=True)):
            if not tuned:
                continue
            weight = self.weight[:, rows]
            out[k] = np.sum(weight * residual[:, rows] ** 2), weight.size - np.sum(used[:, rows])
        return out


def robust_weight(square: np.ndarray, size: int, tail: float) -> np.ndarray:
    """Return weights of residual vectors of squared length `square` and dimension `size`.

    Student's t with `tail` degrees of freedom; 0 keeps weight 1 up to a length that one normal vector in a thousand
    exceeds, and lets it fall as one over the length beyond (Huber).

    >>> robust_weight(np.array([0.0, 100.0]), 1, 4.0).round(3).tolist()
    [1.25, 0.048]
    """
    if tail > 0.0:
        return (tail + size) / (tail + square)
    limit = _LIMITS[min(size, len(_LIMITS) - 1)]
    return np.sqrt(np.minimum(1.0, limit / np.maximum(square, limit)))


_LIMITS = (0.0, 10.83, 13.82, 16.27, 18.47, 20.52)
"""Squared length that one normal vector in a thousand exceeds, by its dimension."""


def _moved(before, after, scalars, column, step):
    if column < BLOCK:
        before = before.copy()
        before[:, column] += step
    elif column < 2 * BLOCK:
        after = after.copy()
        after[:, column - BLOCK] += step
    else:
        scalars = scalars.copy()
        scalars[column - 2 * BLOCK] += step
    return before, after, scalars


def local_columns(*slices: slice, scalars: tuple[int, ...] = (), after: bool = True) -> np.ndarray:
    """Return the columns of states in both knots (or in the first only) and of scalars.

    >>> local_columns(slice(0, 2), scalars=(3,)).tolist() == [0, 1, BLOCK, BLOCK + 1, 2 * BLOCK + 3]
    True
    """
    own = [k for one in slices for k in range(one.start, one.stop)]
    return np.array(own + [BLOCK + k for k in own if after] + [2 * BLOCK + k for k in scalars])


@njit(cache=True)
def _add(interval, columns, residual, slopes, weight, diagonal, beside, border, corner, right, right_corner):
    block = diagonal.shape[1]
    for n in range(len(interval)):
        k = interval[n]
        for r in range(residual.shape[1]):
            w = weight[n, r]
            for i in range(len(columns)):
                a = columns[i]
                value = w * slopes[n, r, i]
                if value == 0.0:
                    continue
                if a < 2 * block:
                    right[k + a // block, a % block] -= value * residual[n, r]
                else:
                    right_corner[a - 2 * block] -= value * residual[n, r]
                for j in range(len(columns)):
                    b = columns[j]
                    product = value * slopes[n, r, j]
                    if a < block and b < block:
                        diagonal[k, a, b] += product
                    elif a < block and b < 2 * block:
                        beside[k, a, b - block] += product
                    elif a < 2 * block and b >= 2 * block:
                        border[k + a // block, a % block, b - 2 * block] += product
                    elif a >= block and a < 2 * block and b >= block:
                        diagonal[k + 1, a - block, b - block] += product
                    elif a >= 2 * block and b >= 2 * block:
                        corner[a - 2 * block, b - 2 * block] += product


@njit(cache=True)
def _after(interval, columns, residual, slopes, knots, scalars):
    """Return residual + J step (n, r)."""
    block = knots.shape[1]
    out = residual.copy()
    for n in range(len(interval)):
        for i in range(len(columns)):
            a = columns[i]
            step = knots[interval[n] + a // block, a % block] if a < 2 * block else scalars[a - 2 * block]
            for r in range(residual.shape[1]):
                out[n, r] += slopes[n, r, i] * step
    return out


@njit(cache=True)
def _used(interval, columns, slopes, weight, diagonal, beside, border, corner):
    """Return w J C J' for every residual (n, r): the share of it that the estimate explains."""
    block = diagonal.shape[1]
    out = np.zeros(weight.shape)
    size = len(columns)
    local = np.empty((size, size))
    for n in range(len(interval)):
        k = interval[n]
        for i in range(size):
            a = columns[i]
            for j in range(i, size):
                b = columns[j]
                if b < block:
                    value = diagonal[k, a, b]
                elif a < block and b < 2 * block:
                    value = beside[k, a, b - block]
                elif b < 2 * block:
                    value = diagonal[k + 1, a - block, b - block]
                elif a < 2 * block:
                    value = border[k + a // block, a % block, b - 2 * block]
                else:
                    value = corner[a - 2 * block, b - 2 * block]
                local[i, j] = value
                local[j, i] = value
        for r in range(weight.shape[1]):
            total = 0.0
            for i in range(size):
                for j in range(size):
                    total += slopes[n, r, i] * local[i, j] * slopes[n, r, j]
            out[n, r] = weight[n, r] * total
    return out
