"""The pipe against the line to which it was to be laid."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..conventions import NOT_SPEAKING, flagged
from ..geometry.measures import polar_radius
from ..geometry.polyline import beside_line
from ..survey import add_assumption, add_warning
from ..survey.overrides import changes

if TYPE_CHECKING:
    import xarray as xr

    from ..config import Config
    from ..survey import Survey

_INVERT = -0.5 * np.pi
_NO_HEIGHT = "no tie tells the height"
_OFF = "the station lies beyond the ends of the design line"


@dataclass(frozen=True)
class _Held:
    """The design line abreast of every station; NaN beyond its ends.

    Attributes:
        elevation: Of the line [m].
        gradient: Of the line along travel, rise per metre of run.
        right: Station right of it, seen along travel [m].
        right_sigma: One-sigma [m].
        up_variance: What the place along the line adds to the variance of the height above it [m2].
    """

    elevation: np.ndarray
    gradient: np.ndarray
    right: np.ndarray
    right_sigma: np.ndarray
    up_variance: np.ndarray


def design_line(survey: Survey, config: Config) -> Survey:
    """Return the survey with the layout's deviation from `/design_line`; as it is when no line was given.

    A line in plan is met square to it, and its height taken there; a line of chainage and elevation is met at the
    station's chainage along the axis. Up and right are as seen along travel, whichever way the line runs. Without a
    tie the height of the whole pipe is unknown: the first station that speaks for the pipe is then held to the line.
    Without two ties apart the plan is unknown: `deviation_right` is missing, and the height is taken by chainage.

    Args:
        survey: With `/layout`, `/section` and `/design_line`; last of all stages, so that a datum set by hand counts.
        config: Not read.
    """
    if not survey.has("design_line"):
        return survey
    if not survey.has("layout"):
        return add_warning(
            survey,
            "The pipe was not held against the design line: no layout was found"
            + ("." if survey.has("inertial") else ", as there is no inertial log."),
        )
    line, layout, why = survey.design_line, survey.layout, {}
    planned = "easting" in line and np.isfinite(line["easting"].values).all()
    if planned and "north" not in json.loads(layout.attrs.get("why_missing", "{}")):
        held = _by_plan(line, layout)
    else:
        held = _by_chainage(line, layout)
        why["deviation_right"] = (
            "the ties do not tell the way north" if planned else "the design line tells chainage and elevation alone"
        )
        if planned and "chainage" not in line:
            survey = add_assumption(survey, "The design line is taken to begin at chainage 0, where the odometer does.")
    known = survey.has("ties") or any("elevation_m" in one["change"] for one in changes(survey, "datum"))
    columns, first = _deviations(survey, held, known)
    if not known:
        why["deviation_up_absolute"] = _NO_HEIGHT
        if first is not None:
            at = float(layout["chainage"].values[first])
            survey = add_assumption(
                survey,
                f"No tie tells the height, so the station at {at:.2f} m is held to the design line; deviations up are "
                "from there on.",
            )
    missing = ~np.isfinite(held.elevation)
    if missing.any():
        survey = add_warning(
            survey, f"{missing.sum()} of {missing.size} stations lie beyond the ends of the design line."
        )
        if missing.all():
            why |= dict.fromkeys(("deviation_up", "deviation_right", "deviation_gradient"), _OFF)
    reasons = json.loads(layout.attrs.get("why_missing", "{}")) | why
    datum = "absolute" if known or first is None else f"{float(layout['chainage'].values[first]):.4f}"
    data = layout.assign({name: ("station", values) for name, values in columns.items()}).assign_attrs(
        why_missing=json.dumps(reasons), design_line=line.attrs.get("refers_to", "axis"), design_datum=datum
    )
    return survey.corrected("layout", data)


def _deviations(survey: Survey, held: _Held, known: bool) -> tuple[dict[str, np.ndarray], int | None]:
    """Return the layout's new columns, and the station that was held to the line where the height is not known."""
    layout = survey.layout
    height, variance = layout["elevation"].values, layout["elevation_sigma"].values ** 2
    if survey.design_line.attrs.get("refers_to") == "invert":
        drop, more = _drop(survey)
        height, variance = height - drop, variance + more
    up, first = height - held.elevation, None
    if not known:
        speaks = np.isfinite(up) & ~flagged(survey.section["flags"].values, *NOT_SPEAKING)
        if speaks.any():
            first = int(np.flatnonzero(speaks)[0])
            up = up - up[first]
    gradient = layout["gradient"].values
    return {
        "design_elevation": held.elevation,
        "design_gradient": held.gradient,
        "deviation_up": up,
        "deviation_up_sigma": np.where(np.isfinite(up), np.sqrt(variance + held.up_variance), np.nan),
        "deviation_right": held.right,
        "deviation_right_sigma": held.right_sigma,
        "deviation_gradient": gradient - held.gradient,
        "deviation_gradient_sigma": np.where(
            np.isfinite(gradient - held.gradient), layout["gradient_sigma"].values, np.nan
        ),
    }, first


