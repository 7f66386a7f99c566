"""The inertial unit: rates and specific force of the robot's true motion, with its errors.

The Earth frame does not rotate. Each sample is the mean over its own interval, centred on its time: the rate is the
rotation from the interval's start to its end divided by its length, the specific force the change of velocity less
gravity's. So the samples integrate back to the true attitude and velocity without an integration error of their own.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from . import equipment
from .attitude import on_earth
from .world import World

GRAVITY = 9.80665
"""Standard gravity [m/s2], straight down everywhere."""

BLOCK = 65536
_DEG_H = np.radians(1.0) / 3600.0


def inertial_blocks(world: World) -> Iterator[tuple[xr.Dataset, xr.Dataset]]:
    """Yield, for each block of samples, the inertial log and its truth."""
    unit: equipment.Inertial = world.scenario.inertial
    count = int(np.floor(world.clock.duration * unit.rate)) + 1
    bias = np.array([np.array(unit.gyro_bias_deg_h) * _DEG_H, unit.accel_bias])
    for block, first in enumerate(range(0, count, BLOCK)):
        time = np.arange(first, min(first + BLOCK, count)) / unit.rate
        rng = world.rng("inertial", block)
        gyro, accel, axes, travelled = true_motion(world, time, unit)
        walk = np.array([unit.gyro_walk_deg_h_sqrt_h * _DEG_H / 60.0, unit.accel_walk]) / np.sqrt(unit.rate)
        drift = bias[:, None] + np.cumsum(walk[:, None, None] * rng.standard_normal((2, time.size, 3)), axis=1)
        white = np.array([np.radians(unit.gyro_noise_deg_sqrt_h) / 60.0, unit.accel_noise]) * np.sqrt(unit.rate)
        noise = white[:, None, None] * rng.standard_normal((2, time.size, 3))
        angles = rng.standard_normal((3, time.size)) * np.radians(unit.attitude_noise_deg)
        kept = np.ones(time.size, bool)
        for start, end in unit.gap:
            kept &= (time < start) | (time >= end)
        attitude = dict(zip(("heading", "inclination", "bank"), on_earth(axes), strict=True))
        if unit.output == "rates":
            measured = {
                "gyro": (("sample", "axis"), (1.0 + unit.gyro_scale) * gyro + drift[0] + noise[0]),
                "accel": (("sample", "axis"), accel + drift[1] + noise[1]),
            }
        else:
            measured = {k: ("sample", v + angles[n]) for n, (k, v) in enumerate(attitude.items())}
        log = xr.Dataset({"time": ("sample", time + unit.clock_offset), **measured})
        truth = xr.Dataset(
            {
                "sample_chainage": ("sample", travelled),
                **{f"sample_{key}": ("sample", values) for key, values in attitude.items()},
                "gyro_bias": (("sample", "axis"), drift[0]),
                "accel_bias": (("sample", "axis"), drift[1]),
            }
        )
        bias = drift[:, -1]
        yield log.isel(sample=kept), truth.isel(sample=kept)


def true_motion(world: World, time: np.ndarray, unit: equipment.Inertial) -> tuple[np.ndarray, ...]:
    """Return true rates [rad/s] and specific force [m/s2] (n, 3) in robot axes, axes (n, 3, 3), travelled chainage."""
    lever, half = np.array(unit.position), 0.5 / unit.rate
    now, _ = world.clock.at(time)
    before, speed_before = world.clock.at(time - half)
    after, speed_after = world.clock.at(time + half)
    axes = world.motion.axes(now)
    # Rows are robot axes on Earth: start @ end^T takes the robot from the interval's start to its end, in robot axes.
    turn = world.motion.axes(before) @ np.swapaxes(world.motion.axes(after), 1, 2)
    gyro = rotation_vector(turn) * unit.rate
    change = speed_after[:, None] * world.motion.velocity(after, lever)
    change -= speed_before[:, None] * world.motion.velocity(before, lever)
    force = change * unit.rate + np.array([0.0, 0.0, GRAVITY])
    return gyro, np.einsum("nij,nj->ni", axes, force), axes, now


def rotation_vector(turn: np.ndarray) -> np.ndarray:
    """Return axis times angle [rad] (n, 3) of small rotations (n, 3, 3) that take column vectors.

    >>> c, s = np.cos(0.1), np.sin(0.1)
    >>> rotation_vector(np.array([[[c, -s, 0], [s, c, 0], [0, 0, 1.0]]])).round(12).tolist()
    [[0.0, 0.0, 0.1]]
    """
    axial = 0.5 * np.stack(
        [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], axis=1
    )
    sine = np.linalg.norm(axial, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(turn, axis1=1, axis2=2) - 1.0))
    return axial * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 1.0)[:, None]
