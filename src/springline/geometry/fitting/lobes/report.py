"""What is known of the rings of a chunk: from the solver's units to those of the readings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .._judge import TOO_FEW
from ..shapes import finish, kernels
from .kernels import HOST, LOBE
from .results import NAMES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..options import Resolved
    from ..shapes.solve import Solver

    Array = NDArray[np.float64]

_LENGTHS = np.array([True] * 5 + [False, False, True, False])


@dataclass(frozen=True)
class Task:
    """What is looked for: kind of lobe, its power and whether that is free, the loss, and the options of the fit."""

    kind: int
    power: float
    free_power: bool
    loss: int
    options: Resolved


@dataclass
class Found:
    """What was found, by ring; names as in `LobeFits`, `lobe` for its alternative."""

    host: Array
    host_covariance: Array
    lobe: Array
    lobe_covariance: Array
    evidence: Array
    rms: Array
    noise: Array
    misfit: Array
    used: NDArray[np.int64]
    status: NDArray[np.uint8]
    lobe_status: NDArray[np.uint8]
    weights: NDArray[np.float32] | None
    residuals: NDArray[np.float32] | None

    @classmethod
    def empty(cls, rings: int, points: int, *, keep: bool, residuals: bool) -> Found:
        """Return room for results: NaN, and no weights or residuals unless asked for."""
        size = len(NAMES)

        def unknown(*shape: int) -> Array:
            return np.full((rings, *shape), np.nan)

        return cls(
            unknown(size), unknown(size, size), unknown(size), unknown(size, size), *(unknown() for _ in range(4)),
            np.zeros(rings, np.int64), np.zeros(rings, np.uint8), np.full(rings, TOO_FEW, np.uint8),
            np.zeros((rings, points), np.float32) if keep else None,
            np.full((rings, points), np.nan, np.float32) if residuals else None,
        )  # fmt: skip

    def part(self, part: slice) -> Found:
        """Return the results of some rings, as views."""
        return Found(*(None if x is None else x[part] for x in vars(self).values()))


@dataclass(frozen=True)
class Scale:
    """From the solver's units to those of the readings."""

    centre: Array
    size: Array
    host: Array | None
    task: Task

    def write(
        self,
        solver: Solver,
        rows: NDArray[np.int64],
        converged: NDArray[np.bool_],
        parameters: Array,
        covariance: Array,
    ) -> NDArray[np.uint8]:
        """Write parameters and covariance of the rings that are determined; return the flags (R,)."""
        unknowns = solver.unknowns[rows]
        near = (unknowns - solver.floor < finish.AT_LIMIT) | (solver.ceiling - unknowns < finish.AT_LIMIT)
        inverse, determined = finish.covariance(solver.information(rows), near)
        determined &= ~np.isnan(inverse).any(axis=(1, 2))
        if self.task.loss == kernels.TUKEY:
            most = np.maximum(finish.MOST_LEVERAGE, 2.0 * solver.size / solver.readings.counts[rows])
            determined &= finish.leverage(solver, rows, inverse) <= most
        inverse *= solver.variance(rows, self.task.loss)[:, None, None]
        options = self.task.options
        status = finish.statuses(solver, rows, converged, determined, options.least_arc, options.most_scatter)
        good = status == 0
        rows, unknowns, inverse, unit = rows[good], unknowns[good], inverse[good], self.size[rows[good]]
        where = np.r_[0:2, (2 + HOST if self.host is not None else 2) : 2 + HOST + LOBE][: solver.size]
        units = np.where(_LENGTHS, unit[:, None], 1.0)
        full = np.full((rows.size, len(NAMES)), np.nan)
        full[:, where] = unknowns
        if self.host is not None:
            full[:, 2 : 2 + HOST] = self.host[rows]
        if solver.size > 2 + HOST or (self.host is not None and solver.size > 2):
            full[:, 8] = np.where(np.isnan(full[:, 8]), self.task.power, full[:, 8])
        parameters[rows] = full * units
        parameters[rows, :2] += self.centre[rows]
        parameters[rows, 5] %= 2.0 * np.pi
        spread = np.where(np.isnan(full[:, :, None] + full[:, None, :]), np.nan, 0.0)
        spread[:, where[:, None], where] = inverse * units[:, where, None] * units[:, None, where]
        covariance[rows] = spread
        return status

    def describe(self, solver: Solver, rows: NDArray[np.int64], found: Found) -> None:
        """Write noise, misfit and weights of some rings."""
        unit, readings = self.size[rows], solver.readings
        rms, misfit = np.empty(rows.size), np.empty(rows.size)
        residuals = solver.residuals()
        finish.residual_statistics(rows, residuals, solver.omega, readings.counts, rms, misfit)
        found.rms[rows], found.misfit[rows], found.noise[rows] = rms * unit, misfit, solver.sigma[rows] * unit
        found.used[rows] = (solver.omega[rows] > 0.0).sum(axis=1)
        row, column = np.nonzero(np.arange(readings.z.shape[1]) < readings.counts[rows, None])
        ring = rows[row]
        given = readings.index[ring, column]
        if found.weights is not None:
            found.weights[ring, given] = solver.omega[ring, column] / readings.prior[ring, column]
        if found.residuals is not None:
            found.residuals[ring, given] = residuals[ring, column] * self.size[ring]
