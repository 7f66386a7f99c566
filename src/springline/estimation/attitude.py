"""The gyro integrated to attitudes, a stretch of samples at a time: what is asked for again is integrated again."""

from __future__ import annotations

import numpy as np
from numba import njit

from .data import Inertial
from .rotations import matrix

_APART = 4096
"""Samples between attitudes that are kept."""
_MORE = 64
"""Samples on either side that are integrated unasked: the next question is mostly about a moment before or after."""


class Attitude:
    """Attitudes at the samples of a log, robot axes in columns, on Earth.

    Args:
        log: The log.
        still: Whether the robot stood still at each sample, so that it did not turn (m,).
        bias: Of the gyro, which is taken off [rad/s] (3,).
        first: Attitude at the first sample (3, 3).
    """

    def __init__(self, log: Inertial, still: np.ndarray, bias: np.ndarray, first: np.ndarray) -> None:
        self._log, self._still, self._bias = log, still, bias
        self._kept = [first]
        self._held: tuple[slice, np.ndarray] | None = None
        for start in range(0, len(log.time) - _APART, _APART):
            rows = slice(start, start + _APART + 1)
            self._kept.append(_integrate(self._kept[-1], self._turns(rows))[-1])

    def turned(self, heading: float) -> None:
        """Turn everything clockwise by `heading` [rad]."""
        turn = matrix(np.array([0.0, 0.0, -heading]))
        self._kept, self._held = [turn @ one for one in self._kept], None

    def rates(self, rows: slice) -> np.ndarray:
        """Return the mean rates from each sample to the next, one less than there are rows [rad/s]."""
        rate = np.where(self._still[rows, None], 0.0, self._log.gyro[rows] - self._bias)
        return 0.5 * (rate[1:] + rate[:-1])

    def at(self, rows: slice) -> np.ndarray:
        """Return the attitudes at consecutive samples (n, 3, 3)."""
        if self._held is None or rows.start < self._held[0].start or rows.stop > self._held[0].stop:
            start = max(rows.start - _MORE, 0) // _APART
            whole = slice(start * _APART, min(rows.stop + _MORE, len(self._still)))
            self._held = whole, _integrate(self._kept[start], self._turns(whole))
        held, axes = self._held
        return axes[rows.start - held.start : rows.stop - held.start]

    def _turns(self, rows: slice) -> np.ndarray:
        return self.rates(rows) * np.diff(self._log.time[rows])[:, None]


@njit(cache=True)
def _integrate(first, turn):
    """Return attitudes (m, 3, 3), robot axes in columns, turned step by step by rotation vectors in robot axes."""
    out = np.empty((len(turn) + 1, 3, 3))
    out[0] = first
    for k in range(len(turn)):
        x, y, z = turn[k]
        square = x * x + y * y + z * z
        angle = np.sqrt(square)
        if angle > 1e-8:
            a, b = np.sin(angle) / angle, (1.0 - np.cos(angle)) / square
        else:
            a, b = 1.0, 0.5
        for i in range(3):
            px, py, pz = out[k, i, 0], out[k, i, 1], out[k, i, 2]
            # Row p of the attitude times the step's matrix I + a [w]x + b [w]x^2, written out.
            d = px * x + py * y + pz * z
            out[k + 1, i, 0] = px + a * (py * z - pz * y) + b * (d * x - square * px)
            out[k + 1, i, 1] = py + a * (pz * x - px * z) + b * (d * y - square * py)
            out[k + 1, i, 2] = pz + a * (px * y - py * x) + b * (d * z - square * pz)
    return out
