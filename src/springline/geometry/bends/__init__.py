"""Bends (4.2): oblique sections of circular and elliptical tori, rings in them, the ovality they fake, and their fit.

Kernels: arrays in, arrays out, broadcast; SI and radians; frame and signs of `springline.conventions`.
"""

from __future__ import annotations

from springline.geometry.bends.centreline import Station, centreline, locate
from springline.geometry.bends.curves import bend_section
from springline.geometry.bends.fit import BendFit, fit_bend
from springline.geometry.bends.ovality import ApparentOvality, bend_ovality, ring_ovality, tilt_ovality
from springline.geometry.bends.torus import ring_bend, torus_hit, torus_quartic

__all__ = [
    "ApparentOvality",
    "BendFit",
    "Station",
    "bend_ovality",
    "bend_section",
    "centreline",
    "fit_bend",
    "locate",
    "ring_bend",
    "ring_ovality",
    "tilt_ovality",
    "torus_hit",
    "torus_quartic",
]
