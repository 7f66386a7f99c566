"""Bends (4.2): oblique sections of circular and elliptical tori, rings in them, and the ovality they fake.

Kernels: arrays in, arrays out, broadcast; SI and radians; frame and signs of `springline.conventions`.
"""

from __future__ import annotations

from springline.geometry.bends.curves import bend_section
from springline.geometry.bends.ovality import ApparentOvality, bend_ovality, ring_ovality, tilt_ovality
from springline.geometry.bends.torus import ring_bend, torus_hit, torus_quartic

__all__ = [
    "ApparentOvality",
    "bend_ovality",
    "bend_section",
    "ring_bend",
    "ring_ovality",
    "tilt_ovality",
    "torus_hit",
    "torus_quartic",
]
