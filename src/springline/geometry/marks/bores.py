"""A lateral's opening fitted: a round bore that cuts the pipe's wall."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.special import ndtr

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_STEPS = 30
_SINGULAR = 1e14
_LEAN = np.radians(30.0)
_MOST_LEAN = np.radians(70.0)


class Bore(NamedTuple):
    """A round bore through the wall.

    Attributes:
        values: x [m] and bearing [rad] where its axis meets the wall, radius [m], lean [rad] towards +x.
        covariance: (4, 4) of the values.
        agreement: Share of the readings, open by one account or the other, that are open by both, 0 to 1.
    """

    values: NDArray[np.float64]
    covariance: NDArray[np.float64]
    agreement: float


def fit_bore(
    x: ArrayLike,
    bearing: ArrayLike,
    radius: ArrayLike,
    inside: ArrayLike,
    known: ArrayLike,
    *,
    wall: float,
    noise: float,
) -> Bore | None:
    """Return the round bore whose edge passes between readings on the wall and readings beyond it.

    Args:
        x: (ring, bearing) place of each reading along the pipe [m].
        bearing: (bearing,) or (ring, bearing) [rad], of one window that is not all round, rising.
        radius: (ring, bearing) radius of the pipe's section at which a reading counts as beyond the wall [m].
        inside: (ring, bearing) whether the reading is beyond.
        known: (ring, bearing) whether there is a reading, or its lack says the same.
        wall: Radius of the pipe's section itself, about the bore [m].
        noise: How far an edge may be off in itself [m].

    Returns:
        None when fewer than eight places of the edge are seen, or the fit does not settle.

    Source: least squares of the distances of the edge from the bore's surface, each weighted by how closely two
    readings enclose it.
    """
    x, bearing, radius = (np.asarray(v, float) for v in (x, bearing, radius))
    inside, known = np.asarray(inside, bool), np.asarray(known, bool)
    points, along = _edge(x, bearing, radius, inside, known)
    if len(points) < 8:
        return None
    start = _start(x, bearing, radius, inside & known)
    prior = np.array([0.0, 0.0, 0.0, 1.0 / _LEAN**2])
    values, damping = start, 1e-3
    cost, residual, jacobian, weight = _linear(values, points, along, wall, noise, prior)
    for _ in range(_STEPS):
        normal = (jacobian * weight[:, None]).T @ jacobian + np.diag(prior)
        right = (jacobian * weight[:, None]).T @ residual + prior * values
        move = _solve(normal + damping * np.diag(np.diag(normal)), right)
        there = values - move
        if there[2] <= 0 or abs(there[3]) > _MOST_LEAN:
            damping *= 10.0
            continue
        after = _linear(there, points, along, wall, noise, prior)
        if after[0] <= cost * (1.0 + 1e-12):
            small = np.abs(move[:3]).max() < 1e-7
            values, (cost, residual, jacobian, weight), damping = there, after, damping * 0.2
            if small:
                break
        else:
            damping *= 10.0
            if damping > 1e9:
                break
    values = _labelled(values, x, bearing, radius, inside, known, wall, noise, prior)
    cost, residual, jacobian, weight = _linear(values, points, along, wall, noise, prior)
    normal = (jacobian * weight[:, None]).T @ jacobian + np.diag(prior)
    misfit = max(1.0, float(np.sum(weight * residual**2)) / max(len(points) - 4, 1))
    if not np.linalg.cond(normal) < _SINGULAR:
        return None
    covariance = np.linalg.inv(normal) * misfit * _alike(residual * np.sqrt(weight))
    model = _distance(values, *_point(x, bearing, radius), wall) < 0.0
    both, either = (model & inside & known).sum(), ((model | inside) & known).sum()
    return Bore(values, covariance, float(both / max(either, 1)))


def _solve(normal: NDArray, right: NDArray) -> NDArray[np.float64]:
    """Return the solution of normal equations, however little they say of one of the values."""
    return np.linalg.solve(normal + 1e-12 * (np.trace(normal) + 1e-300) * np.eye(len(normal)), right)


def _point(x: NDArray, bearing: NDArray, radius: NDArray) -> tuple[NDArray, ...]:
    theta = np.broadcast_to(bearing, x.shape)
    return x, theta, np.broadcast_to(radius, x.shape)


def _distance(values: NDArray, x: NDArray, theta: NDArray, radius: NDArray, wall: float) -> NDArray[np.float64]:
    """Return how far points of the wall lie outside the bore's surface [m]."""
    turn = theta - values[1]
    forward, up, aside = x - values[0], radius * np.cos(turn) - wall, radius * np.sin(turn)
    cos, sin = np.cos(values[3]), np.sin(values[3])
    across = forward * cos - up * sin
    # Only the half of the pipe that the bore leaves from.
    return np.where(np.cos(turn) > 0, np.hypot(across, aside), np.nan) - values[2]


def _edge(x: NDArray, bearing: NDArray, radius: NDArray, inside: NDArray, known: NDArray) -> tuple[NDArray, NDArray]:
    """Return middles (n, 3: x, bearing, radius) between readings on wall and beyond, half their distance (n, 2)."""
    points, along = [], []
    theta = np.broadcast_to(bearing, x.shape)
    for axis in (0, 1):
        a, b = (slice(None, -1), slice(1, None))
        one, two = ((a, slice(None)), (b, slice(None))) if axis == 0 else ((slice(None), a), (slice(None), b))
        change = (inside[one] != inside[two]) & known[one] & known[two]
        half_x, half_theta = 0.5 * (x[two] - x[one])[change], 0.5 * (theta[two] - theta[one])[change]
        points.append(
            np.column_stack(
                [
                    0.5 * (x[one] + x[two])[change],
                    0.5 * (theta[one] + theta[two])[change],
                    0.5 * (radius[one] + radius[two])[change],
                ]
            )
        )
        along.append(np.column_stack([half_x, half_theta]))
    return np.concatenate(points), np.concatenate(along)


