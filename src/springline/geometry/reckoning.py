"""Dead reckoning: where a path runs, from distance along it and the directions at stations.

Between two stations the path is the circular arc that joins their directions, which is what a pipe bend is and what
surveyors of boreholes call minimum curvature; it is exact for any chain of straights and arcs whose joins are stations.
Earth: east, north, up. Heading is clockwise from north, inclination above the horizontal [rad].
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import finite, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


class Reckoned(NamedTuple):
    """A reckoned path.

    Attributes:
        position: East, north, up [m], (..., n, 3), from the first station.
        turn: Angle between the directions at the ends of each stretch [rad], (..., n - 1).
        radius: Of each stretch's arc [m], (..., n - 1); infinite where it is straight.
    """

    position: np.ndarray
    turn: np.ndarray
    radius: np.ndarray


def directions(heading: ArrayLike, inclination: ArrayLike) -> Array:
    """Return unit vectors east, north, up (..., 3) of headings and inclinations [rad].

    >>> directions(np.radians(90), 0.0).round(12) + 0.0
    array([1., 0., 0.])
    """
    heading, inclination = np.broadcast_arrays(finite("heading", heading), finite("inclination", inclination))
    level = np.cos(inclination)
    return np.stack([np.sin(heading) * level, np.cos(heading) * level, np.sin(inclination)], axis=-1)


def reckon(distance: ArrayLike, heading: ArrayLike, inclination: ArrayLike) -> Reckoned:
    """Return the path through stations, each stretch a circular arc between its ends' directions.

    Args:
        distance: Along the path to each station, (..., n) [m], not decreasing.
        heading: At each station, clockwise from north [rad], broadcast against `distance`.
        inclination: Above the horizontal [rad], likewise.

    Returns:
        Reckoned; NaN from the first station on at which something is missing.

    Raises:
        ParameterError: Distances decrease, or directions turn right round (pi) within a stretch.

    Source: minimum curvature: the chord of an arc of length L that turns by b is L/2 (t0 + t1) tan(b/2)/(b/2).

    >>> found = reckon([0.0, 1.0, 1.0 + np.pi, 5.0], np.radians([0.0, 0.0, 90.0, 90.0]), 0.0)
    >>> found.position[2].round(9), found.radius[1].round(9)  # a quarter turn to the right of radius 2 after a metre
    (array([2., 3., 0.]), np.float64(2.0))
    """
    distance = np.asarray(finite("distance", distance))
    if distance.ndim == 0:
        raise ParameterError("distance is one number", expected="(..., n) distances of stations along the path")
    length = np.diff(distance)
    require(~(length < 0), "distance between stations", length, "0 or more", "give stations in the order of travel")
    way = directions(heading, inclination)
    way = np.broadcast_to(way, np.broadcast_shapes(way.shape, (*distance.shape, 3)))
    before, after = way[..., :-1, :], way[..., 1:, :]
    # Half the chord between unit vectors is the sine of half their angle; an arc cosine would lose small turns.
    half = np.arcsin(np.minimum(0.5 * np.linalg.norm(after - before, axis=-1), 1.0))
    require(
        ~(half > 0.5 * np.pi - 1e-6), "turn within a stretch", 2.0 * half, "below pi rad", "give more stations in it"
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(half > 0.0, np.tan(half) / half, 1.0)
        radius = np.where(half > 0.0, length / (2.0 * half), np.inf)
    # A missing direction stays missing: NaN > 0 is false.
    ratio = np.where(np.isnan(half), np.nan, ratio)
    step = 0.5 * (length * ratio)[..., None] * (before + after)
    start = np.zeros_like(step[..., :1, :])
    position = np.cumsum(np.concatenate([start, step], axis=-2), axis=-2)
    return Reckoned(position, 2.0 * half, np.where(np.isnan(half), np.nan, radius))


def along_path(chainage: ArrayLike, distance: ArrayLike, heading: ArrayLike, inclination: ArrayLike) -> Array:
    """Return points (m, 3) of one path [m] at chainages between its stations, on the arcs that join them.

    Args:
        chainage: Where (m,) [m]; NaN outside the stations.
        distance: To each station (n,) [m], increasing.
        heading: At each station (n,) [rad].
        inclination: At each station (n,) [rad].

    Raises:
        ParameterError: As `reckon`.

    >>> along_path([0.5, 1.0 + np.pi / 2], [0.0, 1.0, 1.0 + np.pi], np.radians([0.0, 0.0, 90.0]), 0.0).round(6)
    array([[0.      , 0.5     , 0.      ],
           [0.585786, 2.414214, 0.      ]])
    """
    chainage, distance = np.asarray(finite("chainage", chainage)), np.asarray(finite("distance", distance))
    found = reckon(distance, heading, inclination)
    way = np.broadcast_to(directions(heading, inclination), (len(distance), 3))
    row = np.clip(np.searchsorted(distance, chainage, side="right") - 1, 0, len(distance) - 2)
    since = np.where((chainage >= distance[0]) & (chainage <= distance[-1]), chainage - distance[row], np.nan)
    turn, radius = found.turn[row], found.radius[row]
    straight = ~(turn > 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        part = np.where(straight, 0.0, since / radius)
        # Towards the centre of the arc: the later direction less its part along the earlier one.
        inward = way[row + 1] - np.cos(turn)[:, None] * way[row]
        inward = inward / np.where(straight, 1.0, np.sin(turn))[:, None]
        forth = np.where(straight, since, radius * np.sin(part))
        # 1 - cos without its cancellation.
        aside = np.where(straight, 0.0, 2.0 * radius * np.sin(0.5 * part) ** 2)
    return found.position[row] + forth[:, None] * way[row] + aside[:, None] * inward
