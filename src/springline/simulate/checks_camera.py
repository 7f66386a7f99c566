"""What makes a scenario's camera impossible, beyond single values out of range."""

from __future__ import annotations

from math import degrees, hypot

from . import optics
from .lens import LIMITS, OPEN, rising_to
from .problem import Path, Problem, require
from .scenario import Scenario


def check_camera(scenario: Scenario, camera: optics.Camera) -> None:
    """Raise the first `Problem` of a camera."""
    _lens(camera)
    radius = 0.5 * scenario.pipe.diameter
    slim = f"less than the pipe's radius, {radius:g} m, off the axis"
    require(hypot(*camera.position[1:]) < radius, ("camera", "position"), list(camera.position), slim)
    for k, lamp in enumerate(camera.lamp):
        path: Path = ("camera", "lamp", k, "position")
        require(hypot(*lamp.position[1:]) < radius, path, list(lamp.position), slim)
    lit = camera.laser is not None or sum(lamp.power for lamp in camera.lamp) > 0.0
    require(lit, ("camera", "lamp"), len(camera.lamp), "a lamp with power above 0, or a laser", ": nothing gives light")
    laser = camera.laser
    if laser is not None:
        within = f"below the camera's sight, {camera.sight:g} m"
        require(laser.ahead < camera.sight, ("camera", "laser", "ahead"), laser.ahead, within)
        aside = hypot(camera.position[1] + laser.offset_y, camera.position[2] + laser.offset_z)
        require(aside < radius, ("camera", "laser", "offset_y"), laser.offset_y, slim)


def _lens(camera: optics.Camera) -> None:
    lens = camera.lens
    path: Path = ("camera", "lens")
    if lens.coefficients and lens.model != "polynomial":
        none = "none: only model = 'polynomial' has them"
        raise Problem((*path, "coefficients"), list(lens.coefficients), none)
    if lens.k_px is not None and "field_of_view_deg" in lens.model_fields_set:
        raise Problem((*path, "k_px"), lens.k_px, "k_px or field_of_view_deg, not both: each sets the lens's scale")
    if lens.k_px is None:
        most = 2.0 * LIMITS[lens.model]
        why = f": the {lens.model} lens ends there"
        if lens.model == "polynomial":
            most = 2.0 * degrees(rising_to(lens.coefficients))
            why = ": beyond, the polynomial no longer rises"
        open_end = lens.model in OPEN
        inside = lens.field_of_view_deg < most if open_end else lens.field_of_view_deg <= most
        expected = f"{'below' if open_end else 'at most'} {most:.6g}"
        require(inside, (*path, "field_of_view_deg"), lens.field_of_view_deg, expected, why)
    if lens.centre_px is not None:
        column, row = lens.centre_px
        inside = 0.0 <= column <= camera.width - 1 and 0.0 <= row <= camera.height - 1
        expected = f"within the picture, 0 to {camera.width - 1} and 0 to {camera.height - 1}"
        require(inside, (*path, "centre_px"), list(lens.centre_px), expected)
