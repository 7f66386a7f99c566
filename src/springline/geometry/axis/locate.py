"""Where a pipe lies in a cloud: its centreline, the stretch that can be trusted, its rings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import InputError
from springline.geometry.axis.centreline import Centreline, Placed
from springline.geometry.axis.cylinder import WINDOW
from springline.geometry.axis.pooled import PooledSection, pool_sections
from springline.geometry.axis.search import Found, find_cylinder, thin
from springline.geometry.axis.stations import Stations, cut_stations, longest_stretch, shows_wall, trusted
from springline.geometry.axis.trace import smooth, trace

if TYPE_CHECKING:
    from numpy.typing import NDArray

PIPE_SHARE = 0.45
"""Share of wall among what is seen below which a cloud is not taken for a pipe. The best cylinder in a square duct
reaches 0.42, in a room or a sphere 0.3; the poorest pipe that was scanned well reaches 0.77."""
_TOLERANCE = 0.04
_SAMPLE = 1_000_000
_SETTLE = 5
_COARSE = 0.5
_LEAST_LENGTH = 0.5
_BEND_GAIN = 2.0
"""A trace longer than the straight stretch by this many radii shows that the pipe bends."""
_CLEARLY = 1.1
_BOW = 0.02
"""A straight pipe's middle stays within this of a line, in radii (rms), or within three sigmas."""


@dataclass(frozen=True)
class Located:
    """A pipe in a cloud.

    Attributes:
        centreline: Its axis; distances along it start at the first station's beginning.
        stations: Rings about it, every one of the stretch.
        trusted: (station,) whether the station shows the wall and nothing else.
        outside: How many stations before and after the stretch were left out.
        pooled: The mean section of the trusted stations.
        share: Wall among what is seen, in [0, 1].
        doubt: Relative one-sigma to add to every diameter because it is in doubt which readings are of the wall; 0 in
            a clear pipe.
    """

    centreline: Centreline
    stations: Stations
    trusted: NDArray[np.bool_]
    outside: int
    pooled: PooledSection
    share: float
    doubt: float


