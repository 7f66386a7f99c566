"""Rings: centre and shape of the ellipse that each ring shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..states import AXLES, BLOCK, CLOCK, LEVER, LEVER_UP, SCALE, SLIP_RIGHT, SLIP_UP, State
from .base import Factor, Linear, robust_weight

if TYPE_CHECKING:
    from collections.abc import Callable

    from .sensor import Places

COLUMNS = np.concatenate(
    [np.arange(2 * BLOCK), 2 * BLOCK + np.array([SCALE, SLIP_UP, SLIP_RIGHT, LEVER, LEVER_UP, AXLES, CLOCK])]
)
WINDOW = 4096
"""Rings that are linearised at once."""


class RingFactor(Factor):
    """The factor of rings; its derivatives come from the compiled kernel."""

    many = True

    def __init__(
        self,
        places: Callable[[slice], Places],
        measured: np.ndarray,
        covariance: np.ndarray,
        bent: np.ndarray,
        rows: slice | None = None,
    ) -> None:
        """Make the factor.

        Args:
            places: Function of a slice of the rings: where they are between the knots.
            measured: centre_z, centre_y, mean_radius, oval_cos, oval_sin [m] (n, 5).
            covariance: Of these [m2] (n, 5, 5).
            bent: What a bend adds to the ellipse of the straight pipe [m] (n, 5).
            rows: Which of the rings; all unless given.
        """
        super().__init__("rings", np.arange(0), COLUMNS, None, (slice(0, 5),))
        self._places, self._measured, self._covariance, self._bent = places, measured, covariance, bent
        self._rows = rows or slice(0, len(measured))

    def windows(self) -> list[Factor]:
        """Return the rings in windows: places and derivatives take kilobytes a ring, and are held for one alone."""
        cuts = range(0, len(self._measured), WINDOW)
        return [
            RingFactor(self._places, self._measured, self._covariance, self._bent, slice(first, first + WINDOW))
            for first in cuts
        ]

    def linearise(self, state: State) -> Linear:
        """Return residuals, derivatives and weights at a state."""
        rows, at = self._rows, self._places(self._rows)
        self.interval = at.interval
        shown, slopes = at.evaluate(0, state, COLUMNS)
        whitener = np.linalg.inv(np.linalg.cholesky(self._covariance[rows]))
        residual = np.einsum("nij,nj->ni", whitener, shown + self._bent[rows] - self._measured[rows])
        weight = robust_weight(np.sum(residual**2, axis=1), 5, 0.0) / self.scale[0] ** 2
        return Linear(self, residual, whitener @ slopes, np.repeat(weight[:, None], 5, axis=1))
