"""True outlines of laterals and joints in a frame: where their edges lie in the picture, and which of them are seen.

An edge is a curve on the true wall: of a lateral the line in which its bore cuts the wall (or, where it stands into the
pipe, the rim of its end), of a joint the rims of both pipe ends. A point of it is seen when the lens images it inside
the picture and a ray from the camera to just before it meets nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..cast import cast_rays
from ..centreline import along, level_frame
from ..laying import joints
from ..surface import radius_of_wall
from ..wall import JOINT, LATERAL, Roughness, Wall, build

if TYPE_CHECKING:
    from ..world import World
    from .footage import Footage

POINTS = 96
BLOCK = 32
"""Frames per block of outlines."""

_BEFORE = 0.0015
_BESIDE = 1e-6


@dataclass(frozen=True)
class Edge:
    """One edge on the wall: which row of the truth's features it belongs to, and its points on Earth (n, 3)."""

    feature: int
    kind: int
    part: int
    chainage: float
    points: np.ndarray
    before: np.ndarray


@dataclass(frozen=True)
class Outline:
    """One edge in one frame.

    Attributes:
        feature: Row of the truth's `feature_...` variables.
        kind: "lateral" or "joint".
        part: 0 = a lateral's edge, or the rim of a joint that is met first along travel; 1 = the joint's other rim.
        ahead: Chainage of the feature less the camera's [m].
        points: Column and row of its points [px] (n, 2), in order around; NaN where the lens images none.
        seen: Which of them are in the picture and not hidden (n,).
    """

    feature: int
    kind: str
    part: int
    ahead: float
    points: np.ndarray
    seen: np.ndarray


def edges_of(world: World, features: dict[str, np.ndarray]) -> list[Edge]:
    """Return every edge of the pipe, in order of travelled chainage.

    Args:
        world: The world.
        features: The truth's table: kind, chainage (as travelled), bearing, by name.
    """
    dry = replace(world.pipe, roughness=Roughness(), floors=[])
    wall = build(dry)
    found = _joint_edges(world, wall, features) + _lateral_edges(world, wall, features)
    return sorted(found, key=lambda edge: edge.chainage)


def _joint_edges(world: World, wall: Wall, features: dict[str, np.ndarray]) -> list[Edge]:
    theta = np.arange(POINTS) * (2.0 * np.pi / POINTS)
    line = world.pipe.centreline
    out = []
    for joint in joints(world.scenario.pipe):
        half = 0.5 * joint.gap
        travelled = float(world.route.chainage(joint.chainage))
        row = _row(features, JOINT, travelled, None)
        for after, at in enumerate((joint.chainage - half, joint.chainage + half)):
            k = int(line.index(at + (2 * after - 1) * _BESIDE))
            cell = line.cells[k]
            centre, tangent = along(cell, at - cell.chainage)
            frame = level_frame(tangent)
            inside = np.array([np.clip(at, cell.chainage, cell.end)])
            rho = radius_of_wall(wall, np.array([k]), inside, theta[None], False)[0]
            radial = np.cos(theta)[:, None] * frame[2] + np.sin(theta)[:, None] * frame[1]
            part = 1 - after if world.route.from_end else after
            points, before = centre + rho[:, None] * radial, centre + (rho - _BEFORE)[:, None] * radial
            out.append(Edge(row, JOINT, part, travelled, points, before))
    return out


def _lateral_edges(world: World, wall: Wall, features: dict[str, np.ndarray]) -> list[Edge]:
    turn = np.arange(POINTS) * (2.0 * np.pi / POINTS)
    line, bare = world.pipe.centreline, wall._replace(laterals=wall.laterals[:0])
    given = sorted(world.pipe.laterals, key=lambda one: one.chainage)
    out = []
    for tube, lateral in zip(wall.laterals, given, strict=True):
        axis = tube["axis"]
        _, frame = line.at(lateral.chainage)
        u = frame[0] - (frame[0] @ axis) * axis
        u /= np.linalg.norm(u)
        across = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * np.cross(axis, u)
        start = tube["mouth"] - axis * world.pipe.radius / np.cos(lateral.lean) + tube["inner"] * across
        if tube["start"] < 0.0:
            points = tube["mouth"] + tube["start"] * axis + tube["inner"] * across
        else:
            cell = line.find(start, np.full(POINTS, lateral.chainage))
            ways = np.broadcast_to(axis, (POINTS, 1, 3)).copy()
            reach = cast_rays(bare, start, cell, ways, 20.0 * world.pipe.radius)[0]
            points = start + reach * axis
        travelled = float(world.route.chainage(lateral.chainage))
        row = _row(features, LATERAL, travelled, float(world.route.bearing(lateral.bearing)))
        out.append(Edge(row, LATERAL, 0, travelled, points, points - _BEFORE * axis))
    return out