def locate_pipe(
    points: NDArray[np.float64],
    *,
    spacing: float | None = None,
    bearings: int = 360,
    looking: bool = False,
    seed: int = 0,
) -> Located:
    """Return where the pipe lies in a cloud and its rings.

    A cylinder is searched for, followed through bends where there are any, and its axis settled on the rings
    themselves until it stays. The first ring's frame and the signs are those of `Centreline`; the axis is directed
    along the cloud's x at the end that is nearest to the origin.

    Args:
        points: (point, 3) x forward, y up, z to the right [m].
        spacing: Distance between stations [m]; a twentieth of the diameter when not given.
        bearings: Readings per ring.
        looking: Whether a sensor at the origin, inside the pipe, took the points looking along +x.
        seed: Of the search; the result is the same for the same seed.

    Raises:
        InputError: No pipe is in the cloud; the message says what was found instead.

    >>> s, t = np.meshgrid(np.linspace(0, 2, 200), np.linspace(0, 2 * np.pi, 120))
    >>> wall = np.column_stack([s.ravel(), 0.2 * np.sin(t.ravel()), 0.2 * np.cos(t.ravel()) - 0.05])
    >>> located = locate_pipe(wall, bearings=72)
    >>> round(located.pooled.diameter, 4), located.centreline.straight
    (0.4, True)
    """
    found = _search(points, looking, seed)
    radius, least = found.cylinder.radius, 0.5 if found.clear else 0.5 * found.share
    sample = points[:: -(-len(points) // _SAMPLE)]
    try:
        line, stretch = _settle_straight(sample, found, least)
        path = trace(thin(points, 60_000, np.random.default_rng(seed)), found.cylinder)
        if _bends(path, stretch, line, radius):
            line = _better(sample, line, _settle_curve(sample, path, radius, least), radius)
        return _rings(points, _directed(line), found, spacing, bearings, least)
    except InputError:
        if found.clear or not looking:
            raise
    # Too little is wall to settle anything: the search's own cylinder stands, over the stretch it was judged on.
    reach = WINDOW * radius * found.cylinder.direction
    line = Centreline(np.stack([found.cylinder.point - reach, found.cylinder.point + reach]))
    return _rings(points, _directed(line), found, spacing, bearings, None)


def _search(points: NDArray, looking: bool, seed: int) -> Found:
    found = find_cylinder(points, looking=looking, seed=seed)
    if looking and (found is None or not found.clear):
        found = find_cylinder(points, looking=looking, hard=True, seed=seed) or found
    if found is None:
        raise not_a_pipe("no cylinder passes through its points")
    if found.share < PIPE_SHARE and not looking:
        raise not_a_pipe(
            f"the best cylinder, of diameter {2.0 * found.cylinder.radius:.3g} m, explains {100 * found.share:.0f} % "
            "of the surface near it"
        )
    return found


def not_a_pipe(why: str) -> InputError:
    """Return the error for a cloud in which there is no pipe."""
    return InputError(
        f"the cloud is not of a pipe: {why}",
        where="points",
        expected=f"a pipe's wall, {100 * PIPE_SHARE:.0f} % or more of what is seen near its axis",
        mend="cut the cloud to the inside of the pipe, and check its unit and axes",
    )


def _coarse(points: NDArray, line: Centreline, radius: float, least: float) -> tuple[Placed, float, float]:
    """Return the points about the line, and where the trusted stretch begins and ends."""
    placed = line.place(points)
    wall = np.abs(np.hypot(placed.y, placed.z) / radius - 1.0) < 0.15
    if wall.sum() < 100:
        raise not_a_pipe("its wall was lost while following the axis")
    low, high = np.quantile(placed.along[wall], (0.0005, 0.9995))
    step = _COARSE * radius
    number = min(int((high - low) / step) + 2, 20_000)
    rough = cut_stations(placed, low - 0.5 * step, step, number, 72, 2.0 * radius)
    good = trusted(rough, radius, least)
    rows = longest_stretch(good, (rough.count > 0).sum(axis=1), _COARSE)
    if rows.stop - rows.start < _LEAST_LENGTH / _COARSE:
        raise not_a_pipe("no stretch of it shows a wall and little else")
    return placed, float(rough.distance[rows.start] - 0.5 * step), float(rough.distance[rows.stop - 1] + 0.5 * step)


def _settle_straight(points: NDArray, found: Found, least: float) -> tuple[Centreline, float]:
    """Return the straight axis on which the rings' mean section is centred, and the length of the stretch."""
    cylinder = found.cylinder
    radius = cylinder.radius
    line = Centreline(np.stack([cylinder.point, cylinder.point + radius * cylinder.direction]))
    length = 0.0
    for _ in range(_SETTLE):
        placed, low, high = _coarse(points, line, radius, least)
        length = high - low
        step = 0.1 * radius
        stations = cut_stations(placed, low, step, int(length / step), 360, 2.0 * radius)
        stations = stations[trusted(stations, radius, least)]
        pooled = pool_sections(stations.ranges, stations.bearings, stations.distance, radius)
        ends = np.array([low, high])
        offset = pooled.centre + (ends - pooled.middle)[:, None] * pooled.slope
        frame = line.frames(np.zeros(1))[0]
        line = Centreline(line.at(ends) + offset @ frame[1:])
        if np.abs(offset).max() < 1e-5 * radius:
            break
    return line, length


def _bends(path: NDArray, stretch: float, line: Centreline, radius: float) -> bool:
    run = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    if run > stretch + _BEND_GAIN * radius:
        return True
    if run < 8.0 * radius:
        return False
    placed = line.place(smooth(path, 4.0 * radius))
    return float(np.sqrt(np.mean(placed.y**2 + placed.z**2))) > _BOW * radius


def _settle_curve(points: NDArray, path: NDArray, radius: float, least: float) -> Centreline:
    """Return the smooth curve through the middles of the rings along a traced path."""
    line = Centreline(smooth(path, 2.0 * radius))
    for _ in range(3):
        placed, low, high = _coarse(points, line, radius, least)
        step = 0.25 * radius
        stations = cut_stations(placed, low, step, int((high - low) / step), 120, 2.0 * radius)
        good = trusted(stations, radius, least)
        offset = _middles(stations[good], radius)
        places = line.at(stations.distance[good]) + np.einsum(
            "ni,nij->nj", offset, line.frames(stations.distance[good])[:, 1:]
        )
        line = Centreline(smooth(places, 2.0 * radius))
    return line


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
        target = np.einsum("nb,bi->ni", weight * value, shape) + pull @ np.array([radius, 0.0, 0.0])
        unknown = np.linalg.solve(normal, target[:, :, None])[:, :, 0]
    return unknown[:, 1:]


def _directed(line: Centreline) -> Centreline:
    """Return the line run along the cloud's x at whichever end lies nearer to the origin."""
    ends = np.linalg.norm(line.nodes[[0, -1]], axis=1)
    at = np.array([0.0 if ends[0] <= ends[1] else line.length])
    return line if line.direction(at)[0, 0] >= 0.0 else line.turned()


def _better(points: NDArray, straight: Centreline, curved: Centreline, radius: float) -> Centreline:
    """Return the curve when it puts clearly more of the points on the wall, else the straight line."""

    def on_wall(line: Centreline) -> int:
        placed = line.place(points)
        inside = (placed.along > -radius) & (placed.along < line.length + radius)
        return int((inside & (np.abs(np.hypot(placed.y, placed.z) / radius - 1.0) < _TOLERANCE)).sum())

    return curved if on_wall(curved) > _CLEARLY * on_wall(straight) else straight


def _rings(
    points: NDArray, line: Centreline, found: Found, spacing: float | None, bearings: int, least: float | None
) -> Located:
    radius = found.cylinder.radius
    step = spacing or 0.1 * radius
    if least is not None:
        placed, low, high = _coarse(points, line, radius, least)
    else:
        placed, low, high = line.place(points), 0.0, line.length
    number = max(1, int((high - low) / step))
    stations = cut_stations(placed, low, step, number, bearings, 2.0 * radius)
    good = trusted(stations, radius, least) if least is not None else shows_wall(stations, radius)
    if not good.any():
        raise not_a_pipe("no stretch of it shows a wall and little else")
    rows = longest_stretch(good, np.ones(number), step / radius)
    stations, good = stations[rows], good[rows]
    pooled = pool_sections(stations.ranges[good], stations.bearings, stations.distance[good], radius)
    return Located(line, stations, good, number - len(good), pooled, found.share, _doubt(found))


def _doubt(found: Found) -> float:
    """Return the relative one-sigma that stands for not knowing which readings are of the wall.

    Three ways to be wrong: what is not wall drags the fit by up to the wall's tolerance in proportion to its odds;
    other cylinders may explain the points nearly as well; a few cells of wall agree by chance.
    """
    if found.clear:
        return 0.0
    dragged = _TOLERANCE * (1.0 - found.share) / found.share
    return float(np.sqrt(dragged**2 + found.spread**2 + 1.0 / max(found.score, 1.0)))
