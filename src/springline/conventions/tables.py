"""Columns of the tables that are written, and keys of the survey folder that is read."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class Column:
    """One column of `stations.csv`: where it comes from and how it becomes its edge unit."""

    name: str
    group: str
    variable: str
    factor: float
    decimals: int
    heading: str


def _columns() -> tuple[Column, ...]:
    mm, pct, deg = 1e3, 1e2, 180.0 / pi
    clock = float("nan")  # a bearing, turned into a clock by clock_from_bearing
    rows = (
        ("chainage_m", "section", "chainage", 1.0, 4, "Chainage [m]"),
        ("distance_m", "section", "distance", 1.0, 4, "Distance [m]"),
        ("coverage_pct", "section", "coverage", pct, 1, "Coverage [%]"),
        ("offset_y_mm", "pose", "offset_y", mm, 3, "Offset up [mm]"),
        ("offset_z_mm", "pose", "offset_z", mm, 3, "Offset right [mm]"),
        ("pitch_deg", "pose", "pitch", deg, 4, "Pitch [deg]"),
        ("yaw_deg", "pose", "yaw", deg, 4, "Yaw [deg]"),
        ("roll_deg", "pose", "roll", deg, 4, "Roll [deg]"),
        ("semi_major_mm", "metrics", "semi_major", mm, 3, "Semi-major axis [mm]"),
        ("semi_minor_mm", "metrics", "semi_minor", mm, 3, "Semi-minor axis [mm]"),
        ("axis_clock_h", "metrics", "axis_bearing", clock, 3, "Major axis [clock h]"),
        ("diameter_max_mm", "metrics", "diameter_max", mm, 3, "Largest diameter [mm]"),
        (
            "diameter_max_clock_h",
            "metrics",
            "diameter_max_bearing",
            clock,
            3,
            "Largest diameter at [clock h]",
        ),
        ("diameter_min_mm", "metrics", "diameter_min", mm, 3, "Smallest diameter [mm]"),
        ("diameter_x_mm", "metrics", "diameter_x", mm, 3, "Horizontal diameter [mm]"),
        ("diameter_y_mm", "metrics", "diameter_y", mm, 3, "Vertical diameter [mm]"),
        ("diameter_axes_mm", "metrics", "diameter_axes", mm, 3, "Mean diameter, axes [mm]"),
        ("diameter_polar_mm", "metrics", "diameter_polar", mm, 3, "Mean diameter, polar [mm]"),
        ("diameter_area_mm", "metrics", "diameter_area", mm, 3, "Mean diameter, area [mm]"),
        ("diameter_caliper_mm", "metrics", "diameter_caliper", mm, 3, "Mean diameter, caliper [mm]"),
        ("ovality_axes_pct", "metrics", "ovality_axes", pct, 4, "Ovality, axes [%]"),
        ("ovality_polar_pct", "metrics", "ovality_polar", pct, 4, "Ovality, polar [%]"),
        ("ovality_area_pct", "metrics", "ovality_area", pct, 4, "Ovality, area [%]"),
        ("ovality_caliper_pct", "metrics", "ovality_caliper", pct, 4, "Ovality, caliper [%]"),
        ("ovality_sigma_pct", "metrics", "ovality_polar_sigma", pct, 4, "Ovality, one-sigma [%]"),
        ("deflection_pct", "metrics", "deflection", pct, 4, "Deflection [%]"),
        ("deflection_sigma_pct", "metrics", "deflection_sigma", pct, 4, "Deflection, one-sigma [%]"),
        ("deflection_x_pct", "metrics", "deflection_x", pct, 4, "Horizontal deflection [%]"),
        ("deflection_y_pct", "metrics", "deflection_y", pct, 4, "Vertical deflection [%]"),
        ("area_m2", "metrics", "area", 1.0, 6, "Area [m2]"),
        ("area_loss_pct", "metrics", "area_loss", pct, 4, "Area loss [%]"),
        ("capacity_loss_pct", "metrics", "capacity_loss", pct, 4, "Capacity loss [%]"),
        ("mode", "section", "mode", 1.0, 0, "Section mode"),
        ("s1", "section", "s1", 1.0, 5, "s1"),
        ("s2", "section", "s2", 1.0, 5, "s2"),
        ("s01", "section", "s01", 1.0, 5, "s01"),
        ("s02", "section", "s02", 1.0, 5, "s02"),
        ("residual_rms_mm", "section", "residual_rms", mm, 3, "Residual rms [mm]"),
        ("easting_m", "layout", "easting", 1.0, 4, "Easting [m]"),
        ("northing_m", "layout", "northing", 1.0, 4, "Northing [m]"),
        ("elevation_m", "layout", "elevation", 1.0, 4, "Elevation [m]"),
        ("gradient_pct", "layout", "gradient", pct, 4, "Gradient [%]"),
        ("bend_radius_m", "layout", "bend_radius", 1.0, 3, "Bend radius [m]"),
        ("liner_thickness_mm", "design", "liner_thickness", mm, 2, "Liner thickness [mm]"),
        ("liner_governing", "design", "liner_governing", 1.0, 0, "Governing check"),
        ("flags", "section", "flags", 1.0, 0, "Flags"),
    )
    return tuple(Column(*row) for row in rows)


STATION_COLUMNS = _columns()
"""The columns of `stations.csv`, in their order; empty = not available, never 0."""

DESIGN_LINE_COLUMNS = (
    Column("deviation_up_mm", "layout", "deviation_up", 1e3, 2, "Above the design line [mm]"),
    Column("deviation_right_mm", "layout", "deviation_right", 1e3, 2, "Right of the design line [mm]"),
    Column("deviation_gradient_pct", "layout", "deviation_gradient", 1e2, 4, "Gradient less the design's [%]"),
)
"""Further columns of `stations.csv`, after all others, where a design line was given."""

FEATURE_COLUMNS = (
    "kind",
    "chainage_m",
    "chainage_sigma_m",
    "clock_h",
    "size_mm",
    "length_mm",
    "depth_mm",
    "confidence",
    "source",
    "image",
)
"""The columns of `features.csv`, in their order."""

SURVEY_FOLDER_KEYS = {
    "name": "asset name",
    "nominal_diameter": "nominal diameter with its unit, such as '300mm'",
    "base_diameter": "base (inside) diameter with its unit",
    "wall_thickness": "wall thickness with its unit",
    "material": "material of the host pipe",
    "date": "date of the inspection, ISO 8601",
    "crs": "coordinate reference system of the ties",
    "operator": "who drove the inspection",
    "equipment": "what recorded it",
    "direction": "downstream or upstream",
    "facing": "forwards or backwards: whether the robot's nose pointed along its travel",
    "parts": "table of files: rings, rings_rear, inertial, ties, frames, design_line, observations, calibration",
    "sensor": "table: kind, bearing_zero, bearing_sense, range_noise, and the sensor's geometry",
    "sensor_rear": "table: the same of the scanner of rings_rear",
    "lens": "tables of lens models by name: model, k_px, width_px, height_px, and where known coefficients, "
    "view_angle_deg, centre_px, position_m, pitch_deg, yaw_deg, roll_deg, laser_ahead_m",
    "units": "table: unit of a column whose name has none",
}
"""Keys of `survey.toml`; any other key is refused."""

SURVEY_SENSOR_KEYS = {
    "kind": "ring-laser, depth-camera, lidar or unknown",
    "bearing_zero": "where the device's zero lies: right, crown, left or invert",
    "bearing_sense": "ccw or cw, looking forward",
    "range_noise": "one-sigma of a reading with its unit, such as '0.5mm'",
    "referred_to": "sensor or axis: what the ranges are measured from",
    "offset_x": "sensor ahead of the robot's origin, with its unit",
    "offset_y": "sensor above the robot's origin, with its unit",
    "offset_z": "sensor to the right of the robot's origin, with its unit",
    "boresight_pitch_deg": "ring plane's normal against the robot's forward axis, nose up",
    "boresight_yaw_deg": "the same, nose to the right",
    "boresight_roll_deg": "zero reading against its nominal bearing, from robot z towards robot y",
    "baseline_sigma_deg": "of sensor_rear: one-sigma of the direction between both scanners, as their places state it",
    "range_scale_applied": "range scale by which the ranges were divided already, when a calibration was applied",
}
"""Keys of the table `[sensor]` of `survey.toml`; lengths are stored as attributes of `/rings` in m, those of `offset_`
as `position_`, angles in rad without the `_deg`."""
