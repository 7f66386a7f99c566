"""Small helpers on vectors and rotations, batched over leading axes."""

from __future__ import annotations

import numpy as np


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a x b over the last axis; several times quicker than `np.cross` on small vectors.

    >>> cross(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    array([0., 0., 1.])
    """
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a . b over the last axis."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def rotate(phi: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Return `vector` (..., 3) turned by the rotation vector `phi` (..., 3) [rad], right-handed.

    >>> rotate(np.array([0.0, 0.0, np.pi / 2]), np.array([1.0, 0.0, 0.0])).round(12)
    array([0., 1., 0.])
    """
    square = dot(phi, phi)
    angle = np.sqrt(square)
    # np.sinc(x) = sin(pi x)/(pi x) has no 0/0; 1 - cos(a) = 2 sin2(a/2) does not cancel.
    first = np.sinc(angle / np.pi)[..., None]
    second = (0.5 * np.sinc(0.5 * angle / np.pi) ** 2)[..., None]
    once = cross(phi, vector)
    return vector + first * once + second * cross(phi, once)


def matrix(phi: np.ndarray) -> np.ndarray:
    """Return the rotation matrix (..., 3, 3) that `rotate` applies."""
    phi = np.asarray(phi, float)
    return np.stack([rotate(phi, np.broadcast_to(e, phi.shape)) for e in np.eye(3)], axis=-1)


def pipe_frame(heading: np.ndarray, grade: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the axes x, y, z (..., 3) of the local pipe frame in east, north, up.

    Args:
        heading: Clockwise from north [rad].
        grade: Angle above the horizontal [rad].

    >>> [axis.tolist() for axis in pipe_frame(0.0, 0.0)]
    [[0.0, 1.0, 0.0], [-0.0, -0.0, 1.0], [1.0, -0.0, 0.0]]
    """
    sin, cos = np.sin(heading), np.cos(heading)
    up, level = np.sin(grade), np.cos(grade)
    x = np.stack(np.broadcast_arrays(sin * level, cos * level, up), axis=-1)
    y = np.stack(np.broadcast_arrays(-sin * up, -cos * up, level), axis=-1)
    z = np.stack(np.broadcast_arrays(cos, -sin, 0.0 * up), axis=-1)
    return x, y, z
