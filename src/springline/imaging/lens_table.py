"""A camera as a survey describes it: the table `[lens.NAME]` of a survey folder."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from springline.errors import InputError, nearest
from springline.geometry.checks import positive, require
from springline.geometry.lenses import LENS_MODELS, Lens
from springline.geometry.robot import frame

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

_KEYS = {
    "model": "one of " + ", ".join(LENS_MODELS),
    "k_px": "a number above 0 [px]",
    "coefficients": "up to four numbers",
    "view_angle_deg": "a number above 0, up to 360",
    "centre_px": "two numbers, column and row",
    "width_px": "a whole number above 0",
    "height_px": "a whole number above 0",
    "position_m": "three numbers: ahead, up, right of the robot's middle",
    "pitch_deg": "a number",
    "yaw_deg": "a number",
    "roll_deg": "a number",
    "laser_ahead_m": "a number above 0",
    "source": "text",
    "sigma": "numbers",
}
_NEEDED = ("model", "k_px", "width_px", "height_px")
_LENGTHS = {"centre_px": 2, "position_m": 3}


@dataclass(frozen=True)
class MountedCamera:
    """A camera on the robot.

    Attributes:
        lens: Its lens, k in pixels.
        centre: Column and row of the principal point; (0, 0) is the middle of the first pixel.
        size: Width and height of a picture [px].
        position: Ahead, up and right of the robot's middle, in robot axes [m].
        pitch: Tilt on the robot, up [rad].
        yaw: Tilt to the right [rad].
        roll: Turn from its right towards its up [rad].
        laser_ahead: Of the plane of its laser ring before it, along the robot's axis [m]; None without one.

    Raises:
        ParameterError: There is a laser ring, and it is not ahead or the principal point lies outside the picture.
    """

    lens: Lens
    centre: tuple[float, float]
    size: tuple[int, int]
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    pitch: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0
    laser_ahead: float | None = None

    def __post_init__(self) -> None:
        if self.laser_ahead is None:
            return
        positive("laser_ahead", self.laser_ahead)
        width, height = self.size
        inside = 0 <= self.centre[0] <= width - 1 and 0 <= self.centre[1] <= height - 1
        require(
            np.asarray(inside), "centre", self.centre[0], f"a point of the picture of {width} x {height}",
            "give column and row of the principal point in pixels",
        )  # fmt: skip

    @property
    def axes(self) -> NDArray[np.float64]:
        """The camera's forward, up and right (3, 3) in robot axes; times the robot's own they are those in the pipe."""
        return frame(self.pitch, self.yaw, self.roll)

    def check_size(self, picture: NDArray[np.generic]) -> None:
        """Refuse a picture (row, column) or (row, column, 3) that is not of this camera's size.

        Raises:
            InputError: It is of another size, or no picture.
        """
        size = picture.shape[1::-1] if picture.ndim in (2, 3) else picture.shape
        if size != self.size:
            wide, high = self.size
            raise InputError(
                f"it is {' by '.join(map(str, size))}, its lens is for {wide} by {high}",
                mend="give the lens for this size, or take the picture out",
            )


def cameras_of_calibration(attrs: Mapping[str, Any], *, laser: bool) -> dict[str, MountedCamera]:
    """Return the cameras of a survey by the names of their lenses.

    Args:
        attrs: Of the group `/calibration`; its `lens` is JSON of lens tables by name, none when it is not there.
        laser: Whether to return those with a laser ring or those without; the others' tables are not looked at.

    Raises:
        InputError: A lens table cannot be used.

    >>> cameras_of_calibration({}, laser=False)
    {}
    """
    tables = json.loads(attrs.get("lens", "{}"))
    return {name: camera_of_table(table, name) for name, table in tables.items() if ("laser_ahead_m" in table) == laser}


def camera_of_table(table: Mapping[str, Any], name: str = "camera") -> MountedCamera:
    """Return the camera that a lens table describes.

    Args:
        table: Keys as a survey folder has them, with their units in their names; `model`, `k_px`, `width_px` and
            `height_px` are needed, the principal point is the picture's middle when it is not given.
        name: Of the lens, for messages.

    Raises:
        InputError: A key is unknown or missing, or a value is of the wrong kind or out of range; the key is named.

    >>> table = {"model": "equidistant", "k_px": 333.0, "width_px": 640, "height_px": 480, "pitch_deg": 2.0}
    >>> camera_of_table(table).centre
    (319.5, 239.5)
    >>> camera_of_table(table | {"lazer_ahead_m": 0.3}, "front")
    Traceback (most recent call last):
    springline.errors.InputError: lens.front.lazer_ahead_m: unknown key, did you mean 'laser_ahead_m'?; ...
    """
    for key in table:
        if key not in _KEYS:
            raise InputError(f"unknown key{nearest(key, _KEYS)}", where=f"lens.{name}.{key}", expected=", ".join(_KEYS))
    for key in _NEEDED:
        if key not in table:
            raise InputError("the key is missing", where=f"lens.{name}.{key}", expected=_KEYS[key])
    model = table["model"]
    if model not in LENS_MODELS:
        raise InputError(
            f"'{model}' is no lens model{nearest(str(model), LENS_MODELS)}", where=f"lens.{name}.model",
            expected=_KEYS["model"],
        )  # fmt: skip
    size = (int(_number(table, "width_px", name, above=0)), int(_number(table, "height_px", name, above=0)))
    middle = (0.5 * (size[0] - 1), 0.5 * (size[1] - 1))
    view = _number(table, "view_angle_deg", name, above=0) if "view_angle_deg" in table else None
    return MountedCamera(
        lens=Lens(
            model,
            _number(table, "k_px", name, above=0),
            _numbers(table, "coefficients", name, ()),
            None if view is None else float(np.radians(view)),
        ),
        centre=_numbers(table, "centre_px", name, middle),
        size=size,
        position=_numbers(table, "position_m", name, (0.0, 0.0, 0.0)),
        pitch=float(np.radians(_number(table, "pitch_deg", name))),
        yaw=float(np.radians(_number(table, "yaw_deg", name))),
        roll=float(np.radians(_number(table, "roll_deg", name))),
        laser_ahead=_number(table, "laser_ahead_m", name, above=0) if "laser_ahead_m" in table else None,
    )


def _number(table: Mapping[str, Any], key: str, name: str, *, above: float = -np.inf) -> float:
    """Return the number of `key`, 0 when it is not there."""
    value = table.get(key, 0.0)
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value) or value <= above:
        raise InputError(f"{value!r} cannot be used", where=f"lens.{name}.{key}", expected=_KEYS[key])
    return float(value)


def _numbers(table: Mapping[str, Any], key: str, name: str, default: tuple[float, ...]) -> tuple[float, ...]:
    value = table.get(key, default)
    right = isinstance(value, list | tuple) and all(isinstance(v, int | float) and np.isfinite(v) for v in value)
    if not right or len(value) not in ((_LENGTHS[key],) if key in _LENGTHS else range(5)):
        raise InputError(f"{value!r} cannot be used", where=f"lens.{name}.{key}", expected=_KEYS[key])
    return tuple(float(v) for v in value)
