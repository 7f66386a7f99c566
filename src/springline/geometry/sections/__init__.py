"""Cross-sections of pipes (chapter 3): one interface, modes 1 to 5 as one construction."""

from .base import Chord, Diameters, Moments, Section
from .hinged import Hinge, HingedSection, hinge, hinged
from .severity import chord, pathway, s1_limits, s2_of_s1

__all__ = [
    "Chord",
    "Diameters",
    "Hinge",
    "HingedSection",
    "Moments",
    "Section",
    "chord",
    "hinge",
    "hinged",
    "pathway",
    "s1_limits",
    "s2_of_s1",
]
