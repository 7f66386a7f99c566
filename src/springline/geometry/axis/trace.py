"""Following a pipe through its bends: cylinders laid end to end, then a smooth curve through their middles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.axis._support import support
from springline.geometry.axis.cylinder import Cylinder, refine

if TYPE_CHECKING:
    from numpy.typing import NDArray

_STEP = 0.5
"""Distance from one cylinder to the next, in radii."""
_WINDOW = 0.8
"""Half length of each cylinder, in radii."""
_TOLERANCE = 0.08
_LEAST_SHARE, _LEAST_WALL = 0.5, 30.0
"""Share and number of cells of wall (of about 600) that a cylinder must show to go on."""
_LEAST_ARC = 15
_FRESH = 0.5
"""How far a new direction is believed against the one before."""
_FURTHEST = 4000


def trace(points: NDArray[np.float64], start: Cylinder) -> NDArray[np.float64]:
    """Return places (node, 3) along the pipe's middle, every half radius, as far as its wall is seen.

    Args:
        points: (point, 3), evenly spread over the surface.
        start: A cylinder somewhere on the pipe.
    """
    from scipy.spatial import cKDTree

    tree = cKDTree(points)
    back = _march(points, tree, Cylinder(start.point, -start.direction, start.radius, start.oval))
    ahead = _march(points, tree, start)
    return np.array([*back[::-1], start.point, *ahead])


def _march(points: NDArray, tree, start: Cylinder) -> list[NDArray]:
    found: list[NDArray] = []
    misses: list[NDArray] = []
    last = start
    for _ in range(_FURTHEST):
        guess = Cylinder(last.point + _STEP * start.radius * last.direction, last.direction, start.radius)
        near = points[tree.query_ball_point(guess.point, 1.8 * start.radius)]
        fitted = _fit(near, guess, start.radius, bool(start.oval.any()))
        if fitted is None:
            # One blank step is bridged: a joint or a shadow is shorter than half a radius.
            if misses:
                break
            misses.append(guess.point)
            last = guess
            continue
        found.extend([*misses, fitted.point])
        misses.clear()
        last = fitted
    return found


def _fit(near: NDArray, guess: Cylinder, radius: float, oval: bool) -> Cylinder | None:
    """Return the cylinder at the guess, or None where no wall of about the same radius is there."""
    if len(near) < 30:
        return None
    fitted = refine(near, guess, window=_WINDOW, oval=oval)
    if fitted is None or abs(fitted.radius / radius - 1.0) > 0.15:
        return None
    slip = fitted.point - guess.point
    slip -= (slip @ guess.direction) * guess.direction
    if np.linalg.norm(slip) > 0.3 * radius or fitted.direction @ guess.direction < 0.8:
        return None
    score, share = np.empty(1), np.empty(1)
    arrays = (near, fitted.point[None], fitted.direction[None], np.array([fitted.radius]), fitted.oval[None])
    support(*arrays, _WINDOW, _TOLERANCE, _LEAST_ARC, score, share)
    if share[0] < _LEAST_SHARE or score[0] < _LEAST_WALL:
        return None
    direction = guess.direction + _FRESH * (fitted.direction - guess.direction)
    return Cylinder(fitted.point, direction / np.linalg.norm(direction), fitted.radius)


def smooth(places: NDArray[np.float64], knot: float) -> NDArray[np.float64]:
    """Return the places on a smooth curve through them: a least-squares cubic spline with a knot every `knot` metres.

    Args:
        places: (node, 3) in their order along the pipe.
        knot: Distance between knots [m].

    >>> wavy = np.column_stack([np.arange(9.0), np.tile([0.1, -0.1], 5)[:9], np.zeros(9)])
    >>> bool(np.abs(smooth(wavy, 8.0)[:, 1]).max() < 0.06)
    True
    """
    from scipy.interpolate import make_lsq_spline

    run = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1)))
    inner = np.arange(1, int(run[-1] / knot)) * (run[-1] / max(1, int(run[-1] / knot)))
    degree = min(3, len(places) - 1)
    knots = np.concatenate([np.zeros(degree + 1), inner, np.full(degree + 1, run[-1])])
    if len(knots) - degree - 1 >= len(places):
        return places
    return make_lsq_spline(run, places, knots, k=degree)(run)
