"""What the joint estimator is given, and the truth beside it, from a simulated survey."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from springline.estimation import Inertial, Rings, Ties, pooled_harmonics
from springline.geometry.fitting import fit_ellipses_to_ranges

AXES = ("easting", "northing", "elevation")
TERMS = ("offset_y", "offset_z", "pitch", "yaw", "roll")
_BLOCK = 4000
"""Rings that are fitted at once."""


class Given(NamedTuple):
    """What `estimate_joint` takes."""

    rings: Rings
    log: Inertial
    ties: Ties


def given(survey, ranges: np.ndarray | None = None) -> Given:
    """Return a simulated survey as arrays, its ellipses fitted; `ranges` take the place of its own."""
    data, log, known = survey.rings, survey.inertial, survey.ties
    lever = tuple(float(data.attrs.get(f"position_{axis}", 0.0)) for axis in "xyz")
    make, form = Inertial, ("gyro", "accel")
    if "gyro" not in log:
        make, form = Inertial.from_attitude, ("heading", "inclination", "bank")
    points = np.stack([known[name].values for name in AXES], axis=1)
    return Given(
        fitted(data, lever, ranges),
        make(log["time"].values, *(log[name].values for name in form)),
        Ties(known["distance"].values, points, known["sigma"].values),
    )


def fitted(data, lever: tuple[float, float, float], ranges: np.ndarray | None = None) -> Rings:
    """Return the ellipses of one scanner's rings; `lever` is where it stands on the robot."""
    fits = [
        fit_ellipses_to_ranges((data["range"] if ranges is None else ranges)[rows], data["bearing"].values)
        for rows in (slice(first, first + _BLOCK) for first in range(0, data.sizes["ring"], _BLOCK))
    ]
    parameters, covariance = (np.concatenate([getattr(one, n) for one in fits]) for n in ("parameters", "covariance"))
    return Rings(data["distance"].values, parameters, covariance, data["time"].values, lever)


def shape_of(data, rings: Rings):
    """Return the harmonics of the section that the rings of one scanner show beyond their ellipses."""
    return pooled_harmonics(data["range"].values, data["bearing"].values, rings.parameters)


def here(truth, name: str) -> np.ndarray:
    """Return a true variable of the pipe abreast of every ring."""
    return np.interp(truth["ring_chainage"].values, truth["chainage"].values, truth[name].values)


def true_axis(truth) -> np.ndarray:
    """Return the true axis abreast of every ring [m] (n, 3)."""
    return np.stack([here(truth, name) for name in AXES], axis=1)


def true_pose(truth) -> np.ndarray:
    """Return the sensor's true pose at every ring (n, 5)."""
    return np.stack([truth[name].values for name in TERMS], axis=1)


def true_radii(truth) -> np.ndarray:
    """Return the true half width and half height abreast of every ring [m] (n, 2)."""
    return 0.5 * np.stack([here(truth, f"diameter_{axis}") for axis in "xy"], axis=1)


def radii(found) -> tuple[np.ndarray, np.ndarray]:
    """Return half width and half height by the joint estimate, and their one-sigma [m] (n, 2)."""
    turn = np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]])
    return found.section @ turn.T, np.sqrt(np.einsum("ai,nij,aj->na", turn, found.section_covariance, turn))


def of_stations(found, truth) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return the errors of a joint estimate at every ring, and their sigma, by quantity."""
    values, spread = radii(found)
    out = {name: (values[:, k] - true_radii(truth)[:, k], spread[:, k]) for k, name in enumerate(("r1", "r2"))}
    for k, name in enumerate(TERMS):
        out[name] = (found.pose[:, k] - truth[name].values, found.pose_sigma[:, k])
    for k, name in enumerate(AXES):
        out[name] = (found.axis[:, k] - here(truth, name), found.axis_sigma[:, k])
    return out
