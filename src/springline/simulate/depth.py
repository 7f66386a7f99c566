"""A forward-looking depth camera: one cloud of points per capture, in the camera's own axes."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..errors import ParameterError
from . import equipment
from .cast import cast_rays
from .path import in_travel_frame
from .world import World


def depth_cloud(world: World) -> tuple[xr.Dataset, xr.Dataset]:
    """Return the points of all captures, x forward, y up, z right of the camera at each, and the truth of each.

    Points of one capture share their `time`. Pixels without a return are left out.
    """
    camera: equipment.DepthCamera = world.scenario.depth_camera
    travelled = np.array(camera.captures, float)
    axes = world.motion.axes(travelled)
    origin = world.motion.point(travelled, np.array(camera.position))
    route = world.route
    guess = route.chainage(travelled + camera.position[0])
    cell = route.centreline.find(origin, guess)
    column = (np.arange(camera.width) - 0.5 * (camera.width - 1)) / camera.focal_px
    row = (0.5 * (camera.height - 1) - np.arange(camera.height)) / camera.focal_px
    right, up = (grid.ravel() for grid in np.meshgrid(column, row))
    pixel = np.stack([np.ones_like(right), up, right], axis=1)
    length = np.linalg.norm(pixel, axis=1)
    time = world.clock.when(travelled)
    clouds = []
    for k in range(len(travelled)):
        rays = (pixel / length[:, None]) @ axes[k]
        true, _, _ = cast_rays(world.wall, origin[k : k + 1], cell[k : k + 1], rays[None], 20.0 * camera.range_max)
        if not np.isfinite(true).any():
            raise ParameterError(
                f"the camera sees nothing at {travelled[k]:.3f} m", where="depth_camera", expected="a place in the pipe"
            )
        rng = world.rng("depth_camera", k)
        depth = true[0] / length
        sigma = np.hypot(camera.noise, camera.noise_quadratic * depth * depth)
        depth = depth + sigma * rng.standard_normal(depth.shape)
        seen = np.isfinite(depth) & (depth <= camera.range_max) & (rng.random(depth.shape) >= camera.dropout)
        clouds.append(np.column_stack([depth[seen, None] * pixel[seen], np.full(int(seen.sum()), time[k])]))
    x, y, z, stamp = np.concatenate(clouds).T
    points = xr.Dataset(
        {"x": ("point", x), "y": ("point", y), "z": ("point", z), "time": ("point", stamp)},
        attrs={"source_axes": "x forward, y up, z right", "sensor_kind": "depth-camera", "origin_is_sensor": 1},
    )
    chainage = route.chainage(route.centreline.project(origin, guess))
    point, frame = route.at(chainage)
    off = np.einsum("nij,nj->ni", frame, origin - point)
    pitch, yaw, roll = in_travel_frame(axes, frame)
    values = {
        "time": time, "chainage": chainage, "offset_y": off[:, 1], "offset_z": off[:, 2], "pitch": pitch, "yaw": yaw,
        "roll": roll,
    }  # fmt: skip
    return points, xr.Dataset({f"capture_{name}": ("capture", value) for name, value in values.items()})
