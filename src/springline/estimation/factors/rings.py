"""Rings: centre and shape of the ellipse that each ring shows."""

from __future__ import annotations

import numpy as np

from ..states import AXLES, BLOCK, CLOCK, LEVER, SCALE, SLIP_RIGHT, SLIP_UP, State
from .base import DERIVATIVE_STEPS, Factor, Linear, robust_weight
from .sensor import Places, evaluate

COLUMNS = np.concatenate(
    [np.arange(2 * BLOCK), 2 * BLOCK + np.array([SCALE, SLIP_UP, SLIP_RIGHT, LEVER, AXLES, CLOCK])]
)


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
        self._places, self._tracks = places, places.tracks()
        self._wanted = measured - bent
        self._whitener = np.linalg.inv(np.linalg.cholesky(covariance))

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
            self._tracks,
            at.clock,
            np.asarray(at.lever, float),
            COLUMNS,
            DERIVATIVE_STEPS,
        )
        residual = np.einsum("nij,nj->ni", self._whitener, shown - self._wanted)
        weight = robust_weight(np.sum(residual**2, axis=1), 5, 0.0) / self.scale[0] ** 2
        return Linear(self, residual, self._whitener @ slopes, np.repeat(weight[:, None], 5, axis=1))
