"""The estimated axis as builders read it: sags with the depth of water that stands in them, and angles at joints."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .covariance import Covariance, sigma_of_sum
from .states import AXIS, BLOCK, DIRECTION, SECTION

LEAST_DEPTH = 2e-3
"""Shallowest sag that is called one [m]."""
LEAST_LENGTH = 1.0
"""Shortest one [m]; below that it is a joint out of line, or a dip of the section."""
_CERTAIN = 2.0
_FAR, _NEAR = 0.75, 0.15
"""Straight run on either side of a joint that tells its angle [m], from so far off that knots do not round it."""
_FEWEST = 3


@dataclass(frozen=True)
class Sag:
    """A stretch whose invert lies below the string from its one end to its other.

    Attributes:
        start: Chainage from the first knot at which it begins [m].
        length: Along the axis [m].
        lowest: Chainage of its deepest place [m].
        depth: Of that place below the string [m].
        depth_sigma: One-sigma [m].
        ponding: Depth of water that stands in it when nothing flows [m]; 0 where it drains.
        ponding_sigma: One-sigma [m].
    """

    start: float
    length: float
    lowest: float
    depth: float
    depth_sigma: float
    ponding: float
    ponding_sigma: float


@dataclass(frozen=True)
class Deflection:
    """The angle of the axis at a joint.

    Attributes:
        chainage: From the first knot [m].
        up: Turn upwards [rad].
        right: Turn to the right [rad].
        up_sigma: One-sigma [rad].
        right_sigma: One-sigma [rad].
    """

    chainage: float
    up: float
    right: float
    up_sigma: float
    right_sigma: float


def find_sags(chainage: np.ndarray, knots: np.ndarray, elevation: np.ndarray, found: Covariance) -> tuple[Sag, ...]:
    """Return the sags of an axis: where its invert hangs below a string drawn tight over its high places.

    Args:
        chainage: Of the knots [m] (k,), increasing.
        knots: Their states (k, BLOCK).
        elevation: Of the axis at the knots [m] (k,).
        found: Covariance of the knots.
    """
    mean, cos, _ = knots[:, SECTION].T
    invert = elevation - (mean - cos)
    corners = _string(chainage, invert)
    out = []
    for first, last in pairwise(corners):
        if chainage[last] - chainage[first] < LEAST_LENGTH:
            continue
        share = (chainage[first : last + 1] - chainage[first]) / (chainage[last] - chainage[first])
        below = invert[first] + share * (invert[last] - invert[first]) - invert[first : last + 1]
        deepest = int(np.argmax(below))
        depth = float(below[deepest])
        sigma = _depth_sigma(found, first, first + deepest, last, float(share[deepest]))
        if depth < max(LEAST_DEPTH, _CERTAIN * sigma):
            continue
        inside = invert[first : last + 1]
        # Water rises to the lower of the two sills.
        low = int(np.argmin(inside))
        sill = 0 if inside[0] < inside[-1] else last - first
        out.append(
            Sag(
                start=float(chainage[first]),
                length=float(chainage[last] - chainage[first]),
                lowest=float(chainage[first + deepest]),
                depth=depth,
                depth_sigma=sigma,
                ponding=float(inside[sill] - inside[low]),
                ponding_sigma=_rise_sigma(found, *sorted((first + low, first + sill))),
            )
        )
    return tuple(out)


def _string(x: np.ndarray, y: np.ndarray) -> list[int]:
    """Return the corners of the tight string over a profile (its upper hull)."""
    corners: list[int] = []
    # One pass over knots, each of which enters and leaves once.
    for k in range(len(x)):
        while len(corners) > 1:
            a, b = corners[-2], corners[-1]
            if (y[b] - y[a]) * (x[k] - x[a]) > (y[k] - y[a]) * (x[b] - x[a]):
                break
            corners.pop()
        corners.append(k)
    return corners


def _depth_sigma(found: Covariance, first: int, middle: int, last: int, share: float) -> float:
    """Return one-sigma of the depth below the string: of ways up before and after the middle, weighted against it."""
    weights = np.zeros((last - first + 1, BLOCK))
    up = AXIS.start + 2
    weights[: middle - first, up], weights[middle - first : -1, up] = share - 1.0, share
    for knot, weight in ((first, 1.0 - share), (middle, -1.0), (last, share)):
        _add_invert(weights[knot - first], weight)
    return sigma_of_sum(found, first, weights)


def _rise_sigma(found: Covariance, first: int, last: int) -> float:
    if first == last:
        return 0.0
    weights = np.zeros((last - first + 1, BLOCK))
    weights[:-1, AXIS.start + 2] = 1.0
    _add_invert(weights[0], -1.0)
    _add_invert(weights[-1], 1.0)
    return sigma_of_sum(found, first, weights)


def _add_invert(weights: np.ndarray, weight: float) -> None:
    """Add how the invert lies against the axis at a knot: mean_radius less oval_cos below it."""
    weights[SECTION.start : SECTION.start + 2] += weight * np.array([-1.0, 1.0])


def joint_angles(at: np.ndarray, chainage: np.ndarray, knots: np.ndarray, found: Covariance) -> tuple[Deflection, ...]:
    """Return the angles between the straight runs before and after joints; none where a run is too short.

    Args:
        at: Chainage of the joints [m] (j,), increasing.
        chainage: Of the knots [m] (k,).
        knots: Their states (k, BLOCK).
        found: Covariance of the knots.
    """
    out = []
    for k, place in enumerate(at):
        before = _run(chainage, max(place - _FAR, at[k - 1] + _NEAR if k else -np.inf), place - _NEAR)
        after = _run(chainage, place + _NEAR, min(place + _FAR, at[k + 1] - _NEAR if k + 1 < len(at) else np.inf))
        if len(before) < _FEWEST or len(after) < _FEWEST:
            continue
        first, last = before[0], after[-1]
        level = float(np.cos(knots[first : last + 1, DIRECTION.start + 1].mean()))
        turn, sigma = [], []
        for state, size in ((DIRECTION.start + 1, 1.0), (DIRECTION.start, level)):
            weights = np.zeros((last - first + 1, knots.shape[1]))
            weights[before - first, state], weights[after - first, state] = -size / len(before), size / len(after)
            turn.append(float(np.sum(weights * knots[first : last + 1])))
            sigma.append(sigma_of_sum(found, int(first), weights))
        out.append(Deflection(float(place), turn[0], turn[1], sigma[0], sigma[1]))
    return tuple(out)


def _run(chainage: np.ndarray, low: float, high: float) -> np.ndarray:
    return np.arange(np.searchsorted(chainage, low), np.searchsorted(chainage, high, side="right"))
