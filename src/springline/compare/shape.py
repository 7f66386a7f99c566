"""The slow part of a difference of two walls: what neighbouring rings share is shape, roll or a sensor's error."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import median_filter, uniform_filter, uniform_filter1d

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SHAPE = 3.0  # m over which orders 0 to 2 of the difference are shape, told by diameters, not patches
_LOCAL = 1.0  # m over which the scatter is taken
_CLEAR = 1.0  # scatters of a cell, by which the mean of 25 stands out five times as far
_PATTERN_LENGTH = 5.0  # m from which a pattern that all rings share can be told from a patch
_ROLL = 0.2  # m over which a roll that is left over is taken
_SLOPE_ORDERS = 12
_STRAY = 5.0  # scatters of the wall
_ROLL_KNOWN, _ROLL_UNKNOWN = np.radians(0.01), np.radians(3.0)


def roll_left(
    change: NDArray[np.float32], section: NDArray, wall: NDArray, sigma: NDArray, step: float
) -> NDArray[np.float64]:
    """Return what a difference map shows of walls that are still turned against each other (n, m) [m].

    A wall that is not round tells its roll by its own section: turned by d, its radius changes by d times its slope.
    The roll is taken over 0.2 m and held near zero by its sigma, so that a round wall leaves it at zero.

    Args:
        change: (n, m) radius of B less that of A [m]; NaN where it cannot be told.
        section: (n, m) radius of the fitted section [m].
        wall: (n, m) how far the wall stands outside it [m]; 0 where unseen.
        sigma: (n,) one-sigma of the roll of B against A [rad].
        step: Between rows [m].
    """
    known = np.isfinite(change)
    if not known.any():
        return np.zeros(change.shape)
    width, rows = max(1, round(_ROLL / step)), change.shape[1]
    most = _STRAY * 1.4826 * float(np.median(np.abs(wall[known])))
    steady = uniform_filter1d(np.clip(wall, -most, most), width, axis=0, mode="nearest")
    waves = np.fft.rfft(np.nan_to_num(section) + steady, axis=1)
    orders = np.arange(waves.shape[1])
    slope = np.fft.irfft(waves * np.where((orders > 1) & (orders <= _SLOPE_ORDERS), 1j * orders, 0.0), n=rows, axis=1)
    scatter = 1.4826 * float(np.median(np.abs(change[known])))
    pull, own = (
        width * uniform_filter1d(np.where(known, part, 0.0).sum(axis=1), width, mode="constant")
        for part in (np.nan_to_num(change) * slope, slope**2)
    )
    prior = (scatter / np.maximum(np.nan_to_num(sigma, nan=_ROLL_UNKNOWN), _ROLL_KNOWN)) ** 2
    return (pull / np.maximum(own + prior, 1e-30))[:, None] * slope


def without_shape(change: NDArray, bearing: NDArray, step: float) -> NDArray[np.float32]:
    """Return the change without the first order of each ring, and without orders 0 and 2 averaged along the pipe.

    The first order is where the section's middle was put; a ring says nothing of it.
    """
    waves = np.column_stack([np.ones_like(bearing), *(f(k * bearing) for k in (1, 2) for f in (np.cos, np.sin))])
    own = _orders(change, waves, 1)
    first, shape = waves[:, 1:3], waves[:, [0, 3, 4]]
    centred = change - own[:, 1:3] @ first.T
    slow = _orders(np.where(_marked(centred, step), np.nan, centred), waves, shape_rows(step))
    # Where half of a ring is unseen, only one whose shape is known tells where its middle is.
    shaped = change - slow[:, [0, 3, 4]] @ shape.T
    return (shaped - _orders(shaped, first, 1) @ first.T).astype(np.float32)


def shape_rows(step: float) -> int:
    """Return over how many rows, `step` [m] apart, the orders 0 and 2 are averaged that are shape and no patch."""
    return max(3, round(_SHAPE / step)) | 1


def _marked(change: NDArray, step: float) -> NDArray[np.bool_]:
    """Return the cells that with those about them stand clear of the rest: what is there would raise its neighbours."""
    near = uniform_filter(np.pad(np.nan_to_num(change), ((0, 0), (2, 2)), mode="wrap"), 5, mode="nearest")[:, 2:-2]
    with np.errstate(invalid="ignore"):
        return np.abs(near) > _CLEAR * local_sigma(change, step)


def _orders(change: NDArray, waves: NDArray, width: int) -> NDArray[np.float64]:
    """Return how much of each of the `waves` (m, k) is in each ring (n, k), by least squares over `width` rings."""
    seen = np.isfinite(change)
    right = np.where(seen, change, 0.0).astype(float) @ waves
    products = (waves[:, :, None] * waves[:, None, :]).reshape(len(waves), -1)
    left = seen.astype(float) @ products
    if width > 1:
        right, left = (uniform_filter1d(part, width, axis=0, mode="constant") for part in (right, left))
    count = waves.shape[1]
    left = left.reshape(-1, count, count) + 1e-3 * len(waves) * np.eye(count)
    return np.linalg.solve(left, right[:, :, None])[:, :, 0]


def pattern_of(change: NDArray, length: float) -> NDArray[np.float64]:
    """Return the change that all rings share, by bearing (m,) [m]."""
    if length < _PATTERN_LENGTH or not np.isfinite(change).any():
        return np.zeros(change.shape[1])
    masked = np.ma.masked_invalid(change)
    return np.ma.median(masked, axis=0).filled(0.0).astype(float)


def median_of_nine(values: NDArray) -> NDArray:
    """Return the median (n, m) of each cell and the eight about it; a lone stray reading has no part in it."""
    return median_filter(np.pad(values, ((0, 0), (1, 1)), mode="wrap"), 3, mode="nearest")[:, 1:-1]


def local_sigma(change: NDArray, step: float) -> NDArray[np.float32]:
    """Return the one-sigma (n, m) of a cell, by the scatter of all bearings within half a metre to both sides."""
    n = len(change)
    width = max(1, round(0.5 * _LOCAL / step))
    middles = np.arange(0, n, width)
    scatter = np.full(len(middles), np.nan)
    for k, i in enumerate(middles):
        part = change[max(i - width, 0) : i + width + 1]
        part = part[np.isfinite(part)]
        if part.size > 50:
            scatter[k] = 1.4826 * np.median(np.abs(part - np.median(part)))
    known = np.isfinite(scatter)
    if not known.any():
        return np.full(change.shape, np.nan, np.float32)
    row = np.interp(np.arange(n), middles[known], scatter[known])
    return np.broadcast_to(np.maximum(row, 1e-7)[:, None], change.shape).astype(np.float32)


def white_sigma(change: NDArray, step: float, kept: NDArray) -> NDArray[np.float32]:
    """Return the one-sigma (n, m) of a cell as averages of several cells have it.

    Args:
        change: (n, m) the difference map [m]; NaN where it cannot be told.
        step: Between rows [m].
        kept: (n,) share of the variance of white noise that interpolation left in each row's cells.
    """
    steady = uniform_filter1d(kept, 2 * max(1, round(0.5 * _LOCAL / step)) + 1, mode="nearest")
    return local_sigma(change, step) / np.sqrt(steady, dtype=np.float32)[:, None]
