"""The one table of words, frames, units and names; every module points here.

Frame
-----
Right-handed and fixed to the pipe: **x** along the pipe in the direction of travel, **y** up to the crown, **z** to
the right. A cross-section is drawn as seen looking forward: z to the right, y up. A **bearing** runs from +z
counter-clockwise to +y, so the crown lies at pi/2. The **clock** (EN 13508-2, PACP) is 12 at the crown and runs
clockwise looking forward, so 3 o'clock is +z.

Attitude in the pipe
--------------------
The robot's forward unit vector is (a, b, c) with tan(pitch) = b/a and tan(yaw) = c/a: positive pitch lifts the nose,
positive yaw turns it to the right. The axis comes first, by one direct rotation, then roll about it, positive from the
robot's z towards its y (counter-clockwise looking forward), so that a pure roll turns the measured major axis by
-roll. Worked example: at pitch 10 and yaw 10 degrees (a, b, c) = (0.97029, 0.17109, 0.17109); a robot that first
pitches and then yaws ends with the same axis but is rolled by -0.86 degrees against the direct frame.

Units
-----
SI and radians inside; millimetres, degrees, percent and clock hours at the edges only, with the unit in the name.
NaN means no return; it is never zero and never silently filled.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import TypeVar

    import numpy as np
    from numpy.typing import NDArray

    Angle = TypeVar("Angle")

CROWN = pi / 2
"""Bearing of the crown [rad]."""

BEARING_ZEROS = {"right": 0.0, "crown": pi / 2, "left": pi, "invert": -pi / 2}
"""Bearing [rad] at which a device's own zero may lie, by name."""

BEARING_SENSES = {"ccw": 1, "cw": -1}
"""Sense in which a device counts its angles, seen looking forward."""


def clock_from_bearing(bearing: Angle) -> Angle:
    """Return the clock position [h], in (0, 12], of a bearing [rad]; scalars and arrays alike.

    >>> [clock_from_bearing(b) for b in (0.0, pi / 2, pi, -pi / 2)]
    [3.0, 12.0, 9.0, 6.0]
    """
    return 12.0 - ((bearing - CROWN) * (6.0 / pi)) % 12.0


def bearing_from_clock(clock: Angle) -> Angle:
    """Return the bearing [rad], in [0, 2 pi), of a clock position [h]; scalars and arrays alike.

    >>> [round(bearing_from_clock(h) / pi, 3) for h in (3, 12, 9, 6)]
    [0.0, 0.5, 1.0, 1.5]
    """
    return (CROWN - clock * (pi / 6.0)) % (2.0 * pi)


@dataclass(frozen=True)
class Variable:
    """One variable of a group: its dims, unit, meaning and whether it must be there."""

    name: str
    dims: tuple[str, ...]
    unit: str
    description: str
    dtype: str = "float64"
    required: bool = False


@dataclass(frozen=True)
class Group:
    """One group of the data contract: what makes it, its variables and its attributes."""

    name: str
    made_by: str
    description: str
    variables: tuple[Variable, ...] = ()
    attributes: tuple[tuple[str, str], ...] = ()
    open: bool = False
    """Whether other variables than those listed may stand in it."""

    def variable(self, name: str) -> Variable:
        """Return the listed variable called `name`; KeyError when it is not listed."""
        return {v.name: v for v in self.variables}[name]


MASK_REASONS = {
    0: "used",
    1: "no_return",
    2: "outlier",
    3: "water",
    4: "occluded",
    5: "lateral",
    6: "out_of_range",
}
"""Why a reading is used or not: the flag values of `/mask`; `water` covers sediment lying flat at the invert."""

FIT_STATUS = {
    0: "fitted",
    1: "too few readings",
    2: "readings collinear",
    3: "arc too short",
    4: "no convergence",
    5: "not an ellipse",
    6: "readings too scattered",
    7: "shape not determined",
}
"""Why a station has a section or has none: the flag values of `/section` status."""

