"""Closed oblique sections of a bend: y(z) where a tilted ring plane cuts a circular or elliptical torus."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import finite, positive, require
from springline.geometry.robot.attitude import yaw_after_pitch

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

WALLS = (1, -1)
"""Outer wall, farther from the bend's centre, and inner wall."""


def bend_section(
    z: ArrayLike,
    bend_radius: ArrayLike,
    r1: ArrayLike,
    r2: ArrayLike,
    pitch: ArrayLike = 0.0,
    yaw: ArrayLike = 0.0,
    *,
    wall: ArrayLike = 1,
) -> Array:
    """Return y(z) of the wall in the ring plane of a robot on the axis of an upward bend.

    The robot stands on the pipe's axis and the bend's centre lies above it, at y = bend_radius. A bend to another
    side is the same after turning about x. y and z are coordinates in the ring plane, on the robot's axes after
    pitch and then yaw (the `pitch_yaw` frame), measured from its origin.

    Args:
        z: Positions in the ring plane [m].
        bend_radius: Radius of the pipe's axis [m], above `r2`.
        r1: Semi-axis of the section on z [m], along the axis of the bend.
        r2: Semi-axis of the section in the plane of the bend [m].
        pitch: Nose up [rad].
        yaw: Nose right [rad].
        wall: +1 for the outer wall (below), -1 for the inner wall (above).

    Returns:
        y [m] of the broadcast shape; NaN where the plane misses this wall.

    Raises:
        ParameterError: A value is out of range.

    Source: (4.9)-(4.11) in the simple form of erratum 22, valid for an elliptical torus too; c = R sin(pitch) may
    exceed R - r2, where the inner wall is missed.

    >>> bend_section([0.0, 8.0], 20.0, 10.0, 10.0).round(6)
    array([-10.,  -6.])
    """
    z, r1 = finite("z", z), positive("r1", r1)
    bend_radius, r2 = bend_radii(bend_radius, r2)
    if np.any(~np.isin(wall, WALLS)):
        raise ParameterError(f"wall = {wall!r} is not known", expected="+1 for the outer wall or -1 for the inner one")
    turn = yaw_after_pitch(pitch, yaw)
    across, along = z * np.cos(turn), bend_radius * np.sin(pitch) + z * np.sin(turn)
    with np.errstate(invalid="ignore"):
        reach = bend_radius + np.asarray(wall) * r2 * np.sqrt(1.0 - (across / r1) ** 2)
        return bend_radius * np.cos(pitch) - np.sqrt(reach**2 - along**2)


def bend_radii(bend_radius: ArrayLike, r2: ArrayLike) -> tuple[Array, Array]:
    """Return both radii as floats; refuse a bend that is tighter than the pipe.

    >>> bend_radii(1.0, 0.2)
    (array(1.), array(0.2))
    """
    bend_radius, r2 = positive("bend_radius", bend_radius), positive("r2", r2)
    require(
        ~(bend_radius <= r2),
        "bend_radius",
        bend_radius,
        "bend_radius > r2",
        "the radius is that of the pipe's axis; one below r2 would cross itself",
    )
    return bend_radius, r2
