"""The frames of a survey, each with its camera."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from ...imaging.lens_table import MountedCamera
    from ...survey import Survey


class Filmed(NamedTuple):
    """Frames and cameras.

    Attributes:
        paths: (frame,) files, relative to `folder`.
        folder: Where they lie.
        distance: (frame,) what the counter read [m]; NaN where it is not known or the frame has no usable camera.
        usable: (frame,) whether the frame's camera takes plain pictures and is described.
        cameras: (frame,) each frame's camera; that of an unusable frame stands for nothing.
    """

    paths: np.ndarray
    folder: str
    distance: np.ndarray
    usable: np.ndarray
    cameras: list[MountedCamera]


def filmed(survey: Survey) -> Filmed | None:
    """Return the frames that plain cameras took; None without frames, or without a lens that is not a laser's.

    Raises:
        InputError: A lens table cannot be used.
    """
    if not survey.has("frames") or not survey.has("calibration"):
        return None
    from ...imaging.lens_table import cameras_of_calibration

    mounted = cameras_of_calibration(survey.calibration.attrs, laser=False)
    if not mounted:
        return None
    frames, only = survey.frames, next(iter(mounted))
    paths = frames["path"].values.astype(str)
    names = frames["lens"].values.astype(str) if "lens" in frames else np.full(len(paths), only)
    distance = frames["distance"].values if "distance" in frames else np.full(len(paths), np.nan)
    usable = np.isin(names, list(mounted))
    cameras = [mounted.get(name, mounted[only]) for name in names]
    return Filmed(paths, frames.attrs.get("folder", "."), np.where(usable, distance, np.nan), usable, cameras)
