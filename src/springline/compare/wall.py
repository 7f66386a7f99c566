"""The wall of one inspection as a map: how far it stands outside its fitted section, by chainage and bearing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..conventions import MASK_REASONS
from ..errors import ContractError
from ..geometry.measures import polar_radius
from ..geometry.robot.attitude import frame
from .edges import joint_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..survey import Survey

_MOST_ROWS = 180
_BLOCK = 2048
_LATERAL = next(code for code, name in MASK_REASONS.items() if name == "lateral")
_TILT, _TILT_ESTIMATED = np.radians(2.0), np.radians(1.0)
_SETTLE = 1.0  # s over which gravity is averaged


@dataclass(frozen=True)
class Wall:
    """The wall seen in one inspection, on equal bearings about the middle of its section.

    Attributes:
        chainage: (n,) of each ring [m], rising.
        surface: (n, m) how far the wall stands outside the fitted section [m], float32, at bearings 2 pi k / m; NaN
            where nothing was seen.
        count: (n, m) readings behind each cell, uint8.
        opening: (n, m) whether a reading of the cell fell into an opening of the wall, such as a lateral.
        parameters: (n, 3) mean_radius, oval_cos, oval_sin of the fitted section [m]; NaN where there is none.
        variance: (n, 2) of mean_radius, and the mean of those of oval_cos and oval_sin [m2]; of the fit alone.
        noise: One-sigma of one reading about its section [m], as its usual ring has it.
        roll_source: Where the bearings' vertical comes from: `pose`, `gravity`, or `sensor` when the sensor's own zero
            is taken for it.
        name: What messages call the inspection.
    """

    chainage: NDArray[np.float64]
    surface: NDArray[np.float32]
    count: NDArray[np.uint8]
    opening: NDArray[np.bool_]
    parameters: NDArray[np.float64]
    variance: NDArray[np.float64]
    noise: float
    roll_source: str
    name: str

    @property
    def bearing(self) -> NDArray[np.float64]:
        """Bearings of the cells' middles (m,) [rad]."""
        return np.arange(self.surface.shape[1]) * (2 * np.pi / self.surface.shape[1])

    @property
    def extent(self) -> tuple[float, float]:
        """First and last chainage [m]."""
        return float(self.chainage[0]), float(self.chainage[-1])

    @property
    def spacing(self) -> float:
        """Usual distance between rings [m]."""
        return float(np.median(np.diff(self.chainage)))

    @property
    def radius(self) -> float:
        """Usual mean radius [m]."""
        return float(np.nanmedian(self.parameters[:, 0]))

    @cached_property
    def at_joint(self) -> NDArray[np.bool_]:
        """Whether each ring (n,) stands out from those beside it as a joint does."""
        seen = np.isfinite(self.surface)
        return joint_rows(np.where(seen, self.surface, 0.0), seen, self.parameters, self.spacing)

    @property
    def tilt_sigma(self) -> float:
        """One-sigma of what is not known of the sensor's tilt [rad]: less where it was estimated."""
        return float(_TILT_ESTIMATED if self.roll_source == "pose" else _TILT)

    def upright(self) -> bool:
        """Return whether the vertical of the bearings was measured."""
        return self.roll_source != "sensor"

    def mirrored(self, extent: tuple[float, float] | None = None) -> Wall:
        """Return the wall as seen driving the other way: chainage to first + last less itself, bearing to pi less it.

        Args:
            extent: First and last chainage to mirror about [m]; those of the rings when not given.
        """
        first, last = extent or self.extent
        rows = self.surface.shape[1]
        turned = (rows // 2 - np.arange(rows)) % rows
        return replace(
            self,
            chainage=(first + last) - self.chainage[::-1],
            surface=self.surface[::-1][:, turned],
            count=self.count[::-1][:, turned],
            opening=self.opening[::-1][:, turned],
            parameters=self.parameters[::-1] * [1.0, 1.0, -1.0],
            variance=self.variance[::-1],
        )


def wall_of(survey: Survey) -> Wall:
    """Return the wall of a finished survey.

    Readings are put about the middle of their section, turned upright where roll is known, and averaged in equal
    bearings, at most 180 of an even number: half as many as a ring has readings.

    Args:
        survey: With `/rings`, `/section` and, when readings were set aside, `/mask`.

    Raises:
        ContractError: A group is missing, or there are fewer than two rings.
    """
    name = str(survey.attrs.get("name") or "survey")
    for group in ("rings", "section"):
        if not survey.has(group):
            raise ContractError(f"the survey has no /{group}", where=name, mend="run springline.inspect on it first")
    rings, section = survey.rings, survey.section
    if rings.sizes["ring"] < 2:
        raise ContractError("it holds a single ring", where=name, expected="at least two, to lie along a pipe")
    distance = rings["distance"].values.astype(float)
    at = _station_of_ring(survey, distance)
    parameters = section["parameters"].values.astype(float)[at]
    centre = np.column_stack([section[f"centre_{axis}"].values.astype(float)[at] for axis in "yz"])
    turn, roll, source = _attitude(survey)
    rows = max(2 * (min(rings.sizes["bearing"] // 2, _MOST_ROWS) // 2), 8)
    surface, count, opening = _binned(survey, parameters, centre, turn, rows, roll)
    noise = float(np.nanmedian(section["noise"].values)) if "noise" in section else np.nan
    chainage = section["chainage"].values.astype(float)
    along = chainage if len(chainage) == len(distance) else np.interp(distance, _distances(survey), chainage)
    covariance = section["covariance"].values.astype(float)[at]
    variance = np.column_stack((covariance[:, 0, 0], 0.5 * (covariance[:, 1, 1] + covariance[:, 2, 2])))
    return Wall(along, surface, count, opening, _turned(parameters, roll), variance, noise, source, name)


def _distances(survey: Survey) -> NDArray[np.float64]:
    """Return distance of each station [m], its chainage where the odometer did not count."""
    distance = survey.section["distance"].values.astype(float)
    return distance if np.isfinite(distance).all() else survey.section["chainage"].values.astype(float)


def _station_of_ring(survey: Survey, distance: NDArray[np.float64]) -> NDArray[np.int64]:
    stations = survey.section.sizes["station"]
    if stations == distance.size:
        return np.arange(stations)
    at = _distances(survey)
    return np.clip(np.searchsorted(0.5 * (at[1:] + at[:-1]), distance), 0, stations - 1)


def _attitude(survey: Survey) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
    """Return what the rings' y and z are on the pipe's (n, 2, 2), a roll (n,) [rad] on top, and where they come from.

    Where the attitude was estimated the sections stand in the pipe's frame already; a roll by gravity turns them too.
    """
    count = survey.rings.sizes["ring"]
    turn, roll = np.broadcast_to(np.eye(2), (count, 2, 2)), np.zeros(count)
    if survey.rings.attrs.get("referred_to") == "axis":
        return turn, roll, "sensor"
    if survey.has("pose") and {"pitch", "yaw", "roll"} <= set(survey.pose.variables):
        attitude = np.stack([survey.pose[name].values.astype(float) for name in ("pitch", "yaw", "roll")])
        known = np.isfinite(attitude).all(axis=0)
        if known.any():
            frames = frame(*np.where(known, attitude, 0.0))
            return np.swapaxes(frames[:, 1:, 1:], 1, 2), roll, "pose"
    if survey.has("inertial") and "time" in survey.rings:
        found = _gravity(survey)
        if found is not None:
            return turn, found, "gravity"
    return turn, roll, "sensor"


def _gravity(survey: Survey) -> NDArray[np.float64] | None:
    """Return each ring's roll [rad] by the vertical that the inertial unit felt; None without one."""
    from scipy.ndimage import uniform_filter1d

    inertial, when = survey.inertial, survey.rings["time"].values.astype(float)
    time = inertial["time"].values.astype(float)
    if not np.isfinite(when).all() or time.size < 2:
        return None
    if "bank" in inertial:
        return -np.interp(when, time, np.unwrap(inertial["bank"].values.astype(float)))
    if "accel" not in inertial:
        return None
    width = max(1, round(_SETTLE / float(np.median(np.diff(time)))))
    up, right = (uniform_filter1d(inertial["accel"].values[:, k].astype(float), width) for k in (1, 2))
    return np.interp(when, time, np.unwrap(np.arctan2(right, up)))


def _turned(parameters: NDArray[np.float64], roll: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return section parameters (n, 3) with bearings turned by roll (n,) [rad]."""
    mean, c, s = parameters.T
    cos, sin = np.cos(2 * roll), np.sin(2 * roll)
    return np.column_stack((mean, c * cos - s * sin, c * sin + s * cos))


def _binned(
    survey: Survey, parameters: NDArray, centre: NDArray, turn: NDArray, rows: int, roll: NDArray
) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.bool_]]:
    """Return (ring, rows) mean departure from the section, number of readings, and openings, block by block."""
    ranges = survey.rings["range"]
    reasons = survey.mask["reason"] if survey.has("mask") else None
    bearing = survey.rings["bearing"].values.astype(float)
    n = ranges.shape[0]
    surface, count = np.full((n, rows), np.nan, np.float32), np.zeros((n, rows), np.uint8)
    opening = np.zeros((n, rows), bool)
    holes = survey.candidates["opening"] if survey.has("candidates") and "opening" in survey.candidates else None
    for start in range(0, n, _BLOCK):
        part = slice(start, min(start + _BLOCK, n))
        r = ranges[part].values.astype(float)
        hole = np.zeros(r.shape, bool)
        if holes is not None and holes.shape == ranges.shape:
            hole |= holes[part].values > 0
        if reasons is not None:
            hole |= reasons[part].values == _LATERAL
            r = np.where((reasons[part].values == 0) | hole, r, np.nan)
        y = r * np.sin(bearing) - centre[part, :1]
        z = r * np.cos(bearing) - centre[part, 1:]
        t = turn[part, :, :, None]
        y, z = t[:, 0, 0] * y + t[:, 0, 1] * z, t[:, 1, 0] * y + t[:, 1, 1] * z
        phi = np.arctan2(y, z)
        departure = np.hypot(y, z) - polar_radius(parameters[part, None, :], phi)
        seen = np.isfinite(departure) & ~hole
        cell = np.rint((np.nan_to_num(phi) + roll[part, None]) * (rows / (2 * np.pi))).astype(np.int64) % rows
        cell += np.arange(len(r))[:, None] * rows
        size = len(r) * rows
        found = np.bincount(cell[seen], minlength=size)
        total = np.bincount(cell[seen], weights=departure[seen], minlength=size)
        with np.errstate(invalid="ignore"):
            mean = np.where(found > 0, total / found, np.nan)
        surface[part] = mean.reshape(-1, rows)
        opening[part] = np.bincount(cell[hole], minlength=size).reshape(-1, rows) > 0
        count[part] = np.minimum(found, 255).reshape(-1, rows)
    return surface, count, opening
