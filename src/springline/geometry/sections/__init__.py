"""Cross-sections of pipes (chapter 3): one interface; modes 1 to 5 as one construction; shapes of arcs and lines."""

from .arcs import ArcSection, Pieces
from .base import Chord, Diameters, Moments, Section
from .families import FAMILIES, Family, mode_family
from .hinged import Hinge, HingedSection, hinge, hinged
from .linkage import closing_lower, linkage
from .ovality import expected_maximum, mean_radius_of_circular_hinges, ovality, reduction_factor
from .profiles import Arc, Corner, Line, symmetric
from .segments import Segment, constant, linear, segment, sinusoidal, tabulated
from .severity import chord, pathway, s1_limits, s2_of_s1
from .shapes import (
    SHAPES,
    Shape,
    arch,
    box,
    circle,
    egg,
    egg_side_radius,
    ellipse,
    horseshoe,
    inverted_horseshoe,
    loaf,
)

__all__ = [
    "FAMILIES",
    "SHAPES",
    "Arc",
    "ArcSection",
    "Chord",
    "Corner",
    "Diameters",
    "Family",
    "Hinge",
    "HingedSection",
    "Line",
    "Moments",
    "Pieces",
    "Section",
    "Segment",
    "Shape",
    "arch",
    "box",
    "chord",
    "circle",
    "closing_lower",
    "constant",
    "egg",
    "egg_side_radius",
    "ellipse",
    "expected_maximum",
    "hinge",
    "hinged",
    "horseshoe",
    "inverted_horseshoe",
    "linear",
    "linkage",
    "loaf",
    "mean_radius_of_circular_hinges",
    "mode_family",
    "ovality",
    "pathway",
    "reduction_factor",
    "s1_limits",
    "s2_of_s1",
    "segment",
    "sinusoidal",
    "symmetric",
    "tabulated",
]