STATION_FLAGS = {
    "inverted": "the section hangs upside down: hinged at the invert first",
    "unlike_neighbours": "differs from the pipe on both sides within half a diameter: a joint, or a misread ring",
    "scattered": "of a cloud: scatters over three times as much as the best quarter of its stations",
}
"""Words in `/section` flags and in the flags column of `stations.csv`, separated by spaces."""

NOT_SPEAKING = ("unlike_neighbours", "scattered")
"""Flags of stations that do not speak for the pipe: left out of largest values and verdicts."""


def flagged(flags: NDArray[np.str_], *words: str) -> NDArray[np.bool_]:
    """Return which stations carry one of the words in their flags.

    >>> import numpy as np
    >>> flagged(np.array(["", "inverted scattered"]), "scattered").tolist()
    [False, True]
    """
    import numpy as np

    found = np.zeros(len(flags), bool)
    for word in words:
        found |= np.char.find(flags.astype(str), word) >= 0
    return found


ROOT_ATTRIBUTES = {
    "name": "asset name",
    "nominal_diameter": "nominal diameter [m]",
    "base_diameter": "base (inside) diameter that deflection refers to when given [m]",
    "wall_thickness": "wall thickness [m]",
    "material": "material of the host pipe",
    "direction": "downstream or upstream",
    "date": "date of the inspection, ISO 8601",
    "crs": "coordinate reference system of eastings and northings",
    "operator": "who drove the inspection",
    "equipment": "what recorded it",
    "provenance": "JSON: program version, resolved configuration, input files with their sha256",
    "chunks": "all: every chunk was written, so that a missing one is damage",
    "rules": "JSON list of verdicts: rule, edition, verdict, where",
    "warnings": "JSON list of what the user must know",
    "assumptions": "JSON list of what was assumed while reading: units, bearing zero and sense, up direction",
}
"""Attributes of a survey's root."""

SENSOR_KINDS = ("ring-laser", "depth-camera", "lidar", "unknown")
"""Kinds of range sensor, for which `config.SensorConfig` states a default scale sigma."""


def _v(name: str, dims: str, unit: str, description: str, dtype: str = "float64", required: bool = False) -> Variable:
    return Variable(name, tuple(dims.split()), unit, description, dtype, required)


def _with_sigma(variables: tuple[Variable, ...]) -> tuple[Variable, ...]:
    """Return each variable followed by its one-sigma."""
    return tuple(
        one
        for v in variables
        for one in (v, Variable(f"{v.name}_sigma", v.dims, v.unit, f"one-sigma of {v.name}, fit and scale"))
    )


_RING_VARIABLES = (
    _v("range", "ring bearing", "m", "range from the origin to the wall; NaN = no return", "float32", True),
    _v("bearing", "bearing", "rad", "bearing of each reading, from +z counter-clockwise", required=True),
    _v(
        "distance",
        "ring",
        "m",
        "what the odometer or cable counter read, or position along the axis",
        required=True,
    ),
    _v("time", "ring", "s", "time of the ring"),
    _v("intensity", "ring bearing", "1", "returned intensity", "float32"),
    _v("sensor_y", "ring", "m", "height of the sensor above the pipe's axis (rings cut from a cloud)"),
    _v("sensor_z", "ring", "m", "sensor to the right of the pipe's axis (rings cut from a cloud)"),
    _v("sensor_pitch", "ring", "rad", "nose up, in the pipe (rings cut from a cloud)"),
    _v("sensor_yaw", "ring", "rad", "nose to the right, in the pipe (rings cut from a cloud)"),
    _v("sensor_y_sigma", "ring", "m", "one-sigma of sensor_y"),
    _v("sensor_z_sigma", "ring", "m", "one-sigma of sensor_z"),
    _v("sensor_pitch_sigma", "ring", "rad", "one-sigma of sensor_pitch"),
    _v("sensor_yaw_sigma", "ring", "rad", "one-sigma of sensor_yaw"),
)
_RING_ATTRIBUTES = (
    ("referred_to", "sensor or axis: a ring already about the pipe's axis is never pose-corrected again"),
    ("distance_source", "odometer or axis (position along the fitted axis of a cloud)"),
    ("sensor_kind", "ring-laser, depth-camera, lidar or unknown"),
    ("bearing_zero", "where the device's zero lay: right, crown, left or invert"),
    ("bearing_sense", "ccw or cw, looking forward"),
    ("bearing_assumed", "1 when zero and sense were assumed, 0 when the file or the user stated them"),
    ("range_noise", "one-sigma of a reading [m], when known"),
    ("wall_share", "share of wall among what a cloud shows near the pipe's axis, 0 to 1"),
    ("diameter_doubt", "relative one-sigma to add to every diameter as it is in doubt which readings are of the wall"),
    ("range_max", "longest range that the sensor reports [m], when known"),
    ("position_x", "sensor's origin ahead of the point whose way the odometer counts [m], when known"),
    ("position_y", "sensor's origin above that point, in robot axes [m], when known"),
    ("position_z", "sensor's origin to the right of that point, in robot axes [m], when known"),
)

