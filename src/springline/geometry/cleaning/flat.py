"""Water or sediment: readings on a straight, nearly level chord across the invert, ring after ring."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_HALF_WIDTH = np.radians(80.0)
_STEEPEST = np.tan(np.radians(15.0))
_LEAST_SHARE = 0.02
_PASSES = 4


def flat_at_invert(
    z: ArrayLike, y: ArrayLike, deviation: ArrayLike, noise: ArrayLike, radius: float, *, window: int
) -> NDArray[np.bool_]:
    """Return which readings lie on water or sediment.

    In each ring a line is laid through the readings about the invert that stand inside the fitted section; it counts
    when it is straight within the noise, no steeper than a robot may roll, and when most rings about it have one
    too. Readings on that line, and below it, are not of the wall.

    Args:
        z, y: (ring, bearing) readings about the centre of their ring's section [m]; NaN = no return.
        deviation: (ring, bearing) how far they stand outside the section [m].
        noise: (ring,) one-sigma of a reading [m].
        radius: Typical radius [m].
        window: Rings over which a level must persist, about a diameter's worth.

    Returns:
        (ring, bearing) flags.
    """
    z, y, deviation = (np.asarray(a, float) for a in (z, y, deviation))
    noise = np.maximum(np.nan_to_num(np.asarray(noise, float), nan=0.01 * radius), 1e-3 * radius)[:, None]
    low = (np.arctan2(np.abs(z), -y) < _HALF_WIDTH) & np.isfinite(deviation)
    weight = (low & (deviation < -4.0 * noise) & (deviation > -0.6 * radius)).astype(float)
    z, y = np.nan_to_num(z), np.nan_to_num(y)
    for _ in range(_PASSES):
        level, slope, scatter = _lines(z, y, weight)
        off = np.abs(y - level - slope * z)
        weight = weight * (off < 3.0 * np.maximum(np.minimum(scatter, 0.05 * radius), noise))
    level, slope, scatter = _lines(z, y, weight)
    counts = weight.sum(axis=1)
    share = counts / z.shape[1]
    real = (
        (share >= _LEAST_SHARE)
        & (counts >= 5)
        & (scatter[:, 0] < np.maximum(2.0 * noise[:, 0], 0.01 * radius))
        & (np.abs(slope[:, 0]) < _STEEPEST)
        & (level[:, 0] < -0.2 * radius)
    )
    lasting = uniform_filter1d(real.astype(float), max(window, 1), mode="nearest") >= 0.5
    if not lasting.any():
        return np.zeros(z.shape, bool)
    level, slope = _smoothed(level[:, 0], real, window), _smoothed(slope[:, 0], real, window)
    tolerance = 3.0 * np.maximum(noise, 0.5 * scatter)
    on_it = low & (y < level[:, None] + slope[:, None] * z + tolerance) & (deviation < -2.0 * noise)
    return on_it & lasting[:, None]


def _lines(z: NDArray, y: NDArray, weight: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Return level at z = 0, slope and rms scatter of the weighted line through each ring's readings, (ring, 1)."""
    total = np.maximum(weight.sum(axis=1, keepdims=True), 1e-9)
    mean_z = (weight * z).sum(axis=1, keepdims=True) / total
    mean_y = (weight * y).sum(axis=1, keepdims=True) / total
    spread = (weight * (z - mean_z) ** 2).sum(axis=1, keepdims=True)
    slope = (weight * (z - mean_z) * (y - mean_y)).sum(axis=1, keepdims=True) / np.maximum(spread, 1e-12)
    level = mean_y - slope * mean_z
    scatter = np.sqrt((weight * (y - level - slope * z) ** 2).sum(axis=1, keepdims=True) / total)
    return level, slope, scatter


def _smoothed(values: NDArray, real: NDArray, window: int) -> NDArray:
    """Return the running median over the rings that have a line, carried across those that have none."""
    rows = np.flatnonzero(real)
    filled = np.interp(np.arange(len(values)), rows, values[rows])
    return median_filter(filled, size=max(3, min(window, 9) | 1), mode="nearest")
