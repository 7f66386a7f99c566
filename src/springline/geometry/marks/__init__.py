"""Marks of a pipe seen in rings: laterals, joints, dents, deposits and intrusions, found on the wall and sized."""

from .bores import Bore, fit_bore
from .bumps import Bump, size_bump
from .find import Rings, Seen, find_bumps, find_grooves, find_openings, find_steps
from .joints import Gap, SetOff, size_gap, size_step
from .reference import centre_rings, steady_shape, tracked_centres, wall_deviation
from .wallmap import WallMap, add_rings, at_readings, empty_map, lasting_shape

__all__ = [
    "Bore",
    "Bump",
    "Gap",
    "Rings",
    "Seen",
    "SetOff",
    "WallMap",
    "add_rings",
    "at_readings",
    "centre_rings",
    "empty_map",
    "find_bumps",
    "find_grooves",
    "find_openings",
    "find_steps",
    "fit_bore",
    "lasting_shape",
    "size_bump",
    "size_gap",
    "size_step",
    "steady_shape",
    "tracked_centres",
    "wall_deviation",
]