_METRICS = (
    _v("semi_major", "station", "m", "semi-major axis of the fitted ellipse"),
    _v("semi_minor", "station", "m", "semi-minor axis of the fitted ellipse"),
    _v("axis_bearing", "station", "rad", "bearing of the major axis, in (-pi/2, pi/2]"),
    _v("diameter_max", "station", "m", "largest chord through O of the fitted section"),
    _v("diameter_max_bearing", "station", "rad", "bearing of the largest chord, in (-pi/2, pi/2]"),
    _v("diameter_min", "station", "m", "smallest chord through O"),
    _v("diameter_x", "station", "m", "horizontal chord, at bearing 0"),
    _v("diameter_y", "station", "m", "vertical chord, at bearing pi/2"),
    _v("diameter_axes", "station", "m", "mean of the largest and the smallest chord"),
    _v("diameter_polar", "station", "m", "twice the mean over bearing of the polar radius about O"),
    _v("diameter_area", "station", "m", "diameter of the circle of equal area"),
    _v("diameter_caliper", "station", "m", "perimeter of the convex hull over pi (Cauchy)"),
    _v("ovality_axes", "station", "1", "(max - mean)/mean with the axes mean"),
    _v("ovality_polar", "station", "1", "(max - mean)/mean with the polar mean"),
    _v("ovality_area", "station", "1", "(max - mean)/mean with the area mean"),
    _v("ovality_caliper", "station", "1", "(max - mean)/mean with the caliper mean"),
    _v("deflection", "station", "1", "(Dref - min)/Dref"),
    _v("deflection_x", "station", "1", "(Dx - Dref)/Dref"),
    _v("deflection_y", "station", "1", "(Dy - Dref)/Dref"),
    _v("area", "station", "m2", "area of the fitted section"),
    _v("perimeter", "station", "m", "perimeter of the fitted section"),
    _v("area_loss", "station", "1", "1 - area over that of the circle of Dref"),
    _v("capacity_loss", "station", "1", "1 - full-flow Manning capacity over that of the circle of Dref"),
)

