"""First guess of a bend from the centres of its rings: their plane, then a ramp fitted to their heading."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_CANDIDATES = 40
"""Stations tried for the start and for the end of the bend."""


class Guess(NamedTuple):
    """Start of the arc, rows forward, inward and normal there, bend radius, angle and pipe radius."""

    start: np.ndarray
    frame: np.ndarray
    bend_radius: float
    angle: float
    radius: float


def centres(rings: Array) -> Array:
    """Return the centres (n, 3) of rings (n, m, 3): the circle through each ring's points in its own plane."""
    return _circles(rings)[0]


def guess(rings: Array, *, straights: bool) -> Guess:
    """Return the first guess for `fit_bend`."""
    middles, radii = _circles(rings)
    mean = middles.mean(axis=0)
    plane = np.linalg.svd(middles - mean, full_matrices=False)[2]
    # The two directions in which the centres spread span the bend's plane.
    flat = (middles - mean) @ plane[:2].T
    chord = np.diff(flat, axis=0)
    length = np.linalg.norm(chord, axis=-1)
    station = np.concatenate([[0.0], np.cumsum(length)])
    heading = np.unwrap(np.arctan2(chord[:, 1], chord[:, 0]))
    first, last, at_start, turn = _ramp(station, heading, length, straights)
    sign = 1.0 if turn >= 0 else -1.0
    forward = np.cos(at_start) * plane[0] + np.sin(at_start) * plane[1]
    inward = sign * (-np.sin(at_start) * plane[0] + np.cos(at_start) * plane[1])
    frame = np.stack([forward, inward, np.cross(forward, inward)])
    start = np.array([np.interp(first, station, middles[:, k]) for k in range(3)])
    angle = max(abs(turn), 1e-3)
    return Guess(start, frame, (last - first) / angle, angle, float(np.median(radii)))


def _circles(rings: Array) -> tuple[Array, Array]:
    """Return centres (n, 3) and radii (n,) of Kasa circles in each ring's plane."""
    seen = np.isfinite(rings).all(axis=-1)
    count = seen.sum(axis=-1)[:, None]
    filled = np.where(seen[..., None], rings, 0.0)
    mean = filled.sum(axis=1) / count
    local = np.where(seen[..., None], rings - mean[:, None], 0.0)
    axes = np.linalg.svd(local, full_matrices=False)[2][:, :2]
    flat = local @ axes.swapaxes(-1, -2)
    design = np.concatenate([flat, np.ones((*flat.shape[:2], 1))], axis=-1) * seen[..., None]
    square = np.sum(flat**2, axis=-1, keepdims=True)
    solved = (np.linalg.pinv(design) @ square)[..., 0]
    middle = solved[:, :2] / 2.0
    radius = np.sqrt(np.maximum(solved[:, 2] + np.sum(middle**2, axis=-1), 0.0))
    return mean + (middle[:, None] @ axes)[:, 0], radius


def _ramp(station: Array, heading: Array, weight: Array, straights: bool) -> tuple[float, float, float, float]:
    """Return where the heading starts and stops to change, its value before, and its whole change."""
    at = (station[1:] + station[:-1]) / 2.0
    if not straights:
        ends = np.array([[station[0]], [station[-1]]])
    else:
        grid = np.linspace(station[0], station[-1], min(_CANDIDATES, len(station)))
        ends = np.stack([grid[i] for i in np.triu_indices(len(grid), 1)])
    first, last = ends[0][:, None], ends[1][:, None]
    ramp = np.clip((at - first) / (last - first), 0.0, 1.0)
    total = weight.sum()
    mean_ramp, mean_heading = ramp @ weight / total, heading @ weight / total
    varying, changing = ramp - mean_ramp[:, None], heading - mean_heading
    square = varying**2 @ weight
    change = np.divide((varying * changing) @ weight, square, out=np.zeros_like(square), where=square > 0)
    misfit = (changing - change[:, None] * varying) ** 2 @ weight
    best = int(np.argmin(misfit))
    return ends[0][best], ends[1][best], mean_heading - change[best] * mean_ramp[best], change[best]
