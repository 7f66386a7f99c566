"""Where the pipe's axis runs, for formats with coordinates: as the layout has it, or drawn straight and said so."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError

if TYPE_CHECKING:
    from ...survey import Survey


@dataclass(frozen=True)
class Centreline:
    """The axis at its stations.

    Args:
        chainage: Of each station [m].
        easting: [m].
        northing: [m].
        elevation: [m]; NaN where it is not known.
        crs: Coordinate reference system; empty when the frame is local.
        frame: What the coordinates are, in words.
    """

    chainage: np.ndarray
    easting: np.ndarray
    northing: np.ndarray
    elevation: np.ndarray
    crs: str
    frame: str

    def at(self, chainage: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return easting, northing and elevation [m] at chainages, held at the ends."""
        return tuple(
            np.interp(chainage, self.chainage, values) for values in (self.easting, self.northing, self.elevation)
        )


def centreline(survey: Survey) -> Centreline | None:
    """Return the axis as the layout has it; None when no layout says where it runs."""
    if not survey.has("layout"):
        return None
    layout = survey.layout
    if any(name not in layout for name in ("chainage", "easting", "northing")):
        return None
    place = [layout[name].values.astype(float) for name in ("chainage", "easting", "northing")]
    known = np.isfinite(place).all(axis=0)
    if known.sum() < 2:
        return None
    elevation = layout["elevation"].values.astype(float) if "elevation" in layout else np.full(known.size, np.nan)
    tied = layout.attrs.get("frame", "ties") == "ties"
    crs = str(layout.attrs.get("crs") or survey.attrs.get("crs") or "") if tied else ""
    frame = "as the ties have it" if tied else "local: from the first ring, heading as the robot did"
    return Centreline(*(values[known] for values in (*place, elevation)), crs, frame)


def straight(survey: Survey) -> Centreline:
    """Return the axis drawn straight: easting is the chainage, northing 0, no elevation."""
    chainage = survey.section["chainage"].values.astype(float)
    zero = np.zeros_like(chainage)
    return Centreline(
        chainage, chainage, zero, np.full_like(chainage, np.nan), "", "local: the pipe drawn straight, x = chainage"
    )


def required_centreline(survey: Survey, what: str) -> Centreline:
    """Return the axis as the layout has it.

    Raises:
        InputError: No layout says where it runs; the reason that the survey gives is told.
    """
    found = centreline(survey)
    if found is not None:
        return found
    reasons = json.loads(survey.layout.attrs.get("why_missing", "{}")) if survey.has("layout") else {}
    reason = reasons.get("easting") or reasons.get("axis") or "there is no inertial log to find it from"
    raise InputError(
        f"{what} needs to know where the pipe runs, and {reason}",
        where=str(survey.attrs.get("name", "survey")),
        mend="record an inertial log and ties, or write .gpkg, which can draw the pipe straight and says so",
    )
