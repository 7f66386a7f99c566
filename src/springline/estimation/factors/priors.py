"""The gauge of the first knot, states that nothing else tells, and priors of the scalars."""

from __future__ import annotations

import numpy as np

from ..states import BLOCK, SCALARS
from .base import Factor


def known(name: str, knots: np.ndarray, states: np.ndarray, value: np.ndarray, sigma: np.ndarray) -> Factor:
    """Return a factor that holds states of knots near given values.

    Args:
        name: Of the factor.
        knots: Which knots (n,).
        states: Which states of a knot (s,).
        value: (s,).
        sigma: One-sigma (s,).
    """

    interval = np.maximum(knots - 1, 0)
    late = (knots > 0)[:, None]

    def residual(before, after, scalars):
        return (np.where(late, after[:, states], before[:, states]) - value) / sigma

    columns = np.concatenate([states, BLOCK + states])
    return Factor(name, interval, columns, residual, tuple(slice(k, k + 1) for k in range(len(states))))


def scalars(value: np.ndarray, sigma: np.ndarray) -> Factor:
    """Return the prior of the scalars (SCALARS,)."""

    def residual(before, after, now):
        return ((now - value) / sigma)[None, :]

    columns = 2 * BLOCK + np.arange(SCALARS)
    return Factor("scalars", np.zeros(1, np.int64), columns, residual, tuple(slice(k, k + 1) for k in range(SCALARS)))
