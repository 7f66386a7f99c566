"""The footage of a scenario's camera: where each frame was taken, and each frame's picture when it is asked for."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np
import xarray as xr

from ...conventions import bearing_from_clock
from ...errors import ParameterError
from .. import optics
from ..attitude import in_pipe
from ..cast import cast_rays
from ..lens import LensModel, lens_of
from ..path import in_travel_frame
from ..reading import load
from ..scenario import Scenario
from ..surface import radius_of_wall
from ..truth import feature_table
from ..wall import Roughness, Wall, build
from ..world import World, set_up
from .light import AIR, LAMP, LASER
from .looks import decal_records, look_record
from .outlines import Edge, Outline, edges_of, outlines_in
from .picture import develop, dimming
from .render import Scene, render

_SIGMA_OF_WIDTH = 1.0 / (2.0 * np.sqrt(2.0 * np.log(2.0)))
_SAMPLES = 2
_SPARE = 2.0
_RING = 360


class Footage:
    """The frames of a scenario's camera.

    A frame is rendered when it is asked for, from its own random stream: frame k is the same whether the others are
    made or not. Frames are taken every `camera.spacing` by the odometer, the first one spacing after the start.

    Args:
        scenario: As for `simulate`; it must have a camera.
        seed: As for `simulate`.

    Attributes:
        camera: The camera of the scenario.
        lens: Its lens.
        centre: Column and row of the principal point; (0, 0) is the middle of the picture's first pixel.

    Raises:
        ParameterError: The scenario has no camera, or it stands outside the pipe.

    >>> footage = Footage("camera-short", seed=1)
    >>> footage.image(0).shape, str(footage.image(0).dtype)
    ((480, 640, 3), 'uint8')
    """

    def __init__(self, scenario: str | Path | Scenario | World, seed: int = 0) -> None:
        self.world = scenario if isinstance(scenario, World) else set_up(load(scenario), seed)
        camera = self.world.scenario.camera
        if camera is None:
            raise ParameterError("the scenario has no camera", where="camera", expected="a table [camera]")
        self.camera: optics.Camera = camera
        self.lens: LensModel = lens_of(camera.lens, camera.width)
        middle = (0.5 * (camera.width - 1), 0.5 * (camera.height - 1))
        self.centre = middle if camera.lens.centre_px is None else camera.lens.centre_px
        self._lay_out()

    def _lay_out(self) -> None:
        """Set the frames' distances, times and the camera's true place and axes on Earth."""
        world, camera = self.world, self.camera
        last = float(world.counter.reading(world.end))
        count = int(np.floor(last / camera.spacing + 1e-9))
        if count < 1:
            raise ParameterError(
                f"camera.spacing = {camera.spacing} m", expected=f"below the length driven, {last:.3f} m by the counter"
            )
        self.distance = np.arange(1, count + 1) * camera.spacing
        self.travelled = world.counter.where(self.distance)
        self.time = world.clock.when(self.travelled)
        lever = np.add(camera.position, camera.error_position)
        self.robot = world.motion.axes(self.travelled)
        self.origin = world.motion.point(self.travelled, lever)
        tilt = in_pipe(*np.radians([camera.pitch_deg, camera.yaw_deg, camera.roll_deg]))
        error = in_pipe(*np.radians([camera.error_pitch_deg, camera.error_yaw_deg, camera.error_roll_deg]))
        self.axes = error @ tilt @ self.robot
        guess = world.route.chainage(self.travelled + lever[0])
        self.cell = world.route.centreline.find(self.origin, guess)
        self.chainage = world.route.chainage(world.route.centreline.project(self.origin, guess))
        _check_inside(world, self.cell, self.origin, self.chainage, "camera")
        if camera.laser is not None:
            source, _ = self.laser_pose(np.arange(count))
            guess = world.route.chainage(self.travelled + lever[0] + camera.laser.ahead)
            at = world.route.centreline.project(source, guess)
            cell = world.route.centreline.find(source, guess)
            _check_inside(world, cell, source, world.route.chainage(at), "camera.laser")

    def __len__(self) -> int:
        return self.distance.size

    def image(self, index: int) -> np.ndarray:
        """Return the picture of frame `index` (from 0): (rows, columns, 3), red green blue of 8 bits."""
        index = range(len(self))[index]
        return develop(self.light(index), self.camera, self._dimming, self.world.rng("camera", index))

    def light(self, index: int) -> np.ndarray:
        """Return the light (rows, columns, 3) on each pixel of frame `index` before lens blur, exposure and noise."""
        wall, scene = self._near(index)
        return render(wall, scene, self.origin[index], self.cell[index], self.axes[index], self._rays, _SAMPLES)

    def outlines(self, index: int) -> list[Outline]:
        """Return the true outlines of laterals and joints of which something is seen in frame `index`."""
        return outlines_in(self, range(len(self))[index])

    @cached_property
    def edges(self) -> list[Edge]:
        """Every edge of a lateral or joint, as curves on Earth."""
        return edges_of(self.world, feature_table(self.world))

    def frames(self, folder: str = "frames") -> xr.Dataset:
        """Return the group `/frames`; paths lie in `folder`, which stands beside whatever lists them."""
        names = [f"{folder}/{self.file(k)}" for k in range(len(self))]
        return xr.Dataset(
            {
                "path": ("frame", np.array(names)),
                "distance": ("frame", self.distance),
                "time": ("frame", self.time),
                "lens": ("frame", np.array([self.camera.name] * len(self))),
            }
        )

    def file(self, index: int) -> str:
        """Return the file name of frame `index`."""
        return f"{index + 1:06d}.{self.camera.format}"

    def lens_table(self) -> dict[str, object]:
        """Return what a survey says of the camera under `[lens.NAME]`: its lens, and its nominal place on the robot."""
        camera, lens = self.camera, self.lens
        table: dict[str, object] = {
            "model": lens.model,
            "k_px": lens.k,
            "centre_px": [float(c) for c in self.centre],
            "width_px": camera.width,
            "height_px": camera.height,
        }
        if lens.model == "polynomial":
            table["coefficients"] = list(lens.coefficients)
        if camera.lens.view_angle_deg is not None:
            table["view_angle_deg"] = camera.lens.view_angle_deg
        table["position_m"] = list(camera.position)
        table |= {key: getattr(camera, key) for key in ("pitch_deg", "yaw_deg", "roll_deg")}
        if camera.laser is not None:
            table["laser_ahead_m"] = camera.laser.ahead
        return table

    def truth(self) -> xr.Dataset:
        """Return the camera's true pose at each frame: in the pipe as travelled, and on Earth; and the laser's ring."""
        point, frame = self.world.route.at(self.chainage)
        off = np.einsum("nij,nj->ni", frame, self.origin - point)
        pitch, yaw, roll = in_travel_frame(self.axes, frame)
        poses = {
            "chainage": self.chainage,
            "offset_y": off[:, 1],
            "offset_z": off[:, 2],
            "pitch": pitch,
            "yaw": yaw,
            "roll": roll,
            "easting": self.origin[:, 0],
            "northing": self.origin[:, 1],
            "elevation": self.origin[:, 2],
        }
        out = xr.Dataset({f"frame_{name}": ("frame", value) for name, value in poses.items()})
        if self.camera.laser is None:
            return out
        ring = self.laser_ring()
        bearing = np.arange(ring.shape[1]) * (2.0 * np.pi / ring.shape[1])
        return out.assign(laser_bearing=("laser_bearing", bearing), laser_range=(("frame", "laser_bearing"), ring))

    def laser_ring(self) -> np.ndarray:
        """Return the true range [m] (frames, 360) from the laser's source to the wall, in its plane, by bearing."""
        source, axes = self.laser_pose(np.arange(len(self)))
        theta = np.radians(np.arange(_RING))
        ways = np.cos(theta)[:, None] * axes[:, None, 2] + np.sin(theta)[:, None] * axes[:, None, 1]
        camera: optics.Camera = self.camera
        ahead = camera.position[0] + (camera.laser.ahead if camera.laser else 0.0)
        cell = self.world.route.centreline.find(source, self.world.route.chainage(self.travelled + ahead))
        return cast_rays(self.world.wall, source, cell, ways, 20.0 * self.world.pipe.radius)[0]

    @cached_property
    def _rays(self) -> np.ndarray:
        column, row = np.meshgrid(np.arange(self.camera.width), np.arange(self.camera.height))
        return self.lens.directions(np.stack([column - self.centre[0], self.centre[1] - row], axis=-1))

    @cached_property
    def _dimming(self) -> np.ndarray:
        return dimming(self.camera, self.centre)

    @cached_property
    def smooth(self) -> Wall:
        """The wall without its roughness, which in pictures is drawn as grain."""
        return build(replace(self.world.pipe, roughness=Roughness()))

    @cached_property
    def _painted(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        pipe = self.world.scenario.pipe
        cells = self.world.pipe.centreline.cells
        pieces = np.cumsum([cell.joint for cell in cells]).astype(np.int64)
        return look_record(pipe), decal_records(pipe, bearing_from_clock), pieces

    def in_sight(self, index: int) -> Wall:
        """Return the wall with the laterals that lie in sight of frame `index`."""
        here = float(self.world.route.chainage(self.travelled[index]))
        tubes = self._wall.laterals
        return self._wall._replace(laterals=tubes[np.abs(tubes["chainage"] - here) < self.camera.sight + _SPARE])

    def _near(self, index: int) -> tuple[Wall, Scene]:
        """Return the wall in sight of frame `index`, and what lights it and lies on it."""
        look, decals, pieces = self._painted
        here = float(self.world.route.chainage(self.travelled[index]))
        decals = decals[np.abs(decals["chainage"] - here) < self.camera.sight + _SPARE]
        air = np.zeros(1, AIR)
        air["haze"], air["ambient"] = self.camera.dust.haze, self.camera.ambient if self.camera.lamp else 0.0
        air["sight"], air["seed"] = self.camera.sight, 1000003 * self.world.seed + index
        scene = Scene(look, decals, pieces, self._lamps(index), self._laser(index), air)
        return self.in_sight(index), scene

    @cached_property
    def _wall(self) -> Wall:
        # The laser's line shows roughness itself; under lamps it is drawn as grain, many times faster.
        return self.smooth if self.camera.laser is None else self.world.wall

    def _lamps(self, index: int) -> np.ndarray:
        axes, lamps = self.axes[index], self.camera.lamp
        out = np.zeros(len(lamps), LAMP)
        whole = sum(lamp.power for lamp in lamps) or 1.0
        for k, lamp in enumerate(lamps):
            out[k]["place"] = self.origin[index] + np.array(lamp.position) @ axes
            out[k]["beam"] = (in_pipe(np.radians(lamp.pitch_deg), np.radians(lamp.yaw_deg), 0.0) @ axes)[0]
            out[k]["power"] = lamp.power / whole
            half = np.cos(np.radians(min(lamp.half_angle_deg, 89.0)))
            out[k]["exponent"] = round(np.log(0.5) / np.log(half), 9)
        return out

    def laser_pose(self, index: np.ndarray | int) -> tuple[np.ndarray, np.ndarray]:
        """Return the laser's source (..., 3) and its axes ahead, up, right (..., 3, 3) on Earth at frames."""
        laser: optics.Laser = self.camera.laser
        robot = self.robot[index]
        away = np.array([laser.ahead, laser.offset_y, laser.offset_z])
        axes = in_pipe(np.radians(laser.pitch_deg), np.radians(laser.yaw_deg), 0.0) @ robot
        return self.origin[index] + away @ robot, axes

    def _laser(self, index: int) -> np.ndarray:
        laser = self.camera.laser
        if laser is None:
            return np.zeros(0, LASER)
        source, axes = self.laser_pose(index)
        out = np.zeros(1, LASER)
        out["source"], out["normal"], out["colour"] = source, axes[0], laser.colour
        guess = self.world.route.chainage(self.travelled[index : index + 1] + self.camera.position[0] + laser.ahead)
        out["cell"] = self.world.route.centreline.find(source[None], guess)[0]
        out["sigma"] = laser.line_width * _SIGMA_OF_WIDTH
        for name in ("power", "speckle", "wet", "ghost", "ghost_ahead"):
            out[name] = getattr(laser, name)
        return out


def _check_inside(world: World, cell: np.ndarray, origin: np.ndarray, travelled: np.ndarray, name: str) -> None:
    """Raise when a camera or a laser has left the pipe."""
    s = world.route.chainage(travelled)
    point, frame = world.route.centreline.at(s)
    off = np.einsum("nij,nj->ni", frame, origin - point)
    bearing = np.mod(np.arctan2(off[:, 1], off[:, 2]), 2.0 * np.pi)
    wall = radius_of_wall(world.wall, cell, s, bearing[:, None], False)[:, 0]
    end = world.route.length
    outside = (np.hypot(off[:, 1], off[:, 2]) >= wall) | (s < 0.0) | (s > end)
    if outside.any():
        at = travelled[outside][0]
        raise ParameterError(
            f"it stands outside the pipe, at chainage {at:.3f} m",
            where=name,
            expected=f"a place within the wall, between chainage 0 and {end:g} m all the way that the robot drives",
        )
