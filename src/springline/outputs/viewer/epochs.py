"""Another inspection of the same pipe, laid onto the cells of this one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ..unroll import NO_STATION

if TYPE_CHECKING:
    from ..unroll import Unrolled


@dataclass(frozen=True)
class Epoch:
    """Another inspection.

    Attributes:
        name: What it is called, such as its date.
        wall: Its wall on the very cells of this inspection's wall, as `matched` lays it.
    """

    name: str
    wall: Unrolled


def matched(wall: Unrolled, other: Unrolled, *, chainage: np.ndarray | None = None, turn: float = 0.0) -> Unrolled:
    """Return the other wall on the cells of the first, cell by nearest cell; nothing is averaged.

    Args:
        wall: The first wall.
        other: The wall of another inspection.
        chainage: Where the other inspection has the middle of each group of the first [m]; the same when not given.
        turn: Bearing of the other inspection at bearing 0 of the first [rad].

    Returns:
        The other wall: departures about the first one's circle; where it has no station, none, with that reason.
    """
    middle = (wall.start + wall.end) / 2
    wanted = middle if chainage is None else np.asarray(chainage, float)
    group = np.clip(np.searchsorted(other.start, np.nan_to_num(wanted), "right") - 1, 0, other.start.size - 1)
    reached = (wanted >= other.start[group] - 1e-9) & (wanted <= other.end[group] + 1e-9)
    row = np.rint((wall.bearing + turn) * (other.bearing.size / (2 * pi))).astype(int) % other.bearing.size
    cells = np.ix_(group, row)
    shape = other.shape[cells] + np.float32((other.circle_diameter - wall.circle_diameter) / 2)
    lost = ~reached[:, None]
    return replace(
        wall,
        shape=np.where(lost, np.nan, shape).astype(np.float32),
        surface=np.where(lost, np.nan, other.surface[cells]).astype(np.float32),
        reason=np.where(lost, NO_STATION, other.reason[cells]).astype(np.uint8),
    )
