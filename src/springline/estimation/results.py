"""What the joint estimate returns: every quantity at every ring with its covariance, or why it is missing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from .bends import Bend
from .factors.base import WIDTH
from .iterate import Solution
from .problem import Problem
from .profile import Deflection, Sag
from .states import (
    ACCEL,
    AXLES,
    BASE_RIGHT,
    BASE_UP,
    CLOCK,
    GYRO,
    LEVER,
    LEVER_UP,
    REAR_SCALE,
    SCALE,
    SLIP_RIGHT,
    SLIP_UP,
)
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
    "baseline_up": BASE_UP,
    "baseline_right": BASE_RIGHT,
    "rear_scale": REAR_SCALE,
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
        sags: Stretches that hang below the string between their ends.
        joints: Angles of the axis at the joints that were asked for.
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
    sags: tuple[Sag, ...]
    joints: tuple[Deflection, ...]
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
    state, found, count = solution.state, solution.covariance, len(problem.rings.distance)
    way = np.linalg.norm(np.diff(state.axis, axis=0), axis=1)
    chainage, axis = np.concatenate([[0.0], np.cumsum(way)]), state.axis
    out = {
        name: np.empty((count, *shape))
        for name, shape in (
            ("chainage", ()),
            ("chainage_sigma", ()),
            ("pose", (5,)),
            ("pose_covariance", (5, 5)),
            ("section", (3,)),
            ("section_covariance", (3, 3)),
            ("axis", (3,)),
            ("axis_covariance", (3, 3)),
            ("direction", (2,)),
            ("direction_sigma", (2,)),
        )
    }
    out["rings"] = bend_terms(problem, state)
    for window in problem.windows:
        rows = window.rows(problem.intervals)
        if rows.start == rows.stop:
            continue
        at = problem.places(problem.rings.distance[rows], float(state.scalars[CLOCK]))
        value, slopes = at.evaluate(1, state, np.arange(WIDTH))
        blocks = found.rows(window.first, window.last)
        spread = _sandwich(at.interval - window.first, slopes, *blocks, found.corner)
        share, before = np.clip(at.share, 0.0, 1.0)[:, None, None], at.interval
        points = found.axis[before] * (1.0 - share) + found.axis[before + 1] * share
        ahead = np.sign(np.einsum("ni,ni->n", value[:, 8:11], state.knots[before, :3]))
        out["rings"][rows] += at.evaluate(0, state, np.arange(0))[0]
        out["chainage"][rows] = chainage[before] + ahead * np.linalg.norm(value[:, 8:11], axis=1)
        out["chainage_sigma"][rows] = np.sqrt(points[:, 3, 3])
        out["pose"][rows], out["pose_covariance"][rows] = value[:, :5], spread[:, :5, :5]
        out["section"][rows], out["section_covariance"][rows] = value[:, 5:8], spread[:, 5:8, 5:8]
        out["axis"][rows], out["axis_covariance"][rows] = axis[before] + value[:, 8:11], points[:, :3, :3]
        out["direction"][rows] = value[:, 11:]
        out["direction_sigma"][rows] = np.sqrt(np.einsum("nii->ni", spread[:, 11:, 11:]))
    out["chainage"] -= out["chainage"][0]
    return out


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
