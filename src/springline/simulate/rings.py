"""Ring scanners: rays cast on the true wall, then spoiled as the sensor spoils them, block by block."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from ..errors import ParameterError
from . import equipment
from .attitude import in_pipe, on_earth
from .cast import cast_rays
from .path import HALF_TURN, in_travel_frame
from .wall import WATER
from .world import World

BLOCK = 2048
"""Rings per block; noise is drawn block by block, so that a streamed survey equals one made at once."""


def ring_blocks(world: World, name: str) -> Iterator[tuple[xr.Dataset, xr.Dataset]]:
    """Yield, for each block of rings of scanner `name` ("rings" or "rings_rear"), the rings and their truth."""
    scanner: equipment.RingScanner = getattr(world.scenario, name)
    last = float(world.counter.reading(world.end))
    count = int(np.floor(last / scanner.spacing + 1e-9))
    if count < 1:
        raise ParameterError(
            f"{name}.spacing = {scanner.spacing} m", expected=f"below the length driven, {last:.3f} m by the counter"
        )
    # The first ring is taken one spacing after the start: the counter shows 0 all through a stop there.
    for block, first in enumerate(range(1, count + 1, BLOCK)):
        distance = np.arange(first, min(first + BLOCK, count + 1)) * scanner.spacing
        yield _block(world, name, scanner, distance, world.rng(name, block))


def bearings(scanner: equipment.RingScanner) -> np.ndarray:
    """Return the scanner's bearings [rad], equal steps from +z counter-clockwise."""
    return np.arange(scanner.bearings) * (2.0 * np.pi / scanner.bearings)


def ring_attrs(scanner: equipment.RingScanner) -> dict[str, object]:
    """Return the attributes of the group of rings."""
    return {
        "referred_to": "sensor",
        "distance_source": "odometer",
        "sensor_kind": "ring-laser",
        "bearing_zero": "right",
        "bearing_sense": "ccw",
        "bearing_assumed": 0,
        "range_noise": scanner.noise,
        "range_max": scanner.range_max,
        "position_x": scanner.position[0],
        "position_y": scanner.position[1],
        "position_z": scanner.position[2],
    }


def _block(
    world: World, name: str, scanner: equipment.RingScanner, distance: np.ndarray, rng: np.random.Generator
) -> tuple[xr.Dataset, xr.Dataset]:
    travelled = world.counter.where(distance)
    robot = world.motion.axes(travelled)
    origin = world.motion.point(travelled, np.array(scanner.position))
    sensor = in_pipe(*np.radians([getattr(scanner, f"boresight_{k}_deg") for k in ("pitch", "yaw", "roll")])) @ robot
    bearing = bearings(scanner)
    rays = np.cos(bearing)[:, None] * sensor[:, None, 2] + np.sin(bearing)[:, None] * sensor[:, None, 1]
    route = world.route
    backwards = world.scenario.robot.backwards
    guess = route.chainage(travelled + (-scanner.position[0] if backwards else scanner.position[0]))
    cell = route.centreline.find(origin, guess)
    true, kind, _ = cast_rays(world.wall, origin, cell, rays, scanner.range_max)
    chainage = route.chainage(route.centreline.project(origin, guess))
    _inside(true, chainage, name)
    ring, side = ("ring", "") if name == "rings" else ("ring_rear", "rear_")
    rings = xr.Dataset(
        {
            "range": (("ring", "bearing"), _readings(scanner, true, kind, rng).astype(np.float32)),
            "bearing": ("bearing", bearing),
            "distance": ("ring", distance),
            "time": ("ring", world.clock.when(travelled)),
        },
        attrs=ring_attrs(scanner),
    )
    truth = {f"{side}hit": ((ring, f"{side}bearing"), kind)}
    for key, values in _pose(world, chainage, origin, robot).items():
        truth[f"{side}{key}"] = (ring, values)
    return rings, xr.Dataset(truth)


def _pose(world: World, chainage: np.ndarray, origin: np.ndarray, robot: np.ndarray) -> dict[str, np.ndarray]:
    """Return the truth of each ring: the scanner's origin in the pipe and the robot's attitude there and on Earth."""
    point, frame = world.route.at(chainage)
    off = np.einsum("nij,nj->ni", frame, origin - point)
    # Of a robot that is pulled back the attitude is told as of one turned round: about zero, not about half a turn.
    forwards = HALF_TURN @ robot if world.scenario.robot.backwards else robot
    pitch, yaw, roll = in_travel_frame(forwards, frame)
    heading, inclination, bank = on_earth(robot)
    return {
        "ring_chainage": chainage,
        "offset_y": off[:, 1],
        "offset_z": off[:, 2],
        "pitch": pitch,
        "yaw": yaw,
        "roll": roll,
        "ring_easting": origin[:, 0],
        "ring_northing": origin[:, 1],
        "ring_elevation": origin[:, 2],
        "ring_heading": heading,
        "ring_inclination": inclination,
        "ring_bank": bank,
    }


def _inside(true: np.ndarray, chainage: np.ndarray, name: str) -> None:
    """Raise when a scanner has left the pipe: then no ray of its ring meets anything."""
    outside = ~np.isfinite(true).any(axis=1)
    if outside.any():
        raise ParameterError(
            f"the scanner stands outside the pipe, or sees nothing, at chainage {chainage[outside][0]:.3f} m",
            where=name,
            expected="offsets, attitude and position that keep it within the wall, and a range_max that reaches it",
        )


def _readings(
    scanner: equipment.RingScanner, true: np.ndarray, kind: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Return what the scanner reports of true ranges (rings, bearings); NaN = no return."""
    sigma = np.hypot(scanner.noise, scanner.noise_relative * true)
    reading = (1.0 + scanner.scale_error) * true + sigma * rng.standard_normal(true.shape)
    stray = rng.random(true.shape) < scanner.outliers
    reading = np.where(stray, true * rng.uniform(0.4, 1.3, true.shape), reading)
    lost = rng.random(true.shape) < scanner.dropout
    lost |= (kind == WATER) & (rng.random(true.shape) >= scanner.water_returns)
    angle = np.degrees(bearings(scanner))
    for start, end in scanner.blind_deg:
        lost |= np.mod(angle - start, 360.0) <= np.mod(end - start, 360.0)
    if scanner.resolution > 0.0:
        reading = np.round(reading / scanner.resolution) * scanner.resolution
    with np.errstate(invalid="ignore"):
        lost |= (reading < scanner.range_min) | (reading > scanner.range_max)
    return np.where(lost, np.nan, reading)
