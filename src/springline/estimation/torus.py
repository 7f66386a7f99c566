"""What a bend adds to the ellipse that a tilted ring cuts from a straight pipe.

The pipe's axis leaves its tangent by x^2 kappa/2 and the section turns with it, so the cut is no ellipse any more. The
wall is found at bearings all round, exactly on the torus, and an ellipse is fitted to it as one is fitted to the ring.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..geometry.fitting import fit_ellipses_to_ranges
from ..geometry.robot import frame
from .factors.sensor import Places
from .states import CLOCK, DIRECTION, SECTION, State, place
from .windows import MOST_RINGS

if TYPE_CHECKING:
    from .problem import Problem

_BEARINGS = 48
_STEEPEST = 0.6
"""Tangent of the tilt beyond which no robot drives."""
_LEAST = 2e-6
"""Displacement below which a bend is not looked at [m]."""


def bend_terms(problem: Problem, state: State) -> np.ndarray:
    """Return what bends add to the rings' centre_z, centre_y, mean_radius, oval_cos, oval_sin [m] (n, 5)."""
    out = np.zeros((len(problem.rings.distance), 5))
    if problem.track is None:
        return out
    curvature = _curvature(state)
    interval, _ = place(problem.rings.distance, problem.knots)
    radius = float(np.median(state.knots[:, SECTION.start]))
    bent = np.flatnonzero(np.hypot(*curvature[interval].T) * (_STEEPEST * radius) ** 2 > 2.0 * _LEAST)
    if not bent.size:
        return out
    for first in range(0, len(bent), MOST_RINGS):
        rows = bent[first : first + MOST_RINGS]
        places = problem.places(problem.rings.distance[rows], float(state.scalars[CLOCK]))
        out[rows] = _added(places, state, curvature)
    return out


def added_at(places: Places, state: State) -> np.ndarray:
    """Return what bends add to the ellipses of rings at places, as `bend_terms` does of the survey's own [m] (n, 5)."""
    return _added(places, state, _curvature(state))


def _added(places: Places, state: State, curvature: np.ndarray) -> np.ndarray:
    out = np.zeros((len(places.interval), 5))
    bend = curvature[places.interval]
    if not bend.any():
        return out
    found = places.evaluate(1, state, np.arange(0))[0]
    reach = found[:, 5] * np.hypot(np.tan(found[:, 2]), np.tan(found[:, 3]))
    rows = np.flatnonzero(np.hypot(*bend.T) * reach**2 > 2.0 * _LEAST)
    if rows.size:
        out[rows] = added_by_bend(found[rows, :5], found[rows, 5:8], bend[rows])
    return out


def _curvature(state: State) -> np.ndarray:
    """Return the axis's curvature towards the pipe's y and z over each interval [1/m] (knot - 1, 2)."""
    direction = state.knots[:, DIRECTION]
    way = np.linalg.norm(np.diff(state.axis, axis=0), axis=1)
    turn = np.diff(direction, axis=0) / way[:, None]
    mean = 0.5 * (direction[1:, 1] + direction[:-1, 1])
    raw = np.stack([turn[:, 1], turn[:, 0] * np.cos(mean)], axis=1)
    # A kink at a joint is no bend: the least of three neighbours lasts over at least three intervals.
    size = np.hypot(*raw.T)
    padded = np.concatenate([size[:1], size, size[-1:]])
    least = np.minimum(np.minimum(padded[:-2], padded[2:]), size)
    return raw * (least / np.maximum(size, 1e-12))[:, None]


def added_by_bend(pose: np.ndarray, section: np.ndarray, bend: np.ndarray) -> np.ndarray:
    """Return the ellipse of a ring in a bend less that of the same ring in a straight pipe [m] (n, 5).

    Args:
        pose: offset_y, offset_z, pitch, yaw, roll (n, 5) [m, rad].
        section: mean_radius, oval_cos, oval_sin [m] (n, 3).
        bend: Curvature of the axis towards the pipe's y and z [1/m] (n, 2).

    Source: 4.2, the wall of the torus in the frame of the section abreast of the sensor.

    >>> tilted = np.array([[0.0, 0.0, np.radians(20.0), 0.0, 0.0]])
    >>> (1e3 * added_by_bend(tilted, np.array([[0.15, 0.0, 0.0]]), np.array([[0.5, 0.0]]))).round(2)[0, 1:4].tolist()
    [0.6, 0.03, -0.03]
    """
    theta = np.arange(_BEARINGS) * (2.0 * np.pi / _BEARINGS)
    up, right, along = _rays(pose, theta)
    straight = _wall(pose, section, np.zeros_like(bend), up, right, along)
    bent = _wall(pose, section, bend, up, right, along, straight)
    fits = fit_ellipses_to_ranges(np.concatenate([bent, straight]), theta, robust=False).parameters
    return np.nan_to_num(fits[: len(pose)] - fits[len(pose) :])


def _rays(pose, theta):
    """Return the rays' components up, right and along the pipe (n, m)."""
    frames = frame(pose[:, 2], pose[:, 3], pose[:, 4])
    cos, sin = np.cos(theta), np.sin(theta)
    along, up, right = (frames[:, 2, k, None] * cos + frames[:, 1, k, None] * sin for k in range(3))
    return up, right, along


def _wall(pose, section, bend, up, right, along, start=None):
    """Return the range to the wall (n, m), by Newton's iteration on the section's level."""
    mean, cos, sin = (section[:, k, None] for k in range(3))
    level = mean**2 + cos**2 + sin**2
    zz, yy, zy = level + 2.0 * mean * cos, level - 2.0 * mean * cos, 2.0 * mean * sin
    whole = zz * yy - zy * zy
    kappa = np.hypot(bend[:, 0], bend[:, 1])[:, None]
    inward_up, inward_right = (
        np.divide(bend[:, k, None], kappa, out=np.zeros_like(kappa), where=kappa > 0) for k in range(2)
    )
    reach = np.broadcast_to(mean, up.shape).copy() if start is None else start.copy()
    for _ in range(8):
        x, y, z = reach * along, pose[:, :1] + reach * up, pose[:, 1:2] + reach * right
        inward = y * inward_up + z * inward_right
        # How far the axis has turned towards the point: sqrt((R - q)^2 + x^2) - (R - q), without its cancellation.
        rest = 1.0 - kappa * inward
        root = np.sqrt(rest**2 + (kappa * x) ** 2)
        shift = kappa * x * x / (rest + root)
        y, z = y - shift * inward_up, z - shift * inward_right
        value = (yy * z * z - 2.0 * zy * z * y + zz * y * y) / whole - 1.0
        turn = kappa * x * along / root - (rest / root - 1.0) * (up * inward_up + right * inward_right)
        slope_y, slope_z = up - turn * inward_up, right - turn * inward_right
        slope = 2.0 * ((yy * z - zy * y) * slope_z + (zz * y - zy * z) * slope_y) / whole
        step = value / slope
        reach = reach - step
        if np.max(np.abs(step)) < 1e-13:
            break
    return reach
