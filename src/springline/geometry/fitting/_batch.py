"""From arrays of readings to kernels: checks, chunks of rings, threads, small-sample correction."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.fitting.options import FEWEST_SEARCHED

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.fitting.options import Resolved

CHUNK = 1024
"""Rings handed to a kernel at a time: their coordinates in double precision fill some megabytes, not the memory."""

Z_95 = 1.959963984540054


def points_source(z: ArrayLike, y: ArrayLike) -> tuple[tuple[int, int], Callable]:
    """Return the shape (ring, point) and a function that gives z and y of a slice of rings in double precision."""
    z, y = np.asarray(z), np.asarray(y)
    if z.ndim != 2 or z.shape != y.shape:
        raise ParameterError(f"z has shape {z.shape} and y {y.shape}", expected="the same shape (ring, point) for both")

    def take(part: slice) -> tuple[NDArray, NDArray]:
        return np.ascontiguousarray(z[part], np.float64), np.ascontiguousarray(y[part], np.float64)

    return z.shape, take


def one_source(points: ArrayLike) -> tuple[tuple[int, int], Callable]:
    """Return the source of a single ring of points (point, 2)."""
    points = np.asarray(points, np.float64)
    if points.ndim != 2 or points.shape[1] != 2:
        raise ParameterError(f"points has shape {points.shape}", expected="(point, 2), z and y of each")
    return points_source(points[None, :, 0], points[None, :, 1])


def ranges_source(ranges: ArrayLike, bearings: ArrayLike) -> tuple[tuple[int, int], Callable]:
    """Return the shape (ring, bearing) and a function that gives z and y of a slice of rings in double precision."""
    ranges, bearings = np.asarray(ranges), np.asarray(bearings, np.float64)
    if ranges.ndim != 2:
        raise ParameterError(f"ranges has shape {ranges.shape}", expected="(ring, bearing)")
    if bearings.shape not in (ranges.shape[1:], ranges.shape):
        raise ParameterError(
            f"bearings has shape {bearings.shape}", expected=f"{ranges.shape[1:]} or {ranges.shape}, as the ranges"
        )
    fixed = bearings.ndim == 1
    cos, sin = (np.cos(bearings), np.sin(bearings)) if fixed else (None, None)

    def take(part: slice) -> tuple[NDArray, NDArray]:
        some = ranges[part]
        if fixed:
            return np.multiply(some, cos, dtype=np.float64), np.multiply(some, sin, dtype=np.float64)
        return some * np.cos(bearings[part]), some * np.sin(bearings[part])

    return ranges.shape, take


def run(
    kernel: Callable, source: tuple[tuple[int, int], Callable], size: int, options: Resolved
) -> dict[str, NDArray | str | None]:
    """Call `kernel(z, y, weight, weighted, keep, par, cov, out, used, status, omega)` over chunks of rings.

    Returns the fields of the results, with the covariance widened for few readings.
    """
    shape, take = source
    rings, points = shape
    keep = options.keep_weights
    weights = None if options.weights is None else spread("weights", np.asarray(options.weights), shape)
    par, cov, out = np.empty((rings, size)), np.empty((rings, size, size)), np.empty((rings, 2))
    used, status = np.empty(rings, np.int64), np.empty(rings, np.uint8)
    omega = np.zeros(shape, np.float32) if keep else np.zeros((1, 1), np.float32)
    no_weight = np.ones((1, 1))

    def one(part: slice) -> None:
        z, y = take(part)
        weight = no_weight if weights is None else np.ascontiguousarray(weights[part], np.float64)
        kept = omega[part] if keep else omega
        kernel(z, y, weight, weights is not None, keep, par[part], cov[part], out[part], used[part], status[part], kept)

    in_chunks(one, rings, CHUNK, options.workers)
    cov *= widening(used, size, points, robust=options.robust)[:, None, None]
    return {
        "parameters": par,
        "covariance": cov,
        "residual_rms": out[:, 0],
        "noise_sigma": out[:, 1],
        "n_used": used,
        "status": status,
        "weights": omega if keep else None,
        "method": options.method,
    }


def fit(size: int, source: tuple, options: Resolved) -> dict[str, NDArray | str | None]:
    """Fit circles (`size` 3) or ellipses (5) to the readings of `source`; return the fields of the results."""
    from springline.geometry.fitting import _algebraic, _geometric

    limits = options.least_arc, options.most_scatter

    def geometric(*arrays):
        _geometric.fit_rings(size, options.robust, options.noise, *limits, *arrays)

    def algebraic(z, y, weight, weighted, keep, par, cov, out, used, status, omega):
        if options.robust:
            inlier = np.zeros(z.shape, np.float32)
            geometric(z, y, weight, weighted, True, par, cov, out, used, status, inlier)
            failed, why, seen = status != 0, status.copy(), used.copy()
            weight, weighted = np.where(inlier > 0, weight, 0.0), True
        results = par, cov, out, used, status, omega
        _algebraic.fit_rings(size, options.method_number, *limits, z, y, weight, weighted, keep, *results)
        if options.robust:
            # where no inliers could be told, no fit of all readings takes their place
            status[failed], used[failed] = why[failed], seen[failed]

    kernel = geometric if options.method == "geometric" else algebraic
    return run(kernel, source, size, options)


def spread(name: str, values: NDArray, shape: tuple[int, ...]) -> NDArray:
    """Return `values` broadcast to `shape`; ParameterError names them when they do not fit."""
    try:
        return np.broadcast_to(values, shape)
    except ValueError:
        raise ParameterError(f"{name} has shape {values.shape}", expected=f"one that broadcasts to {shape}") from None


def in_chunks(call: Callable[[slice], None], rings: int, size: int, workers: int | None) -> None:
    """Call `call` with slices of `size` rings, on so many threads, as many as there are cores unless given."""
    parts = [slice(start, start + size) for start in range(0, rings, size)]
    workers = min(workers or _cores(), len(parts))
    if workers > 1:
        with ThreadPoolExecutor(workers) as pool:
            # list() raises whatever a chunk raised
            list(pool.map(call, parts))
    else:
        for part in parts:
            call(part)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def widening(used: NDArray, size: int, points: int, *, robust: bool) -> NDArray:
    """Return the factor per ring by which few readings widen the covariance.

    Student's 97.5 % point with used - size degrees of freedom over the normal one, squared; and, where outliers were
    looked for, what looking costs among few readings: found by simulation, 1 + 24 size/used^2 in sigma.
    """
    from scipy.special import stdtrit

    count = np.arange(points + 1)
    freedom = np.where(count > size, count - size, np.nan)
    table = (stdtrit(freedom, 0.975) / Z_95) ** 2
    if robust:
        searched = count >= FEWEST_SEARCHED * size
        table *= np.where(searched, 1.0 + 24.0 * size / np.maximum(count, 1) ** 2, 1.0) ** 2
    return table[used]
