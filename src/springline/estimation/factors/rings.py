"""Rings: centre and shape of the ellipse that each ring shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..states import AXLES, BLOCK, CLOCK, LEVER, LEVER_UP, SCALE, SLIP_RIGHT, SLIP_UP, State
from .base import Factor, Linear, robust_weight

if TYPE_CHECKING:
    from .sensor import Places

COLUMNS = np.concatenate(
    [np.arange(2 * BLOCK), 2 * BLOCK + np.array([SCALE, SLIP_UP, SLIP_RIGHT, LEVER, LEVER_UP, AXLES, CLOCK])]
)


class RingFactor(Factor):
    """The factor of rings; its derivatives come from the compiled kernel."""

    many = True

    def __init__(
        self,
        places: Places,
        measured: np.ndarray,
        covariance: np.ndarray,
        bent: np.ndarray,
    ) -> None:
        """Make the factor.

        Args:
            places: Where the rings are between the knots.
            measured: centre_z, centre_y, mean_radius, oval_cos, oval_sin [m] (n, 5).
            covariance: Of these [m2] (n, 5, 5).
            bent: What a bend adds to the ellipse of the straight pipe [m] (n, 5).
        """
        super().__init__("rings", places.interval, COLUMNS, None, (slice(0, 5),))
        self._places, self._measured, self._covariance, self._bent = places, measured, covariance, bent

    def linearise(self, state: State) -> Linear:
        """Return residuals, derivatives and weights at a state."""
        shown, slopes = self._places.evaluate(0, state, COLUMNS)
        whitener = np.linalg.inv(np.linalg.cholesky(self._covariance))
        residual = np.einsum("nij,nj->ni", whitener, shown + self._bent - self._measured)
        weight = robust_weight(np.sum(residual**2, axis=1), 5, 0.0) / self.scale[0] ** 2
        return Linear(self, residual, whitener @ slopes, np.repeat(weight[:, None], 5, axis=1))
