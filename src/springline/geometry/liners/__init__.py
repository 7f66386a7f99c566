"""Liners in their host (chapter 7): quasi-ellipse, lobes at any clock, what they claim, and better successors."""

from .chicurel import (
    DEEPEST_K,
    ChicurelLobe,
    chicurel_arc_ratio,
    chicurel_height,
    chicurel_protrusion,
    chicurel_u,
)
from .conformity import (
    Conformity,
    confined_oc,
    conformity,
    conserving_oc,
    conserving_smooth_oc,
    lobe_arc,
    lobe_protrusion,
)
from .families import FAMILIES, lobe_family, smooth_lobe_family, two_lobe_family
from .hosts import host_arc, host_polar, polar_curvature
from .lined import Joints, LinedSection, Liner, chicurel_lobed, lined, lobed, smooth_lobed
from .lobes import Lobe, LobeCoefficients, PolarLobe, SmoothLobe, glock_radius
from .quasi_ellipse import LARGEST_D0, QuasiEllipse, quasi_ellipse, quasi_ellipse_point

__all__ = [
    "DEEPEST_K",
    "FAMILIES",
    "LARGEST_D0",
    "ChicurelLobe",
    "Conformity",
    "Joints",
    "LinedSection",
    "Liner",
    "Lobe",
    "LobeCoefficients",
    "PolarLobe",
    "QuasiEllipse",
    "SmoothLobe",
    "chicurel_arc_ratio",
    "chicurel_height",
    "chicurel_lobed",
    "chicurel_protrusion",
    "chicurel_u",
    "confined_oc",
    "conformity",
    "conserving_oc",
    "conserving_smooth_oc",
    "glock_radius",
    "host_arc",
    "host_polar",
    "lined",
    "lobe_arc",
    "lobe_family",
    "lobe_protrusion",
    "lobed",
    "polar_curvature",
    "quasi_ellipse",
    "quasi_ellipse_point",
    "smooth_lobe_family",
    "smooth_lobed",
    "two_lobe_family",
]
