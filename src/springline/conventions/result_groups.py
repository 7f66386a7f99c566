"""The groups that an inspection makes."""

from __future__ import annotations

from .group import Group, var, with_sigma

_METRICS = (
    var("semi_major", "station", "m", "semi-major axis of the fitted ellipse"),
    var("semi_minor", "station", "m", "semi-minor axis of the fitted ellipse"),
    var("axis_bearing", "station", "rad", "bearing of the major axis, in (-pi/2, pi/2]"),
    var("diameter_max", "station", "m", "largest chord through O of the fitted section"),
    var("diameter_max_bearing", "station", "rad", "bearing of the largest chord, in (-pi/2, pi/2]"),
    var("diameter_min", "station", "m", "smallest chord through O"),
    var("diameter_x", "station", "m", "horizontal chord, at bearing 0"),
    var("diameter_y", "station", "m", "vertical chord, at bearing pi/2"),
    var("diameter_axes", "station", "m", "mean of the largest and the smallest chord"),
    var("diameter_polar", "station", "m", "twice the mean over bearing of the polar radius about O"),
    var("diameter_area", "station", "m", "diameter of the circle of equal area"),
    var("diameter_caliper", "station", "m", "perimeter of the convex hull over pi (Cauchy)"),
    var("ovality_axes", "station", "1", "(max - mean)/mean with the axes mean"),
    var("ovality_polar", "station", "1", "(max - mean)/mean with the polar mean"),
    var("ovality_area", "station", "1", "(max - mean)/mean with the area mean"),
    var("ovality_caliper", "station", "1", "(max - mean)/mean with the caliper mean"),
    var("deflection", "station", "1", "(Dref - min)/Dref"),
    var("deflection_x", "station", "1", "(Dx - Dref)/Dref"),
    var("deflection_y", "station", "1", "(Dy - Dref)/Dref"),
    var("area", "station", "m2", "area of the fitted section"),
    var("perimeter", "station", "m", "perimeter of the fitted section"),
    var("area_loss", "station", "1", "1 - area over that of the circle of Dref"),
    var("capacity_loss", "station", "1", "1 - full-flow Manning capacity over that of the circle of Dref"),
)

