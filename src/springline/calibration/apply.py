"""A survey corrected by its calibration: ranges divided by the range scale, boresight and noise handed on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from ..survey import Survey, add_assumption

if TYPE_CHECKING:
    import xarray as xr

_APPLIED = "range_scale_applied"
_ANGLES = ("boresight_pitch", "boresight_yaw", "boresight_roll")
_BLOCK = 16384


def with_calibration(survey: Survey, calibration: xr.Dataset) -> Survey:
    """Return the survey with this calibration in `/calibration`; its own gives way, save what this one does not hold.

    >>> import xarray as xr
    >>> survey = Survey({"calibration": xr.Dataset({"range_scale": 1.01}, attrs={"lens": "{}"})})
    >>> both = with_calibration(survey, xr.Dataset({"range_scale": 1.005})).calibration
    >>> float(both["range_scale"]), both.attrs["lens"]
    (1.005, '{}')
    """
    groups = {name: survey.group(name) for name in survey.groups}
    if "calibration" in groups:
        own = groups["calibration"]
        kept = {name: own.attrs[name] for name in own.attrs if name not in calibration.attrs}
        if "range_scale" in calibration:
            kept = {name: value for name, value in kept.items() if name == "lens"}
            own = own.drop_vars(list(own.variables))
        calibration = own.drop_vars([v for v in own.variables if v in calibration.variables]).merge(calibration)
        calibration = calibration.assign_attrs(kept)
    return Survey({**groups, "calibration": calibration}, survey.attrs)


def apply_calibration(survey: Survey) -> Survey:
    """Return the survey with its ranges corrected by the range scale of `/calibration`; as it is without one.

    Ranges of `/rings` and coordinates of `/points` are divided by `range_scale`, and the attribute
    `range_scale_applied` says so: no scale is applied twice, and another calibration first undoes the one before. Rings
    also take over boresight, and the noise at their typical range where none was stated. `/rings_rear` is of another
    scanner and stays.

    Args:
        survey: With or without `/calibration`.

    Raises:
        InputError: A scale out of range, or points whose origin is not the sensor.
    """
    if not survey.has("calibration") or "range_scale" not in survey.calibration:
        return survey
    calibration = survey.calibration
    scale = float(calibration["range_scale"])
    if not 0.5 < scale < 2.0:
        raise InputError(f"range_scale is {scale:g}", where="/calibration", expected="reading over true range, about 1")
    groups = {name: survey.group(name) for name in survey.groups}
    if "rings" in groups:
        groups["rings"] = _rings(groups["rings"], calibration, scale)
    if "points" in groups:
        groups["points"] = _points(groups["points"], scale)
    sigma = float(calibration["range_scale_sigma"]) if "range_scale_sigma" in calibration else np.nan
    reference = calibration.attrs.get("reference_diameter")
    on = f" on a reference of {1e3 * float(reference):.5g} mm" if reference else ""
    return add_assumption(
        Survey(groups, survey.attrs),
        f"Ranges are divided by {scale:.6g} (one-sigma {sigma:.2g}), as calibrated{on}.",
    )


def _rings(rings: xr.Dataset, calibration: xr.Dataset, scale: float) -> xr.Dataset:
    factor = float(rings.attrs.get(_APPLIED, 1.0)) / scale
    values = rings["range"].values
    if factor != 1.0:
        corrected = np.empty(values.shape, np.float32)
        for start in range(0, len(values), _BLOCK):
            corrected[start : start + _BLOCK] = values[start : start + _BLOCK] * factor
        rings = rings.assign(range=(rings["range"].dims, corrected, rings["range"].attrs))
    attrs = {_APPLIED: scale}
    attrs |= {name: float(calibration[name]) for name in _ANGLES if _known(calibration, name)}
    if "range_noise" not in rings.attrs and _known(calibration, "noise_constant"):
        typical = float(np.nanmedian(values[:: max(len(values) // 200, 1)])) * factor
        growing = float(calibration["noise_relative"]) if _known(calibration, "noise_relative") else 0.0
        attrs["range_noise"] = float(np.hypot(float(calibration["noise_constant"]), growing * typical))
    return rings.assign_attrs(attrs)


def _points(points: xr.Dataset, scale: float) -> xr.Dataset:
    if points.attrs.get("origin_is_sensor", 0) != 1:
        raise InputError(
            "a range scale cannot be applied to a cloud whose origin is not the sensor",
            where="/points",
            expected="a scan as the sensor took it",
            mend="leave the calibration out",
        )
    factor = float(points.attrs.get(_APPLIED, 1.0)) / scale
    moved = {axis: (points[axis].dims, points[axis].values * factor, points[axis].attrs) for axis in "xyz"}
    return points.assign(moved).assign_attrs({_APPLIED: scale})


def _known(calibration: xr.Dataset, name: str) -> bool:
    return name in calibration and bool(np.isfinite(calibration[name]))
