"""Cross-sections of pipes (chapter 3): one interface; modes 1 to 5 as one construction; shapes of arcs and lines."""

from .arcs import ArcSection, Pieces
from .base import Chord, Diameters, Moments, Section
from .hinged import Hinge, HingedSection, hinge, hinged
from .linkage import closing_lower, linkage
from .profiles import Arc, Corner, Line, symmetric
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
    "SHAPES",
    "Arc",
    "ArcSection",
    "Chord",
    "Corner",
    "Diameters",
    "Hinge",
    "HingedSection",
    "Line",
    "Moments",
    "Pieces",
    "Section",
    "Shape",
    "arch",
    "box",
    "chord",
    "circle",
    "closing_lower",
    "egg",
    "egg_side_radius",
    "ellipse",
    "hinge",
    "hinged",
    "horseshoe",
    "inverted_horseshoe",
    "linkage",
    "loaf",
    "pathway",
    "s1_limits",
    "s2_of_s1",
    "symmetric",
]
