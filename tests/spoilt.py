"""Rings spoilt as those of real surveys are."""

from __future__ import annotations

import numpy as np

READINGS = 360
BEARINGS = np.arange(READINGS) * 2 * np.pi / READINGS
NOISE = 0.003
"""One-sigma of a reading, as a share of the pipe's size."""


def spoil(ranges: np.ndarray, rng: np.random.Generator, size: float = 1.0) -> np.ndarray:
    """Return a ring with noise, 2 % outliers and 20 % missing readings, in one arc or scattered; `size` is its unit."""
    ranges = ranges + NOISE * size * rng.standard_normal(READINGS)
    bad = rng.random(READINGS) < 0.02
    ranges[bad] += size * rng.choice([-1, 1], bad.sum()) * rng.uniform(0.02, 0.2, bad.sum())
    count = READINGS // 5
    if rng.random() < 0.5:
        ranges[(rng.integers(READINGS) + np.arange(count)) % READINGS] = np.nan
    else:
        ranges[rng.choice(READINGS, count, replace=False)] = np.nan
    return ranges
