"""How far the wall stands from its fitted section, reading by reading."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import uniform_filter1d

from .measures import polar_radius

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_WINDOW = np.pi / 18
"""Arc over which deviations are averaged [rad]: 10 degrees."""


def radial_deviation(ranges: ArrayLike, bearings: ArrayLike, parameters: ArrayLike) -> NDArray[np.float64]:
    """Return how far each reading lies outside its ring's ellipse, along the radius from the ellipse's centre.

    Args:
        ranges: (ring, bearing) ranges from the ring's own origin [m]; NaN = no return.
        bearings: (bearing,) bearings [rad], from +z counter-clockwise.
        parameters: (ring, 5) centre_z, centre_y, mean_radius, oval_cos, oval_sin [m].

    Returns:
        (ring, bearing) deviations [m], positive outside; NaN where there is no return or no fit.

    >>> radial_deviation([[1.0, 1.1]], [0.0, np.pi / 2], [[0.0, 0.0, 1.0, 0.0, 0.0]]).round(6)
    array([[0. , 0.1]])
    """
    ranges, p = np.asarray(ranges, float), np.asarray(parameters, float)
    z = ranges * np.cos(bearings) - p[:, :1]
    y = ranges * np.sin(bearings) - p[:, 1:2]
    return np.hypot(z, y) - polar_radius(p[:, None, 2:], np.arctan2(y, z))


def smoothed_extremes(deviation: ArrayLike, bearings: ArrayLike) -> tuple[NDArray[np.float64], ...]:
    """Return the furthest that the wall stands inside and outside its section, averaged over 10 degrees of arc.

    Args:
        deviation: (ring, bearing) deviations [m], positive outside; NaN = no return.
        bearings: (bearing,) equally spaced bearings [rad] round the whole ring.

    Returns:
        Inward deviation (negative) [m], its bearing [rad], outward deviation [m], its bearing [rad], each (ring,). A
        window counts when half of it holds readings; NaN where no window does.
    """
    deviation = np.asarray(deviation, float)
    seen = np.isfinite(deviation)
    width = max(1, round(_WINDOW / (2 * np.pi / deviation.shape[1])))
    total = uniform_filter1d(np.where(seen, deviation, 0.0), width, axis=1, mode="wrap")
    share = uniform_filter1d(seen.astype(float), width, axis=1, mode="wrap")
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(share >= 0.5 - 1e-9, total / share, np.nan)
    empty = ~np.isfinite(mean).any(axis=1)
    mean[empty] = 0.0
    bearings = np.asarray(bearings, float)
    found = []
    for pick in (np.nanargmin(mean, axis=1), np.nanargmax(mean, axis=1)):
        value = np.take_along_axis(mean, pick[:, None], axis=1)[:, 0]
        found += [np.where(empty, np.nan, value), np.where(empty, np.nan, bearings[pick])]
    return tuple(found)
