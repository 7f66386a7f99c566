"""The groups that come from files, and the truth of simulations."""

from __future__ import annotations

from .group import Group, var, with_sigma

_RING_VARIABLES = (
    var("range", "ring bearing", "m", "range from the origin to the wall; NaN = no return", "float32", True),
    var("bearing", "bearing", "rad", "bearing of each reading, from +z counter-clockwise", required=True),
    var(
        "distance",
        "ring",
        "m",
        "what the odometer or cable counter read, or position along the axis",
        required=True,
    ),
    var("time", "ring", "s", "time of the ring"),
    var("intensity", "ring bearing", "1", "returned intensity", "float32"),
    var("sensor_y", "ring", "m", "height of the sensor above the pipe's axis (rings cut from a cloud)"),
    var("sensor_z", "ring", "m", "sensor to the right of the pipe's axis (rings cut from a cloud)"),
    var("sensor_pitch", "ring", "rad", "nose up, in the pipe (rings cut from a cloud)"),
    var("sensor_yaw", "ring", "rad", "nose to the right, in the pipe (rings cut from a cloud)"),
    var("sensor_y_sigma", "ring", "m", "one-sigma of sensor_y"),
    var("sensor_z_sigma", "ring", "m", "one-sigma of sensor_z"),
    var("sensor_pitch_sigma", "ring", "rad", "one-sigma of sensor_pitch"),
    var("sensor_yaw_sigma", "ring", "rad", "one-sigma of sensor_yaw"),
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

SOURCES = (
    Group(
        "points",
        "io",
        "clouds and depth images as read",
        (
            var("x", "point", "m", "along the sensor's forward axis", required=True),
            var("y", "point", "m", "up in the sensor's frame", required=True),
            var("z", "point", "m", "to the right in the sensor's frame", required=True),
            var("intensity", "point", "1", "returned intensity", "float32"),
            var("time", "point", "s", "time of the point"),
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
    Group(
        "rings_rear",
        "io",
        "rings of a second scanner on the same robot, by the same counter and clock",
        _RING_VARIABLES,
        (
            *_RING_ATTRIBUTES,
            (
                "baseline_sigma",
                "one-sigma of the direction between both scanners' origins, as positions state it [rad]",
            ),
        ),
    ),
    Group(
        "inertial",
        "io",
        "inertial log in robot axes, or attitude on Earth",
        (
            var("time", "sample", "s", "time of the sample", required=True),
            var("gyro", "sample axis", "rad/s", "right-handed rates about robot +x, +y, +z"),
            var("accel", "sample axis", "m/s2", "specific force along robot x, y, z: +g on y at rest"),
            var("heading", "sample", "rad", "clockwise from north"),
            var("inclination", "sample", "rad", "nose up"),
            var("bank", "sample", "rad", "right side down"),
        ),
    ),
    Group(
        "frames",
        "io",
        "CCTV frames",
        (
            var("time", "frame", "s", "time of the frame"),
            var("distance", "frame", "m", "odometer at the frame"),
            var("path", "frame", "", "file of the frame, relative to the survey folder", "str", True),
            var("lens", "frame", "", "name of the lens model", "str"),
        ),
    ),
    Group(
        "ties",
        "io",
        "known points such as manholes",
        (
            var("distance", "tie", "m", "odometer at the tie", required=True),
            var("easting", "tie", "m", "easting", required=True),
            var("northing", "tie", "m", "northing", required=True),
            var("elevation", "tie", "m", "elevation", required=True),
            var("sigma", "tie", "m", "one-sigma of each coordinate", required=True),
        ),
    ),
    Group(
        "design_line",
        "io.design_line",
        "the line to which the pipe was to be laid, straight between its points",
        (
            var("chainage", "vertex", "m", "along the pipe from the start node; NaN when the line does not state it"),
            var("easting", "vertex", "m", "easting; NaN for a line of chainage and elevation"),
            var("northing", "vertex", "m", "northing; NaN for a line of chainage and elevation"),
            var("elevation", "vertex", "m", "elevation of what refers_to names", required=True),
        ),
        (("refers_to", "axis or invert: what runs along the line"), ("source", "name of its file")),
    ),
    Group(
        "calibration",
        "calibrate",
        "range scale, boresight, noise law, lens, with covariance",
        (
            *with_sigma(
                (
                    var("range_scale", "", "1", "reading over true range; ranges are divided by it"),
                    var("boresight_pitch", "", "rad", "ring plane's normal against the forward axis, nose up"),
                    var("boresight_yaw", "", "rad", "the same, nose to the right"),
                    var("boresight_roll", "", "rad", "zero reading against its bearing, from robot z towards y"),
                    var("noise_constant", "", "m", "one-sigma of a reading: the part that does not grow"),
                    var("noise_relative", "", "1", "the part that grows with the range, over the range"),
                )
            ),
            var("covariance", "calibration_term calibration_term_2", "", "covariance of CALIBRATION_TERMS"),
            var("range_low", "", "m", "shortest range at which the noise law was seen"),
            var("range_high", "", "m", "longest range at which it was seen"),
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
            var("inspection_row", "observation", "1", "row of the inspection that it belongs to", "int64", True),
            var("distance", "observation", "m", "what the counter read, from the inspection's start", required=True),
            var("code", "observation", "", "code as in the file", "str", True),
            var("kind", "observation", "", "joint, lateral, ... as in /features; empty for a code without", "str"),
            var("characterisation_1", "observation", "", "as in the file", "str"),
            var("characterisation_2", "observation", "", "as in the file", "str"),
            var("quantification_1", "observation", "", "as in the file: its unit hangs on the code", "str"),
            var("quantification_2", "observation", "", "as in the file", "str"),
            var("bearing", "observation", "rad", "bearing at the first clock position"),
            var("bearing_to", "observation", "rad", "bearing at the second one, clockwise from the first"),
            var("joint", "observation", "", "whether it lies at a joint, as in the file", "str"),
            var("continuous", "observation", "", "label of a continuous defect's start or end", "str"),
            var("photo", "observation", "", "reference of the photograph", "str"),
            var("video", "observation", "", "reference into the video", "str"),
            var("remarks", "observation", "", "as in the file", "str"),
            var("fields", "observation", "", "JSON: whatever else the file says of it", "str"),
            var("name", "inspection", "", "the pipe's name", "str"),
            var("header", "inspection", "", "JSON: what the file says of the inspection, by its own names", "str"),
        ),
        (
            ("format", "key of the format that it was read from"),
            ("layout", "JSON: how the file was laid out, to write it back alike"),
        ),
    ),
    Group("truth", "simulate", "simulations only; no stage reads it", open=True),
)
"""Groups made by readers, by calibration or by the simulator."""
