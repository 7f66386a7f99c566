"""Stations whose section differs from the pipe on both sides of it: a ring inside a joint, or one that was misread."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import median_filter

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_SIGMAS = 6.0
_SHARE = 0.004


def unlike_both_sides(parameters: ArrayLike, sigma: ArrayLike, *, window: int) -> NDArray[np.bool_]:
    """Return which stations differ from the running median of the stations about them.

    A change that lasts longer than half the window, such as a new pipe length or a dent, is not flagged.

    Args:
        parameters: (station, parameter) of the sections [m]; NaN where there is none.
        sigma: (station, parameter) their one-sigma [m].
        window: Stations in the running median.

    Returns:
        (station,) flags: any parameter differs by more than six sigmas and by more than 0.4 % of the first parameter,
        the mean radius.

    >>> radius = np.full((9, 1), 0.15)
    >>> radius[4] = 0.16
    >>> np.flatnonzero(unlike_both_sides(radius, np.full((9, 1), 1e-4), window=5)).tolist()
    [4]
    """
    parameters, sigma = np.asarray(parameters, float), np.asarray(sigma, float)
    fitted = np.flatnonzero(np.isfinite(parameters).all(axis=1))
    flags = np.zeros(len(parameters), bool)
    if len(fitted) < 3:
        return flags
    values = parameters[fitted]
    # Within half a window of an end the median is pulled along the slope of the pipe; mirrored values keep it level.
    local = median_filter(values, size=(window | 1, 1), mode="reflect")
    limit = np.maximum(_SIGMAS * sigma[fitted], _SHARE * np.abs(local[:, :1]))
    flags[fitted] = (np.abs(values - local) > limit).any(axis=1)
    return flags
