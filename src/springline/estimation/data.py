"""What the estimator is given: plain arrays of rings, inertial samples and ties."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ..errors import InputError
from .rotations import pipe_frame

GRAVITY = 9.80665
"""Standard gravity [m/s2]."""
_SMOOTHING = 0.1


@dataclass(frozen=True)
class Rings:
    """One fitted ellipse per ring, its sufficient statistic.

    Attributes:
        distance: Odometer reading of each ring [m] (n,), increasing.
        parameters: centre_z, centre_y, mean_radius, oval_cos, oval_sin in the ring's own plane [m] (n, 5); NaN = none.
        covariance: Of the parameters [m2] (n, 5, 5).
        time: By the rings' clock [s] (n,), increasing; None when there was no clock.
        lever: Sensor ahead, above and right of the robot's middle [m].
        odometer: Whether `distance` was counted by wheels or cable, so that it tells how far the robot moved.
    """

    distance: np.ndarray
    parameters: np.ndarray
    covariance: np.ndarray
    time: np.ndarray | None = None
    lever: tuple[float, float, float] = (0.0, 0.0, 0.0)
    odometer: bool = True

    def __post_init__(self) -> None:
        count = len(self.distance)
        for name, shape in (("parameters", (count, 5)), ("covariance", (count, 5, 5)), ("time", (count,))):
            value = getattr(self, name)
            if value is not None and np.shape(value) != shape:
                raise InputError(f"rings.{name} has shape {np.shape(value)}", expected=f"{shape}")
        _increasing("rings.distance", self.distance)
        if self.time is not None:
            _increasing("rings.time", self.time)

    @property
    def seen(self) -> np.ndarray:
        """Whether each ring has an ellipse (n,)."""
        known = np.isfinite(self.parameters).all(axis=1) & np.isfinite(self.covariance).all(axis=(1, 2))
        return known & (np.einsum("nii->ni", np.nan_to_num(self.covariance)) > 0.0).all(axis=1)


@dataclass(frozen=True)
class Inertial:
    """The inertial log in robot axes.

    Attributes:
        time: By its own clock [s] (m,), increasing.
        gyro: Right-handed rates about robot x, y, z [rad/s] (m, 3).
        accel: Specific force [m/s2] (m, 3), +g on y at rest.
        derived: Whether rates and force were made from attitudes, so that they cannot show the unit's own bias.
    """

    time: np.ndarray
    gyro: np.ndarray
    accel: np.ndarray
    derived: bool = False

    def __post_init__(self) -> None:
        count = len(self.time)
        for name in ("gyro", "accel"):
            if np.shape(getattr(self, name)) != (count, 3):
                raise InputError(f"inertial.{name} has shape {np.shape(getattr(self, name))}", expected=f"{(count, 3)}")
        _increasing("inertial.time", self.time)

    @classmethod
    def from_attitude(
        cls, time: np.ndarray, heading: np.ndarray, inclination: np.ndarray, bank: np.ndarray
    ) -> Inertial:
        """Return the log that a unit which tells attitude alone stands for: its rates, and gravity on its axes.

        Angles are smoothed by a tenth of a second, as white noise in them would be read as turning.

        Args:
            time: By the unit's clock [s] (m,), increasing.
            heading: Clockwise from north [rad] (m,).
            inclination: Nose up [rad] (m,).
            bank: Right side down [rad] (m,).

        >>> level = np.zeros(50)
        >>> log = Inertial.from_attitude(np.arange(50) * 0.1, 0.01 * np.arange(50), level, level)
        >>> log.gyro[25].round(4).tolist(), log.accel[25].round(3).tolist()
        ([0.0, -0.1, 0.0], [0.0, 9.807, 0.0])
        """
        step = float(np.median(np.diff(time)))
        angles = np.stack([np.unwrap(heading), inclination, bank], axis=1)
        angles = gaussian_filter1d(angles, max(_SMOOTHING / step, 1e-3), axis=0, mode="nearest")
        x, level, z = pipe_frame(angles[:, 0], angles[:, 1])
        cos, sin = np.cos(angles[:, 2:]), np.sin(angles[:, 2:])
        axes = np.stack([x, cos * level + sin * z, cos * z - sin * level], axis=2)
        turn = np.swapaxes(axes[:-1], 1, 2) @ axes[1:]
        rate = 0.5 * np.stack([turn[:, k, j] - turn[:, j, k] for j, k in ((1, 2), (2, 0), (0, 1))], axis=1)
        rate = rate / np.diff(time)[:, None]
        padded = np.concatenate([rate[:1], rate, rate[-1:]])
        return cls(np.asarray(time, float), 0.5 * (padded[1:] + padded[:-1]), GRAVITY * axes[:, 2, :], True)


@dataclass(frozen=True)
class Ties:
    """Known points of the pipe's axis.

    Attributes:
        distance: Odometer reading when the robot's middle stood abreast of each [m] (t,).
        position: Easting, northing, elevation [m] (t, 3).
        sigma: One-sigma of each coordinate [m] (t,).
    """

    distance: np.ndarray
    position: np.ndarray
    sigma: np.ndarray

    def __post_init__(self) -> None:
        count = len(self.distance)
        if np.shape(self.position) != (count, 3) or np.shape(self.sigma) != (count,):
            raise InputError(
                f"ties.position has shape {np.shape(self.position)} and ties.sigma {np.shape(self.sigma)}",
                expected=f"{(count, 3)} and {(count,)}",
            )
        if not np.all(np.asarray(self.sigma) > 0.0):
            raise InputError("a tie's sigma is not above zero", expected="the one-sigma of its coordinates [m]")


def _increasing(name: str, value: np.ndarray) -> None:
    value = np.asarray(value, float)
    if value.ndim != 1 or not np.isfinite(value).all():
        raise InputError(f"{name} has missing or infinite values", expected="a finite number for each row")
    bad = np.flatnonzero(np.diff(value) <= 0.0)
    if bad.size:
        raise InputError(
            f"{name} does not increase: {value[bad[0]]:g} is followed by {value[bad[0] + 1]:g}",
            where=f"row {bad[0] + 1}",
            expected="rows in the order in which they were recorded",
            mend="sort by the clock; the order of rings is what tells pose, so no other order is taken",
        )