def _row(features: dict[str, np.ndarray], kind: int, chainage: float, bearing: float | None) -> int:
    """Return the row of a feature in the truth's table."""
    off = np.abs(features["chainage"] - chainage)
    if bearing is not None:
        off = off + np.abs(np.sin(0.5 * (np.nan_to_num(features["bearing"]) - bearing)))
    return int(np.argmin(np.where(features["kind"] == kind, off, np.inf)))


def outlines_in(footage: Footage, index: int) -> list[Outline]:
    """Return the outlines of frame `index` of which at least one point is seen, nearest first."""
    eye, axes, sight = footage.origin[index], footage.axes[index], footage.camera.sight
    here = float(footage.chainage[index])
    near = [edge for edge in footage.edges if abs(edge.chainage - here) <= sight]
    if not near:
        return []
    points = np.concatenate([edge.points for edge in near]) - eye
    before = np.concatenate([edge.before for edge in near]) - eye
    image = footage.lens.project(points @ axes.T)
    pixels = np.stack([footage.centre[0] + image[:, 0], footage.centre[1] - image[:, 1]], axis=1)
    far = np.linalg.norm(before, axis=1)
    size = np.array([footage.camera.width, footage.camera.height])
    with np.errstate(invalid="ignore"):
        seen = np.all((pixels >= -0.5) & (pixels < size - 0.5), axis=1) & (far < sight)
    wall = footage.in_sight(index)
    ways = np.ascontiguousarray(before[seen] / far[seen, None])
    reach = cast_rays(wall, eye[None], footage.cell[index : index + 1], ways[None], sight)[0][0]
    with np.errstate(invalid="ignore"):
        seen[seen] = ~(reach < far[seen])
    out = []
    for k, edge in enumerate(near):
        rows = slice(k * POINTS, (k + 1) * POINTS)
        if seen[rows].any():
            kind = "lateral" if edge.kind == LATERAL else "joint"
            out.append(Outline(edge.feature, kind, edge.part, edge.chainage - here, pixels[rows], seen[rows]))
    return out


def outline_blocks(footage: Footage) -> Iterator[xr.Dataset]:
    """Yield the truth of all outlines, block by block, each of at least one outline.

    Outline n of `outline_frame`, `outline_feature`, `outline_part`, `outline_ahead` has the points
    `outline_first[n]` to `outline_first[n] + outline_count[n]` of `outline_column`, `outline_row`, `outline_seen`.
    """
    first, waiting = 0, []
    for k in range(len(footage)):
        waiting += [(k, outline) for outline in outlines_in(footage, k)]
        if waiting and (k % BLOCK == BLOCK - 1 or k == len(footage) - 1):
            yield _table(waiting, first)
            first += POINTS * len(waiting)
            waiting = []


def _table(rows: list[tuple[int, Outline]], first: int) -> xr.Dataset:
    points = np.concatenate([one.points for _, one in rows]).astype(np.float32)
    each = {
        "frame": np.array([frame for frame, _ in rows], np.int32),
        "feature": np.array([one.feature for _, one in rows], np.int32),
        "part": np.array([one.part for _, one in rows], np.uint8),
        "ahead": np.array([one.ahead for _, one in rows]),
        "first": first + POINTS * np.arange(len(rows)),
        "count": np.full(len(rows), POINTS, np.int32),
    }
    every = {"column": points[:, 0], "row": points[:, 1], "seen": np.concatenate([one.seen for _, one in rows])}
    every["seen"] = every["seen"].astype(np.uint8)
    return xr.Dataset(
        {f"outline_{name}": ("outline", value) for name, value in each.items()}
        | {f"outline_{name}": ("outline_point", value) for name, value in every.items()}
    )
