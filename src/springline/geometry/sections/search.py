"""Largest value of a function along one axis, for a whole batch: the best grid point, then a golden section."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def maximise(function: Callable[[Array], Array], grid: Array, values: Array, step: float) -> tuple[Array, Array]:
    """Return the largest value of a function and where it lies.

    Args:
        function: (..., M) arguments to (..., M) values.
        grid: (..., G): arguments in any order, nowhere farther than `step` apart; every kink must be among them.
        values: (..., M, G): the function on the grid, for each of the M searches.
        step: Half width of the bracket around the best grid point; one peak or kink at most lies in a bracket.

    Returns:
        Value and argument, each (..., M).

    >>> grid = np.linspace(0.0, 6.0, 31)
    >>> value, where = maximise(lambda t: np.cos(t - 1.234), grid, np.cos(grid - 1.234)[None, :], 0.2)
    >>> value.round(12).tolist(), where.round(6).tolist()
    ([1.0], [1.234])
    """
    best = np.argmax(values, axis=-1)[..., None]
    peak = np.take_along_axis(values, best, axis=-1)[..., 0]
    at = np.take_along_axis(np.broadcast_to(grid[..., None, :], values.shape), best, axis=-1)[..., 0]
    value, where = golden(function, at - step, at + step)
    return np.maximum(peak, value), np.where(value > peak, where, at)


def golden(function: Callable[[Array], Array], low: Array, high: Array, *, steps: int = 45) -> tuple[Array, Array]:
    """Return the largest value of a function with one peak in [low, high], and where it lies, element by element.

    >>> value, where = golden(lambda t: -((t - 0.3) ** 2), np.array([0.0]), np.array([1.0]))
    >>> where.round(6).tolist()
    [0.3]
    """
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left, at_right = function(left), function(right)
    for _ in range(steps):
        rising = at_left < at_right
        low, high = np.where(rising, left, low), np.where(rising, high, right)
        fresh = np.where(rising, low + _GOLDEN * (high - low), high - _GOLDEN * (high - low))
        at_fresh = function(fresh)
        left, right = np.where(rising, right, fresh), np.where(rising, fresh, left)
        at_left, at_right = np.where(rising, at_right, at_fresh), np.where(rising, at_fresh, at_left)
    return np.maximum(at_left, at_right), np.where(at_left > at_right, left, right)


def rising_root(function: Callable[[Array], tuple[Array, Array]], low: Array, high: Array, *, steps: int = 60) -> Array:
    """Return where a rising function crosses zero in [low, high], by Newton's steps kept inside a shrinking bracket.

    Args:
        function: Arguments to values and slopes, element by element.
        low, high: Brackets; they broadcast to the arguments' shape.
        steps: At most so many; it ends when nothing moves any more.

    >>> rising_root(lambda t: (t**3 - 2.0, 3.0 * t**2), np.array([0.0]), np.array([2.0])).round(12).tolist()
    [1.259921049895]
    """
    at = 0.5 * (low + high)
    for _ in range(steps):
        value, slope = function(at)
        low, high = np.where(value < 0.0, at, low), np.where(value < 0.0, high, at)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = at - value / slope
        moved = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
        still = np.abs(moved - at) <= 4e-16 * np.abs(moved)
        at = np.where(value == 0.0, at, moved)
        if np.all(still | (value == 0.0) | np.isnan(value)):
            break
    return at
