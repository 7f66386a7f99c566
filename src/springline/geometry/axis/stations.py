"""From points about a centreline to rings: one robust range per station and bearing, and which stations to trust."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.axis._rows import row_median

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from springline.geometry.axis.centreline import Placed

_WALL = 0.15
"""A range counts as wall when it is within this of the section, in radii."""
_BIWEIGHT = 4.685
_LEAST_CELLS = 0.03
"""Share of its bearings over which a trusted station shows wall."""
_MOST_SCATTER = 0.05
"""A station whose readings scatter more than this about the section, in radii, tells nothing about its shape."""
_BRIDGE = 2.0
"""Gaps up to a diameter are bridged [radii]: what lies beyond a longer one is seen too badly or is another pipe."""


@dataclass(frozen=True)
class Stations:
    """Rings at equal steps along a centreline.

    Attributes:
        distance: (station,) of their middles along the centreline [m].
        ranges: (station, bearing) robust mean range from the centreline to the points of a cell [m]; NaN = no point.
        bearings: (bearing,) middles of the cells, from +z counter-clockwise [rad].
        count: (station, bearing) points in the cell.
    """

    distance: NDArray[np.float64]
    ranges: NDArray[np.float64]
    bearings: NDArray[np.float64]
    count: NDArray[np.int64]

    def __getitem__(self, rows: slice | NDArray) -> Stations:
        return Stations(self.distance[rows], self.ranges[rows], self.bearings, self.count[rows])


def cut_stations(placed: Placed, start: float, spacing: float, number: int, bearings: int, reach: float) -> Stations:
    """Return rings from points about a centreline.

    Args:
        placed: The points.
        start: Where the first station begins along the centreline [m].
        spacing: Length of a station [m].
        number: How many stations.
        bearings: How many bearings; the first lies at +z.
        reach: Points further from the centreline are left out [m].
    """
    radius = np.hypot(placed.y, placed.z)
    station = np.floor((placed.along - start) / spacing)
    keep = (station >= 0) & (station < number) & (radius < reach)
    radius, station = radius[keep], station[keep].astype(np.int64)
    turn = np.arctan2(placed.y[keep], placed.z[keep]) * (bearings / (2.0 * np.pi))
    cell = station * bearings + np.mod(np.rint(turn).astype(np.int64), bearings)
    # One sort brings cells together and orders the ranges within each.
    order = np.argsort(cell + radius * (0.999 / reach), kind="stable")
    cell, radius = cell[order], radius[order]
    count = np.bincount(cell, minlength=number * bearings)
    filled = np.flatnonzero(count)
    first = np.cumsum(count)[filled] - count[filled]
    low, high = first + (count[filled] - 1) // 2, first + count[filled] // 2
    ranges = np.full(number * bearings, np.nan)
    ranges[filled] = 0.5 * (radius[low] + radius[high])
    ranges[filled] += _mean_departure(radius - ranges[cell], cell, bearings, count)[filled]
    return Stations(
        start + spacing * (np.arange(number) + 0.5),
        ranges.reshape(number, bearings),
        np.arange(bearings) * (2.0 * np.pi / bearings),
        count.reshape(number, bearings),
    )


def _mean_departure(departure: NDArray, cell: NDArray, bearings: int, count: NDArray) -> NDArray[np.float64]:
    """Return the biweight mean of the points' departures from their cell's median, one step from it.

    The median alone jumps between the few values of a quantised depth when a single point enters the cell.
    """
    size, station = np.abs(departure), cell // bearings
    order = np.argsort(station + size * (0.999 / max(float(size.max(initial=0.0)), 1e-300)))
    total = np.bincount(station, minlength=len(count) // bearings)
    middle = np.cumsum(total) - total + total // 2
    scale = np.zeros(len(total))
    scale[total > 0] = 1.4826 * size[order][middle[total > 0]]
    relative = departure / (_BIWEIGHT * np.maximum(scale, 1e-12)[station])
    weight = np.clip(1.0 - relative**2, 0.0, None) ** 2
    top = np.bincount(cell, weight * departure, minlength=len(count))
    return top / np.maximum(np.bincount(cell, weight, minlength=len(count)), 1e-12)


def trusted(
    stations: Stations, radius: float, least_share: float, oval: tuple[float, float] = (0.0, 0.0)
) -> NDArray[np.bool_]:
    """Return which stations (station,) show the wall of a pipe and little else.

    Args:
        stations: Rings about the pipe's axis.
        radius: Its mean radius [m].
        least_share: Of what a station shows that must be wall.
        oval: Its oval_cos and oval_sin, in radii.
    """
    misfit = _misfit(stations, radius, oval)
    wall = misfit < _WALL
    enough = wall.sum(axis=1) >= max(3.0, _LEAST_CELLS * wall.shape[1])
    most = wall.sum(axis=1) >= least_share * np.isfinite(stations.ranges).sum(axis=1)
    scatter = 1.4826 * row_median(np.where(wall, misfit, np.nan))
    return enough & most & (scatter < _MOST_SCATTER)


def shows_wall(stations: Stations, radius: float) -> NDArray[np.bool_]:
    """Return which stations (station,) hold readings that could be wall, whatever else they hold."""
    return (_misfit(stations, radius, (0.0, 0.0)) < _WALL).sum(axis=1) >= 3


def _misfit(stations: Stations, radius: float, oval: tuple[float, float]) -> NDArray[np.float64]:
    """Return how far each range is from the section, in radii; infinite where there is none."""
    section = 1.0 + oval[0] * np.cos(2.0 * stations.bearings) + oval[1] * np.sin(2.0 * stations.bearings)
    return np.abs(np.nan_to_num(stations.ranges, nan=np.inf) / radius - section)


def longest_stretch(good: NDArray[np.bool_], weight: NDArray, step: float) -> slice:
    """Return the run of stations with the most weight, bridging short gaps; empty when none is good.

    Args:
        good: (station,) whether it is trusted.
        weight: (station,) how much it shows.
        step: Distance between stations, in radii.

    >>> longest_stretch(np.array([True, False, False, True, True]), np.ones(5), 2.0)
    slice(3, 5, None)
    """
    rows = np.flatnonzero(good)
    if len(rows) == 0:
        return slice(0, 0)
    breaks = np.flatnonzero(np.diff(rows) * step > _BRIDGE + step)
    firsts, lasts = np.append(0, breaks + 1), np.append(breaks, len(rows) - 1)
    total = np.append(0.0, np.cumsum(weight[rows]))
    best = int(np.argmax(total[lasts + 1] - total[firsts]))
    return slice(int(rows[firsts[best]]), int(rows[lasts[best]]) + 1)
