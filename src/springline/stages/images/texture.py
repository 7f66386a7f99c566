"""Texture: the frames of a survey laid on its corrected wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ...errors import MissingExtraError, listed
from ...survey import add_warning
from .along import in_order
from .filmed import filmed
from .views import views_of

if TYPE_CHECKING:
    from ...config import Config
    from ...imaging.texture import Surface, Texture, View
    from ...survey import Survey
    from .filmed import Filmed

    Array = np.ndarray

_CELLS = 8_000_000
_DOZENS = (15, 120)
_FAR = 1.5
_FARTHEST = 5.0
_LEAST_HALF_VIEW = 0.3
_BRIDGED = 1.0
_NAMED = 5


def texture(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/texture`: the wall's colours by chainage and bearing, from its frames.

    Every frame is projected onto the fitted sections, along the axis as it bends, from where the robot's pose puts its
    camera; neighbouring frames are blended and the lamp's fall of light is taken away. Stations without a section are
    bridged over one diameter; what no frame shows stays black and unseen.

    Args:
        survey: With `/section` and `/pose`; unchanged without `/frames`, a lens, or a single usable frame.
        config: `texture.cell`, and `texture.lay`.

    Raises:
        InputError: A lens table cannot be used.
    """
    film = filmed(survey) if config.texture.lay else None
    if film is None or not np.isfinite(survey.section["parameters"].values[:, 0]).any():
        return survey
    from ...imaging.moving import each_frame
    from ...imaging.texture import lay_frames

    surface = _surface(survey, config.texture.cell)
    numbers, views = _views(survey, film)
    paths = film.paths[numbers]
    near, far = _reach(views, float(np.nanmedian(surface.parameters[:, 0])))
    try:
        laid = lay_frames(surface, views, lambda chosen: each_frame(paths[chosen], film.folder), near, far)
    except MissingExtraError as missing:
        return add_warning(survey, f"The frames were not laid on the wall: {missing}")
    if laid.refused:
        names = [f"{paths[k]} ({why})" for k, why in laid.refused]
        survey = add_warning(survey, f"Frames that could not be laid on the wall: {listed(names, _NAMED)}.")
    if not laid.seen.any():
        return survey
    return survey.with_group("texture", _group(surface, laid))


def _surface(survey: Survey, cell: float) -> Surface:
    """The wall at rows of about `cell` [m], coarser where that were too many."""
    from ...imaging.texture import Surface

    section = survey.section
    place, shape = in_order(section["chainage"].values, section["parameters"].values)
    round_wall = 2.0 * np.pi * float(np.median(shape[:, 0]))
    length = max(float(place[-1] - place[0]), cell)
    cell = max(cell, float(np.sqrt(length * round_wall / _CELLS)))
    x = place[0] + cell * (0.5 + np.arange(max(int(length / cell), 1)))
    # as many as go into halves and thirds, which coarser pictures join
    columns = 12 * int(np.clip(round(round_wall / cell / 12), *_DOZENS))
    parameters = np.stack([np.interp(x, place, shape[:, k]) for k in range(3)], axis=-1)
    after = np.clip(np.searchsorted(place, x), 1, max(len(place) - 1, 1))
    if len(place) > 1:
        parameters[place[after] - place[after - 1] > _BRIDGED * round_wall / np.pi] = np.nan
    return Surface(x, parameters, *_directions(survey, x), 2.0 * np.pi * np.arange(columns) / columns)


def _directions(survey: Survey, x: Array) -> tuple[Array, Array]:
    """Heading and climb of the axis [rad]; straight where the layout is not known."""
    if not survey.has("layout") or "heading" not in survey.layout:
        return np.zeros_like(x), np.zeros_like(x)
    place, heading, climb = in_order(*(survey.layout[name].values for name in ("chainage", "heading", "gradient")))
    if not len(place):
        return np.zeros_like(x), np.zeros_like(x)
    return np.interp(x, place, np.unwrap(heading)), np.arctan(np.interp(x, place, climb))


def _views(survey: Survey, film: Filmed) -> tuple[Array, list[View]]:
    """Numbers of the frames whose camera and place are known, and from where each was taken."""
    from ...geometry.camera import camera_at
    from ...imaging.texture import View

    found = views_of(survey, film.distance, film.cameras)
    numbers = np.flatnonzero(np.isfinite(found.x))
    # about the station of the ring, from which the axis may bend on the way to the camera
    eye = found.eye - np.stack([found.station, *np.zeros((2, len(found.x)))], axis=-1)
    return numbers, [View(float(found.station[k]), camera_at(eye[k], found.axes[k]), film.cameras[k]) for k in numbers]


def _reach(views: list[View], radius: float) -> tuple[float, float]:
    """Which wall ahead of a camera is taken: from where it enters view, as far as the next frame asks for."""
    if not views:
        return 0.0, radius
    camera = views[0].camera
    half = float(np.nan_to_num(camera.lens.zenith(0.5 * max(camera.size)), nan=camera.lens.max_zenith))
    near = radius / np.tan(np.clip(half, _LEAST_HALF_VIEW, 1.4))
    apart = np.diff(np.sort([view.foot for view in views]))
    step = float(np.median(apart)) if len(apart) else 0.0
    # the wall all round enters view later, where the picture's shorter side begins to show it
    short = float(np.nan_to_num(camera.lens.zenith(0.5 * min(camera.size)), nan=camera.lens.max_zenith))
    whole = radius / np.tan(np.clip(short, _LEAST_HALF_VIEW, 1.4))
    return near, min(whole + max(_FAR * radius, 2.0 * step), max(_FARTHEST * radius, 2.0 * whole))


def _group(surface: Surface, laid: Texture) -> xr.Dataset:
    return xr.Dataset(
        {
            "chainage": ("row", surface.x),
            "bearing": ("column", surface.bearing),
            "colour": (("row", "column", "channel"), laid.colour),
            "seen": (("row", "column"), laid.seen.astype(np.uint8)),
        },
        attrs={"cell": float(surface.x[1] - surface.x[0]) if len(surface.x) > 1 else 0.0, "frames": len(laid.used)},
    )
