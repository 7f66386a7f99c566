"""Where a point lies in a pipe that runs straight, bends by a circular arc, and runs straight again.

The centreline is given by its frame at the start of the arc: point, and rows forward, inward (to the bend's centre)
and normal = forward x inward; then the bend's radius and angle. Positions in a section are (out, across): away from
the bend's centre, and along the normal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


class Station(NamedTuple):
    """Arc length from the start of the bend (negative before it), and position in the section [m]."""

    along: np.ndarray
    out: np.ndarray
    across: np.ndarray


def locate(
    points: ArrayLike, start: ArrayLike, frame: ArrayLike, bend_radius: float, angle: float, *, straights: bool = True
) -> Station:
    """Return where points lie about a straight-arc-straight centreline.

    Args:
        points: Array (..., 3) [m].
        start: Point (3,) of the centreline where the arc starts [m].
        frame: Array (3, 3), rows forward, inward, normal at the start.
        bend_radius: Radius of the centreline [m].
        angle: Angle of the bend [rad]; below pi for the straights to be told apart.
        straights: Whether straights join the arc; without them it runs on round the whole circle.

    Returns:
        Station of arrays (...), from the nearest of the three parts.

    Source: 4.2.1, the bend as manufactured: a torus between two straights.

    >>> [float(part) for part in locate([-1.0, 0.1, 0.0], np.zeros(3), np.eye(3), 2.0, 1.5)]
    [-1.0, -0.1, 0.0]
    """
    x, y, across = np.moveaxis((np.asarray(points, float) - start) @ np.transpose(frame), -1, 0)
    turn = np.arctan2(x, bend_radius - y)
    arc_out = np.hypot(x, y - bend_radius) - bend_radius
    if not straights:
        return Station(bend_radius * turn, arc_out, across)
    cos, sin = np.cos(angle), np.sin(angle)
    end_x, end_y = x - bend_radius * sin, y - bend_radius * (1.0 - cos)
    beyond, exit_out = cos * end_x + sin * end_y, sin * end_x - cos * end_y
    part = np.stack([x <= 0, (turn >= 0) & (turn <= angle), beyond >= 0])
    out = np.stack(np.broadcast_arrays(-y, arc_out, exit_out))
    along = np.stack(np.broadcast_arrays(x, bend_radius * turn, bend_radius * angle + beyond))
    distance = np.where(part, np.abs(out), np.inf)
    nearest = np.argmin(distance, axis=0)[None]
    return Station(np.take_along_axis(along, nearest, 0)[0], np.take_along_axis(out, nearest, 0)[0], across)


def centreline(chainage: ArrayLike, start: ArrayLike, frame: ArrayLike, bend_radius: float, angle: float) -> Array:
    """Return the centreline's points (..., 3) [m] at `chainage` [m] from the start of the arc.

    >>> centreline([-1.0, 0.0, np.pi], np.zeros(3), np.eye(3), 2.0, np.pi / 2).round(6) + 0.0
    array([[-1.,  0.,  0.],
           [ 0.,  0.,  0.],
           [ 2.,  2.,  0.]])
    """
    chainage = np.asarray(chainage, float)
    turn = np.clip(chainage / bend_radius, 0.0, angle)
    rest = chainage - bend_radius * turn
    x = bend_radius * np.sin(turn) + rest * np.cos(turn)
    y = bend_radius * (1.0 - np.cos(turn)) + rest * np.sin(turn)
    return start + np.stack([x, y, np.zeros_like(x)], axis=-1) @ frame
