"""Rings: clouds and depth images are cut into rings about the pipe's axis; ring surveys pass through."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..errors import InputError
from ..geometry.axis import locate_pipe
from ..geometry.robot.attitude import pitch_yaw_roll
from ..survey import add_assumption, add_warning

if TYPE_CHECKING:
    from ..config import Config
    from ..geometry.axis import Located
    from ..survey import Survey

_PER_DIAMETER = 20
_OFF_NOMINAL = 3.0
_UNLIKE_NOMINAL = 0.15
_MUCH_UNSEEN = np.radians(120.0)
_SAMPLE = 500


def rings(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/rings`: one robust range per station and bearing, about the pipe's axis.

    Rings that are there pass through unchanged. From `/points` the pipe's axis is found, straight or curved, and the
    stretch that shows its wall is cut every `rings.spacing`; scenery beyond it is left out, and stations within it
    that show too little wall are all NaN. `distance` runs along the axis, from the sensor's foot on it where the
    sensor stands at the origin, from the first station elsewhere. Where the sensor's place is known, its pose in the
    pipe stands beside the rings. Bearings take the cloud's y as up.

    Args:
        survey: With `/rings` or `/points`; `nominal_diameter` is used to catch wrong units, never to fit.
        config: `rings.spacing` and `rings.bearings`.

    Raises:
        InputError: The cloud is not of a pipe, or its diameter is far off the nominal one.
    """
    if survey.has("rings"):
        _check_diameter(survey, 2.0 * _typical_range(survey.rings))
        return survey
    points = survey.points
    nominal = survey.attrs.get("nominal_diameter")
    looking = points.attrs.get("origin_is_sensor", 0) == 1
    located = locate_pipe(
        np.column_stack([points[axis].values for axis in "xyz"]),
        spacing=config.rings.spacing or (nominal / _PER_DIAMETER if nominal else None),
        bearings=config.rings.bearings,
        looking=looking,
    )
    _check_diameter(survey, located.pooled.diameter)
    origin = located.centreline.place(np.zeros((1, 3))) if looking else None
    zero = origin.along[0] if origin else located.stations.distance[0]
    kept = np.where(located.trusted[:, None], located.stations.ranges, np.nan)
    data = xr.Dataset(
        {
            "range": (("ring", "bearing"), kept.astype(np.float32)),
            "distance": ("ring", located.stations.distance - zero),
            **(_sensor_pose(located) if looking else {}),
        },
        coords={"bearing": located.stations.bearings},
        attrs={
            "referred_to": "axis",
            "distance_source": "axis",
            "sensor_kind": points.attrs.get("sensor_kind", "unknown"),
            "wall_share": located.share,
            "diameter_doubt": located.doubt,
        },
    )
    survey = add_assumption(survey, "Bearings of the cloud's rings stand on its own vertical: y is taken as up.")
    return _explain(survey, located).with_group("rings", data)


def _typical_range(data: xr.Dataset) -> float:
    """Return the median range [m] of rings spread along the survey."""
    rows = np.unique(np.linspace(0, data.sizes["ring"] - 1, _SAMPLE).astype(int))
    ranges = data["range"].isel(ring=rows).values
    return float(np.median(ranges[np.isfinite(ranges)])) if np.isfinite(ranges).any() else np.nan


def _check_diameter(survey: Survey, diameter: float) -> None:
    nominal = survey.attrs.get("nominal_diameter")
    if not nominal or not np.isfinite(diameter) or 1 / _OFF_NOMINAL < diameter / nominal < _OFF_NOMINAL:
        return
    raise InputError(
        f"the pipe measures about {diameter * 1e3:.4g} mm across, its nominal diameter is {nominal * 1e3:.4g} mm",
        where=survey.attrs.get("name", "survey"),
        expected=f"between a third and three times the nominal diameter ({diameter / nominal:.3g} times now)",
        mend="state the right unit of the input (--unit, --depth-unit), or mend --nominal",
    )


def _sensor_pose(located: Located) -> dict[str, tuple[str, np.ndarray]]:
    """Return the sensor's place and attitude in the pipe, the same for every ring: it stood still."""
    line, pooled = located.centreline, located.pooled
    foot = line.place(np.zeros((1, 3)))
    # The robot's axes are the cloud's, so its frame in the pipe is the pipe's frame in the cloud, transposed.
    pitch, yaw, _ = pitch_yaw_roll(line.frames(foot.along)[0].T)
    reach = foot.along[0] - pooled.middle
    centre = pooled.covariance[1:3, 1:3] + reach * (pooled.covariance[1:3, 3:5] + pooled.covariance[3:5, 1:3])
    centre = centre + reach**2 * pooled.covariance[3:5, 3:5]
    values = {
        "sensor_y": foot.y[0],
        "sensor_z": foot.z[0],
        "sensor_pitch": pitch,
        "sensor_yaw": yaw,
        "sensor_y_sigma": np.sqrt(centre[0, 0]),
        "sensor_z_sigma": np.sqrt(centre[1, 1]),
        "sensor_pitch_sigma": np.sqrt(pooled.covariance[3, 3]),
        "sensor_yaw_sigma": np.sqrt(pooled.covariance[4, 4]),
    }
    count = len(located.stations.distance)
    return {name: ("ring", np.full(count, float(value))) for name, value in values.items()}


def _explain(survey: Survey, located: Located) -> Survey:
    diameter = located.pooled.diameter
    sentences = []
    if located.doubt > 0:
        sentences.append(
            f"Only {100 * located.share:.0f} % of what the cloud shows near the pipe's axis is wall: the readings are "
            f"too few or too noisy for a diameter, which is uncertain by {100 * located.doubt:.0f} % (one-sigma) for "
            "that reason alone."
        )
    if located.pooled.unseen > _MUCH_UNSEEN:
        sentences.append(
            f"An arc of {np.degrees(located.pooled.unseen):.0f} degrees of the wall was hardly seen at any station; "
            "the section is taken as nearly round there, and a deformation of that arc would not show."
        )
    if blank := int((~located.trusted).sum()):
        sentences.append(
            f"{blank} of {len(located.trusted)} stations show too little wall to be trusted and are left empty."
        )
    nominal = survey.attrs.get("nominal_diameter")
    if nominal and abs(diameter / nominal - 1.0) > _UNLIKE_NOMINAL + 2.0 * located.doubt:
        sentences.append(
            f"The cloud's diameter, about {diameter * 1e3:.4g} mm, is unlike the nominal {nominal * 1e3:.4g} mm."
        )
    return add_warning(survey, *sentences) if sentences else survey
