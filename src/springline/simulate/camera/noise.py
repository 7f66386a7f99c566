"""Random fields on the wall, always the same at one place, that fade where a pixel is wider than their grain."""

from __future__ import annotations

from math import floor

import numpy as np

from ..kernels import inner
from ..surface import lattice


@inner(error_model="numpy")
def value_noise(u, v, around, seed):
    """Return a smooth random number of about unit variance at (u, v) in lattice steps; v repeats after `around`."""
    i, j = floor(u), floor(v)
    f, g = u - i, v - j
    f, g = f * f * (3.0 - 2.0 * f), g * g * (3.0 - 2.0 * g)
    i, j = int(i), int(j)
    a = j if 0 <= j < around else j % around
    b = a + 1 if a + 1 < around else 0
    low = (1.0 - f) * lattice(i, a, seed) + f * lattice(i + 1, a, seed)
    high = (1.0 - f) * lattice(i, b, seed) + f * lattice(i + 1, b, seed)
    # 0.61 is the rms of the blend of four values of unit variance, over the cell.
    return ((1.0 - g) * low + g * high) / 0.61


@inner(error_model="numpy")
def fade(size, footprint):
    """Return how much of a grain of `size` [m] a pixel of `footprint` [m] still shows, 1 to 0."""
    w = (size / footprint - 1.0) / 2.0
    if w <= 0.0:
        return 0.0
    return 1.0 if w >= 1.0 else w * w * (3.0 - 2.0 * w)


@inner(error_model="numpy")
def octaves(s, arc, girth, size, count, footprint, seed):
    """Return a sum of `count` octaves of noise at chainage s and arc length along the girth [m], coarsest `size` [m].

    Each octave is half as coarse and 0.6 times as strong as the one before; of about unit variance where all show.
    """
    total, strength, square = 0.0, 1.0, 0.0
    for k in range(count):
        square += strength * strength
        seen = fade(size, footprint)
        if seen > 0.0:
            around = max(3, round(girth / size))
            step = girth / around
            total += seen * strength * value_noise(s / size, arc / step, around, seed + np.uint64(977 * (k + 1)))
        size, strength = 0.5 * size, 0.6 * strength
    return total / np.sqrt(square)
