"""Noise scales that are taken from the data."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

_GROWTH, _MOST = 1.4, 2.0
"""How a scale's gain grows while it is asked on, and the largest."""
_CALM = 0.4
"""What a gain is multiplied by when its scale is asked back."""
_FURTHEST = 1.0
"""Largest change of a scale's logarithm at once."""
_ENOUGH = 0.05
"""Change of a scale's logarithm that is let be."""


@dataclass
class Tuning:
    """Noise scales on their way to where the data, and what is thought of them beforehand, put them.

    Two scales that explain the same residuals push one another to and fro; so each has its own gain, which falls
    whenever it is asked back.

    Attributes:
        unsure: One-sigma of a scale's logarithm beforehand. A noise that the data say nothing of stays near its start,
            instead of falling to nothing, which no real pipe or robot keeps to.
        scales: Factor name to its groups' one-sigma over the stated one.
        settled: Whether all rest.
    """

    unsure: float
    scales: dict[str, np.ndarray] = field(default_factory=dict)
    settled: bool = False
    _gains: dict[str, np.ndarray] = field(default_factory=dict)
    _last: dict[str, np.ndarray] = field(default_factory=dict)

    def follow(self, balances: dict[str, np.ndarray]) -> None:
        """Move every scale as the balance of its residuals asks: squares left over, and how many are free (g, 2).

        NaN stands for a scale that is not taken from the data.
        """
        self.settled = True
        for name, balance in balances.items():
            scale = self.scales.get(name, np.ones(len(balance)))
            back = -np.log(scale) / self.unsure**2
            left, free = balance[:, 0] + np.maximum(back, 0.0), balance[:, 1] + np.maximum(-back, 0.0)
            asked = np.nan_to_num(0.5 * np.log(np.maximum(left, 1e-9) / np.maximum(free, 1e-9)))
            asked = np.clip(asked, -_FURTHEST, _FURTHEST)
            gain, last = self._gains.get(name, np.ones(len(asked))), self._last.get(name, asked)
            gain = np.where(asked * last < 0.0, _CALM * gain, np.minimum(_GROWTH * gain, _MOST))
            self.scales[name] = scale * np.exp(np.clip(gain * asked, -_FURTHEST, _FURTHEST))
            self._gains[name], self._last[name] = gain, asked
            self.settled &= bool((np.abs(asked) < _ENOUGH).all())
