"""The groups of a survey: which variables stand in each, with dims, unit and meaning."""

from __future__ import annotations

from dataclasses import dataclass


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


def _v(name: str, dims: str, unit: str, description: str, dtype: str = "float64", required: bool = False) -> Variable:
    return Variable(name, tuple(dims.split()), unit, description, dtype, required)


def _with_sigma(variables: tuple[Variable, ...], holds: str = ", fit and scale") -> tuple[Variable, ...]:
    """Return each variable followed by its one-sigma, which holds what `holds` says."""
    return tuple(
        one
        for v in variables
        for one in (v, Variable(f"{v.name}_sigma", v.dims, v.unit, f"one-sigma of {v.name}{holds}"))
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
    ("range_scale_applied", "range scale by which the ranges were divided, when a calibration was applied"),
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
        Group(
            "calibration",
            "calibrate",
            "range scale, boresight, noise law, lens, with covariance",
            (
                *_with_sigma(
                    (
                        _v("range_scale", "", "1", "reading over true range; ranges are divided by it"),
                        _v("boresight_pitch", "", "rad", "ring plane's normal against the forward axis, nose up"),
                        _v("boresight_yaw", "", "rad", "the same, nose to the right"),
                        _v("boresight_roll", "", "rad", "zero reading against its bearing, from robot z towards y"),
                        _v("noise_constant", "", "m", "one-sigma of a reading: the part that does not grow"),
                        _v("noise_relative", "", "1", "the part that grows with the range, over the range"),
                    )
                ),
                _v("covariance", "calibration_term calibration_term_2", "", "covariance of CALIBRATION_TERMS"),
                _v("range_low", "", "m", "shortest range at which the noise law was seen"),
                _v("range_high", "", "m", "longest range at which it was seen"),
            ),
            (
                ("reference_diameter", "inside diameter of the reference [m]"),
                ("reference_sigma", "its one-sigma [m]"),
                ("tilt_sigma", "one-sigma of each stated tilt by itself [rad]"),
                ("common_tilt_sigma", "one-sigma of what all tilts have wrong in common [rad]"),
                ("misfit", "squared misfit of the scans over that expected"),
                ("readings", "readings that the noise law stands on"),
                ("scans", "JSON list: name, rings, tilt_deg and input files of each scan"),
                ("why_missing", "JSON: reason for each quantity that is not observable"),
                ("notes", "JSON list of what the user must know"),
                ("lens", "JSON: lens models by name"),
            ),
            open=True,
        ),
        Group(
            "observations",
            "io",
            "what people coded from CCTV, as an exchange file has it; codes that are not known are carried",
            (
                _v("inspection_row", "observation", "1", "row of the inspection that it belongs to", "int64", True),
                _v("distance", "observation", "m", "what the counter read, from the inspection's start", required=True),
                _v("code", "observation", "", "code as in the file", "str", True),
                _v("kind", "observation", "", "joint, lateral, ... as in /features; empty for a code without", "str"),
                _v("characterisation_1", "observation", "", "as in the file", "str"),
                _v("characterisation_2", "observation", "", "as in the file", "str"),
                _v("quantification_1", "observation", "", "as in the file: its unit hangs on the code", "str"),
                _v("quantification_2", "observation", "", "as in the file", "str"),
                _v("bearing", "observation", "rad", "bearing at the first clock position"),
                _v("bearing_to", "observation", "rad", "bearing at the second one, clockwise from the first"),
                _v("joint", "observation", "", "whether it lies at a joint, as in the file", "str"),
                _v("continuous", "observation", "", "label of a continuous defect's start or end", "str"),
                _v("photo", "observation", "", "reference of the photograph", "str"),
                _v("video", "observation", "", "reference into the video", "str"),
                _v("remarks", "observation", "", "as in the file", "str"),
                _v("fields", "observation", "", "JSON: whatever else the file says of it", "str"),
                _v("name", "inspection", "", "the pipe's name", "str"),
                _v("header", "inspection", "", "JSON: what the file says of the inspection, by its own names", "str"),
            ),
            (
                ("format", "key of the format that it was read from"),
                ("layout", "JSON: how the file was laid out, to write it back alike"),
            ),
        ),
        Group("truth", "simulate", "simulations only; no stage reads it", open=True),
        Group(
            "candidates",
            "stages.detect",
            "what rings and images show that is not plain wall, before it is confirmed",
            (
                _v("kind", "candidate", "", "joint, lateral, inward (a dent, a deposit or an intrusion)", "str", True),
                *_with_sigma(
                    (
                        _v("distance", "candidate", "m", "of its middle, by the same counter as the rings and frames"),
                        _v("bearing", "candidate", "rad", "of its middle, as the ring sees it; NaN for a joint"),
                        _v("size", "candidate", "m", "width round the wall; of a joint its gap"),
                        _v("length", "candidate", "m", "length along the pipe"),
                        _v("depth", "candidate", "m", "positive outward, negative inward; NaN when unseen"),
                    ),
                    "",
                ),
                _v("score", "candidate", "1", "strength of the evidence, in sigmas of what chance shows"),
                _v("probability", "candidate", "1", "that it is there", required=True),
                _v("source", "candidate", "", "rings or images", "str", True),
                _v("first_ring", "candidate", "1", "first ring that shows it; -1 for images", "int64"),
                _v("last_ring", "candidate", "1", "last ring that shows it; -1 for images", "int64"),
                _v("image", "candidate", "", "file of the frame that shows it best; empty for rings", "str"),
                _v("opening", "ring bearing", "1", "1 where a reading falls on an opening, not on wall", "uint8"),
            ),
            (("false_alarm", "bumps and closed joints that a survey may show by chance"),),
            open=True,
        ),
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
            "robot in the pipe; where a calibration found a boresight, the attitude is the scanner's",
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
                _v("chainage_sigma", "station", "m", "one-sigma of chainage, from where the odometer read zero"),
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
                _v("liner_lobe", "station", "1", "1 where the liner has left its host in a lobe", "uint8"),
                _v("liner_lobe_false_alarm", "station", "1", "how often a station without a lobe shows as much"),
                *_with_sigma(
                    (
                        _v("liner_lobe_bearing", "station", "rad", "bearing of the lobe's centre"),
                        _v("liner_lobe_half_angle", "station", "rad", "half the angle that the lobe spans"),
                        _v("liner_lobe_depth", "station", "m", "host's radius at its centre less what is left there"),
                        _v("liner_lobe_power", "station", "1", "power of the lobe's shape; sigma 0 where it was given"),
                        _v("liner_remaining_radius", "station", "m", "radius left at the lobe's centre (OC)"),
                        _v("liner_gap_area", "station", "m2", "area between host and lobe"),
                    )
                ),
                _v("liner_protrusion", "station", "m", "furthest the fitted lobe leaves its host outward"),
            ),
            (
                ("model", "shape model: ellipse"),
                ("range_scale_sigma", "relative one-sigma of the sensor's scale"),
                ("range_scale_source", "where that sigma comes from"),
                ("mean_diameter", "of a cloud: diameter of the mean section [m]"),
                ("mean_diameter_sigma", "its one-sigma without the sensor's scale [m]"),
                ("liner_kind", "kind of lobe that was looked for: proposed or smooth"),
                ("liner_false_alarm_rate", "how often a station without a lobe may be said to show one"),
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
            "joints, laterals, dents, deposits and intrusions, confirmed, sized and placed on the pipe",
            (
                _v("kind", "feature", "", "joint, lateral, dent, deposit or intrusion", "str", True),
                _v("chainage", "feature", "m", "chainage of the feature's middle", required=True),
                _v("chainage_sigma", "feature", "m", "one-sigma of chainage"),
                *_with_sigma(
                    (
                        _v("bearing", "feature", "rad", "bearing of the feature's middle; NaN for what goes all round"),
                        _v("size", "feature", "m", "width round the wall; bore of a lateral; gap of a joint"),
                        _v("length", "feature", "m", "length along the pipe"),
                        _v("depth", "feature", "m", "depth: positive outward, negative inward"),
                        _v("inclination", "feature", "rad", "of a lateral's bore, from across the pipe towards +x"),
                        _v("protrusion", "feature", "m", "how far a lateral's end stands into the pipe"),
                        _v("step", "feature", "m", "how far the next pipe is displaced sideways at a joint"),
                        _v("step_y", "feature", "m", "its part up"),
                        _v("step_z", "feature", "m", "its part to the right"),
                        _v("step_radius", "feature", "m", "how much larger the next pipe's mean radius is"),
                        _v("kink", "feature", "rad", "angle by which the next pipe turns at a joint"),
                        _v("kink_up", "feature", "rad", "its part up"),
                        _v("kink_right", "feature", "rad", "its part to the right"),
                    ),
                    "",
                ),
                _v("confidence", "feature", "1", "probability that the feature is there and is of its kind"),
                _v("source", "feature", "", "rings, images or both; by hand where a person added it", "str"),
                _v("first_ring", "feature", "1", "first ring that shows it; -1 when none does", "int64"),
                _v("last_ring", "feature", "1", "last ring that shows it; -1 when none does", "int64"),
                _v("image", "feature", "", "file of the image that shows it best", "str"),
            ),
            (("false_alarm", "bumps and closed joints that a survey may show by chance"),),
            open=True,
        ),
        Group(
            "layout",
            "stages.estimate",
            "where the pipe's axis runs, how it falls, its bends, sags and angles at joints",
            (
                *_with_sigma(
                    (
                        _v("chainage", "station", "m", "chainage of the station", required=True),
                        _v("easting", "station", "m", "of the axis; of the ties' frame, or of a local one"),
                        _v("northing", "station", "m", "of the axis"),
                        _v("elevation", "station", "m", "of the axis"),
                        _v("gradient", "station", "1", "rise per metre of run along travel"),
                        _v("heading", "station", "rad", "of the axis along travel, clockwise from north"),
                        _v(
                            "bend_radius",
                            "station",
                            "m",
                            "radius of the bend in which the station lies; NaN if straight",
                        ),
                    )
                ),
                _v("axis_covariance", "station axis axis_2", "m2", "covariance of easting, northing, elevation"),
                *_with_sigma(
                    (
                        _v("bend_start", "bend", "m", "chainage at which each bend begins"),
                        _v("bend_angle", "bend", "rad", "between the straight runs beside it"),
                        _v("bend_arc_radius", "bend", "m", "radius of the axis"),
                    )
                ),
                _v("bend_length", "bend", "m", "length of the arc"),
                _v("bend_towards", "bend", "rad", "bearing in the section towards the bend's centre"),
                *_with_sigma(
                    (
                        _v("sag_depth", "sag", "m", "furthest the invert hangs below the string between its ends"),
                        _v("sag_ponding", "sag", "m", "depth of water that stands in it when nothing flows"),
                        _v("joint_up", "joint", "rad", "angle of the axis at each joint, upwards"),
                        _v("joint_right", "joint", "rad", "angle of the axis at each joint, to the right"),
                    )
                ),
                _v("sag_start", "sag", "m", "chainage at which each sag begins"),
                _v("sag_length", "sag", "m", "length along the axis"),
                _v("sag_lowest", "sag", "m", "chainage of its deepest place"),
                _v("joint_chainage", "joint", "m", "chainage of each joint whose angle was measured"),
            ),
            (
                ("frame", "ties, or local: from the first ring, heading as the robot did"),
                ("crs", "coordinate reference system of the ties; empty when not stated"),
                ("why_missing", "JSON: reason for each quantity that is not observable"),
            ),
            open=True,
        ),
        Group(
            "design",
            "design",
            "required liner thickness and the check that governs; `thickness_...` [m] by each check",
            (
                _v("chainage", "station", "m", "chainage of the station", required=True),
                _v("diameter", "station", "m", "mean diameter that was used"),
                _v("ovality", "station", "1", "ovality that was used"),
                *_with_sigma((_v("liner_thickness", "station", "m", "thickness that the governing check asks for"),)),
                _v("liner_governing", "station", "", "check that asks for most; empty without a thickness", "str"),
                _v("liner_standard", "station", "m", "next thickness up that is made"),
                _v("dimension_ratio", "station", "1", "diameter over liner_thickness"),
                _v("liner_remarks", "station", "", "space-separated keys of design.liner.WARNINGS", "str"),
            ),
            (
                ("rule", "published method"),
                ("edition", "its edition"),
                ("condition", "partially or fully deteriorated"),
                ("mean", "by which mean diameter and ovality are taken"),
                ("governing_station", "station that asks for most and speaks for the pipe"),
                ("required_upper", "one-sided 95 % bound of its thickness [m]"),
                ("standard", "next thickness up that is made [m]"),
                ("standard_upper", "the same for required_upper [m]"),
                ("checks", "JSON list of the checks that applied"),
                ("inputs", "JSON: every number of the design, in SI"),
            ),
            open=True,
        ),
    )
}
"""The data contract: group name to `Group`; `survey.schema` validates against it, the docs page is made from it."""

SOURCE_GROUPS = ("points", "rings", "rings_rear", "inertial", "frames", "ties", "calibration", "observations", "truth")
"""Groups that come from files; all others are results, made anew by each inspection."""

SECTION_PARAMETERS = ("mean_radius", "oval_cos", "oval_sin")
"""Parameters of the ellipse: half sum of the semi-axes, and their half difference times cos and sin of twice the
major axis's bearing; unlike (semi-axes, bearing) they stay regular at the circle."""

CALIBRATION_TERMS = (
    "range_scale",
    "boresight_pitch",
    "boresight_yaw",
    "boresight_roll",
    "noise_constant",
    "noise_relative",
)
"""Order of the rows of `/calibration` covariance."""

POSE_TERMS = ("offset_y", "offset_z", "pitch", "yaw", "roll")
"""Order of the rows of `/pose` covariance."""
