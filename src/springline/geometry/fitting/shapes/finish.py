"""From a solver that has come to rest to estimates: covariance, limits reached, and what makes a fit a failure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from .._judge import ARC_BINS, FITTED, NO_CONVERGENCE, SCATTERED, SHORT_ARC, spans
from ..modes.statistics import neighbour_noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .solve import Solver

    Array = NDArray[np.float64]

UNDETERMINED = 7
"""Flag of `springline.conventions.FIT_STATUS`: the readings do not determine the shape."""

AT_LIMIT = 1e-6
"""A coordinate this near to its floor or ceiling counts as being there, over the pipe's mean radius."""

MOST_LEVERAGE = 0.4
"""Share of a reading in its own fitted value beyond which the fit follows it wherever it lies, so that no outlier could
be told. It may be twice the mean share where readings are few."""

_SINGULAR = 1e-11
_CLIPPED = 4.0


def covariance(normal: Array, at_limit: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
    """Return the inverses (R, P, P) of normal matrices, and where the readings determine every unknown.

    An unknown at its limit about which the readings say nothing is held there: its row and column are NaN.

    Args:
        normal: (R, P, P).
        at_limit: (R, P).
    """
    size = normal.shape[-1]
    diagonal = np.einsum("rii->ri", normal)
    largest = np.max(diagonal, axis=1, keepdims=True)
    silent = at_limit & (diagonal < 1e-9 * largest)
    held = silent[:, :, None] | silent[:, None, :]
    scale = np.sqrt(np.where(silent | ~(diagonal > 0.0), 1.0, diagonal))
    scaled = np.where(held, np.eye(size), normal / (scale[:, :, None] * scale[:, None, :]))
    finite = np.isfinite(scaled).all(axis=(1, 2))
    scaled[~finite] = np.eye(size)
    values, vectors = np.linalg.eigh(scaled)
    determined = finite & (values[:, 0] > _SINGULAR) & (silent | (diagonal > 0.0)).all(axis=1)
    inverse = np.einsum("rik,rk,rjk->rij", vectors, 1.0 / np.maximum(values, _SINGULAR), vectors)
    inverse = np.where(held, np.nan, inverse / (scale[:, :, None] * scale[:, None, :]))
    return inverse, determined


def statuses(
    solver: Solver,
    rows: NDArray,
    converged: NDArray[np.bool_],
    determined: NDArray[np.bool_],
    least_arc: float,
    most_scatter: float,
) -> NDArray[np.uint8]:
    """Return (R,) flags of `FIT_STATUS`, in units in which the pipe's mean radius is 1."""
    readings = solver.readings
    wide, used = np.zeros(len(rows), bool), np.zeros(len(rows), np.int64)
    _spans(rows, readings.z, readings.y, readings.counts, solver.omega, solver.unknowns, least_arc, wide, used)
    scattered = (solver.sigma[rows] > most_scatter) | (2 * used < readings.counts[rows])
    conditions = [~wide, ~converged, scattered, ~determined]
    return np.select(conditions, [SHORT_ARC, NO_CONVERGENCE, SCATTERED, UNDETERMINED], FITTED).astype(np.uint8)


@kernel
def _spans(rows, z, y, counts, omega, unknowns, least_arc, wide, used):
    low, high = np.empty(ARC_BINS), np.empty(ARC_BINS)
    for place in range(rows.size):
        ring = rows[place]
        n = counts[ring]
        for i in range(n):
            used[place] += 1 if omega[ring, i] > 0.0 else 0
        wide[place] = used[place] > 0 and spans(least_arc, z[ring], y[ring], omega[ring], n, unknowns[ring], low, high)


def leverage(solver: Solver, rows: NDArray[np.int64], inverse: Array) -> Array:
    """Return (R,) the largest leverage of a reading, from inverse normal matrices (R, P, P).

    Where a fillet or an invert is seen by one or two readings, the fit goes through them whatever they are.
    """
    out = np.empty(rows.size)
    full = np.nan_to_num(inverse)
    _largest_leverage(rows, solver.readings.counts, solver.side, solver.jacobian, solver.omega, full, out)
    return out


@kernel
def _largest_leverage(rows, counts, side, jacobian, omega, inverse, out):
    size = inverse.shape[1]
    for place in range(rows.size):
        ring = rows[place]
        j = jacobian[side[ring], ring]
        largest = 0.0
        for i in range(counts[ring]):
            total = 0.0
            for a in range(size):
                for b in range(size):
                    total += j[a, i] * inverse[place, a, b] * j[b, i]
            largest = max(largest, omega[ring, i] * total)
        out[place] = largest


@kernel
def residual_statistics(rows, residual, omega, counts, rms, misfit):
    """Fill (R,) the rms residual of the readings with weight, and the misfit of `SectionFits`."""
    for place in range(rows.size):
        ring = rows[place]
        n = counts[ring]
        total, used = 0.0, 0
        noise = neighbour_noise(residual[ring, :n])
        clipped = 0.0
        for i in range(n):
            square = residual[ring, i] ** 2
            clipped += min(square, (_CLIPPED * noise) ** 2)
            if omega[ring, i] > 0.0:
                total += square
                used += 1
        rms[place] = np.sqrt(total / max(used, 1))
        misfit[place] = clipped / max(n, 1) / (noise * noise)
