"""`/section` and `/pose` as datasets."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ...conventions import POSE_TERMS, SECTION_PARAMETERS
from ...geometry.fitting.modes import CLASSES
from .rings import DEVIATIONS

if TYPE_CHECKING:
    from ...estimation import JointEstimate

_SEVERITIES = ("s1", "s2", "s02", "s01")


def section(rings: xr.Dataset, mask: xr.Dataset, found: dict[str, np.ndarray]) -> xr.Dataset:
    """Return the group `/section`.

    Args:
        rings: `/rings`.
        mask: `/mask`.
        found: Every column by its name; `parameters` (n, 3), `covariance` (n, 3, 3), `mode` as an index of `CLASSES`,
            `severities` and `severities_sigma` (n, 4), `flags` as a dict of booleans (n,).
    """
    distance = rings["distance"].values
    odometer = rings.attrs.get("distance_source", "odometer") == "odometer"
    columns = {
        "chainage": distance,
        "distance": distance if odometer else np.full(len(distance), np.nan),
        "coverage": mask["coverage"].values,
        **{
            name: found[name]
            for name in ("status", "residual_rms", "noise", "centre_y", "centre_z", *DEVIATIONS, "mode_probability")
        },
        "mode": np.where(found["status"] == 0, np.array([*CLASSES, "undecided"])[found["mode"]], ""),
        "flags": _flags(**found["flags"]),
    }
    columns |= {name: found[name] for name in ("chainage", "chainage_sigma") if name in found}
    for column, name in enumerate(_SEVERITIES):
        columns[name] = found["severities"][:, column]
        columns[f"{name}_sigma"] = found["severities_sigma"][:, column]
    return xr.Dataset(
        {
            **{name: ("station", values) for name, values in columns.items()},
            "parameters": (("station", "parameter"), found["parameters"]),
            "covariance": (("station", "parameter", "parameter_2"), found["covariance"]),
        },
        coords={"parameter": list(SECTION_PARAMETERS), "parameter_2": list(SECTION_PARAMETERS)},
    )


def _flags(**named: np.ndarray) -> np.ndarray:
    """Return the names of the flags that each station carries, separated by spaces."""
    words = [np.where(flag, name, "") for name, flag in named.items()]
    joined = words[0]
    for word in words[1:]:
        gap = np.where((joined != "") & (word != ""), " ", "")
        joined = np.char.add(np.char.add(joined, gap), word)
    return joined


def pose_of_rings(rings: xr.Dataset, found: dict[str, np.ndarray]) -> xr.Dataset:
    """Return the sensor's pose ring by ring: the offset from the section's centre, attitude where the rings carry it.

    Args:
        rings: `/rings`.
        found: `centre_y`, `centre_z`, and `centre_covariance` (n, 2, 2) of z and y.
    """
    count = rings.sizes["ring"]
    terms = {name: np.full(count, np.nan) for name in POSE_TERMS}
    covariance = np.full((count, 5, 5), np.nan, np.float32)
    why = {"roll": "a ring alone does not show roll"}
    if rings.attrs.get("referred_to") == "axis":
        for term, source in (("offset_y", "y"), ("offset_z", "z"), ("pitch", "pitch"), ("yaw", "yaw")):
            if f"sensor_{source}" in rings:
                terms[term] = rings[f"sensor_{source}"].values
                diagonal = POSE_TERMS.index(term)
                covariance[:, diagonal, diagonal] = rings[f"sensor_{source}_sigma"].values ** 2
            else:
                why[term] = "the rings were given about the pipe's axis, without the sensor's pose"
    else:
        terms["offset_y"], terms["offset_z"] = -found["centre_y"], -found["centre_z"]
        covariance[:, :2, :2] = found["centre_covariance"][:, [[1, 1], [0, 0]], [[1, 0], [1, 0]]]
        why["pitch"] = why["yaw"] = "one ring shows its tilt to second order only"
    return _pose(terms, covariance, why)


def pose_of_joint(joint: JointEstimate) -> xr.Dataset:
    """Return the pose of the joint estimate."""
    terms = dict(zip(POSE_TERMS, joint.pose.T, strict=True))
    why = {name: reason for name, reason in joint.why_missing.items() if name in POSE_TERMS}
    return _pose(terms, joint.pose_covariance.astype(np.float32), why)


def _pose(terms: dict[str, np.ndarray], covariance: np.ndarray, why: dict[str, str]) -> xr.Dataset:
    sigma = {f"{name}_sigma": np.sqrt(covariance[:, i, i].astype(float)) for i, name in enumerate(POSE_TERMS)}
    return xr.Dataset(
        {
            **{name: ("ring", values) for name, values in (terms | sigma).items()},
            "covariance": (("ring", "pose", "pose_2"), covariance),
        },
        coords={"pose": list(POSE_TERMS), "pose_2": list(POSE_TERMS)},
        attrs={"why_missing": json.dumps(why)},
    )
