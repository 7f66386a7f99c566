"""A trust-region dogleg solver for square systems, which keeps what Figures 5.6 to 5.8 show of each iteration."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

_STEP = np.sqrt(np.finfo(float).eps)


class Solution(NamedTuple):
    """Where a solver went.

    Attributes:
        x: The last point.
        residual: Largest of the equations there.
        steps: Length of each iteration's step.
        optimality: Largest entry of the gradient of half the squared residuals, at the start and after each iteration.
        converged: Whether the gradient fell below the tolerance.
    """

    x: Array
    residual: float
    steps: Array
    optimality: Array
    converged: bool


def solve(
    equations: Callable[[Array], Array], start: ArrayLike, *, tolerance: float = 1e-6, most: int = 400
) -> Solution:
    """Return where Powell's dogleg within a trust region leads from `start`.

    Args:
        equations: As many as unknowns.
        start: First guess.
        tolerance: Of the gradient's largest entry.
        most: Iterations.

    Source: Powell (1970). The region starts at 1, shrinks to a quarter of a step that fails, and grows to two and a
    half times one that does as foretold.

    >>> found = solve(lambda x: np.array([x[0] ** 2 - 4.0, x[0] * x[1] - 6.0]), [5.0, 5.0], tolerance=1e-9)
    >>> found.x.round(9), found.converged
    (array([2., 3.]), True)
    """
    x = np.array(start, float)
    value = equations(x)
    slope = jacobian(equations, x, value)
    gradient, radius = slope.T @ value, 1.0
    steps, optimality = [], [np.abs(gradient).max()]
    while optimality[-1] >= tolerance and len(steps) < most and radius > 1e-12:
        step = _dogleg(slope, value, gradient, radius)
        foretold = -(gradient @ step + 0.5 * np.sum((slope @ step) ** 2))
        trial = equations(x + step)
        gain = 0.5 * (value @ value - trial @ trial) / foretold if foretold > 0.0 else 0.0
        length = float(np.linalg.norm(step))
        if gain > 1e-4:
            x, value = x + step, trial
            slope = jacobian(equations, x, value)
            gradient = slope.T @ value
        if gain < 0.05:
            radius = 0.25 * length
        elif gain >= 0.9:
            radius = max(radius, 2.5 * length)
        steps.append(length)
        optimality.append(np.abs(gradient).max())
    converged = bool(optimality[-1] < tolerance)
    return Solution(x, float(np.abs(value).max()), np.array(steps), np.array(optimality), converged)


def jacobian(equations: Callable[[Array], Array], x: Array, value: Array) -> Array:
    """Return the derivatives by forward differences, (equations, unknowns)."""
    columns = []
    for k in range(x.size):
        moved = x.copy()
        moved[k] += _STEP * max(abs(x[k]), 1.0)
        columns.append((equations(moved) - value) / (moved[k] - x[k]))
    return np.stack(columns, axis=-1)


def _dogleg(slope: Array, value: Array, gradient: Array, radius: float) -> Array:
    """Return the step: towards Cauchy's point, then towards Newton's, up to the region's edge."""
    cauchy = -(gradient @ gradient) / max(np.sum((slope @ gradient) ** 2), 1e-300) * gradient
    if np.linalg.norm(cauchy) >= radius:
        return cauchy * radius / np.linalg.norm(cauchy)
    newton = np.linalg.lstsq(slope, -value, rcond=None)[0]
    if np.linalg.norm(newton) <= radius:
        return newton
    way = newton - cauchy
    a, b, c = way @ way, cauchy @ way, cauchy @ cauchy - radius**2
    return cauchy + (np.sqrt(b * b - a * c) - b) / a * way
