"""The pipe's own wall, as it is where nothing stands on it: what marks are measured against.

Frame of `springline.conventions`; rings come as ranges about their own origin, NaN = no return.
"""

from __future__ import annotations

from math import nan, sqrt
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy.ndimage import median_filter

from .regions import runs

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_STEPS = 40
_TUNING = 4.0
_LEAST_AGREE = 0.55


def steady_shape(shape: ArrayLike, distance: ArrayLike, *, window: float) -> NDArray[np.float64]:
    """Return each ring's section as the running median over the rings about it: joints and dents leave it alone.

    Rings are first gathered in slices of a tenth of the window, so that the cost does not grow with it.

    Args:
        shape: (ring, 3) mean_radius, oval_cos, oval_sin of every ring's own fit [m]; NaN = no fit.
        distance: (ring,) increasing [m].
        window: Length of the running median [m].

    Returns:
        (ring, 3) sections [m]; NaN when no ring has a fit.

    >>> shape = np.array([[0.15, 0.001, 0.0]] * 50)
    >>> shape[20:23, 0] = 0.16
    >>> steady_shape(shape, 0.01 * np.arange(50), window=0.2)[21].tolist()
    [0.15, 0.001, 0.0]
    """
    shape, distance = np.asarray(shape, float), np.asarray(distance, float)
    known = np.isfinite(shape).all(axis=1)
    if not known.any():
        return np.full(shape.shape, nan)
    step = max(0.1 * window, 1e-9)
    slices = np.floor((distance[known] - distance[0]) / step).astype(np.int64)
    which, first = np.unique(slices, return_index=True)
    rows, ends = shape[known], [*first[1:].tolist(), len(slices)]
    middle = np.array([np.median(rows[a:b], axis=0) for a, b in zip(first.tolist(), ends, strict=True)])
    at = np.array([distance[known][a:b].mean() for a, b in zip(first.tolist(), ends, strict=True)])
    if len(which) > 2:
        middle = median_filter(middle, size=(11, 1), mode="nearest")
    return np.stack([np.interp(distance, at, column) for column in middle.T], axis=1)


def centre_rings(
    ranges: ArrayLike, bearings: ArrayLike, shape: ArrayLike, start: ArrayLike, noise: ArrayLike
) -> NDArray[np.float64]:
    """Return where the section's centre lies in each ring, and how far out the ring stands all round.

    The section's shape is given; only its centre and one offset all round are fitted, so that a dent, a lateral or a
    deposit over less than half of the ring does not draw the section after it.

    Args:
        ranges: (ring, bearing) ranges [m]; NaN = no return or not to be used.
        bearings: (bearing,) [rad], from +z counter-clockwise.
        shape: (ring, 3) mean_radius, oval_cos, oval_sin [m].
        start: (ring, 2) centre_z, centre_y to start from [m].
        noise: (ring,) one-sigma of a reading [m].

    Returns:
        (ring, 5): centre_z, centre_y, offset, one-sigma of each of them for independent readings, and the share of the
        readings that agree, in order; NaN where fewer than a twelfth of the bearings have a reading.

    Source: iterated least squares with Tukey's biweight.

    >>> bearings = np.radians(np.arange(0.0, 360.0, 5.0))
    >>> ring = 0.15 + 0.002 * np.sin(bearings)
    >>> centre_rings([ring], bearings, [[0.15, 0.0, 0.0]], [[0.0, 0.0]], [0.0005]).round(4)[0, :3] + 0.0
    array([0.   , 0.002, 0.   ])
    """
    r, theta = np.ascontiguousarray(ranges, np.float32), np.asarray(bearings, float)
    table = np.stack([np.cos(theta), np.sin(theta)])
    return _centre(r, table, np.asarray(shape, float), np.asarray(start, float), np.asarray(noise, float))


