"""Ring video: frames in which a laser ring is seen become rings; surveys that have rings pass through."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from springline.errors import InputError, listed
from springline.survey import add_warning

if TYPE_CHECKING:
    from springline.config import Config
    from springline.imaging.lens_table import MountedCamera
    from springline.survey import Survey

_NAMED = 5


def ring_video(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/rings` read from the frames of a laser ring.

    Frames whose lens states `laser_ahead_m` show a ring. Each becomes one ring about the point where the robot's
    forward direction from the camera meets the laser plane; `distance` stays that of the camera, and the attribute
    `position_x` says how far ahead of it the ring lies. A frame that cannot be read, has no distance or shows no ring
    is named in a warning; one that shows none stays as a ring without readings.

    Args:
        survey: Anything; only one with `/frames`, and without `/rings` and `/points`, is changed.
        config: `rings.bearings`.

    Raises:
        InputError: No frame shows a ring, or a lens table cannot be used.
        MissingExtraError: OpenCV is not installed, or PyAV for frames of a video.
    """
    if survey.has("rings") or survey.has("points") or not survey.has("frames"):
        return survey
    name, camera = _laser_camera(survey)
    if camera is None:
        return survey
    frames = survey.frames
    shown = frames["lens"].values == name if "lens" in frames else np.ones(frames.sizes["frame"], dtype=bool)
    distance = frames["distance"].values if "distance" in frames else np.full(len(shown), np.nan)
    used = np.flatnonzero(shown & np.isfinite(distance))
    troubles = [f"{frames['path'].values[k]} (it has no distance)" for k in np.flatnonzero(shown & np.isnan(distance))]
    ranges, kept = _read(survey, camera, used, config.rings.bearings, troubles)
    if not np.isfinite(ranges).any():
        raise InputError(
            "no frame shows a laser ring",
            where=survey.attrs.get("name", "survey"),
            expected=f"frames of the lens '{name}' with a ring of light once round",
            mend=f"check them against the list: {listed(troubles, _NAMED)}" if troubles else None,
        )
    if troubles:
        survey = add_warning(
            survey, f"{len(troubles)} of {int(shown.sum())} frames gave no ring: {listed(troubles, _NAMED)}."
        )
    return survey.with_group("rings", _dataset(frames, used[kept], ranges[kept], camera))


def _laser_camera(survey: Survey) -> tuple[str, MountedCamera | None]:
    from springline.imaging.lens_table import cameras_of_calibration

    lasers = cameras_of_calibration(survey.calibration.attrs, laser=True) if survey.has("calibration") else {}
    if not lasers:
        return "", None
    if len(lasers) > 1:
        raise InputError(
            f"{len(lasers)} lenses have a laser ring: {', '.join(sorted(lasers))}",
            where=survey.attrs.get("name", "survey"), expected="one", mend="inspect the frames of one at a time",
        )  # fmt: skip
    ((name, camera),) = lasers.items()
    return name, camera


def _read(
    survey: Survey, camera: MountedCamera, used: np.ndarray, bearings: int, troubles: list[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Return (frame, bearing) ranges, and (frame,) whether a frame was read at all; adds to `troubles`."""
    from springline.imaging.moving import each_frame
    from springline.imaging.ring_video import RingReader

    reader = RingReader(camera, bearings=bearings)
    paths = [str(path) for path in survey.frames["path"].values[used]]
    ranges = np.full((len(used), bearings), np.nan, dtype=np.float32)
    kept = np.ones(len(used), dtype=bool)
    for k, picture in each_frame(paths, survey.frames.attrs.get("folder", ".")):
        try:
            if isinstance(picture, InputError):
                raise picture
            reading = reader.read(picture)
        except InputError as refusal:
            troubles.append(f"{paths[k]} ({refusal.what})")
            kept[k] = False
            continue
        ranges[k] = reading.range
        if not reading:
            troubles.append(f"{paths[k]} ({reading.reason})")
    return ranges, kept


def _dataset(frames: xr.Dataset, rows: np.ndarray, ranges: np.ndarray, camera: MountedCamera) -> xr.Dataset:
    count = ranges.shape[1]
    variables = {
        "range": (("ring", "bearing"), ranges),
        "distance": ("ring", frames["distance"].values[rows]),
    }
    if "time" in frames:
        variables["time"] = ("ring", frames["time"].values[rows])
    ahead, up, right = camera.position
    return xr.Dataset(
        variables,
        coords={"bearing": np.arange(count) * 2.0 * np.pi / count},
        attrs={
            "referred_to": "sensor",
            "distance_source": "odometer",
            "sensor_kind": "ring-laser",
            "position_x": ahead + float(camera.laser_ahead or 0.0),
            "position_y": up,
            "position_z": right,
        },
    )
