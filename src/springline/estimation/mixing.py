"""Anderson's acceleration of an iteration that comes slowly to rest, as reweighting with heavy tails does."""

from __future__ import annotations

import numpy as np

_MEMORY = 5
_DAMPING = 1e-8


class Mixing:
    """The last steps of an iteration, and the place that they point to together.

    Among all mixtures of the last places (weights that add up to one) that one is taken whose mixed step is shortest.

    Source: Anderson 1965, in the form of Walker and Ni 2011.

    >>> mixing, plain, x = Mixing(), 0.0, np.zeros(1)
    >>> for _ in range(6):
    ...     plain, x = plain + 0.1 * (np.cos(plain) - plain), mixing.next(x, 0.1 * (np.cos(x) - x), np.ones(1))
    >>> round(float(plain), 3), x.round(3).tolist()
    (0.451, [0.739])
    """

    def __init__(self) -> None:
        self._places: list[np.ndarray] = []
        self._steps: list[np.ndarray] = []

    def next(self, place: np.ndarray, step: np.ndarray, scale: np.ndarray) -> np.ndarray:
        """Return where to go from `place`, from which the plain iteration would go by `step`; `scale` is one-sigma."""
        self._places = [*self._places, place][-_MEMORY:]
        self._steps = [*self._steps, step][-_MEMORY:]
        if len(self._steps) < 2:
            return place + step
        changes = np.stack([(step - before) / scale for before in self._steps[:-1]], axis=1)
        square = changes.T @ changes
        square += _DAMPING * np.trace(square) * np.eye(len(square))
        share = np.linalg.solve(square, changes.T @ (step / scale))
        out = place + step
        for part, before, taken in zip(share, self._places[:-1], self._steps[:-1], strict=True):
            out = out - part * (place + step - before - taken)
        return out
