"""Between the robot's axes and the scanner's, which a boresight turns against one another.

The scanner's axes are `frame(pitch, yaw, roll)` of the boresight after the robot's, as `conventions` defines attitudes:
a vector's components on them are that matrix times its components on the robot's axes. What rings tell is the scanner's
attitude; an inertial log tells the robot's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import finite
from springline.geometry.robot._numeric import jacobian, propagate
from springline.geometry.robot.attitude import frame, pitch_yaw_roll
from springline.geometry.robot.section import matrix

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


def on_scanner(vectors: ArrayLike, boresight: ArrayLike) -> Array:
    """Return the components on the scanner's axes of vectors (..., 3) on the robot's, such as rates or forces.

    Args:
        vectors: Components on robot x, y, z.
        boresight: Pitch, yaw and roll of the scanner against the robot (3,) [rad].

    >>> on_scanner([0.0, 9.81, 0.0], np.radians([30.0, 0.0, 0.0])).round(3)
    array([4.905, 8.496, 0.   ])
    """
    return finite("vectors", vectors) @ frame(*finite("boresight", boresight)).T


def robot_attitude(
    attitude: ArrayLike,
    boresight: ArrayLike,
    covariance: ArrayLike | None = None,
    boresight_covariance: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Return the robot's pitch, yaw and roll in the pipe from the scanner's.

    Args:
        attitude: Pitch, yaw and roll of the scanner (..., 3) [rad]; NaN where unknown.
        boresight: Of the scanner against the robot, (3,) or (..., 3) [rad].
        covariance: Of `attitude` (..., 3, 3) [rad2].
        boresight_covariance: Of `boresight` (3, 3) [rad2].

    Returns:
        Pitch, yaw and roll of the robot (..., 3) [rad], and their covariance (..., 3, 3) [rad2], NaN when neither
        covariance is given.

    >>> turned, _ = robot_attitude(np.radians([[10.3, 0.0, 0.0]]), np.radians([0.3, 0.0, 0.0]))
    >>> np.degrees(turned).round(6) + 0.0
    array([[10.,  0.,  0.]])
    """
    attitude, boresight = finite("attitude", attitude), finite("boresight", boresight)

    def turn(values: Array) -> Array:
        scanner = frame(*np.moveaxis(values[..., :3], -1, 0))
        back = np.swapaxes(frame(*np.moveaxis(values[..., 3:], -1, 0)), -1, -2)
        return np.stack(pitch_yaw_roll(back @ scanner), axis=-1)

    values = np.concatenate([attitude, np.broadcast_to(boresight, attitude.shape)], axis=-1)
    spread = np.zeros((*attitude.shape[:-1], 6, 6))
    if covariance is not None:
        spread[..., :3, :3] = matrix("covariance", covariance, 3)
    if boresight_covariance is not None:
        spread[..., 3:, 3:] = matrix("boresight_covariance", boresight_covariance, 3)
    if covariance is None and boresight_covariance is None:
        spread[:] = np.nan
    return turn(values), propagate(jacobian(turn, values, [1e-6] * 6), spread)
