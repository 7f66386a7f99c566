"""An open or closed joint sized: how far the pipe ends stand apart, and how the next pipe is set off and turned."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .chance import robust_sigma
from .edges import crossings, edge_between
from .steps import jumps

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_LEAST_RINGS = 6
_WIDER = (1.4, 2.5)
"""Factors on the sigmas of step and turn, measured on simulated pipes: rings about a joint share their roughness."""


class Gap(NamedTuple):
    """An open joint; all with their one-sigma.

    Attributes:
        middle, middle_sigma: Place of its middle [m].
        gap, gap_sigma: How far the ends stand apart on average round the pipe [m].
        depth, depth_sigma: How far the wall stands back in it [m].
        reach: Half the length over which rings see both pipes, the gap and the rings' tilt together [m].
    """

    middle: float
    middle_sigma: float
    gap: float
    gap_sigma: float
    depth: float
    depth_sigma: float
    reach: float


class SetOff(NamedTuple):
    """How the next pipe lies: (right, up, radius) displacement [m] and (right, up) turn [rad], with one-sigma."""

    step: NDArray[np.float64]
    step_sigma: NDArray[np.float64]
    turn: NDArray[np.float64]
    turn_sigma: NDArray[np.float64]


def size_gap(before: ArrayLike, after: ArrayLike, place: ArrayLike, bearings: ArrayLike, *, noise: float) -> Gap | None:
    """Return the size of an open joint.

    Args:
        before: (ring, bearing) deviations from the wall of the pipe before it, carried on across the joint [m];
            positive outside, NaN = no reading.
        after: (ring, bearing) deviations from the wall of the pipe after it, carried back.
        place: (ring,) chainage [m].
        bearings: (bearing,) [rad].
        noise: One-sigma of a reading [m].

    Returns:
        The gap; None when no ring stands in it.
    """
    before, after, place = (np.asarray(v, float) for v in (before, after, place))
    known = np.isfinite(before) & np.isfinite(after)
    with np.errstate(invalid="ignore"):
        lower = np.minimum(before, after)
    rest = lower[known & (lower > 4.0 * noise)]
    if not len(rest):
        return None
    depth = float(np.quantile(rest, 0.75))
    with np.errstate(invalid="ignore"):
        first = crossings(before > 0.5 * depth, known, place)
        last = crossings((after > 0.5 * depth)[::-1], known[::-1], place[::-1])
    start, end = edge_between(*first, bearings), edge_between(last[1], last[0], bearings)
    if start is None or end is None:
        return None
    gap = end.plane[0] - start.plane[0]
    variance = start.covariance[0, 0] + end.covariance[0, 0]
    inside = rest[rest > 0.5 * depth]
    spread = 1.4826 * float(np.median(np.abs(inside - depth)))
    return Gap(
        middle=0.5 * (end.plane[0] + start.plane[0]),
        middle_sigma=float(np.hypot(0.5 * np.sqrt(variance), 0.1 * np.median(np.abs(np.diff(place))))),
        gap=max(float(gap), 0.0),
        gap_sigma=float(np.sqrt(variance)),
        depth=float(np.median(inside)),
        depth_sigma=float(np.hypot(spread / np.sqrt(max(len(inside) / 20.0, 1.0)), 0.5 * noise)),
        reach=0.5 * max(float(gap), 0.0) + max(float(np.hypot(*edge.plane[1:])) for edge in (start, end)),
    )


def size_step(
    place: ArrayLike,
    values: ArrayLike,
    at: float,
    *,
    reach: float,
    window: float,
    scatter: ArrayLike,
    noise: ArrayLike,
) -> SetOff | None:
    """Return how the pipe after a joint is displaced and turned against the pipe before it.

    Lines are laid through the rings on each side; what the robot itself does there is smooth and cancels.

    Args:
        place: (ring,) chainage [m].
        values: (ring, 3) centre_z, centre_y, mean_radius of rings [m]; NaN inside the joint.
        at: Chainage of the joint [m].
        reach: Half the length about it whose rings see both pipes [m].
        window: Length on each side [m].
        scatter: (3,) one-sigma that such steps show where there is no joint [m].
        noise: (3,) one-sigma of a ring's values [m].

    Returns:
        None when a side has fewer than three rings.
    """
    place, values = np.asarray(place, float), np.asarray(values, float)
    known = np.isfinite(values).all(axis=1)
    before, after = np.flatnonzero(known & (place < at - reach))[::-1], np.flatnonzero(known & (place > at + reach))
    if min(len(before), len(after)) < 3:
        return None
    noise, scatter = np.asarray(noise, float), np.asarray(scatter, float)
    sides = before, after
    shorter, one, two = (
        _lines(place, values, at, sides, (least, k * window), noise, scatter)
        for least, k in ((_LEAST_RINGS // 2, 0.5), (_LEAST_RINGS, 1.0), (_LEAST_RINGS, 2.0))
    )
    # What another window says otherwise is the robot's own way, which is not straight over all of it.
    bent = 1.3 * np.sqrt(np.mean((shorter[0] - one[0]) ** 2))
    wound = np.sqrt(np.mean((two[2] - one[2])[:2] ** 2))
    step_sigma, turn_sigma = np.hypot(one[1], bent), np.hypot(two[3], wound)
    return SetOff(one[0], _WIDER[0] * step_sigma, two[2][:2], _WIDER[1] * turn_sigma[:2])


def _lines(
    place: NDArray,
    values: NDArray,
    at: float,
    sides: tuple,
    window: tuple[int, float],
    noise: NDArray,
    scatter: NDArray,
) -> tuple[NDArray[np.float64], ...]:
    """Return step and turn with their sigmas, from lines through at least so many rings, or a window, on each side."""
    least, length = window
    part = [side[: max(least, int((np.abs(place[side] - place[side[0]]) <= length).sum()))] for side in sides]
    rows, left = np.concatenate([part[0][::-1], part[1]]), len(part[0])
    x = place[rows]
    step, step_factor, turn, turn_factor = _across(x, values[rows], at, left)
    one = np.maximum(noise, scatter / max(_plain_factor(x, left), 1e-9))
    return step, one * step_factor, turn, one * turn_factor


def _across(x: NDArray, values: NDArray, at: float, left: int) -> tuple:
    """Return step and change of slope at `at`, and their factors on the noise of one ring."""
    rows = np.zeros((len(x), 4))
    rows[:left, 0], rows[:left, 1] = 1.0, x[:left] - at
    rows[left:, 2], rows[left:, 3] = 1.0, x[left:] - at
    inverse = np.linalg.inv(rows.T @ rows)
    found = inverse @ rows.T @ values
    variance = np.diag(inverse)
    return (
        found[2] - found[0],
        float(np.sqrt(variance[0] + variance[2])),
        found[3] - found[1],
        float(np.sqrt(variance[1] + variance[3])),
    )


def _plain_factor(x: NDArray, left: int) -> float:
    """Return the factor that a step between two neighbouring rings would have with as many rings on each side."""
    spacing = float(np.median(np.diff(x)))
    even = spacing * (np.arange(len(x)) - left + 0.5)
    return _across(even, np.zeros((len(x), 1)), 0.0, left)[1]


def step_scatter(distance: ArrayLike, values: ArrayLike, *, window: int) -> NDArray[np.float64]:
    """Return the one-sigma of steps where most of a survey has no joint: noise, roughness and the robot's own way.

    Args:
        distance: (ring,) increasing [m].
        values: (ring, 3) centre_z, centre_y, mean_radius [m]; NaN = not known.
        window: Rings on each side.
    """
    step = jumps(distance, values, np.ones(3), window=window).step
    return np.array([robust_sigma(column) for column in step.T])
