"""Search over attitudes for `solve_rings`: a grid, then damped Gauss-Newton from its best points, all in one batch.

Everything here is relative to the rings' mean radius. Shapes: B problems, S starts, n rings, k searched angles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.robot._numeric import jacobian
from springline.geometry.robot.attitude import frame_about
from springline.geometry.robot.oblique import design_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

EDGE = np.radians(85.0)
"""Largest pitch or yaw of any ring that is searched."""

_GRID = np.radians(np.linspace(-75.0, 75.0, 13))
_ROLLS = np.radians([-36.0, -18.0, 0.0, 18.0, 36.0])
_STARTS = 12
_ITERATIONS = 80
_SAME = 1e-3
"""Attitudes [rad] closer than this are one root."""


@dataclass(frozen=True)
class Problem:
    """Measured forms (B, n, 3), increments (B, n, 3), whiteners (B, n, 3, 3) and roll (B,) of the first ring."""

    forms: np.ndarray
    steps: np.ndarray
    weights: np.ndarray
    roll: np.ndarray
    unknown_roll: bool
    rotation: bool

    def of(self, index: Array) -> Problem:
        """Return the problems at `index`, one per entry."""
        arrays = (part[index] for part in (self.forms, self.steps, self.weights, self.roll))
        return Problem(*arrays, self.unknown_roll, self.rotation)


@dataclass(frozen=True)
class Found:
    """Best (pitch, yaw, roll, r1, r2) (B, 5), its misfit (B,), the number of roots that are as good (B,), and how far
    each parameter differs among them (B, 5)."""

    values: np.ndarray
    misfit: np.ndarray
    roots: np.ndarray
    spread: np.ndarray


def solve(problem: Problem, guess: Array | None, *, noisy: bool) -> Found:
    """Return the best attitude of each problem and how many others are as good."""
    starts = _starts(problem, guess)
    angles, cost = _descend(problem, starts)
    best = cost.min(axis=1)
    # With a noise model a root is as good when chi-square is within 9; without, when it explains as exactly.
    margin = 9.0 if noisy else np.maximum(3.0 * best, 1e-16)
    good = cost <= (best + margin)[:, None]
    if problem.unknown_roll:
        upright = good & (np.abs(angles[..., 2]) <= np.radians(50.0))
        good = np.where(upright.any(axis=1, keepdims=True), upright, good)
    pick = _pick(angles, cost, good, guess)
    values = np.concatenate([_whole(problem, angles), _residual(problem, angles)[1]], axis=-1)
    chosen = np.take_along_axis(values, pick[:, None, None], axis=1)
    misfit = np.take_along_axis(cost, pick[:, None], axis=1)[:, 0]
    spread = np.abs(np.where(good[..., None], values - chosen, 0.0)).max(axis=1)
    return Found(chosen[:, 0], misfit, _count(angles, good), spread)


def sensitivity(problem: Problem, found: Found) -> Array:
    """Return the derivative (B, 3n, 5) of the whitened forms by (pitch, yaw, roll, r1, r2) at what was found."""

    def model(x):
        design = design_matrix(_frames(problem, x[:, None, :3]))[:, 0]
        form = design @ (x[:, 3:] ** -2.0)[:, None, :, None]
        return (problem.weights @ form)[..., 0].reshape(len(x), -1)

    return jacobian(model, found.values, [1e-6] * 5)


def _starts(problem: Problem, guess: Array | None) -> Array:
    axes = [_GRID, _GRID, _ROLLS] if problem.unknown_roll else [_GRID, _GRID]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))
    points = np.broadcast_to(grid, (len(problem.forms), *grid.shape))
    cost = _cost(problem, points)
    count = _STARTS * (3 if problem.unknown_roll else 1)
    order = np.argsort(cost, axis=1)[:, :count]
    starts = np.take_along_axis(points, order[..., None], axis=1)
    if guess is None:
        return starts
    first = np.broadcast_to(guess, (len(problem.forms), guess.shape[-1]))[:, None]
    return np.concatenate([first, starts], axis=1)


def _whole(problem: Problem, angles: Array) -> Array:
    """Return (..., 3) angles: the given roll joins pitch and yaw when it is not searched."""
    if problem.unknown_roll:
        return angles
    roll = np.broadcast_to(problem.roll[:, None, None], (*angles.shape[:-1], 1))
    return np.concatenate([angles, roll], axis=-1)


def _frames(problem: Problem, angles: Array) -> Array:
    """Return the frames (B, S, n, 3, 3) of all rings; NaN where a ring would face across the pipe."""
    first = angles[:, :, None, :]
    if not problem.rotation:
        turned = first + problem.steps[:, None]
        inside = (np.abs(turned[..., :2]) < EDGE).all(axis=-1)
        b, c = np.tan(turned[..., 0]), np.tan(turned[..., 1])
        return _mask(frame_about(_unit(b, c), turned[..., 2]), inside)
    base = frame_about(_unit(np.tan(first[..., 0]), np.tan(first[..., 1])), first[..., 2])
    frames = np.swapaxes(_rotation(problem.steps), -1, -2)[:, None] @ base
    inside = (frames[..., 0, 0] > np.cos(EDGE)) & (np.abs(first[..., :2]) < EDGE).all(axis=-1)
    return _mask(frames, inside)


def _mask(frames: Array, inside: Array) -> Array:
    return np.where(inside[..., None, None], frames, np.nan)


def _unit(b: Array, c: Array) -> Array:
    return np.stack([np.ones_like(b), b, c], axis=-1) / np.sqrt(1.0 + b * b + c * c)[..., None]


def _rotation(vectors: Array) -> Array:
    """Return rotation matrices (..., 3, 3) of rotation vectors (Rodrigues)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*x.shape, 3, 3)
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    return np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * (cross @ cross)


