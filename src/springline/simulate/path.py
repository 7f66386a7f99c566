"""Where the robot is and how it lies, for every chainage that it travels.

Travelled chainage u runs from where the robot enters, whichever end that is; the **travel frame** is the local pipe
frame seen along travel (turned half round about its y when driving from the pipe's end). A prescribed path is the
axis, eased over the wheelbase, plus stated offsets; a robot that follows points along it. A kinematic path has both
axles ride on the true wall, eased over the wheels, and the body lie along their chord. The result is a spline, so that
rates and accelerations are those of one and the same motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numba import njit
from scipy.interpolate import make_interp_spline
from scipy.ndimage import uniform_filter1d

from ..errors import ParameterError
from . import equipment
from .attitude import from_axes, in_pipe
from .centreline import Centreline, level_frame
from .profiles import Points, Profile, evaluate
from .scenario import Scenario
from .surface import wall_at
from .wall import BED, Pipe, Wall, build

STEP = 0.01
"""Step of the grid on which the motion is laid out [m]."""

HALF_TURN = np.diag([-1.0, 1.0, -1.0])
"""Half a turn about y."""


class Route:
    """The pipe's axis as travelled."""

    def __init__(self, centreline: Centreline, from_end: bool) -> None:
        self.centreline, self.from_end = centreline, from_end
        self.length = centreline.end

    def chainage(self, travelled: np.ndarray | float) -> np.ndarray:
        """Return the pipe's own chainage [m] of travelled chainages, and the other way round."""
        u = np.asarray(travelled, float)
        return self.length - u if self.from_end else u

    def at(self, travelled: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Return axis points (..., 3) and travel frames (..., 3, 3) at travelled chainages."""
        point, frame = self.centreline.at(self.chainage(travelled))
        return point, HALF_TURN @ frame if self.from_end else frame

    def bearing(self, bearing: np.ndarray | float) -> np.ndarray:
        """Return a bearing of the pipe as seen along travel, in [0, 2 pi)."""
        return np.mod(np.pi - np.asarray(bearing) if self.from_end else np.asarray(bearing), 2.0 * np.pi)


class Motion:
    """The robot's middle and axes as splines over travelled chainage.

    Attributes:
        grid: Travelled chainages [m] (n,) on which it was laid out.
        path: Length of the way of the robot's middle [m] at each (n,).
    """

    def __init__(self, scenario: Scenario, pipe: Pipe, route: Route, start: float, end: float) -> None:
        robot = scenario.robot
        margin = 2.0 * robot.wheelbase + 8.0 * robot.wheel_radius + 10.0 * STEP
        self.grid = np.arange(start - margin, end + margin, STEP)
        lay = _driven if robot.path == "kinematic" else _steered
        middle, axes = lay(scenario, pipe, route, self.grid)
        if robot.backwards:
            axes = HALF_TURN @ axes
        self.path = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(middle, axis=0), axis=1))])
        self._middle = make_interp_spline(self.grid, middle, k=5)
        self._quaternion = make_interp_spline(self.grid, _continuous(quaternions(axes)), k=5)

    def middle(self, travelled: np.ndarray) -> np.ndarray:
        """Return the robot's middle (..., 3), east, north, up [m]."""
        return self._middle(travelled)

    def axes(self, travelled: np.ndarray) -> np.ndarray:
        """Return the robot's axes x, y, z as rows (..., 3, 3) in east, north, up."""
        return rotations(self._quaternion(travelled))

    def velocity(self, travelled: np.ndarray, lever: np.ndarray) -> np.ndarray:
        """Return d/du of a point fixed to the robot at `lever` (3,) in robot axes, (..., 3)."""
        raw, change = self._quaternion(travelled), self._quaternion(travelled, 1)
        size2 = np.sum(raw * raw, axis=-1, keepdims=True)
        unit = raw / np.sqrt(size2)
        rate = (change - np.sum(raw * change, axis=-1, keepdims=True) / size2 * raw) / np.sqrt(size2)
        return self._middle(travelled, 1) + 2.0 * _products(unit, rate) @ lever

    def point(self, travelled: np.ndarray, lever: np.ndarray) -> np.ndarray:
        """Return the place (..., 3) of a point fixed to the robot at `lever` (3,) in robot axes."""
        return self.middle(travelled) + np.einsum("...ij,i->...j", self.axes(travelled), lever)


def _steered(scenario: Scenario, pipe: Pipe, route: Route, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return middle (n, 3) and axes (n, 3, 3) of a robot on a prescribed path."""
    robot = scenario.robot
    centre = make_interp_spline(u, _smooth(route.at(u)[0], robot.wheelbase), k=5)
    frame = level_frame(centre(u, 1))
    y, z = _profile(robot.offset_y, u, robot), _profile(robot.offset_z, u, robot)
    for knock in robot.knock:
        y, z = y + knock.offset_y * _window(u, knock), z + knock.offset_z * _window(u, knock)
    middle = centre(u) + y[:, None] * frame[:, 1] + z[:, None] * frame[:, 2]
    forward = frame[:, 0]
    if robot.follow:
        forward = make_interp_spline(u, middle, k=5)(u, 1)
    return middle, _turned(scenario, u, frame, forward, np.zeros(u.size))


def _driven(scenario: Scenario, pipe: Pipe, route: Route, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return middle (n, 3) and axes (n, 3, 3) of a robot whose wheels stand on the wall."""
    robot = scenario.robot
    centre, frame = route.at(u)
    height, side, roll = _ride(scenario, pipe, route, u)
    for knock in robot.knock:
        height, side = height + knock.offset_y * _window(u, knock), side + knock.offset_z * _window(u, knock)
    guide = centre + height[:, None] * frame[:, 1] + side[:, None] * frame[:, 2]
    over = 2.0 * robot.wheel_radius
    axle, turn, eased = (make_interp_spline(u, _smooth(v, over), k=5) for v in (guide, roll, centre))
    half = np.full(u.size, 0.5 * robot.wheelbase)
    for _ in range(8):
        # The axles are a wheelbase apart as the robot measures it, not as the pipe does.
        half *= robot.wheelbase / np.linalg.norm(axle(u + half) - axle(u - half), axis=1)
    rear, front = axle(u - half), axle(u + half)
    roll = 0.5 * (turn(u - half) + turn(u + half))
    axes = _turned(scenario, u, level_frame(eased(u, 1)), front - rear, roll)
    return 0.5 * (rear + front) + (ride_height(scenario) - robot.wheel_radius) * axes[:, 1], axes


def _turned(scenario: Scenario, u: np.ndarray, frame: np.ndarray, forward: np.ndarray, roll: np.ndarray) -> np.ndarray:
    """Return the robot's axes (n, 3, 3): along `forward` on Earth, turned from there as the scenario prescribes."""
    robot = scenario.robot
    ahead = np.einsum("nij,nj->ni", frame, forward)
    pitch = np.arctan2(ahead[:, 1], ahead[:, 0]) + np.radians(_profile(robot.pitch_deg, u, robot))
    yaw = np.arctan2(ahead[:, 2], ahead[:, 0]) + np.radians(_profile(robot.yaw_deg, u, robot) + robot.side_slip_deg)
    roll = roll + np.radians(_profile(robot.roll_deg, u, robot))
    for knock in robot.knock:
        share = _window(u, knock)
        pitch, yaw = pitch + np.radians(knock.pitch_deg) * share, yaw + np.radians(knock.yaw_deg) * share
        roll = roll + np.radians(knock.roll_deg) * share
    return in_pipe(pitch, yaw, roll) @ frame


def _profile(profile: Profile, u: np.ndarray, robot: equipment.Robot) -> np.ndarray:
    """Return a profile on the grid; one of points loses its corners over a wheel's width."""
    values = evaluate(profile, u)
    return _smooth(values, 2.0 * robot.wheel_radius) if isinstance(profile, Points) else values


def _ride(scenario: Scenario, pipe: Pipe, route: Route, u: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return height and side of the axles' middle and their roll, both wheels standing on the true wall."""
    robot = scenario.robot
    # Wheels stand on the bed under the water, and a gap narrower than a wheel does not swallow it.
    dry = replace(
        pipe,
        floors=[floor for floor in pipe.floors if floor.kind == BED],
        centreline=Centreline([replace(cell, groove=0.0) for cell in pipe.centreline.cells]),
    )
    s = np.clip(route.chainage(u), 0.0, route.length)
    climb = np.radians(evaluate(robot.climb_deg, u))
    if route.from_end:
        climb = -climb
    height, side, roll = stand(build(dry), pipe.centreline.index(s), s, climb, robot.half_span, robot.wheel_radius)
    if np.isnan(height).any():
        raise ParameterError(
            f"half_span = {robot.half_span} m: the wheels find no stand at chainage {s[np.isnan(height)][0]:.2f} m",
            where="robot",
            expected="wheels less far apart than the pipe is wide",
        )
    return (height, -side, -roll) if route.from_end else (height, side, roll)


@njit(cache=True)
def stand(wall: Wall, cell, chainage, climb, half_span, wheel_radius):
    """Return height, side [m] and roll [rad] (n,) of the middle of an axle whose two wheels stand on the wall.

    Args:
        wall: Arrays of the wall.
        cell: Cell of each place (n,).
        chainage: Chainage [m] of each place (n,).
        climb: Bearing of the axle's middle from the invert [rad] (n,), positive to the right.
        half_span: Half the distance between the wheels [m].
        wheel_radius: Radius of the wheels [m].
    """
    height, side, roll = np.empty(climb.size), np.empty(climb.size), np.empty(climb.size)
    for i in range(climb.size):
        middle = climb[i] - 0.5 * np.pi
        low, high = 0.0, 0.5 * np.pi
        ly = lz = ry = rz = 0.0
        for _ in range(60):
            half = 0.5 * (low + high)
            ly, lz = _foot(wall, cell[i], chainage[i], middle - half)
            ry, rz = _foot(wall, cell[i], chainage[i], middle + half)
            if np.hypot(ry - ly, rz - lz) < 2.0 * half_span:
                low = half
            else:
                high = half
        wide = np.hypot(ry - ly, rz - lz)
        if abs(wide - 2.0 * half_span) > 1e-3 * half_span:
            height[i] = side[i] = roll[i] = np.nan
            continue
        ny, nz = (rz - lz) / wide, -(ry - ly) / wide
        height[i] = 0.5 * (ly + ry) + wheel_radius * ny
        side[i] = 0.5 * (lz + rz) + wheel_radius * nz
        roll[i] = np.arctan2(ry - ly, rz - lz)
    return height, side, roll


@njit(cache=True)
def _foot(wall, cell, x, theta):
    y, z = np.sin(theta), np.cos(theta)
    rho = wall_at(wall, cell, x, y, z, 1.0)[0]
    return rho * y, rho * z


def ride_height(scenario: Scenario) -> float:
    """Return the height [m] of the robot's axis above its wheels' contact; by default on the round pipe's axis."""
    robot = scenario.robot
    if robot.ride_height is not None:
        return robot.ride_height
    return float(np.sqrt((0.5 * scenario.pipe.diameter) ** 2 - robot.half_span**2))


def in_travel_frame(axes: np.ndarray, frame: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return pitch, yaw, roll [rad] of robot axes (n, 3, 3) against travel frames (n, 3, 3), both on Earth."""
    return from_axes(axes @ np.swapaxes(frame, -1, -2))


def _window(u: np.ndarray, knock: equipment.Knock) -> np.ndarray:
    share = np.clip((u - knock.chainage) / (0.5 * knock.length), -1.0, 1.0)
    return np.cos(0.5 * np.pi * share) ** 2


def _smooth(values: np.ndarray, over: float) -> np.ndarray:
    """Return values averaged four times over a quarter of `over` [m]: a cubic B-spline, smooth to two derivatives."""
    span = 2 * max(1, round(0.125 * over / STEP)) + 1
    for _ in range(4):
        values = uniform_filter1d(values, span, axis=0, mode="nearest")
    return values


def quaternions(axes: np.ndarray) -> np.ndarray:
    """Return unit quaternions (n, 4), scalar first, of robot axes given as rows (n, 3, 3)."""
    m = axes
    trace = m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2]
    squares = np.stack(
        [1.0 + trace, *(1.0 + 2.0 * m[:, k, k] - trace for k in range(3))],
        axis=1,
    )
    # Row i, column j: four times the product of components i and j; the row of the largest component is the safest.
    products = np.zeros((len(m), 4, 4))
    for k in range(4):
        products[:, k, k] = squares[:, k]
    for k, (i, j) in enumerate(((1, 2), (2, 0), (0, 1)), start=1):
        products[:, 0, k] = products[:, k, 0] = m[:, i, j] - m[:, j, i]
        products[:, i + 1, j + 1] = products[:, j + 1, i + 1] = m[:, i, j] + m[:, j, i]
    q = products[np.arange(len(m)), np.argmax(squares, axis=1)]
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def _continuous(q: np.ndarray) -> np.ndarray:
    """Return the quaternions with signs such that each lies near the one before."""
    flips = np.sign(np.sum(q[1:] * q[:-1], axis=1))
    return q * np.concatenate([[1.0], np.cumprod(flips)])[:, None]


def rotations(q: np.ndarray) -> np.ndarray:
    """Return robot axes as rows (..., 3, 3) of quaternions (..., 4), scalar first, of any length."""
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    return np.swapaxes(_products(q, q), -1, -2)


def _products(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the matrix that is quadratic in a quaternion, with one factor from a and one from b (symmetrised)."""
    w, x, y, z = np.moveaxis(a, -1, 0)
    ww, xx, yy, zz = np.moveaxis(b, -1, 0)
    rows = [
        [w * ww + x * xx - y * yy - z * zz, x * yy + y * xx - w * zz - z * ww, x * zz + z * xx + w * yy + y * ww],
        [x * yy + y * xx + w * zz + z * ww, w * ww - x * xx + y * yy - z * zz, y * zz + z * yy - w * xx - x * ww],
        [x * zz + z * xx - w * yy - y * ww, y * zz + z * yy + w * xx + x * ww, w * ww - x * xx - y * yy + z * zz],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
