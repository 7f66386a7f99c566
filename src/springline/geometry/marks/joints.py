"""An open or closed joint sized: how far the pipe ends stand apart, and how the next pipe is set off and turned."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .cuts import cut_ends
from .edges import crossings, edge_between

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .edges import Edge

_LEAST_SPACING = 1e-6
"""For robots that stand [m]."""
_FEW, _WHOLE = 8, 0.9
"""Bearings that must see into a joint, and their share from which rings stand in it as a whole."""
_STRAIGHT = 0.1
"""Share of the spacing by which a clean cut may still be ragged."""
_SPAN = 0.1
"""Length on each side of a joint over which rings tell how the robot drives there [m]."""
_FEWEST, _MOST_RINGS = 8, 24
_LIKE = 0.03
"""Length over which the wall's roughness moves the middles of rings alike [m]."""
_WINDING = 10.0 ** np.arange(-7.0, -1.9, 0.5)
"""How much a robot's way may bend: variance of its direction per length [rad2/m], each as likely as the others."""
_ROUGH = np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0])
"""Error that neighbouring rings share, in one-sigmas of what each has by itself."""
_NARROW = 0.1
"""Share of the spacing below which the width of a gap is as good as none."""
_TURN = np.radians(1.5)
"""One-sigma of what joints turn by."""
_WIDER = 1.35
"""Factor on the sigma of a step, measured on simulated pipes."""


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


def size_gap(
    before: ArrayLike, after: ArrayLike, place: ArrayLike, bearings: ArrayLike, *, noise: float, radius: float
) -> Gap | None:
    """Return the size of an open joint.

    Args:
        before: (ring, bearing) deviations from the wall of the pipe before it, carried on across the joint [m];
            positive outside, NaN = no reading.
        after: (ring, bearing) deviations from the wall of the pipe after it, carried back.
        place: (ring,) chainage [m].
        bearings: (bearing,) [rad].
        noise: One-sigma of a reading [m].
        radius: Of the pipe [m].

    Returns:
        The gap; None when no ring stands in it, nor is cut by it at eight bearings.
    """
    before, after, place = (np.asarray(v, float) for v in (before, after, place))
    known = np.isfinite(before) & np.isfinite(after)
    with np.errstate(invalid="ignore"):
        lower = np.minimum(before, after)
    rest = lower[known & (lower > 4.0 * noise)]
    if not len(rest) or len(place) < 3:
        return None
    depth = float(np.quantile(rest, 0.75))
    with np.errstate(invalid="ignore"):
        first = crossings(before > 0.5 * depth, known, place)
        last = crossings((after > 0.5 * depth)[::-1], known[::-1], place[::-1])
    inside = rest[rest > 0.5 * depth]
    spacing = max(float(np.median(np.abs(np.diff(place)))), _LEAST_SPACING)
    cut = known & (lower > 0.5 * depth)
    met = cut.any(axis=0)
    if _FEW <= met.sum() < _WHOLE * known.any(axis=0).sum() and np.median(cut.sum(axis=0)[met]) < 2:
        # Rings that the joint cuts: bearings that see nothing of it say as much as those that do.
        ends, covariance = cut_ends(cut, known, place, bearings, radius=radius)
        planes = ends[:3], ends[3:]
        apart, floor = float(ends[3] - ends[0]), 2.0 * (_STRAIGHT * spacing) ** 2
        gap, variance = apart, float(covariance[0, 0] + covariance[3, 3] - 2.0 * covariance[0, 3]) + floor
        # One ring that is cut on one side does not tell to which side the joint leans.
        unsure = 0.5 * spacing if cut.any(axis=1).sum() == 1 else 0.1 * spacing
    else:
        start, end = edge_between(*first, bearings), edge_between(last[1], last[0], bearings)
        if start is None or end is None:
            return None
        planes = start.plane, end.plane
        apart = float(end.plane[0] - start.plane[0])
        gap, variance = _apart(start, end, spacing)
        unsure = 0.1 * spacing
    spread = 1.4826 * float(np.median(np.abs(inside - depth)))
    return Gap(
        middle=float(0.5 * (planes[0][0] + planes[1][0])),
        middle_sigma=float(np.hypot(0.5 * np.sqrt(variance), unsure)),
        gap=gap,
        gap_sigma=float(np.sqrt(variance)),
        depth=float(np.median(inside)),
        depth_sigma=float(np.hypot(spread / np.sqrt(max(len(inside) / 20.0, 1.0)), 0.5 * noise)),
        reach=0.5 * max(apart, 0.0) + max(float(np.hypot(*plane[1:])) for plane in planes),
    )


def _apart(start: Edge, end: Edge, spacing: float) -> tuple[float, float]:
    """Return how far two edges are apart and the variance: gaps between 1 and 2 mm are as many as between 2 and 4.

    A joint in which one ring stands would else be taken for as wide as the spacing: narrow gaps are hit less often,
    but there are more of them.
    """
    if start.draws is None or end.draws is None:
        variance = start.covariance[0, 0] + end.covariance[0, 0]
        return max(float(end.plane[0] - start.plane[0]), 0.0), float(variance)
    random = np.random.default_rng(2)
    gap = random.permutation(end.draws) - random.choice(start.draws, len(end.draws))
    gap = gap[gap > 0.0]
    if not len(gap):
        return 0.0, float(start.covariance[0, 0] + end.covariance[0, 0])
    weight = 1.0 / np.hypot(gap, _NARROW * spacing)
    mean = float(np.average(gap, weights=weight))
    floor = start.floor + end.floor
    return mean, float(np.average((gap - mean) ** 2, weights=weight)) + floor


