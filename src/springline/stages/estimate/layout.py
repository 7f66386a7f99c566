"""`/layout`: where the pipe's axis runs, how it falls, its bends, sags and angles at joints."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from ...estimation import JointEstimate
    from ...survey import Survey

_AXES = ("easting", "northing", "elevation")
_BEND = {"start": "start", "length": "length", "angle": "angle", "arc_radius": "radius", "towards": "towards"}


def layout(survey: Survey, joint: JointEstimate, start: float) -> xr.Dataset:
    """Return the group `/layout` of a joint estimate.

    Args:
        survey: For its coordinate reference system.
        joint: The estimate; its axis must be known.
        start: Chainage of the first station [m].
    """
    chainage = start + joint.chainage
    heading, grade = joint.direction.T
    sigma = joint.direction_sigma
    columns = {
        "chainage": chainage,
        "chainage_sigma": joint.chainage_sigma,
        **dict(zip(_AXES, joint.axis.T, strict=True)),
        **{f"{name}_sigma": values for name, values in zip(_AXES, joint.axis_sigma.T, strict=True)},
        "gradient": np.tan(grade),
        "gradient_sigma": sigma[:, 1] / np.cos(grade) ** 2,
        "heading": np.mod(heading, 2.0 * np.pi),
        "heading_sigma": sigma[:, 0],
        **_radius_at(joint, chainage, start),
    }
    data = {name: ("station", values) for name, values in columns.items()}
    data["axis_covariance"] = (("station", "axis", "axis_2"), joint.axis_covariance)
    data |= _bends(joint, start) | _sags(joint, start) | _joints(joint, start)
    local = "north" in joint.why_missing
    return xr.Dataset(
        data,
        coords={"axis": list(_AXES), "axis_2": list(_AXES)},
        attrs={
            "frame": "local" if local else "ties",
            "crs": "" if local else str(survey.attrs.get("crs", "")),
            "why_missing": json.dumps({k: v for k, v in joint.why_missing.items() if k == "north"}),
        },
    )


def _radius_at(joint: JointEstimate, chainage: np.ndarray, start: float) -> dict[str, np.ndarray]:
    """Return the radius of the bend in which each station lies; NaN on straight runs."""
    out = {name: np.full(len(chainage), np.nan) for name in ("bend_radius", "bend_radius_sigma")}
    for bend in joint.bends:
        first = start + bend.start
        inside = (chainage >= first) & (chainage <= first + bend.length)
        out["bend_radius"][inside], out["bend_radius_sigma"][inside] = bend.radius, bend.radius_sigma
    return out


def _bends(joint: JointEstimate, start: float) -> dict[str, tuple[str, np.ndarray]]:
    names = {f"bend_{name}": field for name, field in _BEND.items()}
    names |= {f"bend_{name}_sigma": f"{_BEND[name]}_sigma" for name in ("start", "angle", "arc_radius")}
    table = {
        name: ("bend", np.array([getattr(bend, field) for bend in joint.bends], float)) for name, field in names.items()
    }
    return {**table, "bend_start": ("bend", table["bend_start"][1] + start)}


def _sags(joint: JointEstimate, start: float) -> dict[str, tuple[str, np.ndarray]]:
    names = ("start", "length", "lowest", "depth", "depth_sigma", "ponding", "ponding_sigma")
    table = {f"sag_{name}": ("sag", np.array([getattr(sag, name) for sag in joint.sags], float)) for name in names}
    for name in ("sag_start", "sag_lowest"):
        table[name] = ("sag", table[name][1] + start)
    return table


def _joints(joint: JointEstimate, start: float) -> dict[str, tuple[str, np.ndarray]]:
    names = ("up", "right", "up_sigma", "right_sigma")
    table = {
        f"joint_{name}": ("joint", np.array([getattr(one, name) for one in joint.joints], float)) for name in names
    }
    return {"joint_chainage": ("joint", start + np.array([one.chainage for one in joint.joints])), **table}
