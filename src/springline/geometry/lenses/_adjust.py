"""The bundle adjustment behind `fit_boards`: one lens, one principal point, a pose for each picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.lenses.lens import POLYNOMIAL
from springline.geometry.lenses.models import image_radius, model_range, zenith_of_radius

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_COEFFICIENTS = 2
_STEPS, _SETTLED = 60, 1e-11
_SCALES = np.geomspace(0.25, 2.5, 12)
"""Scales k that are tried, in halves of the picture's diagonal."""
_WIDEST = np.radians(75.0)
"""Points farther off the axis than this do not help a first pose: the plane of projection blows them up."""


@dataclass(frozen=True, eq=False)
class Start:
    """Where an adjustment starts: k, the principal point, and a rotation vector and a place for each picture."""

    shared: Array
    poses: Array


@dataclass(frozen=True, eq=False)
class Adjusted:
    """An adjusted model: k, column and row of the principal point and coefficients, with what tells how good it is."""

    parameters: Array
    covariance: Array
    rms: float
    zenith: float
    criterion: float


def first_poses(model: str, pixels: Array, board: Array, size: tuple[int, int]) -> Start | None:
    """Return a start for `model`, from the scale at which flat boards explain the points best; None when none does."""
    centre = 0.5 * (np.array(size, dtype=float) - 1.0)
    half = 0.5 * float(np.hypot(*size))
    best, found = np.inf, None
    for k in _SCALES * half:
        poses = _posed(model, k, centre, pixels, board)
        if poses is None:
            continue
        shared = np.array([k, *centre, *([0.0] * _COEFFICIENTS if model == POLYNOMIAL else [])])
        misfit = float(np.nansum(np.abs(_residuals(model, shared, poses, pixels, board))))
        if misfit < best:
            best, found = misfit, Start(shared, poses)
    return found


def _posed(model: str, k: float, centre: Array, pixels: Array, board: Array) -> Array | None:
    """Return (picture, 6) poses for a lens scale, each from the homography of its rays; None when one has none."""
    off = pixels - centre
    radius = np.hypot(off[..., 0], off[..., 1])
    shape = "equidistant" if model == POLYNOMIAL else model
    zenith = zenith_of_radius(np.where(np.isfinite(radius), radius, np.nan), k, model=shape)
    flat = np.where(zenith < _WIDEST, np.tan(zenith) / np.maximum(radius, 1e-9), np.nan)[..., None] * off
    poses = np.empty((len(pixels), 6))
    for i, points in enumerate(flat):
        seen = np.isfinite(points).all(axis=1)
        if seen.sum() < 6:
            return None
        poses[i] = _pose(board[seen], points[seen])
    return poses if np.isfinite(poses).all() else None


def _pose(board: Array, flat: Array) -> Array:
    """Return the rotation vector and place of a board from its points on the plane at distance 1."""
    size = float(np.abs(board).max()) or 1.0
    x, y = board.T / size
    zero, one = np.zeros_like(x), np.ones_like(x)
    u, v = flat.T
    rows = np.concatenate(
        [
            np.stack([x, y, one, zero, zero, zero, -u * x, -u * y, -u], axis=1),
            np.stack([zero, zero, zero, x, y, one, -v * x, -v * y, -v], axis=1),
        ]
    )
    plane = np.linalg.eigh(rows.T @ rows)[1][:, 0].reshape(3, 3)
    plane /= 0.5 * (np.linalg.norm(plane[:, 0]) + np.linalg.norm(plane[:, 1])) or 1.0
    plane *= np.sign(plane[2, 2]) or 1.0
    first, second = plane[:, 0], plane[:, 1]
    left, _, right = np.linalg.svd(np.stack([first, second, np.cross(first, second)], axis=1))
    turn = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    return np.concatenate([_vector(turn), plane[:, 2] * size])


def _vector(turn: Array) -> Array:
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(turn).as_rotvec()


