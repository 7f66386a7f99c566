"""Settling an axis on the rings that are cut about it, until neither moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import InputError
from springline.geometry.axis.centreline import Centreline
from springline.geometry.axis.pooled import OVALITY_PRIOR, TUKEY, PooledSection, pool_sections
from springline.geometry.axis.stations import Stations, cut_stations, longest_stretch, trusted
from springline.geometry.axis.trace import smooth

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from springline.geometry.axis.centreline import Placed
    from springline.geometry.axis.cylinder import Cylinder

_STEPS, _STILL, _PASSES, _POLISH = 6, 5e-4, 3, 40
_FINE, _COARSE, _CURVE = 0.1, 0.5, 0.25
"""Spacing of the rings on which a straight axis, the stretch and a curved axis are settled, in radii."""
_WALL = 0.15
_REACH = 2.0
_LEAST_LENGTH = 0.5
_ALIKE = 8.0
"""How many neighbouring points are taken to err alike; a settled axis hardly depends on it."""
_LEAST_SPREAD = 2e-4
_CROWD, _CROWDS = 0.05, 120
"""Length [radii] and number round the circumference of the places over which points are counted."""
_MOST_STATIONS = 20_000


@dataclass(frozen=True)
class Settled:
    """An axis that its own rings confirm.

    Attributes:
        line: It.
        radius: Mean radius about it [m].
        oval: oval_cos and oval_sin of the mean section, in radii.
        low: Where the trusted stretch begins along the line [m].
        high: Where it ends [m].
    """

    line: Centreline
    radius: float
    oval: tuple[float, float]
    low: float
    high: float


def settle_straight(points: NDArray[np.float64], start: Cylinder, least_share: float) -> Settled:
    """Return the straight axis about which the mean section of the rings is centred.

    Rings lie on a lattice whose origin is the foot of the cloud's origin, so that the result does not depend on where
    the search began.

    Args:
        points: (point, 3) [m].
        start: Where to begin.
        least_share: Of what a station shows that must be wall.

    Raises:
        InputError: No stretch along the axis shows a wall.
    """
    radius = start.radius
    line = Centreline(np.stack([start.point, start.point + radius * start.direction]))
    oval = oval_in_section(start, line)
    for _ in range(_STEPS):
        placed, low, high = find_stretch(points, line, radius, least_share, oval)
        pooled, stations = _pooled(placed, low, high, radius, least_share, oval)
        line, moved = _shifted(line, low, high, pooled.centre, pooled.slope, pooled.middle)
        radius, oval = pooled.mean_radius, _relative(pooled)
        if moved < _STILL * radius:
            break
    for _ in range(_PASSES):
        placed, low, high = find_stretch(points, line, radius, least_share, oval)
        pooled, stations = _pooled(placed, low, high, radius, least_share, oval)
        radius, centre, slope = polish(placed, stations, pooled)
        line, _ = _shifted(line, low, high, centre, slope, pooled.middle)
    return Settled(line, radius, oval, 0.0, line.length)


def oval_in_section(cylinder: Cylinder, line: Centreline) -> tuple[float, float]:
    """Return a cylinder's oval_cos and oval_sin, in radii, about a line along it."""
    y, z = line.frames(np.zeros(1))[0, 1:] @ cylinder.oval
    return float(z * z - y * y), float(2.0 * z * y)


def _relative(pooled: PooledSection) -> tuple[float, float]:
    return pooled.oval_cos / pooled.mean_radius, pooled.oval_sin / pooled.mean_radius


def _pooled(
    placed: Placed, low: float, high: float, radius: float, least_share: float, oval: tuple[float, float]
) -> tuple[PooledSection, Stations]:
    step = _FINE * lattice(radius)
    stations = cut_stations(placed, low, step, round((high - low) / step), 360, _REACH * radius)
    stations = stations[trusted(stations, radius, least_share, oval)]
    return pool_sections(stations.ranges, stations.bearings, stations.distance, radius), stations


def _shifted(
    line: Centreline, low: float, high: float, centre: NDArray, slope: NDArray, middle: float
) -> tuple[Centreline, float]:
    """Return the line from `low` to `high` moved to the centre and the slope, and by how much it moved [m]."""
    ends = np.array([low, high])
    offset = centre + (ends - middle)[:, None] * slope
    return Centreline(line.at(ends) + offset @ line.frames(np.zeros(1))[0, 1:]), float(np.abs(offset).max())


