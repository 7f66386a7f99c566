"""Another inspection of the same pipe, laid onto the cells of this one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ..results import Results
from ..unroll import NO_STATION, unroll

if TYPE_CHECKING:
    from ...compare import Comparison
    from ..unroll import Unrolled


_CELLS = 4_000_000
"""Of each of two walls, so that their viewer stays below 30 MB too."""


@dataclass(frozen=True)
class Epoch:
    """Another inspection.

    Attributes:
        name: What it is called, such as its date.
        wall: Its wall on the very cells of this inspection's wall, as `matched` lays it.
        later: Whether it is the later of the two: a change is what the later one has more.
    """

    name: str
    wall: Unrolled
    later: bool = False


def matched(
    wall: Unrolled,
    other: Unrolled,
    *,
    chainage: np.ndarray | None = None,
    turn: float | np.ndarray = 0.0,
    mirrored: bool = False,
) -> Unrolled:
    """Return the other wall on the cells of the first, cell by nearest cell; nothing is averaged.

    Args:
        wall: The first wall.
        other: The wall of another inspection.
        chainage: Where the other inspection has the middle of each group of the first [m], NaN where nowhere; the same
            chainages when not given.
        turn: What the other's bearings must be turned by to be the first one's [rad], for each group or for all.
        mirrored: Whether the other was driven from the other end, so that its right is the first one's left; `turn` is
            then of its bearings seen along the first one's travel.

    Returns:
        The other wall: departures about the first one's circle; where it has no station, none, with that reason.
    """
    middle = (wall.start + wall.end) / 2
    wanted = middle if chainage is None else np.asarray(chainage, float)
    group = np.clip(np.searchsorted(other.start, np.nan_to_num(wanted), "right") - 1, 0, other.start.size - 1)
    reached = (wanted >= other.start[group] - 1e-9) & (wanted <= other.end[group] + 1e-9)
    bearing = wall.bearing[None, :] - np.broadcast_to(turn, middle.shape)[:, None]
    if mirrored:
        bearing = pi - bearing
    row = np.rint(bearing * (other.bearing.size / (2 * pi))).astype(int) % other.bearing.size
    cells = (group[:, None], row)
    shape = other.shape[cells] + np.float32((other.circle_diameter - wall.circle_diameter) / 2)
    lost = ~reached[:, None]
    return replace(
        wall,
        shape=np.where(lost, np.nan, shape).astype(np.float32),
        surface=np.where(lost, np.nan, other.surface[cells]).astype(np.float32),
        reason=np.where(lost, NO_STATION, other.reason[cells]).astype(np.uint8),
    )


def compared(found: Comparison) -> tuple[Results, Unrolled, Epoch] | None:
    """Return what `render_viewer` shows of a comparison: the earlier inspection, its wall, and the later one on it.

    None when one of them has no finished survey, or they could not be placed on each other.

    Args:
        found: The comparison.
    """
    finished = ("rings", "section", "metrics")
    surveys = [one.survey for one in (found.a, found.b)]
    if found.placed is None or not all(s is not None and all(map(s.has, finished)) for s in surveys):
        return None
    results = [Results(one) for one in surveys]
    wall, other = (unroll(one, cells=_CELLS) for one in results)
    middle = (wall.start + wall.end) / 2
    placed = found.placed
    onto = matched(wall, other, chainage=placed.at(middle)[0], turn=placed.roll_at(middle), mirrored=placed.reversed)
    return results[0], wall, Epoch(found.b.name, onto, later=True)
