"""From a survey to points for cloud formats."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .axes import from_contract

if TYPE_CHECKING:
    from ..survey import Survey


@dataclass(frozen=True)
class Points:
    """Points to write: coordinates (point, 3) [m] in the file's axes, and what else is known of each."""

    xyz: np.ndarray
    intensity: np.ndarray | None = None
    time: np.ndarray | None = None


def points_of(survey: Survey, axes: str) -> Points:
    """Return `/points`, or the returns of `/rings` set at their distance along a straight pipe.

    Args:
        survey: A survey with `/points` or `/rings`.
        axes: The file's axes, as `axes.parse_axes` reads them.
    """
    if survey.has("points"):
        data = survey.points
        return Points(
            from_contract(data["x"].values, data["y"].values, data["z"].values, axes),
            data["intensity"].values if "intensity" in data else None,
            data["time"].values if "time" in data else None,
        )
    rings = survey.rings
    ranges = rings["range"].values
    ring, reading = np.nonzero(np.isfinite(ranges))
    r, bearing = ranges[ring, reading].astype(np.float64), rings["bearing"].values[reading]
    return Points(
        from_contract(rings["distance"].values[ring], r * np.sin(bearing), r * np.cos(bearing), axes),
        rings["intensity"].values[ring, reading] if "intensity" in rings else None,
        rings["time"].values[ring] if "time" in rings else None,
    )