def _residual(problem: Problem, angles: Array) -> tuple[Array, Array]:
    """Return whitened residuals (B, S, 3n) with the radii eliminated, and the radii (B, S, 2)."""
    frames = _frames(problem, _whole(problem, angles))
    inside = np.isfinite(frames[..., 0, 0]).all(axis=-1)
    design = problem.weights[:, None] @ design_matrix(np.where(inside[..., None, None, None], frames, np.eye(3)))
    left = design.reshape(*design.shape[:2], -1, 2)
    right = (problem.weights @ problem.forms[..., None]).reshape(len(problem.forms), 1, -1, 1)
    normal = np.swapaxes(left, -1, -2) @ left
    curvature = np.linalg.solve(normal, np.swapaxes(left, -1, -2) @ right)
    residual = (right - left @ curvature)[..., 0]
    curvature = curvature[..., 0]
    valid = inside & (curvature > 0).all(axis=-1)
    radii = np.where(valid[..., None], curvature, np.nan) ** -0.5
    return np.where(valid[..., None], residual, np.inf), radii


def _cost(problem: Problem, angles: Array) -> Array:
    return np.sum(_residual(problem, angles)[0] ** 2, axis=-1)


def _descend(problem: Problem, starts: Array) -> tuple[Array, Array]:
    """Return angles (B, S, k) and cost (B, S) after damped Gauss-Newton from every start."""
    size, count, width = starts.shape
    angles = starts.reshape(-1, 1, width).copy()
    owner = np.repeat(np.arange(size), count)
    cost = _cost(problem, starts).reshape(-1, 1)
    damping = np.full(cost.shape, 1e-3)
    active = np.flatnonzero(np.isfinite(cost[:, 0]))
    for _ in range(_ITERATIONS):
        if not active.size:
            break
        part, here = problem.of(owner[active]), angles[active]
        step = _step(part, here, damping[active])
        trial = _cost(part, here + step)
        better = trial < cost[active]
        angles[active] = np.where(better[..., None], here + step, here)
        cost[active] = np.where(better, trial, cost[active])
        damping[active] = np.clip(damping[active] * np.where(better, 0.1, 10.0), 1e-15, 1e8)
        going = (np.abs(step).max(axis=-1) >= 1e-12) & (damping[active] < 1e8)
        active = active[going[:, 0]]
    return angles.reshape(starts.shape), cost.reshape(size, count)


def _step(problem: Problem, angles: Array, damping: Array) -> Array:
    """Return the damped Gauss-Newton step, at most half a radian in any angle."""
    value = _residual(problem, angles)[0]
    with np.errstate(invalid="ignore"):
        slope = jacobian(lambda x: _residual(problem, x)[0], angles, [1e-6] * angles.shape[-1])
    # At the edge of the searched attitudes a difference is infinite and says nothing.
    slope = np.where(np.isfinite(slope), slope, 0.0)
    normal = np.swapaxes(slope, -1, -2) @ slope
    gradient = np.einsum("...ij,...i->...j", slope, value)
    ridge = damping * (np.trace(normal, axis1=-2, axis2=-1) + 1e-300)
    step = -np.linalg.solve(normal + ridge[..., None, None] * np.eye(angles.shape[-1]), gradient[..., None])[..., 0]
    return step * np.minimum(1.0, 0.5 / np.maximum(np.abs(step).max(axis=-1), 1e-300))[..., None]


def _pick(angles: Array, cost: Array, good: Array, guess: Array | None) -> Array:
    if guess is None:
        return np.argmin(cost, axis=1)
    distance = np.linalg.norm(angles - np.asarray(guess)[..., None, :], axis=-1)
    return np.argmin(np.where(good, distance, np.inf), axis=1)


def _count(angles: Array, good: Array) -> Array:
    """Return how many distinct attitudes are good: each start counts when no earlier good one is the same."""
    near = np.linalg.norm(angles[:, :, None] - angles[:, None], axis=-1) < _SAME
    earlier = np.tril(np.ones(near.shape[1:], dtype=bool), -1)
    repeated = (near & earlier & good[:, None, :]).any(axis=-1)
    return np.sum(good & ~repeated, axis=1)
