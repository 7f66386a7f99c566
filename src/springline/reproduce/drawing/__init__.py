"""Figures as plain SVG: panels with curves and coloured fields, solids, and the sheet they stand on."""

from springline.reproduce.drawing.contours import contour_paths
from springline.reproduce.drawing.panel import Panel
from springline.reproduce.drawing.sheet import Key, sheet
from springline.reproduce.drawing.solid import Solid
from springline.reproduce.drawing.style import BLUE, GREEN, INK, ORANGE, PURPLE, SOFT, departures, ramp

__all__ = [
    "BLUE",
    "GREEN",
    "INK",
    "ORANGE",
    "PURPLE",
    "SOFT",
    "Key",
    "Panel",
    "Solid",
    "contour_paths",
    "departures",
    "ramp",
    "sheet",
]