def polish(
    placed: Placed, stations: Stations, pooled: PooledSection
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return radius, centre (y, z) at the pooled middle, and slope, from the points themselves and not from cells.

    Cells change when the axis moves by less than a point's own error, and with them everything after. Here points
    keep their weight while the axis moves, so that the same points, read from another file, give the same axis.

    Args:
        placed: Points about a line that is settled but for the last fraction of a millimetre.
        stations: Trusted rings about the same line.
        pooled: Their mean section.
    """
    radius = pooled.mean_radius
    rho, bearing = np.hypot(placed.y, placed.z), np.arctan2(placed.y, placed.z)
    station, inside = _station_of(placed.along, stations.distance)
    keep = inside & (np.abs(rho / radius - 1.0) < _WALL)
    rho, bearing, along, station = rho[keep] / radius, bearing[keep], placed.along[keep], station[keep]
    share = 1.0 / _crowd(along / (_CROWD * radius), bearing * (_CROWDS / (2.0 * np.pi)))
    cos, sin, place = np.cos(bearing), np.sin(bearing), (along - pooled.middle) / radius
    shape = np.stack([np.ones_like(cos), sin, cos, place * sin, place * cos, cos * cos - sin * sin, 2 * sin * cos])
    unknown = np.array([1.0, 0.0, 0.0, 0.0, 0.0, pooled.oval_cos / radius, pooled.oval_sin / radius])
    pull = np.diag([0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]) * (_ALIKE / OVALITY_PRIOR**2)
    pull[1:5, 1:5] *= 1e-6
    for step in range(_POLISH):
        misfit = rho - unknown @ shape
        if step % 5 == 0:
            scatter = np.maximum(_spread(np.abs(misfit), station, len(stations.distance)), _LEAST_SPREAD)[station]
        weight = share * np.clip(1.0 - (misfit / (TUKEY * scatter)) ** 2, 0.0, None) ** 2 / scatter**2
        weighted = shape * weight
        before, unknown = unknown, np.linalg.solve(weighted @ shape.T + pull, weighted @ rho)
        if step > 5 and np.abs(unknown - before).max() < 1e-9:
            break
    return float(unknown[0] * radius), unknown[1:3] * radius, unknown[3:5]


def _station_of(along: NDArray, distance: NDArray) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the station nearest to each place, and whether the place lies inside it."""
    step = float(np.min(np.diff(distance))) if len(distance) > 1 else np.inf
    after = np.clip(np.searchsorted(distance, along), 1, max(1, len(distance) - 1))
    after = np.minimum(after, len(distance) - 1)
    before = np.maximum(after - 1, 0)
    station = np.where(along - distance[before] < distance[after] - along, before, after)
    return station, np.abs(along - distance[station]) <= 0.5 * step


def _spread(size: NDArray, station: NDArray, number: int) -> NDArray[np.float64]:
    """Return the robust one-sigma of each station from the sizes of its points' misfits."""
    order = np.argsort(station + size * (0.999 / max(float(size.max()), 1e-300)))
    total = np.bincount(station, minlength=number)
    middle = np.minimum(np.cumsum(total) - total + total // 2, len(size) - 1)
    return 1.4826 * size[order][middle]


def _crowd(along: NDArray, around: NDArray) -> NDArray[np.float64]:
    """Return how many points share the place of each, counted with a tent of one unit each way so that it is smooth."""
    row, column = np.floor(along).astype(np.int64), np.floor(around).astype(np.int64)
    p, q = along - row, around - column
    row = row - row.min()
    corners = [
        ((row + i) * _CROWDS + (column + j) % _CROWDS, (p if i else 1.0 - p) * (q if j else 1.0 - q))
        for i in (0, 1)
        for j in (0, 1)
    ]
    count = sum(np.bincount(cell, part, minlength=(int(row.max()) + 2) * _CROWDS) for cell, part in corners)
    return sum(part * count[cell] for cell, part in corners)


def settle_curve(
    points: NDArray[np.float64],
    path: NDArray[np.float64],
    radius: float,
    least_share: float,
    oval: tuple[float, float] = (0.0, 0.0),
) -> Settled:
    """Return the smooth curve through the middles of the rings along a traced path.

    Args:
        points: (point, 3) [m].
        path: (node, 3) where to begin [m].
        radius: Mean radius [m].
        least_share: Of what a station shows that must be wall.
        oval: oval_cos and oval_sin of the mean section, in radii.

    Raises:
        InputError: No stretch along the path shows a wall.
    """
    line = Centreline(smooth(path, 2.0 * radius))
    for _ in range(3):
        placed, low, high = find_stretch(points, line, radius, least_share, oval)
        step = _CURVE * radius
        stations = cut_stations(placed, low, step, max(1, int((high - low) / step)), 120, _REACH * radius)
        stations = stations[trusted(stations, radius, least_share, oval)]
        frames = line.frames(stations.distance)[:, 1:]
        places = line.at(stations.distance) + np.einsum("ni,nij->nj", _middles(stations, radius), frames)
        line = Centreline(smooth(places, 2.0 * radius))
    _, low, high = find_stretch(points, line, radius, least_share, oval)
    return Settled(line, radius, oval, low, high)


def find_stretch(
    points: NDArray[np.float64], line: Centreline, radius: float, least_share: float, oval: tuple[float, float]
) -> tuple[Placed, float, float]:
    """Return the points about the line, and where the trusted stretch begins and ends along it [m].

    Raises:
        InputError: No stretch along the line shows a wall.
    """
    placed = line.place(points)
    wall = np.abs(np.hypot(placed.y, placed.z) / radius - 1.0) < _WALL
    if wall.sum() < 100:
        raise lost()
    step = _COARSE * lattice(radius)
    foot = line.place(np.zeros((1, 3))).along[0]
    low, high = np.quantile(placed.along[wall], (0.0005, 0.9995))
    low = foot + step * np.floor((low - foot) / step)
    number = min(int((high - low) / step) + 1, _MOST_STATIONS)
    rough = cut_stations(placed, low, step, number, 72, _REACH * radius)
    good = trusted(rough, radius, least_share, oval)
    rows = longest_stretch(good, (rough.count > 0).sum(axis=1), _COARSE)
    if rows.stop - rows.start < _LEAST_LENGTH / _COARSE:
        raise lost()
    return placed, float(low + step * rows.start), float(low + step * rows.stop)


def lattice(radius: float) -> float:
    """Return the radius rounded to a ladder of quarter octaves, so that a lattice does not follow its every twitch.

    >>> lattice(0.2), lattice(0.2001)
    (0.21022410381342863, 0.21022410381342863)
    """
    return float(2.0 ** (round(4.0 * np.log2(radius)) / 4.0))


def lost() -> InputError:
    """Return the error for an axis along which there is no wall."""
    return InputError(
        "no stretch along the best axis shows a wall and little else",
        where="points",
        expected="the inside of a pipe",
        mend="cut the cloud to the inside of the pipe, and check its unit and axes",
    )


def _middles(stations: Stations, radius: float) -> NDArray[np.float64]:
    """Return the centre (station, 2) y, z of each ring by a robust circle; a ring that sees an arc stays in place."""
    cos, sin = np.cos(stations.bearings), np.sin(stations.bearings)
    shape = np.column_stack([np.ones_like(cos), sin, cos])
    value = np.nan_to_num(stations.ranges, nan=1e9)
    unknown = np.zeros((len(value), 3))
    unknown[:, 0] = radius
    # A weak pull towards the radius and the axis at hand settles what a short arc leaves open.
    pull = np.diag([4.0, 4.0, 4.0])
    for gate in (0.2, 0.1, 0.06, 0.06, 0.06):
        misfit = value - unknown @ shape.T
        weight = np.clip(1.0 - (misfit / (gate * radius)) ** 2, 0.0, None) ** 2
        normal = np.einsum("nb,bi,bj->nij", weight, shape, shape) + pull
        target = (weight * value) @ shape + pull @ np.array([radius, 0.0, 0.0])
        unknown = np.linalg.solve(normal, target[:, :, None])[:, :, 0]
    return unknown[:, 1:]