def _drop(survey: Survey) -> tuple[np.ndarray, np.ndarray]:
    """Return how far the invert lies below the axis [m], and the variance of that, with the sensor's scale [m2]."""
    section = survey.section
    radius = polar_radius(section["parameters"].values, _INVERT)
    spread = section["covariance"].values
    slope = np.array([1.0, -1.0, 0.0])
    variance = np.einsum("i,nij,j->n", slope, spread, slope)
    scale = float(section.attrs.get("range_scale_sigma", 0.0))
    level = np.cos(np.arctan(survey.layout["gradient"].values))
    return radius * level, (variance + (scale * radius) ** 2) * level**2


def _by_plan(line: xr.Dataset, layout: xr.Dataset) -> _Held:
    """Return the line at the feet of the stations' perpendiculars in plan."""
    plan = np.stack([layout[name].values for name in ("easting", "northing")], axis=1)
    corners = np.stack([line[name].values for name in ("easting", "northing")], axis=1)
    heights = line["elevation"].values
    heading = layout["heading"].values
    seen = np.isfinite(plan).all(axis=1) & np.isfinite(heading)
    travel = np.stack([np.sin(heading[seen]), np.cos(heading[seen])], axis=1)
    if np.sum(beside_line(plan[seen], corners).tangent * travel) < 0.0:
        corners, heights = corners[::-1], heights[::-1]
    found = beside_line(np.where(seen[:, None], plan, corners[0]), corners)
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    inside = seen & (found.along >= 0.0) & (found.along <= run[-1])
    slope = (np.diff(heights) / np.diff(run))[found.piece]
    spread = layout["axis_covariance"].values
    across = np.stack([found.tangent[:, 1], -found.tangent[:, 0]], axis=1)
    # Moving along the line by one metre raises what is below by the slope, and may share errors with the height.
    way = np.einsum("nk,nkl->nl", found.tangent, spread[:, :2, :])
    along = np.einsum("nl,nl->n", way[:, :2], found.tangent)
    more = slope**2 * along - 2.0 * slope * way[:, 2]
    return _Held(
        *(
            np.where(inside, values, np.nan)
            for values in (
                np.interp(found.along, run, heights),
                slope,
                found.right,
                np.sqrt(np.einsum("nk,nkl,nl->n", across, spread[:, :2, :2], across)),
                np.maximum(more, -(layout["elevation_sigma"].values ** 2)),
            )
        )
    )


def _by_chainage(line: xr.Dataset, layout: xr.Dataset) -> _Held:
    """Return the line at the stations' chainages; one without chainage begins at 0."""
    heights = line["elevation"].values
    if "chainage" in line:
        at = line["chainage"].values
    else:
        steps = np.diff(np.stack([line[name].values for name in ("easting", "northing", "elevation")], axis=1), axis=0)
        at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
    chainage, sigma = layout["chainage"].values, layout["chainage_sigma"].values
    inside = (chainage >= at[0]) & (chainage <= at[-1])
    rise = np.diff(heights) / np.diff(at)
    rise = rise[np.clip(np.searchsorted(at, chainage, side="right") - 1, 0, len(rise) - 1)]
    empty = np.full(len(chainage), np.nan)
    # Chainage runs along the slope, and a gradient is per metre of run.
    grade = rise / np.sqrt(np.maximum(1.0 - rise**2, 1e-12))
    return _Held(
        np.where(inside, np.interp(chainage, at, heights), np.nan),
        np.where(inside, grade, np.nan),
        empty,
        empty,
        np.where(inside, (rise * sigma) ** 2, np.nan),
    )
