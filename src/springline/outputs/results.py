"""A reader's view of a finished survey: sections at the rings, station lengths, sentences and provenance."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..conventions import NOT_SPEAKING, flagged
from ..errors import ContractError
from ..geometry.robot import frame

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr

    from ..survey import Survey
    from .units import System

_RING_BLOCK = 2048
_UNSEEN_COVERAGE = 0.5
_GAP = 3.0


def polar_radius(bearing: np.ndarray, semi_major: Any, semi_minor: Any, axis_bearing: Any) -> np.ndarray:
    """Return the radius of an ellipse about its own centre; all arguments broadcast.

    Args:
        bearing: Bearing about the centre [rad].
        semi_major: Semi-major axis [m].
        semi_minor: Semi-minor axis [m].
        axis_bearing: Bearing of the major axis [rad].

    >>> polar_radius(np.array([0.0, np.pi / 2]), 2.0, 1.0, 0.0)
    array([2., 1.])
    """
    phase = bearing - axis_bearing
    return semi_major * semi_minor / np.hypot(semi_minor * np.cos(phase), semi_major * np.sin(phase))


@dataclass(frozen=True)
class RingBlock:
    """Some consecutive rings with the section that each lies on; arrays are (ring, bearing) or (ring, 1)."""

    start: int
    range: np.ndarray
    reason: np.ndarray
    centre_y: np.ndarray
    centre_z: np.ndarray
    semi_major: np.ndarray
    semi_minor: np.ndarray
    axis_bearing: np.ndarray
    turn: np.ndarray
    """(ring, 2, 2): what the ring's own y and z are on the pipe's y and z; the identity where attitude is unknown."""

    def about_centre(self, bearing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return radius [m] and bearing [rad] of each reading about its section's centre; NaN where there is none."""
        y, z = self.in_pipe(self.range * np.sin(bearing) - self.centre_y, self.range * np.cos(bearing) - self.centre_z)
        return np.hypot(y, z), np.arctan2(y, z)

    def in_pipe(self, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return places in the rings' planes, seen along the pipe."""
        turn = self.turn[:, :, :, None]
        return turn[:, 0, 0] * y + turn[:, 0, 1] * z, turn[:, 1, 0] * y + turn[:, 1, 1] * z

    def fitted(self, bearing: np.ndarray) -> np.ndarray:
        """Return the fitted radius [m] at bearings [rad] about the centre."""
        return polar_radius(bearing, self.semi_major, self.semi_minor, self.axis_bearing)


class Results:
    """A finished survey, as tables, mesh, report and viewer read it.

    Args:
        survey: A survey with `/rings`, `/section` and `/metrics`; other groups are shown when they are there.

    Raises:
        ContractError: A group that an inspection makes is missing.
    """

    def __init__(self, survey: Survey) -> None:
        missing = [name for name in ("rings", "section", "metrics") if not survey.has(name)]
        if missing:
            raise ContractError(
                f"the survey is not finished: /{missing[0]} is missing",
                where="survey",
                mend="run springline.inspect on it first",
            )
        self.survey = survey

    def station(self, group: str, variable: str) -> np.ndarray:
        """Return a variable of a station group, NaN at every station when the survey does not have it."""
        if not self.survey.has(group) or variable not in self.survey.group(group).variables:
            return np.full(self.stations, np.nan)
        values = self.survey.group(group)[variable].values
        return values[self.ring_of_station] if group == "pose" else values

    def metric(self, variable: str) -> np.ndarray:
        """Return a variable of `/metrics`."""
        return self.station("metrics", variable)

    def judged(self, variable: str, group: str = "metrics") -> np.ndarray:
        """Return a variable of the stations that speak for the pipe, NaN at those flagged otherwise."""
        return np.where(self.speaks, self.station(group, variable), np.nan)

    @cached_property
    def speaks(self) -> np.ndarray:
        """Whether each station speaks for the pipe; one at a joint or misread does not."""
        if "flags" not in self.survey.section:
            return np.ones(self.stations, bool)
        return ~flagged(self.survey.section["flags"].values, *NOT_SPEAKING)

    def metrics_attr(self, name: str) -> float:
        """Return a number among the attributes of `/metrics`, NaN when it is not there."""
        value = self.survey.metrics.attrs.get(name)
        return float(value) if isinstance(value, int | float | np.number) else float("nan")

    @property
    def stations(self) -> int:
        """Number of stations."""
        return self.survey.section.sizes["station"]

    @cached_property
    def chainage(self) -> np.ndarray:
        """Chainage of each station [m]."""
        return self.survey.section["chainage"].values.astype(float)

    @cached_property
    def bearing(self) -> np.ndarray:
        """Bearings of the readings of every ring [rad]."""
        return self.survey.rings["bearing"].values.astype(float)

    @cached_property
    def status(self) -> np.ndarray:
        """Why each station has a section or has none; flags of `conventions.FIT_STATUS`."""
        return self.survey.section["status"].values

    @cached_property
    def coverage(self) -> np.ndarray:
        """Used over possible bearings of each station."""
        return self.station("section", "coverage")

    @cached_property
    def _nearest(self) -> tuple[np.ndarray, np.ndarray]:
        rings, stations = self.survey.rings.sizes["ring"], self.stations
        if rings == stations:
            return np.arange(stations), np.arange(rings)
        ring_at = self.survey.rings["distance"].values
        station_at = self.survey.section["distance"].values
        if not np.isfinite(station_at).all():
            station_at = self.chainage
        return _nearest(ring_at, station_at), _nearest(station_at, ring_at)

    @property
    def ring_of_station(self) -> np.ndarray:
        """The ring nearest to each station."""
        return self._nearest[0]

    @property
    def station_of_ring(self) -> np.ndarray:
        """The station nearest to each ring."""
        return self._nearest[1]

    @cached_property
    def spacing(self) -> float:
        """Typical distance between stations [m]; 0 for a single one."""
        steps = np.diff(self.chainage)
        return float(np.median(steps)) if steps.size else 0.0

    @cached_property
    def extents(self) -> tuple[np.ndarray, np.ndarray]:
        """Start and end of the length that each station stands for [m].

        Stations share the length between them, save where they lie more than three spacings apart: such a gap
        belongs to nobody.
        """
        steps = np.diff(self.chainage)
        half = np.where(steps > _GAP * self.spacing, self.spacing, steps) / 2
        before = np.concatenate(([0.0], half))
        after = np.concatenate((half, [0.0]))
        return self.chainage - before, self.chainage + after

    @cached_property
    def length(self) -> float:
        """Length from the first station to the last [m]."""
        return float(self.chainage[-1] - self.chainage[0])

    @cached_property
    def unseen(self) -> float:
        """Length of stations under 50 % coverage, and of gaps between stations [m]."""
        start, end = self.extents
        seen = np.nan_to_num(self.coverage) >= _UNSEEN_COVERAGE
        return max(0.0, self.length - float(np.sum((end - start)[seen])))

    def groups(self, most: int) -> np.ndarray:
        """Return the group of each station: neighbours joined until about `most` groups remain, never across a gap."""
        start, end = self.extents
        new_run = np.append(True, start[1:] > end[:-1] + 1e-9)
        run_start = np.maximum.accumulate(np.where(new_run, np.arange(start.size), 0))
        joined = -(-start.size // most)
        return np.cumsum((np.arange(start.size) - run_start) % joined == 0) - 1

    @cached_property
    def reason_counts(self) -> dict[int, int]:
        """How many readings carry each flag of `conventions.MASK_REASONS`."""
        counts = np.zeros(256, np.int64)
        for block in self.blocks():
            counts += np.bincount(block.reason.ravel(), minlength=256)
        return {int(flag): int(counts[flag]) for flag in np.flatnonzero(counts)}

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """Program version, resolved configuration and input files."""
        return json.loads(self.survey.attrs.get("provenance", "{}"))

    @property
    def units(self) -> System:
        """System of units in which people read the results: that of the run's configuration."""
        return self.provenance.get("config", {}).get("outputs", {}).get("units", "si")

    @cached_property
    def circle_diameter(self) -> float:
        """Diameter of the circle that shape is drawn against [m]: the mean one, or twice the median range."""
        mean = self.metrics_attr("diameter_mean")
        if np.isfinite(mean):
            return mean
        area = self.metric("diameter_area")
        if np.isfinite(area).any():
            return float(np.nanmedian(area))
        ranges = self.survey.rings["range"]
        rows = np.linspace(0, ranges.shape[0] - 1, min(64, ranges.shape[0])).astype(int)
        return 2.0 * float(np.nanmedian(ranges[np.unique(rows)].values))

    def blocks(self, rows: np.ndarray | None = None) -> Iterator[RingBlock]:
        """Yield the rings in blocks, each with its section; of the rings in `rows` alone when given.

        Memory stays at a few megabytes whatever the length of the survey.
        """
        ranges = self.survey.rings["range"]
        reasons = self.survey.mask["reason"] if self.survey.has("mask") else None
        count = ranges.shape[0] if rows is None else rows.size
        shape = [
            np.asarray(values, float)[:, None]
            for values in (
                self.station("section", "centre_y"),
                self.station("section", "centre_z"),
                self.metric("semi_major"),
                self.metric("semi_minor"),
                self.metric("axis_bearing"),
            )
        ]
        for start in range(0, count, _RING_BLOCK):
            stop = min(start + _RING_BLOCK, count)
            take = slice(start, stop) if rows is None else rows[start:stop]
            block = ranges[take].values.astype(float)
            reason = (~np.isfinite(block)).astype(np.uint8) if reasons is None else reasons[take].values
            at = self.station_of_ring[take]
            yield RingBlock(start, block, reason, *(values[at] for values in shape), self._turn(take))

    def _turn(self, rows: slice | np.ndarray) -> np.ndarray:
        """Return what the rings' own y and z are on the pipe's (ring, 2, 2)."""
        known = self.survey.has("pose") and {"pitch", "yaw", "roll"} <= set(self.survey.pose.variables)
        if not known or self.survey.rings.attrs.get("referred_to") == "axis":
            return np.broadcast_to(np.eye(2), (len(self.survey.rings["distance"][rows]), 2, 2))
        attitude = np.stack([self.survey.pose[name].values[rows] for name in ("pitch", "yaw", "roll")])
        # A ring whose attitude is unknown stands as it was seen.
        frames = frame(*np.where(np.isfinite(attitude).all(axis=0), attitude, 0.0))
        return np.swapaxes(frames[:, 1:, 1:], 1, 2)


def _nearest(axis: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return the index into the increasing `axis` that lies nearest to each wanted value."""
    after = np.clip(np.searchsorted(axis, wanted), 1, max(axis.size - 1, 1))
    if axis.size == 1:
        return np.zeros(wanted.size, int)
    return np.where(wanted - axis[after - 1] <= axis[after] - wanted, after - 1, after)


def worst_station(values: np.ndarray) -> int | None:
    """Return the station with the largest value, None when no station has one."""
    return int(np.nanargmax(values)) if np.isfinite(values).any() else None


def feature_count(survey: Survey) -> int | None:
    """Return how many features were found, None when nobody looked for any."""
    return survey.features.sizes.get("feature", 0) if survey.has("features") else None


def text(data: xr.Dataset, variable: str, count: int) -> list[str]:
    """Return a text variable as strings, empty where it is missing."""
    if variable not in data.variables:
        return [""] * count
    return ["" if v is None or v != v else str(v) for v in data[variable].values.tolist()]