def tracked_centres(
    distance: ArrayLike, placed: ArrayLike, *, most_offset: float, longest: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the centre in each ring, carried across rings whose own is not to be trusted, and which rings are.

    A ring that stands partly in an open joint is drawn after it, and shows that by standing out all round. Over less
    than `longest` its centre is taken from the rings before and behind it.

    Args:
        distance: (ring,) increasing [m].
        placed: (ring, 5) of `centre_rings`.
        most_offset: Offset all round beyond which a ring is not trusted [m].
        longest: Longest stretch that is bridged [m].

    Returns:
        (ring, 2) centre_z, centre_y [m], and (ring,) flags.
    """
    distance, placed = np.asarray(distance, float), np.asarray(placed, float)
    with np.errstate(invalid="ignore"):
        good = (placed[:, 4] > _LEAST_AGREE) & (np.abs(placed[:, 2]) < most_offset)
    centre = placed[:, :2].copy()
    if not good.any():
        return centre, np.isfinite(centre).all(axis=1)
    for first, last in runs(~good).tolist():
        before, after = max(first - 1, 0), min(last + 1, len(good) - 1)
        own = np.isfinite(placed[first : last + 1, 0]).all()
        if own and distance[after] - distance[before] > longest:
            good[first : last + 1] = True
    for column in centre.T:
        column[~good] = np.interp(distance[~good], distance[good], column[good])
    return centre, good


def wall_deviation(ranges: ArrayLike, bearings: ArrayLike, sections: ArrayLike) -> NDArray[np.float32]:
    """Return how far each reading lies outside its ring's section, along the radius from the section's centre.

    The same as `geometry.deviation.radial_deviation`, in single precision and without arrays in between, for maps of
    a whole survey.

    Args:
        ranges: (ring, bearing) ranges [m]; NaN = no return.
        bearings: (bearing,) [rad].
        sections: (ring, 5) centre_z, centre_y, mean_radius, oval_cos, oval_sin [m].

    Returns:
        (ring, bearing) deviations [m], positive outside; NaN without a reading or a section.

    >>> wall_deviation([[1.0, 1.1]], [0.0, np.pi / 2], [[0.0, 0.0, 1.0, 0.0, 0.0]]).round(6)
    array([[0. , 0.1]], dtype=float32)
    """
    r, theta = np.ascontiguousarray(ranges, np.float32), np.asarray(bearings, float)
    return _deviation(r, np.stack([np.cos(theta), np.sin(theta)]), np.ascontiguousarray(sections, np.float64))


@njit(cache=True, nogil=True, error_model="numpy")
def _deviation(ranges, table, sections):
    count, bearings = ranges.shape
    out = np.full((count, bearings), np.float32(nan))
    for i in range(count):
        z0, y0, m, c, s = sections[i]
        o2 = c * c + s * s
        square = (m * m - o2) ** 2
        level, turn = (m * m + o2) / square, -2.0 * m / square
        if not np.isfinite(level) or not np.isfinite(z0):
            continue
        for j in range(bearings):
            if np.isfinite(ranges[i, j]):
                out[i, j] = _outside(ranges[i, j], table[0, j], table[1, j], z0, y0, c, s, level, turn)
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def _centre(ranges, table, shape, start, noise):
    count, bearings = ranges.shape
    out = np.full((count, 5), nan)
    deviation = np.empty(bearings)
    for i in range(count):
        m, c, s = shape[i]
        if not (m > 0.0) or not np.isfinite(start[i, 0]):
            continue
        o2 = c * c + s * s
        square = (m * m - o2) ** 2
        level, turn = (m * m + o2) / square, -2.0 * m / square
        z0, y0, offset, scale = start[i, 0], start[i, 1], 0.0, 0.0
        total = 0.0
        for step in range(_STEPS):
            n = 0
            for j in range(bearings):
                if np.isfinite(ranges[i, j]):
                    deviation[n] = _outside(ranges[i, j], table[0, j], table[1, j], z0, y0, c, s, level, turn)
                    n += 1
            if n * 12 < bearings:
                break
            if step == 0:
                offset = np.median(deviation[:n])
            if step < 15:
                scale = max(1.4826 * np.median(np.abs(deviation[:n] - offset)), 0.5 * noise[i], 1e-6)
            a = np.zeros((3, 3))
            b = np.zeros(3)
            k, total = 0, 0.0
            for j in range(bearings):
                if not np.isfinite(ranges[i, j]):
                    continue
                u = (deviation[k] - offset) / (_TUNING * scale)
                residual = deviation[k] - offset
                k += 1
                if abs(u) >= 1.0:
                    continue
                w = (1.0 - u * u) ** 2
                total += 1.0
                row = (table[0, j], table[1, j], 1.0)
                for p in range(3):
                    b[p] += w * row[p] * residual
                    for q in range(3):
                        a[p, q] += w * row[p] * row[q]
            a[0, 0] += 1e-9
            a[1, 1] += 1e-9
            a[2, 2] += 1e-9
            inverse = np.linalg.inv(a)
            move = inverse @ b
            z0, y0, offset = z0 + move[0], y0 + move[1], offset + move[2]
            if abs(move[0]) + abs(move[1]) + abs(move[2]) < 1e-7:
                break
        if total == 0.0:
            continue
        out[i, 0], out[i, 1], out[i, 2] = z0, y0, offset
        out[i, 3], out[i, 4] = scale * sqrt(inverse[2, 2]), total / n
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def _outside(r, cos, sin, z0, y0, c, s, level, turn):
    """Return how far a reading lies outside the ellipse about (z0, y0), along the radius from there."""
    z, y = r * cos - z0, r * sin - y0
    h2 = z * z + y * y
    twice = (c * (z * z - y * y) + s * 2.0 * z * y) / h2
    return sqrt(h2) - 1.0 / sqrt(level + turn * twice)
