"""What is known along the pipe, put in order."""

from __future__ import annotations

import numpy as np


def in_order(place: np.ndarray, *values: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return places (n,) and values (n, ...) where all of them are known, by rising place.

    >>> place, value = in_order(np.array([2.0, np.nan, 1.0, 3.0]), np.array([20.0, 0.0, 10.0, np.nan]))
    >>> place.tolist(), value.tolist()
    ([1.0, 2.0], [10.0, 20.0])
    """
    good = np.logical_and.reduce([np.isfinite(v).all(axis=tuple(range(1, v.ndim))) for v in (place, *values)])
    order = np.flatnonzero(good)[np.argsort(place[good], kind="stable")]
    return tuple(v[order] for v in (place, *values))
