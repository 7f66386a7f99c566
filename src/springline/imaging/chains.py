"""Edge points linked into smooth arcs."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from springline.imaging.edges import EdgeField

    Array = NDArray[np.float64]

_STRONG = 1.3  # strength at which a chain begins; weaker points only prolong it
_SHORTEST = 10  # points
_STRAIGHT = 0.9  # cosine of the most that a chain turns from point to point
_TOLERANCE = 0.6  # px that an arc's points lie off its circle, rms


def smooth_arcs(field: EdgeField) -> list[Array]:
    """Return runs of edge points, longest first, each of which lies on one circle.

    Returns:
        Arrays (n, 6) with the columns of `EdgeField.points`, in order along the arc.
    """
    members, ends = _chains(field.points, field.index, _STRONG, _SHORTEST, _STRAIGHT)
    arcs: list[Array] = []
    for first, last in itertools.pairwise(ends):
        chain = field.points[members[first:last]]
        arcs += [chain[i:j] for i, j in _pieces(chain[:, 0].copy(), chain[:, 1].copy(), _TOLERANCE, _SHORTEST)]
    return sorted(arcs, key=len, reverse=True)


@njit(cache=True)
def _chains(points, index, strong, shortest, straight):
    """Follow edge points both ways from the strongest that is free; members of all chains and where each ends."""
    count = len(points)
    used = np.zeros(count, np.bool_)
    members = np.empty(count, np.int32)
    run = np.empty(count, np.int32)
    ends = [0]
    total = 0
    for seed in np.argsort(-points[:, 4]):
        if used[seed]:
            continue
        if points[seed, 4] < strong:
            break
        used[seed] = True
        back = 0
        here = seed
        while True:
            here = _next(points, index, used, here, -1.0, straight)
            if here < 0:
                break
            run[back] = here
            back += 1
        length = back + 1
        start = total
        for k in range(back):
            members[start + k] = run[back - 1 - k]
        members[start + back] = seed
        here = seed
        while True:
            here = _next(points, index, used, here, 1.0, straight)
            if here < 0:
                break
            members[start + length] = here
            length += 1
        if length >= shortest:
            total += length
            ends.append(total)
    return members[:total], np.array(ends)


@njit(cache=True)
def _next(points, index, used, here, way, straight):
    """The free neighbour that best continues the edge, marked as used; -1 when there is none."""
    along_x, along_y = -points[here, 3] * way, points[here, 2] * way
    column, row = round(points[here, 0]), round(points[here, 1])
    best, found = -1e9, -1
    for y in range(max(row - 2, 0), min(row + 3, index.shape[0])):
        for x in range(max(column - 2, 0), min(column + 3, index.shape[1])):
            other = index[y, x]
            if other < 0 or used[other]:
                continue
            step_x, step_y = points[other, 0] - points[here, 0], points[other, 1] - points[here, 1]
            step = math.hypot(step_x, step_y)
            if step < 0.3 or step > 2.6:
                continue
            ahead = (step_x * along_x + step_y * along_y) / step
            alike = points[other, 2] * points[here, 2] + points[other, 3] * points[here, 3]
            if ahead < 0.7 or alike < straight:
                continue
            merit = ahead + alike - 0.3 * step
            if merit > best:
                best, found = merit, other
    if found >= 0:
        used[found] = True
    return found


@njit(cache=True)
def _pieces(x, y, tolerance, shortest):
    """Cut a chain into the longest runs that each fit a circle; first and last + 1 of each."""
    found = [(0, 0)]
    found.pop()
    first, count = 0, len(x)
    while count - first >= shortest:
        if _misfit(x[first:], y[first:]) <= tolerance:
            found.append((first, count))
            break
        low, high = first + shortest, count
        if _misfit(x[first:low], y[first:low]) > tolerance:
            first += max(1, shortest // 2)
            continue
        while high - low > 1:
            middle = (low + high) // 2
            if _misfit(x[first:middle], y[first:middle]) <= tolerance:
                low = middle
            else:
                high = middle
        found.append((first, low))
        first = low
    return found


@njit(cache=True)
def _misfit(x, y):
    """Rms distance of points to their circle by Kasa's fit; a straight run counts as a circle."""
    mean_x, mean_y = x.mean(), y.mean()
    u, v = x - mean_x, y - mean_y
    z = u * u + v * v
    uu, uv, vv = (u * u).sum(), (u * v).sum(), (v * v).sum()
    determinant = uu * vv - uv * uv
    if determinant < 1e-9 * (uu + vv) ** 2:
        return 0.0
    a = 0.5 * ((u * z).sum() * vv - (v * z).sum() * uv) / determinant
    b = 0.5 * ((v * z).sum() * uu - (u * z).sum() * uv) / determinant
    radius = math.sqrt(a * a + b * b + z.mean())
    total = 0.0
    for k in range(len(u)):
        total += (math.hypot(u[k] - a, v[k] - b) - radius) ** 2
    return math.sqrt(total / len(u))
