"""Where a pipe lies in a cloud: its centreline, the stretch that can be trusted, its rings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import InputError
from springline.geometry.axis.centreline import Centreline
from springline.geometry.axis.cylinder import WINDOW, Cylinder
from springline.geometry.axis.pooled import PooledSection, pool_sections
from springline.geometry.axis.search import Found, find_cylinder, judge, side_walls, thin
from springline.geometry.axis.settle import Settled, lost, settle_curve, settle_straight
from springline.geometry.axis.stations import Stations, cut_stations, longest_stretch, shows_wall, trusted
from springline.geometry.axis.trace import smooth, trace

if TYPE_CHECKING:
    from numpy.typing import NDArray

PIPE_SHARE = 0.45
"""Share of wall among what is seen below which a cloud is not taken for a pipe. The best cylinder in a square duct
reaches 0.42, in a room or a sphere 0.3; the poorest pipe that was scanned well reaches 0.77."""
_WORTH_TRYING = 0.4
_SIDE_WALLS = 0.25
"""Share of side walls above which a doubtful cylinder is not a pipe: a duct has 0.5, the noisiest pipe 0.05."""
_MOST_DOUBT = 0.5
_LEAST_SHARE, _LEAST_SHARE_IN_DOUBT = 0.5, 0.2
"""Share of what a station shows that must be wall, in a clear pipe and where it is in doubt what is wall."""
_TOLERANCE = 0.04
_SAMPLE, _THINNED = 150_000, 60_000
_BEND_GAIN = 2.0
"""A trace longer than the straight stretch by this many radii shows that the pipe bends, or that the trace strayed."""
_CLEARLY = 1.1
"""A curve must put this many times as many points on the wall as a straight line."""
_SHORT, _BOW = 8.0, 0.02
"""A stretch shorter than `_SHORT` radii is straight; a longer one while its middle stays within `_BOW` radii (rms)."""


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
    least = _LEAST_SHARE if found.clear else _LEAST_SHARE_IN_DOUBT
    sample = points[:: -(-len(points) // _SAMPLE)]
    thinned = thin(points, _THINNED, np.random.default_rng(seed))
    if not found.clear and (sides := side_walls(thinned, found.cylinder, seed=seed)) > _SIDE_WALLS:
        raise not_a_pipe(f"{100 * sides:.0f} % of the surface about the best axis are side walls of another shape")
    try:
        settled = settle_straight(sample, found.cylinder, least)
        path = trace(thinned, found.cylinder)
        if _bends(path, settled):
            settled = _better(sample, settled, settle_curve(sample, path, settled.radius, least, settled.oval))
    except InputError:
        if found.clear or not looking:
            raise
        # Too little is wall to settle anything: the search's own cylinder stands, over the stretch it was judged on.
        reach = WINDOW * found.cylinder.radius * found.cylinder.direction
        line = Centreline(np.stack([found.cylinder.point - reach, found.cylinder.point + reach]))
        settled, least = Settled(line, found.cylinder.radius, (0.0, 0.0), 0.0, line.length), 0.0
    return _rings(points, thinned, settled, found, spacing, bearings, least)


def _search(points: NDArray, looking: bool, seed: int) -> Found:
    found = find_cylinder(points, looking=looking, seed=seed)
    worth_it = looking or (found is not None and found.share > _WORTH_TRYING)
    if worth_it and not (found and found.clear):
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


def _bends(path: NDArray, settled: Settled) -> bool:
    """Whether the traced path goes on beyond the straight stretch, or leaves it."""
    radius = settled.radius
    run = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    if run > settled.high - settled.low + _BEND_GAIN * radius:
        return True
    if run < _SHORT * radius:
        return False
    placed = settled.line.place(smooth(path, 4.0 * radius))
    return float(np.sqrt(np.mean(placed.y**2 + placed.z**2))) > _BOW * radius


def _better(points: NDArray, straight: Settled, curved: Settled) -> Settled:
    """Return the curve when it puts clearly more of the points on the wall, else the straight line."""

    def on_wall(settled: Settled) -> int:
        placed = settled.line.place(points)
        inside = (placed.along > settled.low) & (placed.along < settled.high)
        return int((inside & (np.abs(np.hypot(placed.y, placed.z) / settled.radius - 1.0) < _TOLERANCE)).sum())

    return curved if on_wall(curved) > _CLEARLY * on_wall(straight) else straight


def _rings(
    points: NDArray,
    thinned: NDArray,
    settled: Settled,
    found: Found,
    spacing: float | None,
    bearings: int,
    least: float,
) -> Located:
    radius, line = settled.radius, settled.line
    low, high = settled.low, settled.high
    if _runs_back(line):
        line, low, high = line.turned(), line.length - high, line.length - low
    step = spacing or 0.1 * radius
    number = max(1, int((high - low) / step))
    stations = cut_stations(line.place(points), low, step, number, bearings, 2.0 * radius)
    good = trusted(stations, radius, least, settled.oval) if least else shows_wall(stations, radius)
    if not good.any():
        raise lost()
    rows = longest_stretch(good, np.ones(number), step / radius)
    stations, good = stations[rows], good[rows]
    pooled = pool_sections(stations.ranges[good], stations.bearings, stations.distance[good], radius)
    middle = np.array([0.5 * (low + high)])
    score, share = judge(thinned, Cylinder(line.at(middle)[0], line.direction(middle)[0], radius, found.cylinder.oval))
    doubt = 0.0 if found.clear else _doubt(share, score, found.spread)
    return Located(line, stations, good, number - len(good), pooled, share, doubt)


def _runs_back(line: Centreline) -> bool:
    """Whether the line runs against the cloud's x at whichever end lies nearer to the origin."""
    ends = np.linalg.norm(line.nodes[[0, -1]], axis=1)
    at = np.array([0.0 if ends[0] <= ends[1] else line.length])
    return bool(line.direction(at)[0, 0] < 0.0)


def _doubt(share: float, score: float, spread: float) -> float:
    """Return the relative one-sigma that stands for not knowing which readings are of the wall.

    Three ways to be wrong: what is not wall drags the fit by up to the wall's tolerance in proportion to its odds;
    other cylinders may explain the points nearly as well; a few cells of wall agree by chance.
    """
    dragged = _TOLERANCE * (1.0 - share) / max(share, 0.05)
    return min(_MOST_DOUBT, float(np.sqrt(dragged**2 + spread**2 + 1.0 / max(score, 1.0))))
