"""What stands apart from the section: single readings that no neighbour confirms, and patches that persist."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import uniform_filter1d

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_ACROSS = 3
_ALONG = 5


def unlike_neighbours(deviation: ArrayLike, noise: ArrayLike, limit: float) -> NDArray[np.bool_]:
    """Return which readings stand further from the wall about them than the noise allows.

    The wall at a reading is the median deviation over five rings and, in the reading's own ring, over three bearings,
    whichever is nearer: a dent or a lateral that goes on along the pipe stays, a spike does not.

    Args:
        deviation: (ring, bearing) radial deviations from the section [m]; NaN = no return.
        noise: (ring,) one-sigma of a reading [m].
        limit: In sigmas.
    """
    deviation = np.asarray(deviation, float)
    noise = np.asarray(noise, float)[:, None]
    with np.errstate(invalid="ignore"):
        suspect = np.abs(deviation) > limit * noise
    suspect |= np.isfinite(deviation) & ~np.isfinite(noise)
    rows, columns = np.nonzero(suspect)
    if rows.size == 0:
        return suspect
    level = np.nan_to_num(deviation)
    count, bearings = level.shape
    along = np.clip(rows[:, None] + np.arange(-(_ALONG // 2), _ALONG // 2 + 1), 0, count - 1)
    across = (columns[:, None] + np.arange(-(_ACROSS // 2), _ACROSS // 2 + 1)) % bearings
    value = level[rows, columns]
    by_rings = np.abs(value - np.median(level[along, columns[:, None]], axis=1))
    by_bearings = np.abs(value - np.median(level[rows[:, None], across], axis=1))
    far = np.nan_to_num(np.minimum(by_rings, by_bearings) > limit * noise[rows, 0], nan=True)
    suspect[rows, columns] = far
    return suspect


def patches(flags: ArrayLike, *, across: int, along: int) -> NDArray[np.bool_]:
    """Return the flags that belong to a patch: most of a window of bearings and most of a window of rings about them.

    Args:
        flags: (ring, bearing).
        across: Bearings of the window, which closes round the ring.
        along: Rings of the window.
    """
    flags = np.asarray(flags, bool)
    dense = uniform_filter1d(flags.astype(np.float32), max(across, 1), axis=1, mode="wrap")
    dense = uniform_filter1d(dense, max(along, 1), axis=0, mode="nearest")
    return flags & (dense > 0.5)
