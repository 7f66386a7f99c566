"""Validation of a survey against the contract of `springline.conventions`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..conventions import GROUPS
from ..errors import ContractError, InputError, nearest
from .turning import FEWEST, turn_of

if TYPE_CHECKING:
    import xarray as xr

    from ..conventions import Group
    from .model import Survey


_LENGTHS = ("nominal_diameter", "base_diameter", "wall_thickness")
_TURN = 2.0 * np.pi * (1.0 + 1e-6)


def validate(survey: Survey, *, where: str = "survey") -> Survey:
    """Return the survey when it follows the contract.

    Checked: every variable is known, has its dims and a fitting type, required ones are there; diameters are lengths;
    bearings of rings are radians of one turn; distances of rings are finite, never repeat, turn once at most, and
    increase unless the robot faced backwards; rings hold at least one return.

    Args:
        survey: The survey.
        where: What to name in messages, such as the file it came from.

    Raises:
        ContractError: Structure: a variable is missing, unknown or has other dims.
        InputError: Content: no returns at all, distances that repeat or go back, bearings that are no radians.
    """
    for name in _LENGTHS:
        _check_length(name, survey.attrs.get(name), where)
    for name in survey.groups:
        _check_structure(GROUPS[name], survey.group(name), where)
    for name in ("rings", "rings_rear"):
        if survey.has(name):
            _check_rings(survey.group(name), f"{where}, /{name}", back=survey.attrs.get("facing") == "backwards")
    return survey


def _check_structure(group: Group, data: xr.Dataset, where: str) -> None:
    listed = {v.name: v for v in group.variables}
    place = f"{where}, /{group.name}"
    for variable in group.variables:
        if variable.required and variable.name not in data.variables:
            raise ContractError(f"the variable '{variable.name}' is missing", where=place)
    for name, array in data.variables.items():
        if name not in listed:
            if group.open or array.dims == (name,):
                continue
            raise ContractError(f"unknown variable '{name}'{nearest(str(name), listed)}", where=place)
        if tuple(array.dims) != listed[str(name)].dims:
            raise ContractError(
                f"'{name}' has dims {array.dims}", where=place, expected=f"dims {listed[str(name)].dims}"
            )
        text = listed[str(name)].dtype == "str"
        if text != (array.dtype.kind in "OUST") or array.dtype.kind == "c":
            raise ContractError(
                f"'{name}' has type {array.dtype}", where=place, expected=f"type {listed[str(name)].dtype}"
            )


def _check_length(name: str, value: object, where: str) -> None:
    number = isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
    if value is not None and not (number and 0.0 < float(value) < np.inf):
        raise ContractError(f"the attribute '{name}' is {value!r}", where=where, expected="a length in metres")


def _check_bearings(bearing: np.ndarray, where: str) -> None:
    if not np.isfinite(bearing).all():
        raise InputError(f"bearing {int(np.argmin(np.isfinite(bearing)))} is not a number", where=where)
    if np.ptp(bearing) > _TURN or np.abs(bearing).max() > 2.0 * _TURN:
        raise InputError(
            f"bearings run from {bearing.min():g} to {bearing.max():g}",
            where=where,
            expected="radians within one turn",
            mend="turn degrees into radians: numpy.radians(bearing)",
        )


def _check_rings(rings: xr.Dataset, where: str, *, back: bool) -> None:
    if 0 in rings.sizes.values():
        raise InputError("there are no readings", where=where, expected="at least one ring with readings")
    _check_bearings(rings["bearing"].values, where)
    distance = rings["distance"].values
    if not np.isfinite(distance).all():
        row = int(np.flatnonzero(~np.isfinite(distance))[0])
        raise InputError("the distance is not a number", where=f"{where}, ring {row}")
    steps = np.diff(distance)
    turned = turn_of(distance) is not None
    if (steps <= 0).any() and (steps >= 0).any() and not turned:
        row = int(np.flatnonzero(steps * np.sign(distance[-1] - distance[0] or 1.0) <= 0)[0]) + 1
        word = "repeats" if steps[row - 1] == 0 else "goes back"
        raise InputError(
            f"the distance {word}: {distance[row - 1]:g} m, then {distance[row]:g} m",
            where=f"{where}, ring {row}",
            expected="distances that strictly increase",
            mend=f"a run may come back once, with {FEWEST} rings or more either way; split others, and drop rings "
            "taken at a standstill",
        )
    if (steps < 0).any() and not (back or turned):
        raise InputError(
            f"distances decrease from {distance[0]:g} to {distance[-1]:g} m",
            where=where,
            expected="distances that increase along travel",
            mend="reverse the order of the rings if the counter ran backwards",
        )
    block = 16384
    shape = rings["range"].shape[0]
    if not any(np.isfinite(rings["range"][i : i + block].values).any() for i in range(0, shape, block)):
        raise InputError("every reading is missing (NaN)", where=where, expected="at least one return")
