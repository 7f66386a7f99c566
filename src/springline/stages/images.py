"""Images: frames confirm, refine or add to what rings show; without rings' candidates there is nothing to look for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..conventions import GROUPS
from ..errors import InputError, MissingExtraError
from ..survey import add_warning

if TYPE_CHECKING:
    from ..config import Config
    from ..imaging.lens_table import MountedCamera
    from ..imaging.sightings import Sighting
    from ..survey import Survey

_OFFSET_SIGMA, _TURN_SIGMA = 0.02, 0.01
_WITHIN = 0.3
_WITHIN_BEARING = 0.3
_NAMED = 5
_LEAST_HALF_VIEW = 0.3


def images(survey: Survey, config: Config) -> Survey:
    """Return the survey with what its frames show added to `/candidates` and `/features`.

    Rings propose places; for each the frames are looked at in which it stands in good view (6.5), with lens and pose.
    What rings and images both show is one feature with the source `both`; what images show and rings do not stands
    with the source `images`. A frame that cannot be used is named in a warning.

    Args:
        survey: With `/candidates`, `/features`, `/section` and `/pose`; unchanged without `/frames` or a lens.
        config: `detect.least_confidence`.

    Raises:
        InputError: A lens table cannot be used.

    Source: dissertation 6.4 and 6.5.
    """
    mounted = _cameras(survey)
    if not mounted or not survey.has("features") or not np.isfinite(_radius(survey)):
        return survey
    try:
        seen, warnings = _sightings(survey, mounted)
    except MissingExtraError as missing:
        return add_warning(survey, f"The frames were not looked at: {missing}")
    if warnings:
        survey = add_warning(survey, *warnings)
    sure = [(one, image) for one, image in seen if one.probability >= config.detect.least_confidence]
    survey = survey.corrected("candidates", _with_candidates(survey, seen))
    return survey.corrected("features", _with_features(survey, sure))


def _radius(survey: Survey) -> float:
    """The pipe's usual radius; NaN where no station has one."""
    width = 0.5 * (survey.metrics["diameter_x"].values + survey.metrics["diameter_y"].values)
    width = width[np.isfinite(width)]
    return 0.5 * float(np.median(width)) if len(width) else np.nan


def _cameras(survey: Survey) -> dict[str, MountedCamera]:
    """Lenses of the survey that take plain pictures, by name."""
    from ..imaging.lens_table import cameras_of_calibration

    if not survey.has("frames") or not survey.has("calibration"):
        return {}
    return cameras_of_calibration(survey.calibration.attrs, laser=False)


def _sightings(survey: Survey, mounted: dict[str, MountedCamera]) -> tuple[list[tuple[Sighting, str]], list[str]]:
    """What the chosen frames show, each with the file of its best frame; and warnings."""
    from ..geometry.camera import camera_at
    from ..geometry.robot import frame
    from ..imaging.moving import each_frame
    from ..imaging.reprojection import PosePrior
    from ..imaging.sightings import put_together
    from ..imaging.wall import marks_of_frame

    frames = survey.frames
    paths = frames["path"].values.astype(str)
    distance = frames["distance"].values if "distance" in frames else np.full(len(paths), np.nan)
    names = frames["lens"].values.astype(str) if "lens" in frames else np.full(len(paths), next(iter(mounted)))
    usable = np.isin(names, list(mounted))
    troubles = [f"{path} (it has no distance)" for path in paths[usable & np.isnan(distance)]]
    poses = _poses(survey, np.where(usable, distance, np.nan))
    camera = mounted[names[usable][0]] if usable.any() else next(iter(mounted.values()))
    x = poses["x"] + camera.position[0] - float(survey.rings.attrs.get("position_x", 0.0))
    radius = _radius(survey)
    chosen = _chosen(survey, x, camera, radius)
    prior = PosePrior(_OFFSET_SIGMA * radius, _TURN_SIGMA)
    marks = []
    for k, picture in each_frame(paths[chosen], frames.attrs.get("folder", ".")):
        at = chosen[k]
        camera = mounted[names[at]]
        try:
            if isinstance(picture, InputError):
                raise picture
            if picture.shape[1::-1] != camera.size:
                raise InputError(f"it is {picture.shape[1]} by {picture.shape[0]}, its lens {camera.size}")
        except InputError as refusal:
            troubles.append(f"{paths[at]} ({refusal.what})")
            continue
        turn = [poses[name][at] for name in ("pitch", "yaw", "roll")]
        tilted = frame(turn[0] + camera.pitch, turn[1] + camera.yaw, turn[2] + camera.roll)
        eye = [x[at], poses["offset_y"][at] + camera.position[1], poses["offset_z"][at] + camera.position[2]]
        half = (poses["half_z"][at], poses["half_y"][at])
        found = marks_of_frame(picture, camera_at(eye, tilted), camera.lens, camera.centre, *half, prior=prior)
        marks += [(int(at), mark) for mark in found]
    warnings = []
    if troubles:
        more = f" and {len(troubles) - _NAMED} more" if len(troubles) > _NAMED else ""
        warnings = [
            f"{len(troubles)} of {int(usable.sum())} frames were left out: {'; '.join(troubles[:_NAMED])}{more}."
        ]
    sightings = put_together(marks, x[chosen], radius)
    return [(one, str(paths[one.frames[0]])) for one in sightings], warnings