def size_step(
    place: ArrayLike, values: ArrayLike, at: float, *, at_sigma: float, reach: float, noise: ArrayLike
) -> SetOff | None:
    """Return how the pipe after a joint is displaced and turned against the pipe before it.

    The robot's own way is smooth, however much it bends; the pipe's jumps at the joint and turns there. How much the
    way bends, and how much of the rings' scatter neighbours share, is told by these very rings: step and turn are
    means over all that is likely, and their sigmas hold the doubt about it.

    Args:
        place: (ring,) chainage, rising [m].
        values: (ring, 3) centre_z, centre_y, mean_radius of rings [m]; NaN inside the joint.
        at: Chainage of the joint [m].
        at_sigma: Its one-sigma [m].
        reach: Half the length about it whose rings may see both pipes [m]; those that lie so far off are left out too.
        noise: (3,) one-sigma of a ring's values [m].

    Returns:
        None when a side has fewer than three rings.

    Source: least squares of two lines, with a Gaussian process between them: a twice integrated random walk for the
    robot's way (a smoothing spline), exponential correlation for the roughness.
    """
    place, values = np.asarray(place, float), np.asarray(values, float)
    noise = np.asarray(noise, float)
    known = np.isfinite(values).all(axis=1)
    reach = reach + 1e-9
    before, after = np.flatnonzero(known & (place < at - reach))[::-1], np.flatnonzero(known & (place > at + reach))
    if min(len(before), len(after)) < 3:
        return None
    parts = [_thinned(place, values, side) for side in (before, after)]
    x, y, share = (np.concatenate([part[k] for part in parts]) for k in range(3))
    found, variance, weight = _by_bend(x - at, y, share, noise)
    mean = (weight[..., None] * found).sum(axis=0)
    sigma = np.sqrt((weight[..., None] * (variance + (found - mean) ** 2)).sum(axis=0))
    # The step is that at the joint: where it lies otherwise, the turn adds to it.
    lever = at_sigma * np.hypot(mean[:, 1], sigma[:, 1])
    return SetOff(mean[:, 0], np.hypot(_WIDER * sigma[:, 0], lever), mean[:2, 1], sigma[:2, 1])


def _thinned(place: NDArray, values: NDArray, side: NDArray) -> tuple[NDArray, ...]:
    """Return place, values and share of the noise of means over rings of one side of a joint, nearest first."""
    side = side[: max(_FEWEST, int((np.abs(place[side] - place[side[0]]) <= _SPAN).sum()))]
    size = -(-len(side) // _MOST_RINGS)
    rows = side[: len(side) // size * size].reshape(-1, size)
    return place[rows].mean(axis=1), values[rows].mean(axis=1), np.full(len(rows), 1.0 / size)


def _by_bend(x: NDArray, values: NDArray, share: NDArray, noise: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Return step and turn (case, value, 2), their variances and how likely each case of bend and roughness is."""
    from_first = x - x.min()
    low, high = np.minimum.outer(from_first, from_first), np.maximum.outer(from_first, from_first)
    bend = low * low * (3.0 * high - low) / 6.0
    alike = np.exp(-np.abs(x[:, None] - x) / _LIKE)
    beyond = np.where(x > 0.0, x, 0.0)
    rows = np.column_stack([np.ones_like(x), x, x > 0.0, beyond])
    winding, rough = (v.ravel()[:, None, None] for v in np.meshgrid(_WINDING, _ROUGH, indexing="ij"))
    found, variance, log_weight = [], [], []
    for k, sigma in enumerate(np.maximum(noise, 1e-9)):
        covariance = sigma**2 * (np.diag(share) + rough**2 * alike) + winding * bend
        root = np.linalg.cholesky(covariance)
        white = np.linalg.solve(root, np.column_stack([rows, values[:, k]])[None])
        design, y = white[..., :4], white[..., 4:]
        normal = design.swapaxes(1, 2) @ design
        normal[:, 3, 3] += 1.0 / _TURN**2
        inverse = np.linalg.inv(normal)
        beta = inverse @ design.swapaxes(1, 2) @ y
        misfit = ((y - design @ beta) ** 2).sum(axis=(1, 2)) + (beta[:, 3, 0] / _TURN) ** 2
        size = np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1) + 0.5 * np.linalg.slogdet(normal)[1]
        found.append(beta[:, 2:, 0])
        variance.append(np.diagonal(inverse, axis1=1, axis2=2)[:, 2:])
        log_weight.append(-0.5 * misfit - size)
    weight = np.exp(np.array(log_weight) - np.max(log_weight, axis=1, keepdims=True))
    weight /= weight.sum(axis=1, keepdims=True)
    return np.stack(found, axis=1), np.stack(variance, axis=1), weight.T
