"""The groups of a survey: which variables stand in each, with dims, unit and meaning."""

from __future__ import annotations

from .result_groups import RESULTS
from .source_groups import SOURCES

GROUPS = {group.name: group for group in (*SOURCES, *RESULTS)}
"""The data contract: group name to `Group`; `survey.schema` validates against it, the docs page is made from it."""

SOURCE_GROUPS = (
    "points",
    "rings",
    "rings_rear",
    "inertial",
    "frames",
    "ties",
    "design_line",
    "calibration",
    "observations",
    "truth",
)
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
