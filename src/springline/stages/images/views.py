"""Where the camera was in the pipe at every frame, and how well that is known."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from ...conventions import MASK_REASONS
from ...geometry.camera import camera_at
from ...geometry.robot import frame
from .along import in_order

if TYPE_CHECKING:
    from ...imaging.lens_table import MountedCamera
    from ...imaging.reprojection import PosePrior
    from ...survey import Survey

_WATER = next(code for code, name in MASK_REASONS.items() if name == "water")
_OFFSET = 0.01
_TURN = 0.004
_TILT = 0.02
ROLL_SIGMA = np.radians(2.0)
"""One-sigma of a robot's roll where nothing tells it; `features` allows as much."""
LEVEL_SIGMA = np.radians(0.3)
"""One-sigma of how level water or sediment lies."""
_WINDOW = 0.15
_FEWEST = 5


class Views(NamedTuple):
    """The camera at every frame.

    Attributes:
        x: (frame,) its chainage [m]; NaN where it is not known.
        station: (frame,) chainage of a ring taken at the same reading of the counter, where offsets and turns are
            known [m].
        eye: (frame, 3) chainage, height above and way right of the pipe's axis [m].
        axes: (frame, 3, 3) its forward, up and right in the pipe.
        half: (frame, 2) half widths of the pipe across and up [m].
        prior: How far offset and turn may be off.
        roll_sigma: One-sigma of its roll [rad].
        level: (ring,) the robot's roll by which what lies flat at the invert is level [rad]; None where `/pose` has
            the roll, or nothing lies flat.
    """

    x: np.ndarray
    station: np.ndarray
    eye: np.ndarray
    axes: np.ndarray
    half: np.ndarray
    prior: PosePrior
    roll_sigma: float
    level: np.ndarray | None

    def matrix(self, at: int) -> np.ndarray:
        """Return the camera's pose as `geometry.camera` has it."""
        return camera_at(self.eye[at], self.axes[at])


def views_of(survey: Survey, distance: np.ndarray, cameras: list[MountedCamera]) -> Views:
    """Return the views of frames.

    Args:
        survey: With `/rings`, `/mask`, `/pose`, `/section` and `/metrics`.
        distance: (frame,) what the counter read [m]; NaN = unknown.
        cameras: (frame,) each frame's camera.

    Unknown offsets and tilts are taken for none, with a prior as wide as robots tilt. Where roll is not known, what
    lies flat at the invert, water or sediment, is taken as level.
    """
    from ...imaging.reprojection import PosePrior

    section, metrics, rings, pose = survey.section, survey.metrics, survey.rings, survey.pose
    station, ring = section["distance"].values, rings["distance"].values
    x = _at(distance, station, section["chainage"].values, np.nan)
    # beyond the first and the last station the counter runs on
    x = x + distance - np.clip(distance, np.nanmin(station), np.nanmax(station))
    known = {name: bool(np.isfinite(pose[name].values).any()) for name in ("pitch", "yaw", "roll")}
    roll, roll_sigma = pose["roll"].values, _sigma(pose, "roll", ROLL_SIGMA)
    level = None if known["roll"] else level_roll(survey)
    if level is not None:
        roll, roll_sigma = level, LEVEL_SIGMA
    turns = [_at(distance, ring, values, 0.0) for values in (pose["pitch"].values, pose["yaw"].values, roll)]
    robot = frame(*turns)
    scanner = np.array([float(rings.attrs.get(f"position_{name}", 0.0)) for name in "xyz"])
    lever = np.array([camera.position for camera in cameras]).reshape(-1, 3) - scanner
    middle = np.stack([x, *(_at(distance, ring, pose[name].values, 0.0) for name in ("offset_y", "offset_z"))], -1)
    eye = middle + np.einsum("fi,fij->fj", lever, robot)
    axes = np.array([camera.axes for camera in cameras]).reshape(-1, 3, 3) @ robot
    half = np.stack([_at(distance, station, 0.5 * metrics[f"diameter_{name}"].values, np.nan) for name in "xy"], -1)
    radius = float(np.nanmedian(half))
    off = np.hypot(_sigma(pose, "offset_y", 0.0), _OFFSET * radius)
    tilt = _TILT if not (known["pitch"] and known["yaw"]) else np.hypot(_sigma(pose, "pitch", _TILT), _TURN)
    return Views(eye[:, 0], x, eye, axes, half, PosePrior(float(off), float(tilt)), float(roll_sigma), level)


def level_roll(survey: Survey) -> np.ndarray | None:
    """Return each ring's roll (ring,) by which what lies flat at the invert is level [rad]; None where nothing does.

    The readings on water or sediment are a straight line in the ring; it is level in the pipe, so its slope is the
    robot's roll. Rings within 0.15 m are taken together; between such places the roll is carried on evenly.
    """
    rings = survey.rings
    ranges, bearing = rings["range"].values, rings["bearing"].values
    on = (survey.mask["reason"].values == _WATER) & np.isfinite(ranges)
    count = on.sum(axis=1)
    if (count >= _FEWEST).mean() < 0.5:
        return None
    ranges = np.where(on, ranges, 0.0)
    z, y = ranges * np.cos(bearing), ranges * np.sin(bearing)
    share = np.maximum(count, 1)
    z_off, y_off = (np.where(on, v - (v.sum(axis=1) / share)[:, None], 0.0) for v in (z, y))
    spacing = float(np.median(np.diff(rings["distance"].values))) if len(count) > 1 else 1.0
    window = max(1, round(2.0 * _WINDOW / max(spacing, 1e-6)))
    along, across = (uniform_filter1d(np.where(count >= _FEWEST, s.sum(axis=1), 0.0), window, mode="nearest")
                     for s in (z_off * y_off, z_off**2))  # fmt: skip
    good = np.flatnonzero(across > 0)
    return np.interp(np.arange(len(count)), good, -np.arctan2(along[good], across[good]))


def _at(distance: np.ndarray, places: np.ndarray, values: np.ndarray, missing: float) -> np.ndarray:
    """Return what is known at `places` at each distance, `missing` where nothing is."""
    places, values = in_order(places, values)
    return np.interp(distance, places, values) if len(places) else np.full(len(distance), missing)


def _sigma(pose, name: str, missing: float) -> float:
    values = pose[f"{name}_sigma"].values if f"{name}_sigma" in pose else np.array([np.nan])
    return float(np.nanmedian(values)) if np.isfinite(values).any() else missing
