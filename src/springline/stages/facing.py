"""Surveys of a robot that drove with its nose behind, told as of one that drove nose first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from ..survey import Survey, add_assumption

if TYPE_CHECKING:
    import xarray as xr

_TURN = np.array([-1.0, 1.0, -1.0])
"""What half a turn about the robot's y does to its axes."""
_LEFT = ("frames", "points")
_SIGNS = {"position_x": -1.0, "position_z": -1.0, "boresight_pitch": -1.0, "boresight_roll": -1.0}


def facing(survey: Survey) -> Survey:
    """Return the survey as a robot turned round would have made it; as it is unless its `facing` is backwards.

    Robot axes are turned by half a turn about y, so that x points along travel again: readings change sides, rates and
    forces along x and z their signs, and so do the scanners' places. A counter that runs back counts on instead.
    Pictures and clouds, which look where the nose points, are left aside.

    Args:
        survey: With its calibration applied.

    Raises:
        InputError: The attribute is neither forwards nor backwards.
    """
    told = survey.attrs.get("facing", "forwards")
    if told not in ("forwards", "backwards"):
        raise InputError(f"'{told}' is no way to face", where="facing", expected="forwards or backwards")
    if told == "forwards":
        return survey
    groups = {name: survey.group(name) for name in survey.groups if name not in _LEFT}
    counter = _counter(survey)
    for name in ("rings", "rings_rear"):
        if name in groups:
            groups[name] = _rings(groups[name], counter)
    if "inertial" in groups:
        groups["inertial"] = _inertial(groups["inertial"])
    if "ties" in groups:
        known = groups["ties"]
        groups["ties"] = known.assign(distance=(known["distance"].dims, counter(known["distance"].values)))
    turned = Survey(groups, survey.attrs).with_attrs(facing="forwards")
    return add_assumption(turned, "The robot faced backwards: it is told as one that was turned round, nose first.")


def _counter(survey: Survey):
    """Return the function that makes a counter count on; one that does so already is left as it is."""
    if not survey.has("rings"):
        return lambda values: values
    distance = survey.rings["distance"].values
    if distance[-1] >= distance[0]:
        return lambda values: values
    first = float(distance[0])
    return lambda values: first - values


def _rings(rings: xr.Dataset, counter) -> xr.Dataset:
    bearing = np.mod(np.pi - rings["bearing"].values, 2.0 * np.pi)
    order = np.argsort(bearing)
    out = rings.isel(bearing=order)
    out = out.assign(distance=("ring", counter(rings["distance"].values)))
    out = (
        out.assign_coords(bearing=bearing[order])
        if "bearing" in rings.coords
        else out.assign(bearing=("bearing", bearing[order]))
    )
    return out.assign_attrs({key: sign * float(rings.attrs[key]) for key, sign in _SIGNS.items() if key in rings.attrs})


def _inertial(log: xr.Dataset) -> xr.Dataset:
    changed = {name: (log[name].dims, log[name].values * _TURN) for name in ("gyro", "accel") if name in log}
    if "heading" in log:
        changed["heading"] = ("sample", np.mod(log["heading"].values + np.pi, 2.0 * np.pi))
    changed |= {name: ("sample", -log[name].values) for name in ("inclination", "bank") if name in log}
    return log.assign(changed)
