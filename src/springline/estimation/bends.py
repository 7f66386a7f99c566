"""Bends of the estimated axis as explicit line-arc-line: radius, angle, plane, start, with their sigma.

A bend is a stretch in which the direction turns steadily. Its ends are the corners of a ramp, fitted to the direction
by least squares; its covariance is what the joint estimate states, and the kinks that joints may add to it and to
the straight runs beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .covariance import Covariance, Stretch
from .states import DIRECTION

LEAST_ANGLE = np.radians(3.0)
"""Smallest turn that is called a bend [rad]."""
LEAST_RATE = np.radians(5.0)
"""Smallest turning that is [rad/m]."""
KINK = 1.1e-3
"""Random walk of the direction of a laid straight run [rad per square root of m]: joints of 0.1 degree every 2.5 m."""
_RUN = 0.75
"""Length of the straight runs beside a bend that tell its angle [m]."""
_EDGE = 0.1
_CORNER = 0.14
"""One-sigma of a corner's place in steps between knots."""
_ROUNDED = 2.5
_FEWEST = 3
_STEPS = 25


@dataclass(frozen=True)
class Bend:
    """One bend.

    Attributes:
        start: Distance along the axis at which it begins [m].
        length: Of its arc [m].
        angle: Between the straight runs [rad].
        radius: Of the axis [m].
        towards: Bearing in the pipe's section towards its centre [rad].
        start_sigma: One-sigma [m].
        angle_sigma: One-sigma [rad].
        radius_sigma: One-sigma [m].
    """

    start: float
    length: float
    angle: float
    radius: float
    towards: float
    start_sigma: float
    angle_sigma: float
    radius_sigma: float


def find_bends(chainage: np.ndarray, direction: np.ndarray, covariance: Covariance) -> tuple[Bend, ...]:
    """Return the bends of an axis.

    Args:
        chainage: Along the axis at the knots, at nearly equal steps [m] (k,).
        direction: Heading clockwise from north and grade angle at the knots [rad] (k, 2).
        covariance: Of the knots.
    """
    turn = np.hypot(np.cos(direction[1:, 1]) * np.diff(direction[:, 0]), np.diff(direction[:, 1]))
    turning = turn / np.diff(chainage) > LEAST_RATE
    # One knot that wavers within a bend does not end it.
    turning[1:-1] |= turning[:-2] & turning[2:]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], turning.astype(np.int8), [0]])))
    ends = [
        (int(first), int(last))
        for first, last in zip(edges[::2], edges[1::2], strict=True)
        if last - first >= 2 and turn[first:last].sum() > LEAST_ANGLE
    ]
    found = []
    for k, (first, last) in enumerate(ends):
        # The straight runs beside it, up to half the way to the next bend.
        low, high = chainage[first] - _RUN, chainage[last] + _RUN
        if k > 0:
            low = max(low, 0.5 * (chainage[ends[k - 1][1]] + chainage[first]))
        if k + 1 < len(ends):
            high = min(high, 0.5 * (chainage[last] + chainage[ends[k + 1][0]]))
        rows = np.flatnonzero((chainage >= low) & (chainage <= high))
        spread = Stretch.of(covariance, rows[0], rows[-1]).together(DIRECTION)
        found.append(_fit(chainage[rows], direction[rows], spread, chainage[first], chainage[last]))
    return tuple(one for one in found if one is not None)


def _fit(at, direction, spread, first, last) -> Bend | None:
    """Return the ramp through the directions: level, level, and two corners, in the plane in which they turn."""
    before, after = at < first - _EDGE, at > last + _EDGE
    if before.sum() < _FEWEST or after.sum() < _FEWEST:
        return None
    level = np.array([np.cos(direction[:, 1].mean()), 1.0])
    flat = direction * level
    whole = np.median(flat[after], axis=0) - np.median(flat[before], axis=0)
    plane = whole / np.hypot(*whole)
    seen = flat @ plane
    noise = np.einsum("a,iajb,b->ij", plane * level, spread, plane * level)
    # Joints kink the runs beside the bend and the bend itself.
    for side in (np.maximum(first - at, 0.0), np.maximum(at - first, 0.0)):
        noise = noise + KINK**2 * np.minimum(side[:, None], side)
    values = np.array([first, last, np.median(seen[before]), float(np.hypot(*whole))])

    def ramp(v):
        return v[2] + np.clip((at - v[0]) / (v[1] - v[0]), 0.0, 1.0) * v[3]

    slopes, step = np.empty((len(at), 4)), float(np.median(np.diff(at)))
    for _ in range(_STEPS):
        now = ramp(values)
        # Knots round off the corners, and what is thought of straight runs beforehand draws in the bend's first turn.
        clear = np.minimum(np.abs(at - values[0]), np.abs(at - values[1])) > step
        used = clear if (clear & (at > values[0]) & (at < values[1])).sum() >= _FEWEST else np.ones(len(at), bool)
        for k in range(4):
            moved = values.copy()
            moved[k] += 1e-6
            slopes[:, k] = (ramp(moved) - now) / 1e-6
        change = np.linalg.lstsq(slopes[used], (seen - now)[used], rcond=None)[0]
        values = values + np.clip(change, -0.02, 0.02)
        if np.abs(change).max() < 1e-8:
            break
    left = (seen - ramp(values))[used]
    inverse, noise = np.linalg.pinv(slopes[used]), noise[np.ix_(used, used)]
    # What is left over beyond what the covariance says.
    rest = max(float(left @ left) / (len(left) - 4) - float(np.mean(np.diag(noise))), 0.0)
    spread = inverse @ (noise + rest * np.eye(len(left))) @ inverse.T
    # Knots round off the corners between them.
    spread[[0, 1], [0, 1]] += (_CORNER * step) ** 2
    start, end, _, angle = values
    if end - start < 1e-3 or angle <= 0.0:
        return None
    radius = (end - start) / angle
    gradient = np.array([-1.0, 1.0, 0.0, -radius]) / angle
    return Bend(
        start=float(start),
        length=float(end - start),
        angle=float(angle),
        radius=float(radius),
        towards=float(np.mod(np.arctan2(plane[1], plane[0]), 2.0 * np.pi)),
        start_sigma=float(np.sqrt(spread[0, 0])),
        angle_sigma=float(np.sqrt(spread[3, 3])),
        radius_sigma=float(np.sqrt(gradient @ spread @ gradient)),
    )


def rounding(bends: tuple[Bend, ...], chainage: np.ndarray, step: float) -> np.ndarray:
    """Return by how much pitch and yaw are in doubt about the ends of bends, where knots round the corner (n, 2) [rad].

    Args:
        bends: The bends.
        chainage: Of the stations [m] (n,).
        step: Between knots [m].
    """
    out = np.zeros((len(chainage), 2))
    for bend in bends:
        plane = np.array([np.sin(bend.towards), np.cos(bend.towards)])
        for end in (bend.start, bend.start + bend.length):
            near = np.clip(1.0 - np.abs(chainage - end) / (_ROUNDED * step), 0.0, None)
            # A corner between two knots may lie half a step from where they put it.
            out += (0.5 * step / bend.radius * np.sqrt(near)[:, None] * plane) ** 2
    return np.sqrt(out)
