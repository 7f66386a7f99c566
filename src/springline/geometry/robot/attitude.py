"""Robot attitude in the pipe: forward axis, frame in three orders, implicit roll.

Frame and signs as in `springline.conventions`: tan(pitch) = b/a and tan(yaw) = c/a for the forward unit vector
(a, b, c); roll turns the robot's z towards its y. A frame is a 3 by 3 matrix whose rows are the robot's x, y and z
axes in pipe coordinates, so `frame @ v` are the robot components of a pipe vector v. Angles in radians.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import acute, choice, finite

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

ORDERS = ("direct", "pitch_yaw", "yaw_pitch")
"""How a robot reached its axis: by one rotation, or by two in either order."""


def axis(pitch: ArrayLike, yaw: ArrayLike) -> Array:
    """Return the robot's forward unit vector (a, b, c).

    Args:
        pitch: Nose up [rad], inside +-pi/2.
        yaw: Nose right [rad], inside +-pi/2; broadcast against `pitch`.

    Returns:
        Array (..., 3) of components on pipe x, y and z.

    Raises:
        ParameterError: An angle is not inside +-pi/2.

    Source: (5.1)-(5.3) with the exponent -1/2 (erratum 11).

    >>> axis(np.radians(10), np.radians(10)).round(5)
    array([0.97029, 0.17109, 0.17109])
    """
    b, c = np.broadcast_arrays(np.tan(acute("pitch", pitch)), np.tan(acute("yaw", yaw)))
    return np.stack([np.ones_like(b), b, c], axis=-1) / np.sqrt(1.0 + b * b + c * c)[..., None]


def yaw_after_pitch(pitch: ArrayLike, yaw: ArrayLike) -> Array:
    """Return the second rotation [rad] that reaches `yaw` when the robot pitches first.

    Args:
        pitch: Nose up [rad].
        yaw: Nose right [rad], tan(yaw) = c/a.

    Returns:
        atan(tan(yaw) cos(pitch)) [rad].

    Source: 4.2.2 and (5.36).

    >>> round(float(np.degrees(yaw_after_pitch(np.radians(15), np.radians(7.5)))), 6)
    7.247208
    """
    return np.arctan(np.tan(acute("yaw", yaw)) * np.cos(acute("pitch", pitch)))


def pitch_after_yaw(pitch: ArrayLike, yaw: ArrayLike) -> Array:
    """Return the second rotation [rad] that reaches `pitch` when the robot yaws first.

    Args:
        pitch: Nose up [rad], tan(pitch) = b/a.
        yaw: Nose right [rad].

    Returns:
        atan(tan(pitch) cos(yaw)) [rad].

    Source: (5.37).

    >>> float(pitch_after_yaw(0.3, 0.0))
    0.3
    """
    return np.arctan(np.tan(acute("pitch", pitch)) * np.cos(acute("yaw", yaw)))


def implicit_roll(pitch: ArrayLike, yaw: ArrayLike, *, order: str = "pitch_yaw") -> Array:
    """Return the roll [rad] of a stepwise frame against the direct one, with its sign.

    Args:
        pitch: Nose up [rad].
        yaw: Nose right [rad].
        order: `pitch_yaw`, `yaw_pitch`, or `direct` (no implicit roll).

    Returns:
        Signed roll [rad], positive from the robot's z towards its y.

    Raises:
        ParameterError: `order` is unknown or an angle is not inside +-pi/2.

    Source: (5.17) keeps only its magnitude; tan(roll/2) = -tan(pitch/2) tan(yaw'/2) by erratum 12, and by symmetry
    tan(roll/2) = +tan(yaw/2) tan(pitch'/2) for yaw first.

    >>> round(float(np.degrees(implicit_roll(np.radians(10), np.radians(10)))), 2)
    -0.86
    """
    choice("order", order, ORDERS)
    if order == "pitch_yaw":
        half = -np.tan(acute("pitch", pitch) / 2) * np.tan(yaw_after_pitch(pitch, yaw) / 2)
    elif order == "yaw_pitch":
        half = np.tan(acute("yaw", yaw) / 2) * np.tan(pitch_after_yaw(pitch, yaw) / 2)
    else:
        half = 0.0 * (acute("pitch", pitch) + acute("yaw", yaw))
    return 2.0 * np.arctan(half)


def frame(pitch: ArrayLike, yaw: ArrayLike, roll: ArrayLike = 0.0, *, order: str = "direct") -> Array:
    """Return the robot's axes in pipe coordinates.

    Args:
        pitch: Nose up [rad], inside +-pi/2.
        yaw: Nose right [rad], inside +-pi/2.
        roll: From the robot's z towards its y [rad], after pitch and yaw.
        order: How the axis was reached: `direct` (one rotation), `pitch_yaw` or `yaw_pitch`.

    Returns:
        Array (..., 3, 3); its rows are the robot's x, y and z axes.

    Raises:
        ParameterError: `order` is unknown or an angle is out of range.

    Source: (5.15) and the matrix after it, in the closed form without 0/0 at pitch = yaw = 0; erratum 12 for the
    stepwise orders.

    >>> frame(0.0, 0.0, np.radians(90)).round(12) + 0.0
    array([[ 1.,  0.,  0.],
           [ 0.,  0., -1.],
           [ 0.,  1.,  0.]])
    """
    n = axis(pitch, yaw)
    total = finite("roll", roll) + implicit_roll(pitch, yaw, order=order)
    return frame_about(n, total)


def frame_about(forward: Array, roll: ArrayLike) -> Array:
    """Return the direct frame (..., 3, 3) about the forward unit vector (..., 3) with a > -1, then rolled [rad].

    >>> frame_about(np.array([1.0, 0.0, 0.0]), 0.0)[0]
    array([1., 0., 0.])
    """
    a, b, c = np.moveaxis(forward, -1, 0)
    mixed = -b * c / (1.0 + a)
    y_direct = np.stack([-b, 1.0 - b * b / (1.0 + a), mixed], axis=-1)
    z_direct = np.stack([-c, mixed, 1.0 - c * c / (1.0 + a)], axis=-1)
    cos, sin = np.cos(roll)[..., None], np.sin(roll)[..., None]
    rows = np.broadcast_arrays(forward, cos * y_direct - sin * z_direct, cos * z_direct + sin * y_direct)
    return np.stack(rows, axis=-2)


def pitch_yaw_roll(frames: ArrayLike) -> tuple[Array, Array, Array]:
    """Return the (pitch, yaw, roll) of frames, in the direct order.

    Args:
        frames: Array (..., 3, 3) as `frame` makes it.

    Returns:
        Three arrays (...) [rad]; NaN where the robot does not face along the pipe (a <= 0).

    Source: inverse of (5.1)-(5.3) and of the direct frame.

    >>> np.round(pitch_yaw_roll(frame(0.2, -0.1, 0.05)), 12)
    array([ 0.2 , -0.1 ,  0.05])
    """
    frames = np.asarray(frames, dtype=float)
    a, b, c = (np.where(frames[..., 0, 0] > 0, frames[..., 0, i], np.nan) for i in range(3))
    pitch, yaw = np.arctan2(b, a), np.arctan2(c, a)
    direct = frame(pitch, yaw)
    sin = np.sum(frames[..., 2, :] * direct[..., 1, :], axis=-1)
    cos = np.sum(frames[..., 2, :] * direct[..., 2, :], axis=-1)
    return pitch, yaw, np.arctan2(sin, cos)
