"""Where rings see wall, there is no opening: what looks like one in a picture is a stain."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ...imaging.sightings import Sighting
    from ...survey import Survey

_INNER = 0.6
_FEWEST = 12
_MOST = 4.0


class Unbroken:
    """Tells what rings say against openings that only images show.

    Args:
        survey: With `/rings`, `/mask`, `/candidates`, `/section` and `/pose`.
        level: (ring,) the robot's roll [rad] where `/pose` has none; None when nothing tells it.
        radius: The pipe's [m].
    """

    def __init__(self, survey: Survey, level: np.ndarray | None, radius: float) -> None:
        roll = survey.pose["roll"].values if level is None else level
        self.radius, self.roll = radius, np.nan_to_num(roll)
        self.bearing, self.x = survey.rings["bearing"].values, survey.section["chainage"].values
        wall = survey.mask["reason"].values == 0
        if "opening" in survey.candidates:
            wall &= survey.candidates["opening"].values == 0
        self.wall = wall

    def against(self, one: Sighting) -> float:
        """Return the log odds that readings of the wall inside the edge of a lateral take from it.

        Nothing where too few rings pass there; nothing from a joint, which rings may miss.
        """
        if one.kind != "lateral":
            return 0.0
        rows = np.flatnonzero(np.abs(self.x - one.x) < _INNER * one.radius)
        if not len(rows):
            return 0.0
        turn = self.bearing + self.roll[rows[len(rows) // 2]] - one.bearing
        columns = np.abs((turn + math.pi) % (2.0 * math.pi) - math.pi) < _INNER * one.radius / self.radius
        inside = self.wall[np.ix_(rows, columns)]
        if inside.size < _FEWEST:
            return 0.0
        return _MOST * float(np.clip(2.0 * inside.mean() - 0.5, 0.0, 1.0))
