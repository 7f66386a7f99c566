"""Marks of a pipe seen in rings: laterals, joints, dents, deposits and intrusions, found on the wall and sized."""

from .find import Rings, Seen, find_bumps, find_grooves, find_openings, find_steps
from .reference import centre_rings, steady_shape, wall_deviation
from .wallmap import WallMap, add_rings, at_readings, empty_map, lasting_shape

__all__ = [
    "Rings",
    "Seen",
    "WallMap",
    "add_rings",
    "at_readings",
    "centre_rings",
    "empty_map",
    "find_bumps",
    "find_grooves",
    "find_openings",
    "find_steps",
    "lasting_shape",
    "steady_shape",
    "wall_deviation",
]
