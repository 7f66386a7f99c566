"""The joint estimate of a survey: what it needs, and what it makes of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError
from ...estimation import Inertial, JointEstimate, Rear, Rings, Ties, estimate_joint
from ...geometry.robot.boresight import on_scanner
from .plausible import check_log, check_ties

if TYPE_CHECKING:
    import xarray as xr

    from ...survey import Survey
    from .rings import Fitted

_POSITION = ("x", "y", "z")
_FORMS = (("gyro", "accel"), ("heading", "inclination", "bank"))
"""What an inertial log may hold; the first that is there is used."""


def why_not(survey: Survey) -> str:
    """Return why the joint estimate is not made by itself; empty when it is."""
    rings = survey.rings
    if reason := why_never(survey):
        return reason
    if not survey.has("inertial") or not any(set(form) <= set(survey.inertial.variables) for form in _FORMS):
        return "there is no inertial log of rates and specific force, or of attitude"
    if "time" not in rings or not np.isfinite(rings["time"].values).all():
        return "the rings have no time, so the inertial log cannot be joined to them"
    return ""


def why_never(survey: Survey) -> str:
    """Return why the rings cannot be estimated jointly at all; empty when they can."""
    rings = survey.rings
    if rings.attrs.get("referred_to") == "axis" or rings.attrs.get("distance_source") == "axis":
        return "the rings stand about the pipe's axis already"
    return ""


def estimate_survey(survey: Survey, fitted: Fitted, rear: Rear | None = None) -> JointEstimate:
    """Return the joint estimate from rings, and inertial log and ties where there are any.

    Args:
        survey: With `/rings`, and `/inertial` and `/ties` where there are any.
        fitted: Ellipses of the rings, with the harmonics that they share.
        rear: Rings of a second scanner; None when there is none.

    Raises:
        InputError: The rings stand about the pipe's axis already, are too few, the log does not cover them, or log or
            ties cannot be of this run.
    """
    if reason := why_never(survey):
        raise InputError(
            f"no joint estimate: {reason}", where="estimate.method", expected="rings as the sensor saw them"
        )
    rings = survey.rings
    known = np.isfinite(rings["time"].values).all() if "time" in rings else False
    given = Rings(
        rings["distance"].values.astype(float),
        np.where((fitted.status == 0)[:, None], fitted.parameters, np.nan),
        fitted.covariance,
        rings["time"].values.astype(float) if known else None,
        tuple(on_scanner(lever(rings.attrs), boresight(rings))),
        rings.attrs.get("distance_source", "odometer") == "odometer",
    )
    log = _inertial(survey.inertial, boresight(rings)) if survey.has("inertial") and known else None
    ties = _ties(survey)
    if log is not None:
        check_log(log)
    if ties is not None and given.odometer:
        check_ties(ties, given.distance)
    return estimate_joint(given, log, ties, harmonics=fitted.harmonics, joints=_joints(survey), rear=rear)


def _joints(survey: Survey) -> np.ndarray | None:
    """Return the odometer readings of the candidate joints that are likelier than not [m]; None when nobody looked."""
    if not survey.has("candidates") or not {"kind", "distance"} <= set(survey.candidates.variables):
        return None
    found = survey.candidates
    likely = found["kind"].values == "joint"
    if "probability" in found:
        likely = likely & (found["probability"].values > 0.5)
    return np.unique(found["distance"].values[likely].astype(float))


def boresight(rings: xr.Dataset) -> np.ndarray:
    """Return pitch, yaw and roll (3,) of the scanner against the robot [rad] by its calibration; 0 without one."""
    return np.nan_to_num([float(rings.attrs.get(f"boresight_{name}", 0.0)) for name in ("pitch", "yaw", "roll")])


def lever(attrs: dict[str, object]) -> tuple[float, float, float]:
    """Return where the sensor stands from the robot's middle [m]: ahead, above, to the right."""
    x, y, z = (float(attrs.get(f"position_{k}", 0.0)) for k in _POSITION)
    return x, y, z


def _inertial(data: xr.Dataset, scanner: np.ndarray) -> Inertial | None:
    """Return the log of rates and specific force on the scanner's axes; where it tells attitude alone, what that says.

    Rings tell the scanner's attitude and the log the robot's, so the log is turned by the scanner's boresight.
    """
    for form, make in zip(_FORMS, (Inertial, Inertial.from_attitude), strict=True):
        if set(form) <= set(data.variables):
            columns = [data[name].values.astype(float) for name in ("time", *form)]
            known = np.isfinite(np.column_stack(columns)).all(axis=1)
            if known.any():
                log = make(*(column[known] for column in columns))
                return replace(log, gyro=on_scanner(log.gyro, scanner), accel=on_scanner(log.accel, scanner))
    return None


def _ties(survey: Survey) -> Ties | None:
    if not survey.has("ties") or not survey.ties.sizes.get("tie", 0):
        return None
    data = survey.ties
    points = np.stack([data[name].values.astype(float) for name in ("easting", "northing", "elevation")], axis=1)
    order = np.argsort(data["distance"].values, kind="stable")
    return Ties(data["distance"].values.astype(float)[order], points[order], data["sigma"].values.astype(float)[order])
