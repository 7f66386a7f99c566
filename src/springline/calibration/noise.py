"""The noise law of a range sensor: how the scatter of a reading grows with the range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

_BINS = 16
_FEWEST = 200
"""Readings in a bin of ranges."""
_MAD_VARIANCE = 1.3606
"""Relative variance of the scaled median absolute deviation times the number of readings: efficiency 36.75 %."""
_KNOWN = 0.25
"""The part that grows is known when its one-sigma is below this share of the whole variance."""


@dataclass(frozen=True, eq=False)
class NoiseLaw:
    """One-sigma of a reading at range r: sqrt(constant^2 + (relative r)^2).

    Attributes:
        constant: The part that does not grow [m].
        relative: The part that grows with the range [1]; NaN where the ranges do not spread enough to tell, and
            `constant` then is the whole at these ranges.
        covariance: Of `constant` and `relative` (2, 2); NaN likewise.
        range_low: Ranges that were seen, from here [m].
        range_high: To here [m].
        readings: How many there were.
    """

    constant: float
    relative: float
    covariance: Array
    range_low: float
    range_high: float
    readings: int

    def sigma(self, ranges: ArrayLike) -> Array:
        """Return the one-sigma [m] of readings at `ranges` [m]."""
        growing = 0.0 if np.isnan(self.relative) else self.relative
        return np.hypot(self.constant, growing * np.asarray(ranges, float))


def fit_noise_law(ranges: ArrayLike, deviation: ArrayLike) -> NoiseLaw:
    """Return the noise law that deviations from the wall show.

    The scatter in each of up to 16 bins of range is the scaled median absolute deviation, which outliers do not move;
    constant^2 and relative^2 follow by weighted least squares on the bins' variances, neither below zero.

    Args:
        ranges: Ranges [m], any shape; NaN = no return.
        deviation: What each reads too much against the wall along its ray [m], same shape.

    Returns:
        NoiseLaw; all NaN with fewer than 50 readings.

    Source: efficiency of the median absolute deviation from Rousseeuw and Croux, JASA 88 (1993) 1273.

    >>> rng = np.random.default_rng(0)
    >>> r = rng.uniform(0.05, 0.3, 200_000)
    >>> law = fit_noise_law(r, np.hypot(0.0005, 0.004 * r) * rng.standard_normal(r.size))
    >>> round(1e3 * law.constant, 1), round(law.relative, 4)
    (0.5, 0.004)
    """
    ranges, deviation = np.ravel(np.asarray(ranges, float)), np.ravel(np.asarray(deviation, float))
    seen = np.isfinite(ranges) & np.isfinite(deviation)
    ranges, deviation = ranges[seen], deviation[seen]
    if ranges.size < 50:
        return NoiseLaw(np.nan, np.nan, np.full((2, 2), np.nan), np.nan, np.nan, int(ranges.size))
    low, high = np.quantile(ranges, [0.005, 0.995])
    whole = 1.4826 * float(np.median(np.abs(deviation - np.median(deviation))))
    whole_sigma = whole * np.sqrt(_MAD_VARIANCE / ranges.size)
    place, variance, count = _binned(ranges, deviation)
    values, spread = _law(place**2, variance, count)
    middle = float(np.mean(ranges**2))
    if np.sqrt(spread[1, 1]) * middle > _KNOWN * whole**2:
        covariance = np.array([[whole_sigma**2, np.nan], [np.nan, np.nan]])
        return NoiseLaw(whole, np.nan, covariance, float(low), float(high), int(ranges.size))
    root = np.sqrt(values)
    # At zero the square is half of a bell; its root is known to the root of the bell's sigma.
    slope = np.where(values > 0.0, 0.5 / np.where(values > 0.0, root, 1.0), 0.0)
    covariance = slope[:, None] * spread * slope
    ends = np.sqrt(np.diagonal(spread)) * (values <= 0.0)
    return NoiseLaw(
        float(root[0]), float(root[1]), covariance + np.diag(ends), float(low), float(high), int(ranges.size)
    )


def _binned(ranges: Array, deviation: Array) -> tuple[Array, Array, Array]:
    """Return rms range, robust variance and number of readings of each bin."""
    order = np.argsort(ranges)
    parts = np.array_split(order, int(np.clip(ranges.size // _FEWEST, 1, _BINS)))
    middle = np.median(deviation)
    place = np.array([np.sqrt(np.mean(ranges[part] ** 2)) for part in parts])
    spread = np.array([1.4826 * np.median(np.abs(deviation[part] - middle)) for part in parts])
    return place, spread**2, np.array([part.size for part in parts], float)


def _law(square: Array, variance: Array, count: Array) -> tuple[Array, Array]:
    """Return constant^2 and relative^2 (2,), and their covariance (2, 2)."""
    design = np.stack([np.ones_like(square), square], axis=1)
    values = np.array([np.mean(variance), 0.0])
    spread = np.full((2, 2), np.inf)
    if square.size < 3 or np.ptp(square) == 0.0:
        return values, spread
    size = np.array([1.0, 1.0 / np.mean(square)])
    for _ in range(10):
        # The root's relative variance is _MAD_VARIANCE / n; the square's four times that.
        weight = count / (4.0 * _MAD_VARIANCE * np.maximum(design @ values, 1e-3 * np.mean(variance)) ** 2)
        scaled = design * size
        spread = np.linalg.inv(scaled.T @ (weight[:, None] * scaled)) * np.outer(size, size)
        values = spread @ (design.T @ (weight * variance))
        for below in np.flatnonzero(values < 0.0)[:1]:
            other = 1 - below
            alone = design[:, other]
            values = np.zeros(2)
            values[other] = np.sum(weight * alone * variance) / np.sum(weight * alone**2)
    return values, spread
