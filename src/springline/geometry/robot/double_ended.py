"""Pitch and yaw of a robot that scans at both ends, from the offsets of its two origins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import choice, finite, positive, require
from springline.geometry.robot._numeric import jacobian, propagate
from springline.geometry.robot.section import matrix

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

MEASURED = ("ring", "pipe")


@dataclass(frozen=True)
class DoubleEnded:
    """Attitude of a double-ended scanner.

    Attributes:
        pitch: Nose up [rad].
        yaw: Nose right [rad].
        covariance: Of (pitch, yaw) [rad2], (..., 2, 2); NaN when no covariance was given.
        detected: (..., 2): whether pitch and yaw differ from zero by more than two sigma; False also when no
            covariance was given. An angle that is not detected is not known to have a sign.
    """

    pitch: np.ndarray
    yaw: np.ndarray
    covariance: np.ndarray
    detected: np.ndarray


def double_ended(
    offset_v: ArrayLike,
    offset_h: ArrayLike,
    length: ArrayLike,
    *,
    measured: str = "ring",
    roll: ArrayLike = 0.0,
    covariance: ArrayLike | None = None,
    length_sigma: ArrayLike = 0.0,
) -> DoubleEnded:
    """Return pitch and yaw from the difference of the front and rear offsets of a double-ended scanner.

    Args:
        offset_v: Height of the front origin above its ring's centre, minus that of the rear [m].
        offset_h: The same to the right [m].
        length: Distance between the two origins [m].
        measured: `ring`: read in the two ring planes, as a scanner does, where tan(pitch) = offset_v / length is
            exact; `pipe`: components already turned onto the pipe's axes, where offset_v / length is a component of
            the forward unit vector.
        roll: Of the robot [rad]; offsets read in ring planes are turned back by it. Unused for `pipe`.
        covariance: Of (offset_v, offset_h) [m2], (..., 2, 2): the sum of those of front and rear.
        length_sigma: One sigma of `length` [m].

    Returns:
        DoubleEnded of broadcast arrays. Both angles are observable in any pipe, round ones included.

    Raises:
        ParameterError: The offsets reach the length (for `pipe`), or a value is out of range.

    Source: (5.32), (5.33) for `ring`, since o_f - o_r = L n - (L/a) x has components L tan(pitch), L tan(yaw) on the
    ring's axes: the sine correction (5.34)-(5.39) does not apply there (erratum 5). For `pipe`
    a = sqrt(1 - v^2 - h^2), pitch = atan(v/a), yaw = atan(h/a), with no iteration (erratum 6).

    >>> found = double_ended(8.03847577, 3.94957493, 30.0)
    >>> round(float(np.degrees(found.pitch)), 6), round(float(np.degrees(found.yaw)), 6)
    (15.0, 7.5)
    """
    choice("measured", measured, MEASURED)
    values = np.stack(
        np.broadcast_arrays(
            finite("offset_v", offset_v),
            finite("offset_h", offset_h),
            positive("length", length),
            finite("roll", roll),
        ),
        axis=-1,
    )
    if measured == "pipe":
        reach = np.hypot(values[..., 0], values[..., 1]) / values[..., 2]
        require(~(reach >= 1), "offset / length", reach, "below 1", "offsets on pipe axes are shorter than the robot")
    solve = _from_rings if measured == "ring" else _from_pipe
    pitch, yaw = np.moveaxis(solve(values), -1, 0)
    spread = np.full((*pitch.shape, 2, 2), np.nan)
    if covariance is not None:
        spread = _covariance(solve, values, matrix("covariance", covariance, 2), length_sigma)
    with np.errstate(invalid="ignore"):
        sigma = np.sqrt(np.diagonal(spread, axis1=-2, axis2=-1))
        detected = np.abs(np.stack([pitch, yaw], axis=-1)) > 2.0 * sigma
    return DoubleEnded(pitch, yaw, spread, detected)


def _from_rings(values: Array) -> Array:
    v, h, length, roll = np.moveaxis(values, -1, 0)
    cos, sin = np.cos(roll), np.sin(roll)
    return np.stack([np.arctan((cos * v + sin * h) / length), np.arctan((cos * h - sin * v) / length)], axis=-1)


def _from_pipe(values: Array) -> Array:
    v, h = values[..., 0] / values[..., 2], values[..., 1] / values[..., 2]
    a = np.sqrt(1.0 - v * v - h * h)
    return np.stack([np.arctan(v / a), np.arctan(h / a)], axis=-1)


def _covariance(solve: Callable[[Array], Array], values: Array, covariance: Array, length_sigma: Array) -> Array:
    length_sigma = finite("length_sigma", length_sigma)
    if np.any(length_sigma < 0):
        raise ParameterError(f"length_sigma = {np.min(length_sigma):g} is negative", expected="length_sigma >= 0")
    size = float(np.nanmean(values[..., 2]))
    derivative = jacobian(solve, values, [1e-7 * size, 1e-7 * size, 1e-7 * size, 1e-7])
    of_length = derivative[..., 2:3] * np.asarray(length_sigma)[..., None, None]
    return propagate(derivative[..., :2], covariance) + of_length @ np.swapaxes(of_length, -1, -2)
