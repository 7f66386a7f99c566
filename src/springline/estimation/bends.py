"""Bends of the estimated axis as explicit line-arc-line: radius, angle, plane, start, with their sigma.

A bend is a stretch in which the direction turns steadily. Its ends are the corners of a ramp, fitted to the direction
by weighted least squares; joints' kinks, which turn the pipe at one place, are left to the axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEAST_ANGLE = np.radians(3.0)
"""Smallest turn that is called a bend [rad]."""
LEAST_RATE = np.radians(5.0)
"""Smallest turning that is [rad/m]."""
_RUN = 1.5
"""Length of the straight runs beside a bend that tell its angle [m]."""
_EDGE = 0.1
_FEWEST = 3
_ALIKE = 8
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


def find_bends(chainage: np.ndarray, direction: np.ndarray) -> tuple[Bend, ...]:
    """Return the bends of an axis.

    Args:
        chainage: Along the axis at equal or nearly equal steps [m] (k,).
        direction: Heading clockwise from north and grade angle [rad] (k, 2).
    """
    turn = np.hypot(np.cos(direction[1:, 1]) * np.diff(direction[:, 0]), np.diff(direction[:, 1]))
    rate = turn / np.diff(chainage)
    turning = rate > LEAST_RATE
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
        found.append(_fit(chainage[rows], direction[rows], chainage[first], chainage[last]))
    return tuple(one for one in found if one is not None)


def _fit(at, direction, first, last) -> Bend | None:
    """Return the ramp through the directions: level, level, and two corners, in the plane in which they turn."""
    before, after = at < first - _EDGE, at > last + _EDGE
    if before.sum() < _FEWEST or after.sum() < _FEWEST:
        return None
    level = np.array([np.cos(direction[:, 1].mean()), 1.0])
    flat = direction * level
    whole = np.median(flat[after], axis=0) - np.median(flat[before], axis=0)
    plane = whole / np.hypot(*whole)
    seen = flat @ plane
    values = np.array([first, last, np.median(seen[before]), float(np.hypot(*whole))])

    def ramp(v):
        return v[2] + np.clip((at - v[0]) / (v[1] - v[0]), 0.0, 1.0) * v[3]

    slopes = np.empty((len(at), 4))
    for _ in range(_STEPS):
        now = ramp(values)
        for k in range(4):
            moved = values.copy()
            moved[k] += 1e-6
            slopes[:, k] = (ramp(moved) - now) / 1e-6
        step = np.linalg.lstsq(slopes, seen - now, rcond=None)[0]
        values = values + np.clip(step, -0.02, 0.02)
        if np.abs(step).max() < 1e-8:
            break
    left = seen - ramp(values)
    noise = float(left @ left) / max(len(left) - 4, 1)
    # Neighbours err alike: by as many as their errors' own correlation says.
    alike = 1.0 + 2.0 * sum(max(float(left[k:] @ left[:-k]) / float(left @ left), 0.0) for k in range(1, _ALIKE))
    spread = np.linalg.pinv(slopes.T @ slopes) * noise * alike
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
