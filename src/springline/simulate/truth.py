"""What is true of the pipe itself: sections and axis at stations, everything that stands on the wall, and the settings.

All of it is told as travelled: chainages run from where the robot enters, bearings as it sees them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import xarray as xr

from ..conventions import bearing_from_clock
from . import equipment, pipes
from .laying import joints
from .measures import measure
from .stretches import SHAPES, parameters_at, stretches
from .strewn import cracks, deposits, laterals, stains
from .surface import radius_of_wall
from .wall import BED, CRACK, DENT, DEPOSIT, HIT_KINDS, JOINT, LATERAL, STAIN, WATER
from .world import World

WALL_BEARINGS = 360
_FINE = 1440


BLOCK = 1024
"""Stations per block."""


def pipe_truth(world: World) -> Iterator[xr.Dataset]:
    """Yield the truth that does not depend on any sensor: features, settings and a first block of stations; then the
    other stations, block by block."""
    kinds = " ".join(f"{code}={name}" for code, name in enumerate(HIT_KINDS))
    shapes = ", ".join(f"{code}={name}" for code, name in enumerate(SHAPES))
    attrs = {
        "hit_kinds": kinds,
        "shapes": shapes,
        "scenario": json.dumps(world.scenario.model_dump(mode="json", exclude_defaults=True)),
        "seed": world.seed,
    }
    features = {f"feature_{name}": ("feature", column) for name, column in feature_table(world).items()}
    features["wall_bearing"] = ("wall_bearing", _bearings(WALL_BEARINGS))
    count = int(np.floor(world.route.length / world.scenario.truth_spacing + 1e-9)) + 1
    for first in range(0, count, BLOCK):
        travelled = np.arange(first, min(first + BLOCK, count)) * world.scenario.truth_spacing
        stations = _stations(world, travelled)
        yield xr.Dataset(stations | features, attrs=attrs) if first == 0 else xr.Dataset(stations)


def _bearings(count: int) -> np.ndarray:
    return np.arange(count) * (2.0 * np.pi / count)


def _stations(world: World, travelled: np.ndarray) -> dict[str, tuple[object, np.ndarray]]:
    """Return the axis and the section, without what stands on it, at stations; and the wall with everything."""
    route = world.route
    s = route.chainage(travelled)
    point, frame = route.at(travelled)
    cell = route.centreline.index(s)
    out: dict[str, tuple[object, np.ndarray]] = {
        "chainage": ("station", travelled),
        "easting": ("station", point[:, 0]),
        "northing": ("station", point[:, 1]),
        "elevation": ("station", point[:, 2]),
        "gradient": ("station", frame[:, 0, 2] / np.hypot(frame[:, 0, 0], frame[:, 0, 1])),
        "heading": ("station", np.mod(np.arctan2(frame[:, 0, 0], frame[:, 0, 1]), 2.0 * np.pi)),
    }
    cells = [route.centreline.cells[k] for k in cell]
    out["curvature"] = ("station", np.array([c.curvature for c in cells]))
    out["curvature_bearing"] = ("station", route.bearing(np.array([c.towards for c in cells])))
    return out | _sections(world, s, cell) | _parameters(world, s)


def _sections(world: World, s: np.ndarray, cell: np.ndarray) -> dict[str, tuple[object, np.ndarray]]:
    """Return the true wall with everything on it, and what the bare section measures on 1440 radii."""
    seen, across = (world.route.bearing(_bearings(n))[None] for n in (WALL_BEARINGS, _FINE))
    wall = radius_of_wall(world.wall, cell, s, seen, False).astype(np.float32)
    measured = measure(radius_of_wall(world.wall, cell, s, across, True))
    out: dict[str, tuple[object, np.ndarray]] = {name: ("station", value) for name, value in measured.items()}
    out["wall_radius"] = (("station", "wall_bearing"), wall)
    return out


def _parameters(world: World, s: np.ndarray) -> dict[str, tuple[object, np.ndarray]]:
    """Return shape and severities of the section at each station."""
    pipe = world.scenario.pipe
    out: dict[str, np.ndarray] = {}
    for one in stretches(pipe, world.route.length):
        rows = (s >= one.start) & (s <= one.end)
        if rows.any():
            for name, value in parameters_at(pipe, one, s[rows]).items():
                empty = np.nan if value.dtype.kind == "f" else 0
                out.setdefault(name, np.full(s.size, empty, value.dtype))[rows] = value
    return {name: ("station", value) for name, value in out.items()}


def feature_table(world: World) -> dict[str, np.ndarray]:
    """Return what stands on the wall, in order: kind as the code of a hit, chainage, bearing, size, length, depth."""
    pipe, route = world.scenario.pipe, world.route
    radius = 0.5 * pipe.diameter
    rows: list[tuple[float, ...]] = [
        (JOINT, joint.chainage, np.nan, joint.gap, joint.gap, pipe.wall_thickness, *_set_off(joint))
        for joint in joints(pipe)
    ]
    for lateral in laterals(pipe):
        lean = np.cos(np.radians(lateral.inclination_deg))
        size = lateral.diameter
        rows.append((LATERAL, lateral.chainage, _bearing(lateral), size, size / lean, np.nan, *_NONE))
    for kind, patches in ((DENT, pipe.dent), (DEPOSIT, deposits(pipe))):
        for patch in patches:
            size = np.radians(patch.width_deg) * radius
            rows.append((kind, patch.chainage, _bearing(patch), size, patch.length, -patch.depth, *_NONE))
    rows += [(CRACK, one.chainage, _bearing(one), one.width, one.length, np.nan, *_NONE) for one in cracks(pipe)]
    rows += [
        (STAIN, one.chainage, _bearing(one), np.radians(one.width_deg) * radius, one.length, np.nan, *_NONE)
        for one in stains(pipe)
    ]
    for kind, levels in ((BED, pipe.bed), (WATER, pipe.water)):
        rows.extend((kind, *_extent(level, route.length, radius), *_NONE) for level in levels)
    names = ("kind", "chainage", "bearing", "size", "length", "depth", "offset_y", "offset_z", "kink_up", "kink_right")
    table = np.array(rows, float).reshape(-1, len(names))
    table[:, 1] = route.chainage(table[:, 1])
    if route.from_end:
        table[:, 2] = route.bearing(table[:, 2])
        # From the other end the next pipe is the one before: a step up is one down, a turn right one to the left.
        table[:, [6, 9]] *= -1.0
    table = table[np.argsort(table[:, 1], kind="stable")]
    return dict(zip(names, table.T, strict=True))


_NONE = (np.nan, np.nan, np.nan, np.nan)


def _bearing(one: pipes.Lateral | pipes.Patch | pipes.Crack | pipes.Stain) -> float:
    return bearing_from_clock(one.clock_h)


def _set_off(joint: pipes.Joint) -> tuple[float, float, float, float]:
    return joint.offset_y, joint.offset_z, np.radians(joint.kink_up_deg), np.radians(joint.kink_right_deg)


def _extent(level: pipes.Level, length: float, radius: float) -> tuple[float, ...]:
    """Return middle, bearing, width at its surface in a round pipe, length and depth of water or a bed."""
    start, end = level.start or 0.0, length if level.end is None else level.end
    width = 2.0 * np.sqrt(max(radius**2 - (radius - level.depth) ** 2, 0.0))
    return 0.5 * (start + end), 1.5 * np.pi, width, end - start, -level.depth


def ties(world: World) -> tuple[xr.Dataset, xr.Dataset]:
    """Return the known points with their errors, and where they truly are; in order of travel.

    A tie is a point of the pipe's axis; its distance is what the odometer reads when the robot's middle is there.
    """
    known: equipment.Ties = world.scenario.ties
    route = world.route
    travelled = np.sort(route.chainage(np.array(known.chainages, float)))
    point, _ = route.at(travelled)
    seen = point + known.sigma * world.rng("ties").standard_normal(point.shape)
    names = ("easting", "northing", "elevation")
    group = {name: ("tie", seen[:, k]) for k, name in enumerate(names)}
    group |= {
        "distance": ("tie", world.counter.reading(travelled)),
        "sigma": ("tie", np.full(travelled.size, known.sigma)),
    }
    truth = {f"tie_{name}": ("tie", point[:, k]) for k, name in enumerate(names)}
    return xr.Dataset(group), xr.Dataset(truth | {"tie_chainage": ("tie", travelled)})
