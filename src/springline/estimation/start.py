"""First values of every state: the track's dead reckoning, ring centres on it, and the rings' own shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .data import Rings, Ties
from .factors.sensor import reach_weights
from .rotations import dot, pipe_frame
from .states import AXIS, BLOCK, DIRECTION, OFFSET, ORIGIN, SCALARS, SECTION, State
from .windows import MOST_RINGS

if TYPE_CHECKING:
    from collections.abc import Callable

    from .track import Marks

_SPAN = 0.15
"""Half the length over which the first direction is taken [m]."""


def reckoned(
    marks: Callable[[np.ndarray], Marks], distance: np.ndarray, lever: tuple[float, float, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return where the sensor is by dead reckoning from the first place (n, 3), and the robot's y and z there (n, 3).

    Args:
        marks: The track at odometer readings; a part of the places is asked for at a time.
        distance: Of the places, increasing [m] (n,).
        lever: Sensor ahead, above and right of the robot's middle [m].
    """
    weights = reach_weights(np.zeros(SCALARS), lever)
    point, up, right = np.zeros((3, len(distance), 3))
    for first in range(0, len(distance), MOST_RINGS):
        # The last place of the part before joins the two.
        rows = slice(max(first - 1, 0), first + MOST_RINGS)
        part = marks(distance[rows])
        way = part.reach @ weights
        point[rows] = point[rows.start] + way - way[0]
        up[rows], right[rows] = part.axes[..., 1], part.axes[..., 2]
    return point, up, right


def first_axis(rings: Rings, marks: Callable[[np.ndarray], Marks]) -> np.ndarray:
    """Return the ring centres (n, 3) by dead reckoning from the first ring: in a straight pipe they lie on its axis."""
    point, up, right = reckoned(marks, rings.distance, rings.lever)
    return point + right * rings.parameters[:, :1] + up * rings.parameters[:, 1:2]


def heading_of(axis: np.ndarray, distance: np.ndarray, ties: Ties) -> float | None:
    """Return by how much the track must turn clockwise for its ties to lie as the known points do [rad].

    None when fewer than two ties lie apart: then nothing tells the way north.
    """
    known = np.asarray(ties.position, float)[:, :2]
    chord = known[-1] - known[0]
    if len(known) < 2 or np.hypot(*chord) < 5.0 * float(np.max(ties.sigma)):
        return None
    shown = np.stack([np.interp(ties.distance, distance, axis[:, k]) for k in (0, 1)], axis=1)
    way = shown[-1] - shown[0]
    return float(np.arctan2(chord[0], chord[1]) - np.arctan2(way[0], way[1]))


def first_state(
    distance: np.ndarray, rings: Rings, marks: Callable[[np.ndarray], Marks], axis: np.ndarray, origin: np.ndarray
) -> State:
    """Return the state from which the iteration starts.

    Args:
        distance: Knots [m] (k,).
        rings: The rings.
        marks: The track at odometer readings.
        axis: Ring centres by dead reckoning (n, 3).
        origin: What is added to dead reckoning so that it lies in the working frame [m] (3,).
    """
    seen = rings.seen
    axis = axis[seen] + origin
    where = rings.distance[seen]
    knots = np.zeros((len(distance), BLOCK))
    smooth = _local_mean(axis, where, distance, _SPAN)
    slope = _local_slope(smooth, distance)
    heading = np.unwrap(np.arctan2(slope[:, 0], slope[:, 1]))
    grade = np.arctan2(slope[:, 2], np.hypot(slope[:, 0], slope[:, 1]))
    knots[:-1, AXIS] = np.diff(smooth, axis=0)
    knots[:, DIRECTION] = np.stack([heading, grade], axis=1)
    sensor = reckoned(marks, distance, rings.lever)[0] + origin
    _, y, z = pipe_frame(heading, grade)
    knots[:, OFFSET] = np.stack([dot(sensor - smooth, y), dot(sensor - smooth, z)], axis=1)
    knots[:, SECTION] = np.median(rings.parameters[seen, 2:], axis=0)
    scalars = np.zeros(SCALARS)
    scalars[ORIGIN] = smooth[0]
    return State(distance, knots, scalars)


def straight_state(distance: np.ndarray, rings: Rings) -> State:
    """Return the start without an inertial log: a straight level pipe due north, the robot along it."""
    seen = rings.seen
    knots = np.zeros((len(distance), BLOCK))
    knots[:-1, AXIS.start + 1] = np.diff(distance)
    centre = _local_mean(rings.parameters[seen, 1::-1], rings.distance[seen], distance, _SPAN)
    knots[:, OFFSET] = -centre
    knots[:, SECTION] = np.median(rings.parameters[seen, 2:], axis=0)
    return State(distance, knots, np.zeros(SCALARS))


def _local_mean(values: np.ndarray, at: np.ndarray, where: np.ndarray, span: float) -> np.ndarray:
    """Return values (n, d) fitted by a line within `span` of each place; robust enough as a start."""
    total = np.concatenate([np.zeros((1, 1)), np.cumsum(np.ones((len(at), 1)), axis=0)])
    sums = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
    places = np.concatenate([[0.0], np.cumsum(at)])
    low, high = np.searchsorted(at, where - span), np.searchsorted(at, where + span, side="right")
    low, high = np.minimum(low, len(at) - 2), np.maximum(high, np.minimum(low, len(at) - 2) + 2)
    count = total[high] - total[low]
    mean = (sums[high] - sums[low]) / count
    middle = (places[high] - places[low])[:, None] / count
    # At the ends the window is lopsided; the overall way between its edges carries the mean to the place itself.
    slope = (values[high - 1] - values[low]) / (at[high - 1] - at[low])[:, None]
    return mean + slope * (where[:, None] - middle)


def _local_slope(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    if len(at) < 3:
        return np.gradient(values, at, axis=0)
    reach = max(round(_SPAN / (at[1] - at[0])), 1)
    rows = np.arange(len(at))
    low, high = np.maximum(rows - reach, 0), np.minimum(rows + reach, len(at) - 1)
    return (values[high] - values[low]) / (at[high] - at[low])[:, None]