def adjust(model: str, pixels: Array, board: Array, start: Start) -> Adjusted:
    """Return lens, principal point and poses that miss the points least."""
    shared, poses, damping = start.shared, start.poses, 1e-3
    rest = _residuals(model, shared, poses, pixels, board)
    for _ in range(_STEPS):
        slopes = _slopes(model, shared, poses, pixels, board)
        normal, target = slopes.T @ slopes, -slopes.T @ rest
        while True:
            scaled = normal + damping * np.diag(np.diag(normal) + 1e-12)
            step = np.linalg.solve(scaled, target)
            next_shared = shared + step[: len(shared)]
            next_poses = poses + step[len(shared) :].reshape(poses.shape)
            if next_shared[0] > 0:
                next_rest = _residuals(model, next_shared, next_poses, pixels, board)
                if next_rest @ next_rest <= rest @ rest:
                    break
            damping *= 10.0
            if damping > 1e8:
                return _finished(shared, poses, rest, slopes, pixels, board)
        gain = rest @ rest - next_rest @ next_rest
        shared, poses, rest, damping = next_shared, next_poses, next_rest, max(damping / 10.0, 1e-12)
        if gain <= _SETTLED * (rest @ rest):
            break
    return _finished(shared, poses, rest, _slopes(model, shared, poses, pixels, board), pixels, board)


def _finished(shared: Array, poses: Array, rest: Array, slopes: Array, pixels: Array, board: Array) -> Adjusted:
    # A board's point that was not found leaves a residual of zero.
    count = 2 * int(np.isfinite(pixels).all(axis=2).sum())
    freedom = max(count - slopes.shape[1], 1)
    misfit = float(rest @ rest)
    inverse = np.linalg.pinv(slopes.T @ slopes, hermitian=True)[: len(shared), : len(shared)]
    zenith = np.where(np.isfinite(pixels).all(axis=2), _seen_at(poses, board)[0], 0.0)
    criterion = count * np.log(max(misfit, 1e-300)) + len(shared) * np.log(count)
    return Adjusted(
        shared, inverse * misfit / freedom, float(np.sqrt(misfit / freedom)), float(zenith.max()), criterion
    )


def _seen_at(poses: Array, board: Array) -> tuple[Array, Array]:
    """Return the zenith (picture, point) of the board's points, and their (picture, point, 2) way off the axis."""
    from scipy.spatial.transform import Rotation

    turns = Rotation.from_rotvec(poses[:, :3]).as_matrix()
    points = np.einsum("pij,nj->pni", turns[:, :, :2], board) + poses[:, None, 3:]
    across = np.hypot(points[..., 0], points[..., 1])
    way = points[..., :2] / np.maximum(across, 1e-12)[..., None]
    return np.arctan2(across, points[..., 2]), way


def _residuals(model: str, shared: Array, poses: Array, pixels: Array, board: Array) -> Array:
    """Return column and row misses of all points [px], flat; 0 where a point was not found."""
    zenith, way = _seen_at(poses, board)
    if model == POLYNOMIAL:
        square = zenith * zenith
        radius = shared[0] * zenith * (1.0 + square * (shared[3] + square * shared[4]))
    else:
        limit, _ = model_range(model)
        radius = image_radius(np.minimum(zenith, 0.999 * limit), shared[0], model=model)
    missed = shared[1:3] + radius[..., None] * way - pixels
    return np.nan_to_num(missed, nan=0.0).ravel()


def _slopes(model: str, shared: Array, poses: Array, pixels: Array, board: Array) -> Array:
    """Return the residuals' (residual, unknown) derivatives; a picture's pose moves its own points alone."""
    count, each = len(poses), 2 * len(board)
    result = np.zeros((count * each, len(shared) + 6 * count))
    for j in range(len(shared)):
        step = np.zeros_like(shared)
        step[j] = 1e-6 * max(abs(shared[j]), 1e-1)
        ahead = _residuals(model, shared + step, poses, pixels, board)
        result[:, j] = (ahead - _residuals(model, shared - step, poses, pixels, board)) / (2.0 * step[j])
    scale = float(np.abs(board).max())
    for j in range(6):
        step = np.zeros(6)
        step[j] = 1e-6 * (1.0 if j < 3 else scale)
        ahead = _residuals(model, shared, poses + step, pixels, board)
        moved = (ahead - _residuals(model, shared, poses - step, pixels, board)) / (2.0 * step[j])
        for i in range(count):
            result[i * each : (i + 1) * each, len(shared) + 6 * i + j] = moved[i * each : (i + 1) * each]
    return result
