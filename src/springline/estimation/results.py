"""What the joint estimate returns: every quantity at every ring with its covariance, or why it is missing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from .bends import Bend
from .factors.base import DERIVATIVE_STEPS, WIDTH
from .factors.rings import WINDOW
from .factors.sensor import OUT, evaluate
from .iterate import Solution
from .problem import Problem
from .states import ACCEL, AXLES, CLOCK, GYRO, LEVER, LEVER_UP, SCALE, SLIP_RIGHT, SLIP_UP
from .torus import bend_terms

SCALAR_NAMES = {
    "gyro_bias_x": GYRO.start,
    "gyro_bias_y": GYRO.start + 1,
    "gyro_bias_z": GYRO.start + 2,
    "accel_bias_x": ACCEL.start,
    "accel_bias_y": ACCEL.start + 1,
    "accel_bias_z": ACCEL.start + 2,
    "odometer_scale": SCALE,
    "slip_up": SLIP_UP,
    "slip_right": SLIP_RIGHT,
    "lever": LEVER,
    "lever_up": LEVER_UP,
    "axles": AXLES,
    "clock_offset": CLOCK,
}
"""Scalars of a survey by name; see `states` for what each is."""


@dataclass(frozen=True, eq=False)
class JointEstimate:
    """The joint estimate; arrays run over rings, frames and signs are those of `springline.conventions`.

    Attributes:
        chainage: Along the axis from where the first ring was taken [m] (n,); NaN when unknown, as everywhere.
        chainage_sigma: (n,) [m].
        rings: Ellipse that each ring shows by this estimate, in its own plane and frame: centre_z, centre_y,
            mean_radius, oval_cos, oval_sin [m] (n, 5).
        pose: offset_y, offset_z, pitch, yaw, roll (n, 5) [m, rad].
        pose_covariance: (n, 5, 5).
        section: mean_radius, oval_cos, oval_sin of the true section in the pipe's frame [m] (n, 3).
        section_covariance: (n, 3, 3) [m2].
        axis: Point of the axis abreast of each ring: easting, northing, elevation [m] (n, 3); from where the first ring
            was taken when there are no ties.
        axis_covariance: (n, 3, 3) [m2].
        direction: Heading clockwise from north, and grade angle above the horizontal, of the pipe [rad] (n, 2); heading
            from the robot's first when nothing tells the way north.
        direction_sigma: (n, 2) [rad].
        scalars: Name of SCALAR_NAMES to (value, one-sigma).
        bends: Bends as line-arc-line.
        why_missing: Quantity to the reason why it is NaN.
        warnings: What the user must know.
        misfit: Squared misfit of rings over that expected from their covariance.
        iterations: Steps taken.
        converged: Whether they came to rest.
    """

    chainage: np.ndarray
    chainage_sigma: np.ndarray
    rings: np.ndarray
    pose: np.ndarray
    pose_covariance: np.ndarray
    section: np.ndarray
    section_covariance: np.ndarray
    axis: np.ndarray
    axis_covariance: np.ndarray
    direction: np.ndarray
    direction_sigma: np.ndarray
    scalars: dict[str, tuple[float, float]]
    bends: tuple[Bend, ...]
    why_missing: dict[str, str]
    warnings: tuple[str, ...]
    misfit: float
    iterations: int
    converged: bool

    @property
    def pose_sigma(self) -> np.ndarray:
        """(n, 5) one-sigma of `pose`."""
        return np.sqrt(np.einsum("nii->ni", self.pose_covariance))

    @property
    def section_sigma(self) -> np.ndarray:
        """(n, 3) one-sigma of `section` [m]."""
        return np.sqrt(np.einsum("nii->ni", self.section_covariance))

    @property
    def axis_sigma(self) -> np.ndarray:
        """(n, 3) one-sigma of `axis` [m]."""
        return np.sqrt(np.einsum("nii->ni", self.axis_covariance))

    @property
    def gradient(self) -> np.ndarray:
        """(n,) rise per metre of run."""
        return np.tan(self.direction[:, 1])


def at_rings(problem: Problem, solution: Solution) -> dict[str, np.ndarray]:
    """Return values and covariances at every ring, before what is not observable is taken out."""
    state, found = solution.state, solution.covariance
    shown = bend_terms(problem, state)
    places = problem.places(problem.rings.distance, float(state.scalars[CLOCK]))
    value, spread = np.empty((len(places.share), OUT)), np.empty((len(places.share), OUT, OUT))
    for first in range(0, len(value), WINDOW):
        rows = slice(first, first + WINDOW)
        at = places.rows(rows)
        value[rows], slopes = evaluate(
            1,
            at.interval,
            state.knots,
            state.scalars,
            at.share,
            at.step,
            at.tracks(),
            at.clock,
            np.asarray(at.lever, float),
            np.arange(WIDTH),
            DERIVATIVE_STEPS,
        )
        spread[rows] = _sandwich(at.interval, slopes, found.diagonal, found.beside, found.border, found.corner)
        shown[rows] += evaluate(
            0,
            at.interval,
            state.knots,
            state.scalars,
            at.share,
            at.step,
            at.tracks(),
            at.clock,
            np.asarray(at.lever, float),
            np.arange(0),
            DERIVATIVE_STEPS,
        )[0]
    share = np.clip(places.share, 0.0, 1.0)
    before, after = places.interval, places.interval + 1
    way = np.linalg.norm(np.diff(state.axis, axis=0), axis=1)
    chainage = np.concatenate([[0.0], np.cumsum(way)])
    length = np.linalg.norm(value[:, 8:11], axis=1)
    ahead = np.sign(np.einsum("ni,ni->n", value[:, 8:11], state.knots[before, :3]))
    points = found.axis[before] * (1.0 - share[:, None, None]) + found.axis[after] * share[:, None, None]
    return {
        "rings": shown,
        "chainage_sigma": np.sqrt(points[:, 3, 3]),
        "chainage": chainage[before] + ahead * length - ahead[0] * length[0],
        "pose": value[:, :5],
        "pose_covariance": spread[:, :5, :5],
        "section": value[:, 5:8],
        "section_covariance": spread[:, 5:8, 5:8],
        "axis": state.axis[before] + value[:, 8:11],
        "axis_covariance": points[:, :3, :3],
        "direction": value[:, 11:],
        "direction_sigma": np.sqrt(np.einsum("nii->ni", spread[:, 11:, 11:])),
    }


@njit(cache=True)
def _sandwich(interval, slopes, diagonal, beside, border, corner):
    """Return J C J' (n, r, r) with C the covariance of the knots before and after and the scalars."""
    block, scalars = border.shape[1:]
    size = 2 * block + scalars
    out = np.empty((len(interval), slopes.shape[1], slopes.shape[1]))
    local = np.empty((size, size))
    for n in range(len(interval)):
        k = interval[n]
        local[:block, :block] = diagonal[k]
        local[block : 2 * block, block : 2 * block] = diagonal[k + 1]
        local[:block, block : 2 * block] = beside[k]
        local[block : 2 * block, :block] = beside[k].T
        local[:block, 2 * block :] = border[k]
        local[2 * block :, :block] = border[k].T
        local[block : 2 * block, 2 * block :] = border[k + 1]
        local[2 * block :, block : 2 * block] = border[k + 1].T
        local[2 * block :, 2 * block :] = corner
        slope = np.ascontiguousarray(slopes[n])
        out[n] = slope @ local @ np.ascontiguousarray(slope.T)
    return out
