"""Where the pipe steps sideways, changes its diameter or its direction from one ring to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Jumps(NamedTuple):
    """What changes between ring k - 1 and ring k, (ring, value) each: step [unit], its sigma, change of slope."""

    step: NDArray[np.float64]
    step_sigma: NDArray[np.float64]
    slope: NDArray[np.float64]
    slope_sigma: NDArray[np.float64]


def jumps(distance: ArrayLike, values: ArrayLike, noise: ArrayLike, *, window: int) -> Jumps:
    """Return by how much lines through the rings before and after each place miss each other there.

    Args:
        distance: (ring,) increasing [m].
        values: (ring, value) such as the centre of each ring; NaN = not known.
        noise: (value,) one-sigma of each.
        window: Rings on each side.

    Returns:
        For each k the line through up to `window` rings from k on, less that through as many before k, at the middle
        between k - 1 and k: step and change of slope with their sigmas; NaN where a side has fewer than three rings.

    >>> x = 0.01 * np.arange(20)
    >>> y = np.where(x < 0.1, 0.0, 0.002)[:, None]
    >>> jumps(x, y, [1e-4], window=5).step[10].round(6).tolist()
    [0.002]
    """
    distance, values = np.asarray(distance, float), np.asarray(values, float)
    noise = np.asarray(noise, float)
    count = len(distance)
    place = np.concatenate([[distance[0]], 0.5 * (distance[1:] + distance[:-1])])
    known = np.isfinite(values)
    filled = np.where(known, values, 0.0)
    sides = []
    for offsets in (range(-window, 0), range(window)):
        sums = [np.zeros(values.shape) for _ in range(5)]
        for k in offsets:
            index = np.arange(count) + k
            inside = (index >= 0) & (index < count)
            index = np.clip(index, 0, count - 1)
            x = (distance[index] - place)[:, None]
            w = (known[index] & inside[:, None]).astype(float)
            v = filled[index]
            for total, part in zip(sums, (w, w * x, w * x * x, w * v, w * x * v), strict=True):
                total += part
        sides.append(_line(sums))
    (v0, var_v0, s0, var_s0), (v1, var_v1, s1, var_s1) = sides
    return Jumps(v1 - v0, noise * np.sqrt(var_v0 + var_v1), s1 - s0, noise * np.sqrt(var_s0 + var_s1))


def _line(sums: list[NDArray[np.float64]]) -> tuple[NDArray[np.float64], ...]:
    """Return value at 0 and slope of a fitted line with their variances for unit noise; NaN below three readings."""
    n, x, xx, v, xv = sums
    with np.errstate(invalid="ignore", divide="ignore"):
        determinant = np.where(n >= 3, n * xx - x * x, np.nan)
        return (
            (xx * v - x * xv) / determinant,
            xx / determinant,
            (n * xv - x * v) / determinant,
            n / determinant,
        )


def peaks(score: ArrayLike, distance: ArrayLike, *, least: float, apart: float) -> NDArray[np.int64]:
    """Return the indices of scores above `least` that no higher one within `apart` [m] outdoes, in order.

    >>> peaks([0, 1, 5, 4, 0, 0, 3], np.arange(7.0), least=2, apart=2).tolist()
    [2, 6]
    """
    score, distance = np.nan_to_num(np.asarray(score, float), nan=-np.inf), np.asarray(distance, float)
    taken: list[int] = []
    free = np.ones(len(score), bool)
    for k in np.flatnonzero(score > least)[np.argsort(-score[score > least], kind="stable")]:
        if free[k]:
            taken.append(int(k))
            low, high = np.searchsorted(distance, [distance[k] - apart, distance[k] + apart])
            free[low : high + 1] = False
    return np.array(sorted(taken), np.int64)
