"""Readings of many rings as the solver takes them: those that can be used in front, about a centre, in one unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from .._readings import gather
from .solve import Readings

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def gathered(z: Array, y: Array, weights: Array | None, centre: Array, size: Array, *, along: bool) -> Readings:
    """Return the readings about `centre` in units of `size`.

    Args:
        z, y: (N, M) from the sensor [m]; NaN = no return.
        weights: (N, M) relative inverse variances, or None; readings without a positive one are not used.
        centre: (N, 2) z and y [m].
        size: (N,) [m].
        along: Whether readings err along their rays.
    """
    rings, points = z.shape
    out = np.zeros((3, rings, points))
    rays, index, counts = np.zeros((2, rings, points)), np.zeros((rings, points), np.int64), np.zeros(rings, np.int64)
    given = np.ones((1, 1)) if weights is None else np.ascontiguousarray(weights, float)
    _gather_all(z, y, given, weights is not None, centre, size, *out, rays, index, counts)
    return Readings(*out, index, counts, rays, along)


@kernel
def _gather_all(z, y, weights, weighted, centre, size, out_z, out_y, prior, rays, index, counts):
    for ring in range(z.shape[0]):
        row = ring if weighted else 0
        counts[ring] = gather(
            z[ring], y[ring], weights[row], weighted, out_z[ring], out_y[ring], prior[ring], index[ring]
        )
        for i in range(counts[ring]):
            reach = np.sqrt(out_z[ring, i] ** 2 + out_y[ring, i] ** 2) + 1e-300
            rays[0, ring, i] = out_z[ring, i] / reach
            rays[1, ring, i] = out_y[ring, i] / reach
            out_z[ring, i] = (out_z[ring, i] - centre[ring, 0]) / size[ring]
            out_y[ring, i] = (out_y[ring, i] - centre[ring, 1]) / size[ring]