def _poses(survey: Survey, distance: np.ndarray) -> dict[str, np.ndarray]:
    """Chainage, pose and half widths at the frames' distances; unknown offsets and tilts are taken for none."""
    section, metrics, rings, pose = survey.section, survey.metrics, survey.rings, survey.pose
    station, ring = section["distance"].values, rings["distance"].values

    def at(places: np.ndarray, values: np.ndarray, missing: float) -> np.ndarray:
        good = np.isfinite(values) & np.isfinite(places)
        order = np.argsort(places[good])
        if not good.any():
            return np.full(len(distance), missing)
        return np.interp(distance, places[good][order], values[good][order])

    found = {"x": at(station, section["chainage"].values, np.nan)}
    # beyond the first and the last station the counter runs on
    beyond = distance - np.clip(distance, np.nanmin(station), np.nanmax(station))
    found["x"] = found["x"] + beyond
    for name in ("offset_y", "offset_z", "pitch", "yaw", "roll"):
        found[name] = at(ring, pose[name].values, 0.0)
    found["half_z"] = at(station, 0.5 * metrics["diameter_x"].values, np.nan)
    found["half_y"] = at(station, 0.5 * metrics["diameter_y"].values, np.nan)
    return found


def _chosen(survey: Survey, x: np.ndarray, camera: MountedCamera, radius: float) -> np.ndarray:
    """Frames in which the joints and laterals that rings show stand in good view."""
    from ..imaging.choosing import Bias, choose_frames

    shorter = 0.5 * min(camera.size)
    half = float(np.nan_to_num(camera.lens.zenith(shorter), nan=camera.lens.max_zenith))
    bias = Bias.of_view(radius, float(np.clip(half, _LEAST_HALF_VIEW, 1.2)))
    shown = np.isin(survey.features["kind"].values.astype(str), ("joint", "lateral"))
    return choose_frames(x, survey.features["chainage"].values[shown], bias)[0]


def _with_candidates(survey: Survey, seen: list[tuple[Sighting, str]]) -> xr.Dataset:
    """`/candidates` with a row for everything that images show, by the counter's distance."""
    section = survey.section
    rows = [
        {
            "kind": one.kind,
            "source": "images",
            "image": image,
            "distance": float(np.interp(one.x, section["chainage"].values, section["distance"].values)),
            "distance_sigma": one.x_sigma,
            "bearing": one.bearing,
            "bearing_sigma": one.bearing_sigma,
            "size": 2.0 * one.radius,
            "size_sigma": 2.0 * one.radius_sigma,
            "score": np.sqrt(2.0 * max(one.log_odds, 0.0)),
            "probability": one.probability,
            "first_ring": -1,
            "last_ring": -1,
        }
        for one, image in seen
    ]
    return _longer(survey.candidates, "candidate", rows)


def _with_features(survey: Survey, sure: list[tuple[Sighting, str]]) -> xr.Dataset:
    """`/features` with images added: to what rings show too, and on their own where rings show nothing."""
    data = survey.features.copy(deep=True)
    kind, chainage = data["kind"].values.astype(str), data["chainage"].values
    radius = _radius(survey)
    source, image = data["source"].values.astype("U64"), data["image"].values.astype("U64")
    confidence = data["confidence"].values.copy()
    rows = []
    for one, file in sure:
        near = (
            (kind == one.kind) & (np.abs(chainage - one.x) < _WITHIN * radius + 2.0 * one.x_sigma) & (source == "rings")
        )
        if one.kind == "lateral":
            turn = (data["bearing"].values - one.bearing + np.pi) % (2.0 * np.pi) - np.pi
            near &= np.abs(turn) < _WITHIN_BEARING
        if near.any():
            at = int(np.argmin(np.where(near, np.abs(chainage - one.x), np.inf)))
            source[at], image[at] = "both", file
            confidence[at] = 1.0 - (1.0 - confidence[at]) * (1.0 - one.probability)
            continue
        rows.append(
            {
                "kind": one.kind,
                "source": "images",
                "image": file,
                "chainage": one.x,
                "chainage_sigma": one.x_sigma,
                "bearing": one.bearing,
                "bearing_sigma": one.bearing_sigma,
                "size": 2.0 * one.radius,
                "size_sigma": 2.0 * one.radius_sigma,
                "confidence": one.probability,
                "first_ring": -1,
                "last_ring": -1,
            }
        )
    data = data.assign(source=("feature", source), image=("feature", image), confidence=("feature", confidence))
    data = _longer(data, "feature", rows)
    return data.isel(feature=np.argsort(data["chainage"].values, kind="stable"))


def _longer(data: xr.Dataset, along: str, rows: list[dict[str, object]]) -> xr.Dataset:
    """The dataset with rows added along a dimension; what they do not say is NaN or empty."""
    if not rows:
        return data
    listed = GROUPS["candidates" if along == "candidate" else "features"].variables
    words, counts = ({v.name for v in listed if v.dtype == dtype} for dtype in ("str", "int64"))
    out = {}
    # a variable that bears a dimension's name stands among the coordinates
    for name, values in data.variables.items():
        if values.dims != (along,):
            out[name] = values
        elif name in words:
            added = np.array([str(row.get(name, "")) for row in rows])
            out[name] = (along, np.concatenate([values.values.astype(str), added]), values.attrs)
        else:
            added = np.array([row.get(name, -1 if name in counts else np.nan) for row in rows], dtype=float)
            kept = np.concatenate([values.values.astype(float), added])
            out[name] = (along, kept.astype(np.int64) if name in counts else kept, values.attrs)
    return xr.Dataset(out, attrs=data.attrs)
