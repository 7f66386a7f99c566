"""Robot attitude as rotation matrices.

Rows of a matrix are the robot's x, y, z axes in the pipe's (or the Earth's) axes. Built by turning vectors, not by the
closed forms that `springline.geometry` has.
"""

from __future__ import annotations

import numpy as np


def in_pipe(pitch: np.ndarray, yaw: np.ndarray, roll: np.ndarray) -> np.ndarray:
    """Return the robot's axes (..., 3, 3) in the local pipe frame, as `conventions` defines pitch, yaw and roll.

    The forward axis (a, b, c), tan(pitch) = b/a and tan(yaw) = c/a, is reached by the one turn that takes x straight
    to it; then the robot rolls about it, from its z towards its y.

    >>> a = np.radians(10.0)
    >>> in_pipe(a, a, 0.0)[0].round(5).tolist()
    [0.97029, 0.17109, 0.17109]
    """
    pitch, yaw, roll = np.broadcast_arrays(*(np.asarray(v, float) for v in (pitch, yaw, roll)))
    forward = np.stack([np.ones_like(pitch), np.tan(pitch), np.tan(yaw)], axis=-1)
    forward /= np.linalg.norm(forward, axis=-1, keepdims=True)
    up, right = turn_with(np.array([1.0, 0.0, 0.0]), forward, np.eye(3)[1:])
    c, s = np.cos(roll)[..., None], np.sin(roll)[..., None]
    return np.stack([forward, c * up - s * right, c * right + s * up], axis=-2)


def turn_with(start: np.ndarray, end: np.ndarray, vectors: np.ndarray) -> list[np.ndarray]:
    """Return each vector (3,) turned by the smallest rotation that takes unit `start` (3,) to unit `end` (..., 3).

    Two mirrorings make one rotation: in the plane normal to `start`, then in the one normal to their half-way vector.
    """
    half = start + end
    norm2 = np.sum(half * half, axis=-1, keepdims=True)
    turned = []
    for v in vectors:
        mirrored = v - 2.0 * (v @ start) * start
        turned.append(mirrored - 2.0 * np.sum(mirrored * half, axis=-1, keepdims=True) / norm2 * half)
    return turned


def from_axes(axes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return pitch, yaw and roll [rad] of robot axes (..., 3, 3) in the local pipe frame; undoes `in_pipe`."""
    a, b, c = np.moveaxis(axes[..., 0, :], -1, 0)
    up, right = turn_with(np.array([1.0, 0.0, 0.0]), axes[..., 0, :], np.eye(3)[1:])
    robot_right = axes[..., 2, :]
    roll = np.arctan2(np.sum(robot_right * up, axis=-1), np.sum(robot_right * right, axis=-1))
    return np.arctan2(b, a), np.arctan2(c, a), roll


def on_earth(axes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return heading (clockwise from north), inclination (nose up) and bank (right side down) [rad] of robot axes
    (..., 3, 3) given in east, north, up."""
    x, y, z = axes[..., 0, :], axes[..., 1, :], axes[..., 2, :]
    return (
        np.mod(np.arctan2(x[..., 0], x[..., 1]), 2.0 * np.pi),
        np.arctan2(x[..., 2], np.hypot(x[..., 0], x[..., 1])),
        np.arctan2(-z[..., 2], y[..., 2]),
    )
