"""Where a pipe ends, told from rings that see its wall or no longer see it, bearing by bearing.

An edge is a plane across the pipe: it lies at x = c + a cos(bearing) + b sin(bearing). No ring stands on it; each
bearing says only between which two rings it lies. How sure that is of c, a and b is not a matter of least squares: a
hundred bearings that all say "between 1 and 2" know no more than one of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit
from scipy.optimize import linprog

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_MOST = 120
_DRAWS = 4000
_RAGGED = 0.5
_STRAIGHT = 0.1
"""Share of the spacing by which a clean cut may still be ragged."""
_LEVEL = 0.1
"""Share of the spacing below which a tilt is as good as none: robots mostly drive level."""


class Edge(NamedTuple):
    """An edge.

    Attributes:
        plane: (3,) mean of c, a, b [m].
        covariance: (3, 3) of them [m2].
        bearings: How many it stands on.
        floor: Part of the variance of c that stays however many rings there are [m2].
        draws: Values of c, each as likely as the others, without the floor; None where it was fitted by least squares.
    """

    plane: NDArray[np.float64]
    covariance: NDArray[np.float64]
    bearings: int
    floor: float = 0.0
    draws: NDArray[np.float64] | None = None


def edge_between(before: ArrayLike, after: ArrayLike, bearings: ArrayLike) -> Edge | None:
    """Return the plane that passes between the rings before it and the rings after it, with its covariance.

    Args:
        before: (bearing,) place of the last ring before the edge [m]; NaN = not known at that bearing.
        after: (bearing,) place of the first ring beyond it [m].
        bearings: (bearing,) [rad].

    Returns:
        The edge; None when fewer than eight bearings see it.

    Source: the posterior, drawn by hit and run, of planes that pass between the rings at every bearing; the
    prior of a and b falls with the square of the tilt. Ragged ends, which no plane fits, are fitted by least squares.

    >>> bearings = np.radians(np.arange(0.0, 360.0, 10.0))
    >>> edge = edge_between(np.full(36, 0.002), np.full(36, 0.003), bearings)
    >>> print(edge.plane[0].round(4), 1e3 * np.sqrt(edge.covariance[0, 0]).round(4))
    0.0025 0.3
    """
    before, after, bearings = (np.asarray(v, float) for v in (before, after, bearings))
    known = np.flatnonzero(np.isfinite(before) & np.isfinite(after))
    if len(known) < 8:
        return None
    rows = np.column_stack([np.ones(len(known)), np.cos(bearings[known]), np.sin(bearings[known])])
    low, high = before[known], after[known]
    width = max(float(np.median(high - low)), 1e-9)
    plane, scatter, kept = _plane(rows, low, high, width)
    rows, low, high = rows[kept], low[kept], high[kept]
    if len(low) < 8:
        return None
    part = np.unique(np.linspace(0, len(low) - 1, min(_MOST, len(low))).astype(int))
    floor = np.diag([(_STRAIGHT * width) ** 2, 0.0, 0.0])
    inside, slack = _between(rows[part], low[part], high[part])
    if slack > -_RAGGED * width:
        # A cut that is ragged by less than the spacing is given the room that it needs.
        room = max(0.0, -1.25 * slack) + _STRAIGHT * width
        draws = _hit_and_run(rows[part], low[part] - room, high[part] + room, inside)
        weight = 1.0 / (draws[:, 1] ** 2 + draws[:, 2] ** 2 + (_LEVEL * width) ** 2)
        draws = draws[np.random.default_rng(0).choice(len(draws), len(draws), p=weight / weight.sum())]
        bottom, top = low.max() - room, high.min() + room
        if top > bottom:
            # A ring that stands square to the pipe is as likely as any tilt.
            level = np.zeros_like(draws)
            level[:, 0] = np.linspace(bottom, top, len(draws))
            draws = np.concatenate([draws, level])
        return Edge(draws.mean(axis=0), np.cov(draws.T) + floor, len(low), float(floor[0, 0]), draws[:, 0])
    inverse = np.linalg.inv(rows.T @ rows)
    # Readings of one ring round alike: part of that error stays however many they are.
    rounding = np.diag([width**2 / 12.0 / (1.0 + (scatter / width) ** 2 * len(low)), 0.0, 0.0])
    return Edge(plane, inverse * scatter**2 + rounding + floor, len(low))


def _plane(rows: NDArray, low: NDArray, high: NDArray, width: float) -> tuple[NDArray, float, NDArray[np.bool_]]:
    """Return the plane of least squares through the middles, the scatter about it, and which bearings agree."""
    middle = 0.5 * (low + high)
    kept = np.ones(len(low), bool)
    plane, scatter = np.zeros(3), 0.0
    for _ in range(4):
        ridge = np.diag([0.0, 0.5, 0.5])
        plane = np.linalg.solve(rows[kept].T @ rows[kept] + ridge, rows[kept].T @ middle[kept])
        off = middle - rows @ plane
        scatter = float(max(1.4826 * np.median(np.abs(off[kept])), width / np.sqrt(12.0)))
        kept = np.abs(off) < np.maximum(4.0 * scatter, 0.75 * (high - low))
    return plane, scatter, kept


def _between(rows: NDArray, low: NDArray, high: NDArray) -> tuple[NDArray[np.float64], float]:
    """Return the plane that keeps farthest from the rings on both sides, and how far (negative: none passes)."""
    one = np.ones((len(low), 1))
    limits = np.concatenate([np.hstack([rows, one]), np.hstack([-rows, one])])
    unit = float(np.median(high - low))
    found = linprog([0.0, 0.0, 0.0, -1.0], A_ub=limits, b_ub=np.concatenate([high, -low]) / unit, bounds=(None, None))
    return unit * found.x[:3], unit * float(found.x[3])


def _hit_and_run(rows: NDArray, low: NDArray, high: NDArray, inside: NDArray) -> NDArray[np.float64]:
    """Return planes drawn evenly from all that pass between the rings: along a random line each time."""
    random = np.random.default_rng(1)
    lines, shares = random.standard_normal((_DRAWS, 3)), random.random(_DRAWS)
    return _walk(rows, low, high, inside, lines, shares)


@njit(cache=True, nogil=True, error_model="numpy")
def _walk(rows, low, high, inside, lines, shares):
    draws = np.empty(lines.shape)
    at = inside.copy()
    place = rows @ at
    for k in range(len(lines)):
        line = lines[k].copy()
        if k % 2:
            line[k // 2 % 3] *= 10.0
        slope = rows @ line
        bottom, top = -np.inf, np.inf
        for j in range(low.size):
            if slope[j] > 0.0:
                bottom, top = max(bottom, (low[j] - place[j]) / slope[j]), min(top, (high[j] - place[j]) / slope[j])
            elif slope[j] < 0.0:
                bottom, top = max(bottom, (high[j] - place[j]) / slope[j]), min(top, (low[j] - place[j]) / slope[j])
        if top > bottom:
            step = bottom + (top - bottom) * shares[k]
            at = at + step * line
            place = place + step * slope
        draws[k] = at
    return draws


def crossings(inside: ArrayLike, known: ArrayLike, place: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return between which rings each bearing passes into an opening, going along the rings.

    Args:
        inside: (ring, bearing) whether a reading is beyond the edge.
        known: (ring, bearing) whether there is a reading at all.
        place: (ring,) or (ring, bearing) where it lies [m].

    Returns:
        Place of the last known ring before the first ring inside, and of that first ring, (bearing,) each [m]; NaN
        where either is lacking.

    >>> inside = np.array([[False], [False], [True], [True]])
    >>> [v.tolist() for v in crossings(inside, np.ones((4, 1), bool), [0.0, 1.0, 2.0, 3.0])]
    [[1.0], [2.0]]
    """
    inside, known = np.asarray(inside, bool), np.asarray(known, bool)
    place = np.asarray(place, float)
    place = np.broadcast_to(place[:, None] if place.ndim == 1 else place, inside.shape)
    rows = np.arange(len(inside))[:, None]
    within = inside & known
    first = np.where(within.any(axis=0), np.argmax(within, axis=0), len(inside))
    wall = known & ~inside & (rows < first)
    last = np.where(wall, rows, -1).max(axis=0)
    there = (first < len(inside)) & (last >= 0)
    columns = np.arange(inside.shape[1])
    after = np.where(there, place[np.minimum(first, len(inside) - 1), columns], np.nan)
    before = np.where(there, place[np.maximum(last, 0), columns], np.nan)
    return before, after