GROUPS = {
    g.name: g
    for g in (
        Group(
            "points",
            "io",
            "clouds and depth images as read",
            (
                _v("x", "point", "m", "along the sensor's forward axis", required=True),
                _v("y", "point", "m", "up in the sensor's frame", required=True),
                _v("z", "point", "m", "to the right in the sensor's frame", required=True),
                _v("intensity", "point", "1", "returned intensity", "float32"),
                _v("time", "point", "s", "time of the point"),
            ),
            (
                ("source_axes", "how the file's axes map to x forward, y up, z right"),
                ("sensor_kind", "ring-laser, depth-camera, lidar or unknown"),
                ("origin_is_sensor", "1 when the points' origin is the sensor (depth images), else 0"),
            ),
        ),
        Group(
            "rings",
            "io or stages.rings",
            "one revolution of range readings each",
            _RING_VARIABLES,
            _RING_ATTRIBUTES,
        ),
        Group("rings_rear", "io", "rings of a rear scanner", _RING_VARIABLES, _RING_ATTRIBUTES),
        Group(
            "inertial",
            "io",
            "inertial log in robot axes, or attitude on Earth",
            (
                _v("time", "sample", "s", "time of the sample", required=True),
                _v("gyro", "sample axis", "rad/s", "right-handed rates about robot +x, +y, +z"),
                _v("accel", "sample axis", "m/s2", "specific force along robot x, y, z: +g on y at rest"),
                _v("heading", "sample", "rad", "clockwise from north"),
                _v("inclination", "sample", "rad", "nose up"),
                _v("bank", "sample", "rad", "right side down"),
            ),
        ),
        Group(
            "frames",
            "io",
            "CCTV frames",
            (
                _v("time", "frame", "s", "time of the frame"),
                _v("distance", "frame", "m", "odometer at the frame"),
                _v("path", "frame", "", "file of the frame, relative to the survey folder", "str", True),
                _v("lens", "frame", "", "name of the lens model", "str"),
            ),
        ),
        Group(
            "ties",
            "io",
            "known points such as manholes",
            (
                _v("distance", "tie", "m", "odometer at the tie", required=True),
                _v("easting", "tie", "m", "easting", required=True),
                _v("northing", "tie", "m", "northing", required=True),
                _v("elevation", "tie", "m", "elevation", required=True),
                _v("sigma", "tie", "m", "one-sigma of each coordinate", required=True),
            ),
        ),
        Group("calibration", "calibrate", "range scale, boresight, noise law, lens, with covariance", open=True),
        Group("truth", "simulate", "simulations only; no stage reads it", open=True),
        Group("candidates", "detect", "what detect saw, with its evidence", open=True),
        Group(
            "mask",
            "stages.clean",
            "why each reading is used or not",
            (
                _v("reason", "ring bearing", "1", "flag of conventions.MASK_REASONS", "uint8", True),
                _v("coverage", "ring", "1", "used over possible bearings", required=True),
            ),
        ),
        Group(
            "pose",
            "stages.estimate",
            "robot in the pipe",
            (
                *_with_sigma(
                    (
                        _v("offset_y", "ring", "m", "height of the sensor above the pipe's axis"),
                        _v("offset_z", "ring", "m", "sensor to the right of the pipe's axis"),
                        _v("pitch", "ring", "rad", "nose up, in the pipe"),
                        _v("yaw", "ring", "rad", "nose to the right, in the pipe"),
                        _v("roll", "ring", "rad", "from robot z towards robot y"),
                    )
                ),
                _v("covariance", "ring pose pose_2", "", "covariance of offset_y, offset_z, pitch, yaw, roll"),
            ),
            (("why_missing", "JSON: reason for each quantity that is not observable"),),
        ),
        Group(
            "section",
            "stages.estimate",
            "the pipe's true cross-section at each station",
            (
                _v(
                    "chainage",
                    "station",
                    "m",
                    "distance along the pipe axis from the start node",
                    required=True,
                ),
                _v(
                    "distance",
                    "station",
                    "m",
                    "what the odometer read; NaN when there was none",
                    required=True,
                ),
                _v(
                    "parameters",
                    "station parameter",
                    "m",
                    "mean_radius, oval_cos, oval_sin of the ellipse",
                    required=True,
                ),
                _v(
                    "covariance",
                    "station parameter parameter_2",
                    "m2",
                    "covariance of the parameters",
                    required=True,
                ),
                _v("centre_y", "station", "m", "height of the section's centre in the ring's own frame"),
                _v("centre_z", "station", "m", "section's centre to the right in the ring's own frame"),
                _v("deviation_in", "station", "m", "furthest the wall stands inside the section, over 10 degrees"),
                _v("deviation_in_bearing", "station", "rad", "bearing of deviation_in"),
                _v("deviation_out", "station", "m", "furthest the wall stands outside the section, over 10 degrees"),
                _v("deviation_out_bearing", "station", "rad", "bearing of deviation_out"),
                _v("residual_rms", "station", "m", "rms distance of the used readings to the section"),
                _v("noise", "station", "m", "robust one-sigma of one reading about the section"),
                _v("coverage", "station", "1", "used over possible bearings"),
                _v("status", "station", "1", "flag of conventions.FIT_STATUS", "uint8", True),
                _v("mode", "station", "", "circle, 1 to 5, or undecided; empty without a section", "str"),
                _v("mode_probability", "station", "1", "posterior of the likeliest mode"),
                *_with_sigma(
                    (
                        _v("s1", "station", "1", "severity of the bottom half"),
                        _v("s2", "station", "1", "severity of the top half"),
                        _v("s01", "station", "1", "frozen severity of the bottom quarter arcs"),
                        _v("s02", "station", "1", "frozen severity of the top quarter arcs"),
                    )
                ),
                _v("flags", "station", "", "space-separated remarks", "str"),
            ),
            (
                ("model", "shape model: ellipse"),
                ("range_scale_sigma", "relative one-sigma of the sensor's scale"),
                ("range_scale_source", "where that sigma comes from"),
            ),
            open=True,
        ),
        Group(
            "metrics",
            "stages.metrics",
            "diameters, ovalities, deflection, area and capacity",
            (
                _v("chainage", "station", "m", "chainage of the station", required=True),
                *_with_sigma(_METRICS),
                _v(
                    "diameter_area_sigma_fit",
                    "station",
                    "m",
                    "one-sigma of diameter_area without the scale's part",
                ),
                _v("ovality_polar_low", "station", "1", "lower end of the 95 % interval of ovality_polar"),
                _v("ovality_polar_high", "station", "1", "upper end of the 95 % interval of ovality_polar"),
            ),
            (
                ("reference_diameter", "Dref [m]"),
                ("reference_kind", "nominal, base or none"),
                ("diameter_mean", "area mean diameter over the stations [m]"),
                ("diameter_sigma", "its one-sigma, fit and scale [m]"),
                ("diameter_sigma_fit", "the fit's part [m]"),
                ("diameter_sigma_scale", "the sensor scale's part [m]"),
            ),
        ),
        Group(
            "features",
            "stages.features",
            "joints, laterals, dents, deposits",
            (
                _v("kind", "feature", "", "joint, lateral, dent, deposit, ...", "str", True),
                _v("chainage", "feature", "m", "chainage of the feature's middle", required=True),
                _v("chainage_sigma", "feature", "m", "one-sigma of chainage"),
                _v("bearing", "feature", "rad", "bearing of the feature's middle"),
                _v("size", "feature", "m", "size along the wall"),
                _v("length", "feature", "m", "length along the pipe"),
                _v("depth", "feature", "m", "depth: positive outward, negative inward"),
                _v("confidence", "feature", "1", "probability that the feature is there"),
                _v("source", "feature", "", "rings, images or both", "str"),
                _v("image", "feature", "", "file of the image that shows it best", "str"),
            ),
            open=True,
        ),
        Group("layout", "stages.estimate", "centreline, gradient, bends, with sigma", open=True),
        Group("design", "design", "required liner thickness and the check that governs", open=True),
    )
}
"""The data contract: group name to `Group`; `survey.schema` validates against it, the docs page is made from it."""

SOURCE_GROUPS = ("points", "rings", "rings_rear", "inertial", "frames", "ties", "calibration", "truth")
"""Groups that come from files; all others are results, made anew by each inspection."""

SECTION_PARAMETERS = ("mean_radius", "oval_cos", "oval_sin")
"""Parameters of the ellipse: half sum of the semi-axes, and their half difference times cos and sin of twice the
major axis's bearing; unlike (semi-axes, bearing) they stay regular at the circle."""

POSE_TERMS = ("offset_y", "offset_z", "pitch", "yaw", "roll")
"""Order of the rows of `/pose` covariance."""


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
    "parts": "table of files: rings, inertial, ties, frames",
    "sensor": "table: kind, bearing_zero, bearing_sense, range_noise, and the sensor's geometry",
    "lens": "tables of lens models by name",
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
}
"""Keys of the table `[sensor]` of `survey.toml`; lengths are stored as attributes of `/rings` in m, angles in rad
without the `_deg`."""
