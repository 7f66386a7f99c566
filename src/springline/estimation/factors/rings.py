"""Rings: centre and shape of the ellipse that each ring shows."""

from __future__ import annotations

import numpy as np

from ..states import AXLES, BLOCK, CLOCK, LEVER, LEVER_UP, SCALE, SLIP_RIGHT, SLIP_UP, State
from .base import DERIVATIVE_STEPS, Factor, Linear, robust_weight
from .sensor import Places, evaluate

COLUMNS = np.concatenate(
    [np.arange(2 * BLOCK), 2 * BLOCK + np.array([SCALE, SLIP_UP, SLIP_RIGHT, LEVER, LEVER_UP, AXLES, CLOCK])]
)
WINDOW = 4096
"""Rings that are linearised at once."""


class RingFactor(Factor):
    """The factor of rings; its derivatives come from the compiled kernel."""

    def __init__(self, places: Places, measured: np.ndarray, covariance: np.ndarray, bent: np.ndarray) -> None:
        """Take where the rings were taken and what they showed.

        Args:
            places: Where.
            measured: centre_z, centre_y, mean_radius, oval_cos, oval_sin [m] (n, 5).
            covariance: Of `measured` [m2] (n, 5, 5).
            bent: What a bend adds to the ellipse of the straight pipe [m] (n, 5).
        """
        super().__init__("rings", places.interval, COLUMNS, None, (slice(0, 5),))
        self._places, self._measured, self._covariance, self._bent = places, measured, covariance, bent

    def windows(self) -> list[Factor]:
        """Return the rings in windows: derivatives take two kilobytes a ring, and are held for one window alone."""
        cuts = range(0, len(self.interval), WINDOW)
        parts = (slice(first, first + WINDOW) for first in cuts)
        return [
            RingFactor(self._places.rows(rows), self._measured[rows], self._covariance[rows], self._bent[rows])
            for rows in parts
        ]

    def linearise(self, state: State) -> Linear:
        """Return residuals, derivatives and weights at a state."""
        at = self._places
        shown, slopes = evaluate(
            0,
            at.interval,
            state.knots,
            state.scalars,
            at.share,
            at.step,
            at.tracks(),
            at.clock,
            np.asarray(at.lever, float),
            COLUMNS,
            DERIVATIVE_STEPS,
        )
        whitener = np.linalg.inv(np.linalg.cholesky(self._covariance))
        residual = np.einsum("nij,nj->ni", whitener, shown + self._bent - self._measured)
        weight = robust_weight(np.sum(residual**2, axis=1), 5, 0.0) / self.scale[0] ** 2
        return Linear(self, residual, whitener @ slopes, np.repeat(weight[:, None], 5, axis=1))
