"""Small pipes and rays for the simulator's tests."""

from __future__ import annotations

import numpy as np

from springline.simulate.cast import cast_rays
from springline.simulate.centreline import Cell, Centreline, direction, level_frame
from springline.simulate.sections import Section, ellipse
from springline.simulate.wall import Knots, Pipe, Wall, build

BEARING = np.arange(360) * (2.0 * np.pi / 360)


def stack(section: Section, count: int = 1) -> Section:
    return Section(np.repeat(section.pieces[None], count, axis=0))


def straight(section: Section, length: float = 10.0, heading: float = 0.0, gradient: float = 0.0, **more) -> Pipe:
    cell = Cell(0.0, length, 0.0, 0.0, np.zeros(3), level_frame(direction(heading, gradient)))
    return Pipe(Centreline([cell]), [Knots(stack(section))], 0.15, **more)


def round_pipe(radius: float = 0.15, **more) -> Pipe:
    return straight(ellipse(radius, radius), **more)


def ring(
    pipe: Pipe, chainage: float, axes: np.ndarray | None = None, offset=(0.0, 0.0), limit: float = 20.0,
    wall: Wall | None = None,
):  # fmt: skip
    """Return range, kind and chainage of one ring: `axes` of the sensor in the local pipe frame, offset (y, z)."""
    point, frame = pipe.centreline.at(chainage)
    origin = (point + offset[0] * frame[1] + offset[1] * frame[2])[None]
    sensor = (np.eye(3) if axes is None else axes) @ frame
    rays = np.cos(BEARING)[:, None] * sensor[2] + np.sin(BEARING)[:, None] * sensor[1]
    cell = pipe.centreline.find(origin, np.array([chainage]))
    found = cast_rays(build(pipe) if wall is None else wall, origin, cell, rays[None], limit)
    return tuple(part[0] for part in found)


def one_ray(pipe: Pipe, chainage: float, towards, start=(0.0, 0.0), limit: float = 20.0):
    """Return range, kind and chainage of one ray from (y, z) = start towards (x, y, z) in the local pipe frame."""
    point, frame = pipe.centreline.at(chainage)
    origin = (point + start[0] * frame[1] + start[1] * frame[2])[None]
    ray = np.asarray(towards, float) / np.linalg.norm(towards) @ frame
    cell = pipe.centreline.find(origin, np.array([chainage]))
    found = cast_rays(build(pipe), origin, cell, ray[None, None], limit)
    return tuple(part[0, 0] for part in found)
