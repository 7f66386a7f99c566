"""The robot in the pipe: origin offsets (4.1), attitude and oblique sections with their inverses (5).

Kernels: arrays in, arrays out, broadcast; SI and radians; frame and signs of `springline.conventions`.
"""

from __future__ import annotations

from springline.geometry.robot.attitude import (
    axis,
    frame,
    implicit_roll,
    pitch_after_yaw,
    pitch_yaw_roll,
    yaw_after_pitch,
)
from springline.geometry.robot.double_ended import DoubleEnded, double_ended
from springline.geometry.robot.oblique import Ellipse, ObliqueEllipse, conic_to_ellipse, oblique_ellipse, ring_cylinder
from springline.geometry.robot.offsets import deformed_r1, offset_deformation, offset_pitch, ride_height
from springline.geometry.robot.rings import RingsSolution, solve_rings
from springline.geometry.robot.section import RingSection, ring_covariance, section_from_ring

__all__ = [
    "DoubleEnded",
    "Ellipse",
    "ObliqueEllipse",
    "RingSection",
    "RingsSolution",
    "axis",
    "conic_to_ellipse",
    "deformed_r1",
    "double_ended",
    "frame",
    "implicit_roll",
    "oblique_ellipse",
    "offset_deformation",
    "offset_pitch",
    "pitch_after_yaw",
    "pitch_yaw_roll",
    "ride_height",
    "ring_covariance",
    "ring_cylinder",
    "section_from_ring",
    "solve_rings",
    "yaw_after_pitch",
]