RESULTS = (
    Group(
        "candidates",
        "stages.detect",
        "what rings and images show that is not plain wall, before it is confirmed",
        (
            var("kind", "candidate", "", "joint, lateral, inward (a dent, a deposit or an intrusion)", "str", True),
            *with_sigma(
                (
                    var("distance", "candidate", "m", "of its middle, by the same counter as the rings and frames"),
                    var("bearing", "candidate", "rad", "of its middle, as the ring sees it; NaN for a joint"),
                    var("size", "candidate", "m", "width round the wall; of a joint its gap"),
                    var("length", "candidate", "m", "length along the pipe"),
                    var("depth", "candidate", "m", "positive outward, negative inward; NaN when unseen"),
                ),
                "",
            ),
            var("score", "candidate", "1", "strength of the evidence, in sigmas of what chance shows"),
            var("probability", "candidate", "1", "that it is there", required=True),
            var("source", "candidate", "", "rings or images", "str", True),
            var("first_ring", "candidate", "1", "first ring that shows it; -1 for images", "int64"),
            var("last_ring", "candidate", "1", "last ring that shows it; -1 for images", "int64"),
            var("image", "candidate", "", "file of the frame that shows it best; empty for rings", "str"),
            var("opening", "ring bearing", "1", "1 where a reading falls on an opening, not on wall", "uint8"),
        ),
        (("false_alarm", "bumps and closed joints that a survey may show by chance"),),
        open=True,
    ),
    Group(
        "mask",
        "stages.clean",
        "why each reading is used or not",
        (
            var("reason", "ring bearing", "1", "flag of conventions.MASK_REASONS", "uint8", True),
            var("coverage", "ring", "1", "used over possible bearings", required=True),
        ),
    ),
    Group(
        "mask_rear",
        "stages.clean",
        "the same of a rear scanner's readings",
        (
            var("reason", "ring bearing", "1", "flag of conventions.MASK_REASONS", "uint8", True),
            var("coverage", "ring", "1", "used over possible bearings", required=True),
        ),
    ),
    Group(
        "pose",
        "stages.estimate",
        "robot in the pipe; where a calibration found a boresight, the attitude is the scanner's",
        (
            *with_sigma(
                (
                    var("offset_y", "ring", "m", "height of the sensor above the pipe's axis"),
                    var("offset_z", "ring", "m", "sensor to the right of the pipe's axis"),
                    var("pitch", "ring", "rad", "nose up, in the pipe"),
                    var("yaw", "ring", "rad", "nose to the right, in the pipe"),
                    var("roll", "ring", "rad", "from robot z towards robot y"),
                )
            ),
            var("covariance", "ring pose pose_2", "", "covariance of offset_y, offset_z, pitch, yaw, roll"),
        ),
        (("why_missing", "JSON: reason for each quantity that is not observable"),),
    ),
    Group(
        "section",
        "stages.estimate",
        "the pipe's true cross-section at each station",
        (
            var(
                "chainage",
                "station",
                "m",
                "distance along the pipe axis from the start node",
                required=True,
            ),
            var("chainage_sigma", "station", "m", "one-sigma of chainage, from where the odometer read zero"),
            var(
                "distance",
                "station",
                "m",
                "what the odometer read; NaN when there was none",
                required=True,
            ),
            var(
                "parameters",
                "station parameter",
                "m",
                "mean_radius, oval_cos, oval_sin of the ellipse",
                required=True,
            ),
            var(
                "covariance",
                "station parameter parameter_2",
                "m2",
                "covariance of the parameters",
                required=True,
            ),
            var("centre_y", "station", "m", "height of the section's centre in the ring's own frame"),
            var("centre_z", "station", "m", "section's centre to the right in the ring's own frame"),
            var("deviation_in", "station", "m", "furthest the wall stands inside the section, over 10 degrees"),
            var("deviation_in_bearing", "station", "rad", "bearing of deviation_in"),
            var("deviation_out", "station", "m", "furthest the wall stands outside the section, over 10 degrees"),
            var("deviation_out_bearing", "station", "rad", "bearing of deviation_out"),
            var("residual_rms", "station", "m", "rms distance of the used readings to the section"),
            var("noise", "station", "m", "robust one-sigma of one reading about the section"),
            var("coverage", "station", "1", "used over possible bearings"),
            var("status", "station", "1", "flag of conventions.FIT_STATUS", "uint8", True),
            var("mode", "station", "", "circle, 1 to 5, or undecided; empty without a section", "str"),
            var("mode_probability", "station", "1", "posterior of the likeliest mode"),
            *with_sigma(
                (
                    var("s1", "station", "1", "severity of the bottom half"),
                    var("s2", "station", "1", "severity of the top half"),
                    var("s01", "station", "1", "frozen severity of the bottom quarter arcs"),
                    var("s02", "station", "1", "frozen severity of the top quarter arcs"),
                )
            ),
            var("flags", "station", "", "space-separated remarks", "str"),
            var("liner_lobe", "station", "1", "1 where the liner has left its host in a lobe", "uint8"),
            var("liner_lobe_false_alarm", "station", "1", "how often a station without a lobe shows as much"),
            *with_sigma(
                (
                    var("liner_lobe_bearing", "station", "rad", "bearing of the lobe's centre"),
                    var("liner_lobe_half_angle", "station", "rad", "half the angle that the lobe spans"),
                    var("liner_lobe_depth", "station", "m", "host's radius at its centre less what is left there"),
                    var("liner_lobe_power", "station", "1", "power of the lobe's shape; sigma 0 where it was given"),
                    var("liner_remaining_radius", "station", "m", "radius left at the lobe's centre (OC)"),
                    var("liner_gap_area", "station", "m2", "area between host and lobe"),
                )
            ),
            var("liner_protrusion", "station", "m", "furthest the fitted lobe leaves its host outward"),
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
        "passes",
        "stages.passes",
        "the back pass at the stations of the out pass, where both were joined",
        (
            var("chainage", "station", "m", "chainage of the station", required=True),
            *with_sigma(
                (var("back_chainage", "station", "m", "its place by the back pass, from the out pass's end"),), ""
            ),
            *with_sigma(
                (var("radius_difference", "station", "m", "mean radius of the out pass less that of the back"),), ""
            ),
            var("misfit", "station", "1", "squared difference of the two sections over its variance, per parameter"),
        ),
    ),
    Group(
        "metrics",
        "stages.metrics",
        "diameters, ovalities, deflection, area and capacity",
        (
            var("chainage", "station", "m", "chainage of the station", required=True),
            *with_sigma(_METRICS),
            var(
                "diameter_area_sigma_fit",
                "station",
                "m",
                "one-sigma of diameter_area without the scale's part",
            ),
            var("ovality_polar_low", "station", "1", "lower end of the 95 % interval of ovality_polar"),
            var("ovality_polar_high", "station", "1", "upper end of the 95 % interval of ovality_polar"),
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
            var("kind", "feature", "", "joint, lateral, dent, deposit or intrusion", "str", True),
            var("chainage", "feature", "m", "chainage of the feature's middle", required=True),
            var("chainage_sigma", "feature", "m", "one-sigma of chainage"),
            *with_sigma(
                (
                    var("bearing", "feature", "rad", "bearing of the feature's middle; NaN for what goes all round"),
                    var("size", "feature", "m", "width round the wall; bore of a lateral; gap of a joint"),
                    var("length", "feature", "m", "length along the pipe"),
                    var("depth", "feature", "m", "depth: positive outward, negative inward"),
                    var("inclination", "feature", "rad", "of a lateral's bore, from across the pipe towards +x"),
                    var("protrusion", "feature", "m", "how far a lateral's end stands into the pipe"),
                    var("step", "feature", "m", "how far the next pipe is displaced sideways at a joint"),
                    var("step_y", "feature", "m", "its part up"),
                    var("step_z", "feature", "m", "its part to the right"),
                    var("step_radius", "feature", "m", "how much larger the next pipe's mean radius is"),
                    var("kink", "feature", "rad", "angle by which the next pipe turns at a joint"),
                    var("kink_up", "feature", "rad", "its part up"),
                    var("kink_right", "feature", "rad", "its part to the right"),
                ),
                "",
            ),
            var("confidence", "feature", "1", "probability that the feature is there and is of its kind"),
            var("source", "feature", "", "rings, images or both; by hand where a person added it", "str"),
            var("first_ring", "feature", "1", "first ring that shows it; -1 when none does", "int64"),
            var("last_ring", "feature", "1", "last ring that shows it; -1 when none does", "int64"),
            var("image", "feature", "", "file of the image that shows it best", "str"),
        ),
        (("false_alarm", "bumps and closed joints that a survey may show by chance"),),
        open=True,
    ),
    Group(
        "texture",
        "stages.images",
        "the wall's colours as frames show them, the lamp's fall of light taken away",
        (
            var("chainage", "row", "m", "chainage of the row's middle", required=True),
            var("bearing", "column", "rad", "bearing of the column's middle", required=True),
            var("colour", "row column channel", "1", "red, green and blue in sRGB; 0 where unseen", "uint8", True),
            var("seen", "row column", "1", "1 where a frame shows the wall", "uint8", True),
        ),
        (("cell", "length of a row [m]"), ("frames", "how many frames were laid")),
    ),
    Group(
        "layout",
        "stages.estimate, stages.design_line",
        "where the pipe's axis runs, how it falls, its bends, sags and angles at joints",
        (
            *with_sigma(
                (
                    var("chainage", "station", "m", "chainage of the station", required=True),
                    var("easting", "station", "m", "of the axis; of the ties' frame, or of a local one"),
                    var("northing", "station", "m", "of the axis"),
                    var("elevation", "station", "m", "of the axis"),
                    var("gradient", "station", "1", "rise per metre of run along travel"),
                    var("heading", "station", "rad", "of the axis along travel, clockwise from north"),
                    var(
                        "bend_radius",
                        "station",
                        "m",
                        "radius of the bend in which the station lies; NaN if straight",
                    ),
                )
            ),
            var("axis_covariance", "station axis axis_2", "m2", "covariance of easting, northing, elevation"),
            var("design_elevation", "station", "m", "of the design line abreast of the station; in its own datum"),
            var("design_gradient", "station", "1", "of the design line, rise per metre of run along travel"),
            *with_sigma(
                (
                    var("deviation_up", "station", "m", "axis or invert above the design line"),
                    var("deviation_right", "station", "m", "axis to the right of the design line, along travel"),
                    var("deviation_gradient", "station", "1", "gradient less that of the design line"),
                ),
                "",
            ),
            *with_sigma(
                (
                    var("bend_start", "bend", "m", "chainage at which each bend begins"),
                    var("bend_angle", "bend", "rad", "between the straight runs beside it"),
                    var("bend_arc_radius", "bend", "m", "radius of the axis"),
                )
            ),
            var("bend_length", "bend", "m", "length of the arc"),
            var("bend_towards", "bend", "rad", "bearing in the section towards the bend's centre"),
            *with_sigma(
                (
                    var("sag_depth", "sag", "m", "furthest the invert hangs below the string between its ends"),
                    var("sag_ponding", "sag", "m", "depth of water that stands in it when nothing flows"),
                    var("joint_up", "joint", "rad", "angle of the axis at each joint, upwards"),
                    var("joint_right", "joint", "rad", "angle of the axis at each joint, to the right"),
                )
            ),
            var("sag_start", "sag", "m", "chainage at which each sag begins"),
            var("sag_length", "sag", "m", "length along the axis"),
            var("sag_lowest", "sag", "m", "chainage of its deepest place"),
            var("joint_chainage", "joint", "m", "chainage of each joint whose angle was measured"),
        ),
        (
            ("frame", "ties, or local: from the first ring, heading as the robot did"),
            ("crs", "coordinate reference system of the ties; empty when not stated"),
            ("why_missing", "JSON: reason for each quantity that is not observable"),
            ("design_line", "axis or invert, whichever was held against the design line"),
            ("design_datum", "absolute, or chainage [m] of the station held to the line as nothing tells the height"),
        ),
        open=True,
    ),
    Group(
        "design",
        "design",
        "required liner thickness and the check that governs; `thickness_...` [m] by each check",
        (
            var("chainage", "station", "m", "chainage of the station", required=True),
            var("diameter", "station", "m", "mean diameter that was used"),
            var("ovality", "station", "1", "ovality that was used"),
            *with_sigma((var("liner_thickness", "station", "m", "thickness that the governing check asks for"),)),
            var("liner_governing", "station", "", "check that asks for most; empty without a thickness", "str"),
            var("liner_standard", "station", "m", "next thickness up that is made"),
            var("dimension_ratio", "station", "1", "diameter over liner_thickness"),
            var("liner_remarks", "station", "", "space-separated keys of design.liner.WARNINGS", "str"),
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
"""Groups made by the stages and by the liner's design."""
