"""Derivatives and covariances of vectorised functions, by central differences."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


def jacobian(function: Callable[[Array], Array], x: Array, steps: ArrayLike) -> Array:
    """Return the derivative (..., m, k) of `function`: (..., k) -> (..., m) at `x`; `steps` (k,) are half-widths."""
    columns = []
    for k, step in enumerate(np.asarray(steps, dtype=float)):
        shift = np.zeros(x.shape[-1])
        shift[k] = step
        columns.append((function(x + shift) - function(x - shift)) / (2.0 * step))
    return np.stack(columns, axis=-1)


def propagate(derivative: Array, covariance: Array) -> Array:
    """Return J C J' over the last two axes."""
    return derivative @ covariance @ np.swapaxes(derivative, -1, -2)


def whitener(covariance: Array) -> Array:
    """Return W (..., m, m) with W' W = inverse of `covariance`, by eigenvalues; all NaN where that is not definite."""
    known = np.isfinite(covariance).all(axis=(-1, -2), keepdims=True)
    values, vectors = np.linalg.eigh(np.where(known, covariance, np.eye(covariance.shape[-1])))
    definite = known[..., 0] & (values > 1e-14 * values[..., -1:]) & (values > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.where(definite, 1.0 / np.sqrt(values), np.nan)
    return scale[..., None] * np.swapaxes(vectors, -1, -2)
