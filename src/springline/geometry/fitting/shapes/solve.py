"""Robust least squares of a wall's coordinates on many rings at once: Levenberg's damping, steps within limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from .._refine import SUMS
from . import kernels

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Rows = NDArray[np.int64]

ITERATIONS = 80


class Wall(Protocol):
    """What the solver asks of a family of sections."""

    floor: Array
    """(K,) least value of each coordinate."""
    ceiling: Array
    """(K,) largest value of each coordinate."""

    def prepare(self, coordinates: Array) -> tuple[NDArray[np.bool_], Any]:
        """Return which coordinates (R, K) make sections, and what `evaluate` needs of those that do."""

    def evaluate(
        self, rows: Rows, prepared: Any, bearing: Array, counts: Rows, radius: Array, slope: Array, by: Array
    ) -> None:
        """Fill radius, slope (N, M) and derivatives by the coordinates (N, K, M) for some rings.

        Args:
            rows: (R,) the rings.
            prepared: What `prepare` made of their coordinates, in the order of `rows`.
            bearing: (N, M) about O in the section's own frame [rad].
            counts: (N,) how many of the M are readings.
            radius, slope, by: Outputs.
        """


@dataclass(frozen=True, eq=False)
class Readings:
    """The readings of N rings, those that can be used in front.

    Attributes:
        z, y: (N, M).
        prior: (N, M) relative inverse variances with mean one.
        index: (N, M) place of each reading among those given.
        counts: (N,) how many can be used.
        rays: (2, N, M) unit vectors from the sensor to each reading.
        along: Whether readings err along these rays; otherwise along the wall's normal.
    """

    z: Array
    y: Array
    prior: Array
    index: Rows
    counts: Rows
    rays: Array
    along: bool


class Solver:
    """The fit of one wall to the readings of N rings; unknowns are centre z, centre y, coordinates and a free turn.

    Args:
        wall: The family of sections.
        readings: The readings.
        fixed_turn: (N,) turn of the section's own frame, counter-clockwise [rad]; where the turn is free, the part of
            it that is not an unknown.
        turning: Whether the turn is free.
    """

    def __init__(self, wall: Wall, readings: Readings, fixed_turn: Array, *, turning: bool) -> None:
        self.wall, self.readings, self.turning = wall, readings, turning
        self.fixed_turn = fixed_turn
        rings, points = readings.z.shape
        inner = len(wall.floor)
        self.size = 2 + inner + turning
        free = [np.inf] * 2
        self.floor = np.concatenate([np.negative(free), wall.floor, [-np.inf] * turning])
        self.ceiling = np.concatenate([free, wall.ceiling, [np.inf] * turning])
        self.unknowns = np.full((rings, self.size), np.nan)
        self.side = np.zeros(rings, np.int64)
        self.residual = np.empty((2, rings, points))
        self.jacobian = np.empty((2, rings, self.size, points))
        self.omega = np.zeros((rings, points))
        self.sums = np.zeros((rings, SUMS))
        self.sigma = np.full(rings, np.nan)
        self.verdict = np.zeros(rings, np.int64)
        self._bearing, self._radius, self._slope = (np.empty((rings, points)) for _ in range(3))
        self._by = np.empty((rings, inner, points))

    def run(
        self,
        rows: Rows,
        start: Array,
        kind: int,
        *,
        tolerance: float,
        sigma: Array | None = None,
        most: int = ITERATIONS,
    ) -> NDArray[np.bool_]:
        """Bring the unknowns of some rings from `start` (R, P) to the least loss; return which converged.

        Args:
            rows: (R,) the rings.
            start: (R, P) unknowns to start from, brought within their limits.
            kind: Loss: `kernels.PLAIN`, `CAUCHY` or `TUKEY`.
            tolerance: Length of the last step in sigmas of the unknowns.
            sigma: (R,) noise to keep; follows from the residuals unless given.
            most: Most iterations.
        """
        start = np.clip(start, self.floor, self.ceiling)
        self.unknowns[rows] = start
        good = self._evaluate(rows, start, self.side)
        self.verdict[rows] = np.where(good, kernels.MOVED, kernels.STALLED)
        active = rows[good]
        fixed = sigma is not None
        if fixed:
            self.sigma[rows] = sigma
        counts, prior = self.readings.counts, self.readings.prior
        kernels.begin(active, kind, counts, prior, self.side, self.residual, self.sigma, fixed, self.omega, self.sums)
        damping = np.zeros(len(self.side))
        trial, length = np.empty_like(self.unknowns), np.empty(len(self.side))
        for _ in range(most):
            if not active.size:
                break
            kernels.propose(
                active, kind, counts, self.side, self.residual, self.jacobian, self.omega, self.sums, self.unknowns,
                self.floor, self.ceiling, damping, trial, length,
            )  # fmt: skip
            solved = length[active] >= 0.0
            valid = np.zeros(active.size, bool)
            valid[solved] = self._evaluate(active[solved], trial[active[solved]], 1 - self.side)
            kernels.judge(
                active, valid, kind, counts, prior, self.side, self.residual, fixed, self.unknowns, trial, length,
                tolerance, self.sigma, damping, self.omega, self.sums, self.verdict,
            )  # fmt: skip
            active = active[self.verdict[active] == kernels.MOVED]
        return self.verdict[rows] == kernels.CONVERGED

    def information(self, rows: Rows) -> Array:
        """Return (R, P, P) normal matrices of the rings where they stand, with the weights that they have."""
        normal = np.empty((len(self.side), self.size, self.size))
        kernels.information(rows, self.readings.counts, self.side, self.residual, self.jacobian, self.omega, normal)
        return normal[rows]

    def variance(self, rows: Rows, kind: int) -> Array:
        """Return (R,) the factor from inverse normal matrix to covariance; NaN without readings to spare."""
        out = np.empty(len(self.side))
        kernels.variances(rows, kind, self.sigma, self.sums, self.size, out)
        return out[rows]

    def residuals(self) -> Array:
        """Return (N, M) residuals of all rings where they stand."""
        return self.residual[self.side, np.arange(len(self.side))]

    def _evaluate(self, rows: Rows, unknowns: Array, side: Rows) -> NDArray[np.bool_]:
        """Fill residuals and jacobian of some rings in the sides named; return where there is a section."""
        coordinates = unknowns[:, 2 : 2 + len(self.wall.floor)]
        good = np.isfinite(unknowns).all(axis=1)
        good[good], prepared = self.wall.prepare(coordinates[good])
        rows = rows[good]
        full = np.empty_like(self.unknowns)
        full[rows] = unknowns[good]
        r = self.readings
        kernels.place(rows, r.z, r.y, r.counts, full, self.turning, self.fixed_turn, self._bearing)
        if rows.size:
            self.wall.evaluate(rows, prepared, self._bearing, r.counts, self._radius, self._slope, self._by)
        kernels.compare(
            rows, r.z, r.y, r.counts, full, self.turning, self.fixed_turn, self._bearing, self._radius, self._slope,
            self._by, r.rays, r.along, side, self.residual, self.jacobian,
        )  # fmt: skip
        return good
