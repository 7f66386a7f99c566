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


def common_deviation(ranges: ArrayLike, bearings: ArrayLike, parameters: ArrayLike) -> tuple[float, float]:
    """Return how far the wall leaves its ellipses at the same bearings in all of some rings.

    The median over the rings is taken at each bearing that three in ten of them show, and then over 10 degrees of arc:
    neither what one ring shows, such as a lateral or a joint, nor noise counts.

    Args:
        ranges: (ring, bearing) ranges from the ring's own origin [m]; NaN = none.
        bearings: (bearing,) bearings [rad], from +z counter-clockwise.
        parameters: (ring, 5) centre_z, centre_y, mean_radius, oval_cos, oval_sin [m].

    Returns:
        Root mean square and largest size [m]; zeros where nothing is shown.

    >>> t = np.radians(np.arange(0, 360, 2))
    >>> found = common_deviation(0.3 + 0.01 * np.tile(np.cos(3 * t), (9, 1)), t, np.tile([0, 0, 0.3, 0, 0], (9, 1)))
    >>> np.round(found, 3)
    array([0.007, 0.01 ])
    """
    deviation = radial_deviation(ranges, bearings, parameters)
    shown = np.isfinite(deviation).sum(axis=0) >= max(0.3 * len(deviation), 1.0)
    if not shown.any():
        return 0.0, 0.0
    common = np.full(deviation.shape[1], np.nan)
    common[shown] = np.nanmedian(deviation[:, shown], axis=0)
    reach = max(1, round(_WINDOW / (2 * np.pi / len(common)) / 2))
    smooth = np.array([np.roll(common, k) for k in range(-reach, reach + 1)])
    smooth = np.nanmedian(smooth[:, np.isfinite(smooth).any(axis=0)], axis=0)
    return float(np.sqrt(np.mean(smooth**2))), float(np.abs(smooth).max())


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


def correlation_inflation(deviation: ArrayLike, noise: ArrayLike, *, window: int) -> NDArray[np.float64]:
    """Return by how much the variance of a fit grows because neighbouring readings err together.

    Readings that share their error tell less than their number says: the variance of what is fitted to them is that
    of independent readings times 1 + 2 (sum of the correlations at all lags). The correlations are those of the
    deviations along the ring, over lags up to 10 degrees while they stay positive, averaged over a window of rings.
    A wall that is no ellipse counts too: where the model is wrong its sigma is widened.

    Args:
        deviation: (ring, bearing) radial deviations from the fitted section [m] at equal bearings; NaN = not used.
        noise: (ring,) one-sigma of a reading [m]; deviations count up to four of them.
        window: Rings of the average.

    Returns:
        (ring,) factors of 1 or more; 1 where there is no fit.

    Source: effective sample size of a correlated series, with the initial positive sequence of correlations.

    >>> rough = np.repeat(np.random.default_rng(0).standard_normal((50, 60)), 6, axis=1)
    >>> round(float(correlation_inflation(rough, np.ones(50), window=9).mean()), 1)
    6.2
    """
    deviation, noise = np.asarray(deviation, float), np.asarray(noise, float)[:, None]
    with np.errstate(invalid="ignore"):
        part = np.nan_to_num(np.clip(deviation, -4.0 * noise, 4.0 * noise))
    seen = (np.isfinite(deviation) & np.isfinite(noise)).astype(float)
    part = part * seen
    lags = max(1, round(_WINDOW / (2 * np.pi / deviation.shape[1])))
    covariance = [
        _running(np.einsum("ij,ij->i", part, np.roll(part, k, axis=1)), window)
        / np.maximum(_running(np.einsum("ij,ij->i", seen, np.roll(seen, k, axis=1)), window), 1e-9)
        for k in range(lags + 1)
    ]
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = np.nan_to_num(np.stack(covariance[1:]) / covariance[0])
    positive = np.cumprod(correlation > 0, axis=0)
    return 1.0 + 2.0 * (correlation * positive).sum(axis=0)


def _running(values: NDArray[np.float64], window: int) -> NDArray[np.float64]:
    return uniform_filter1d(values, max(window, 1), mode="nearest")


def largest_gap(used: ArrayLike) -> NDArray[np.float64]:
    """Return the longest arc [rad] without a used reading, for each ring of equally spaced bearings.

    Args:
        used: (ring, bearing) flags.

    >>> largest_gap([[True, True, False, False], [False, False, False, False]]).round(4)
    array([4.7124, 6.2832])
    """
    used = np.asarray(used, bool)
    count = used.shape[1]
    twice = np.concatenate([used, used], axis=1)
    place = np.where(twice, np.arange(2 * count), -1)
    last = np.maximum.accumulate(place, axis=1)
    # From each used reading of the second turn back to the one before it.
    before = np.concatenate([np.full((len(used), 1), -1), last[:, :-1]], axis=1)
    steps = np.where(twice, np.arange(2 * count) - before, 0)[:, count:]
    widest = np.where(used.any(axis=1), steps.max(axis=1), count)
    return np.where(widest > 1, widest, 0.0) * (2.0 * np.pi / count)