def _linear(values: NDArray, points: NDArray, along: NDArray, wall: float, noise: float, prior: NDArray) -> tuple:
    """Return cost, distances, derivatives and weights; an edge along the line between its readings weighs little."""
    x, theta, radius = points.T
    residual = _distance(values, x, theta, radius, wall)
    steps = np.array([1e-6, 1e-6, 1e-6, 1e-6])
    jacobian = np.empty((len(points), 4))
    for k in range(4):
        shifted = values.copy()
        shifted[k] += steps[k]
        jacobian[:, k] = (_distance(shifted, x, theta, radius, wall) - residual) / steps[k]
    slope_x = (_distance(values, x + 1e-6, theta, radius, wall) - residual) / 1e-6
    slope_theta = (_distance(values, x, theta + 1e-6, radius, wall) - residual) / 1e-6
    reach = slope_x * along[:, 0] + slope_theta * along[:, 1]
    variance = reach**2 / 3.0 + noise**2
    with np.errstate(invalid="ignore"):
        fine = np.isfinite(residual) & np.isfinite(jacobian).all(axis=1) & np.isfinite(variance)
    size = 3.0 * np.sqrt(np.where(fine, variance, 0.0) + np.median(residual[fine] ** 2)) if fine.any() else 1.0
    robust = np.where(fine, 1.0 / (1.0 + (np.where(fine, residual, 0.0) / size) ** 2), 0.0)
    weight = robust / np.where(fine, variance, 1.0)
    residual, jacobian = np.where(fine, residual, 0.0), np.where(fine[:, None], jacobian, 0.0)
    return float(np.sum(weight * residual**2) + prior[3] * values[3] ** 2), residual, jacobian, weight


def _labelled(
    values: NDArray,
    x: NDArray,
    bearing: NDArray,
    radius: NDArray,
    inside: NDArray,
    known: NDArray,
    wall: float,
    noise: float,
    prior: NDArray,
) -> NDArray[np.float64]:
    """Return the values for which every reading is likeliest to be where it is: on the wall or beyond the edge.

    Middles between readings err outward where a row of them ends; what each reading says by itself does not.
    """
    theta = np.broadcast_to(bearing, x.shape)
    step_x = float(np.median(np.abs(np.diff(x[:, 0])))) if len(x) > 1 else noise
    step_theta = float(np.median(np.abs(np.diff(theta, axis=1))))
    rows = known & (_distance(values, x, theta, radius, wall) < values[2])
    x, theta, radius = x[rows], theta[rows], radius[rows]
    sign = np.where(inside[rows], -1.0, 1.0)
    for _ in range(12):
        distance = _distance(values, x, theta, radius, wall)
        jacobian = np.stack(
            [(_distance(values + 1e-6 * unit, x, theta, radius, wall) - distance) / 1e-6 for unit in np.eye(4)], axis=1
        )
        slope_x = (_distance(values, x + 1e-6, theta, radius, wall) - distance) / 1e-6
        slope_theta = (_distance(values, x, theta + 1e-6, radius, wall) - distance) / 1e-6
        scale = 0.35 * np.hypot(slope_x * step_x, slope_theta * step_theta) + noise
        fine = np.isfinite(distance) & np.isfinite(jacobian).all(axis=1) & (np.abs(distance) < 4.0 * scale)
        if fine.sum() < 8:
            break
        score = np.clip(distance / scale, -4.0, 4.0)[fine]
        share = np.clip(ndtr(score), 1e-4, 1.0 - 1e-4)
        density = np.exp(-0.5 * score**2) / np.sqrt(2.0 * np.pi)
        pull = np.where(sign[fine] > 0, density / share, -density / (1.0 - share)) / scale[fine]
        weight = density**2 / (share * (1.0 - share)) / scale[fine] ** 2
        normal = (jacobian[fine] * weight[:, None]).T @ jacobian[fine] + np.diag(prior)
        move = _solve(normal, jacobian[fine].T @ pull - prior * values)
        move = np.clip(move, -0.2 * values[2], 0.2 * values[2])
        values = values + move
        values[3] = np.clip(values[3], -_MOST_LEAN, _MOST_LEAN)
        if np.abs(move).max() < 1e-6:
            break
    return values


def _start(x: NDArray, bearing: NDArray, radius: NDArray, inside: NDArray) -> NDArray[np.float64]:
    theta = np.broadcast_to(bearing, x.shape)[inside]
    middle = float(np.median(np.broadcast_to(radius, x.shape)[inside]))
    width = max(middle * np.sin(min(0.5 * float(np.ptp(theta)), 1.5)), 1e-3)
    return np.array([0.5 * (x[inside].min() + x[inside].max()), 0.5 * (theta.min() + theta.max()), width, 0.0])


def _alike(score: NDArray) -> float:
    """Return by how much the variance grows as neighbouring places of the edge err alike."""
    if len(score) < 8:
        return 1.0
    score = score - score.mean()
    total = float(score @ score)
    if total <= 0.0:
        return 1.0
    rho = [float(score[k:] @ score[:-k]) / total for k in range(1, min(20, len(score) // 2))]
    positive = np.cumprod(np.array(rho) > 0.05)
    return 1.0 + 2.0 * float(np.sum(np.array(rho) * positive))
