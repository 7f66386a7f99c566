"""Ways to match that need no model, told the sense of travel; what they leave undone is what the model is for."""

from __future__ import annotations

import numpy as np

from springline.compare import FeatureList


def nearest(a: FeatureList, b: FeatureList, reach: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return mutual nearest neighbours of one kind within `reach` [m], counters as they are."""
    return _mutual(a.chainage, b.chainage, a, b, reach)


def linear(a: FeatureList, b: FeatureList, reach: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return mutual nearest neighbours after scaling A's extent to B's."""
    x = b.extent[0] + (a.chainage - a.extent[0]) * b.length / a.length
    return _mutual(x, b.chainage, a, b, reach)


def warped(a: FeatureList, b: FeatureList) -> tuple[np.ndarray, np.ndarray]:
    """Return the mutual partners of dynamic time warping of the scaled chainages, other kinds 5 m apart."""
    x = b.extent[0] + (a.chainage - a.extent[0]) * b.length / a.length
    cost = np.abs(x[:, None] - b.chainage[None, :]) + 5.0 * (a.kind[:, None] != b.kind[None, :])
    total = np.full((len(a) + 1, len(b) + 1), np.inf)
    total[0, 0] = 0.0
    for i in range(len(a)):
        for j in range(len(b)):
            total[i + 1, j + 1] = cost[i, j] + min(total[i, j], total[i, j + 1], total[i + 1, j])
    path, (i, j) = [], (len(a), len(b))
    while i and j:
        path.append((i - 1, j - 1))
        i, j = min(((i - 1, j - 1), (i - 1, j), (i, j - 1)), key=lambda at: total[at])
    kept: dict[int, int] = {}
    for p, q in sorted(path, key=lambda at: cost[at]):
        if p not in kept and q not in kept.values() and a.kind[p] == b.kind[q]:
            kept[p] = q
    return np.array(list(kept), dtype=int), np.array(list(kept.values()), dtype=int)


def _mutual(x: np.ndarray, y: np.ndarray, a: FeatureList, b: FeatureList, reach: float) -> tuple:
    apart = np.where(a.kind[:, None] == b.kind[None, :], np.abs(x[:, None] - y[None, :]), np.inf)
    to_b, to_a = apart.argmin(axis=1), apart.argmin(axis=0)
    i = np.flatnonzero((to_a[to_b] == np.arange(len(a))) & (apart.min(axis=1) <= reach))
    return i, to_b[i]
