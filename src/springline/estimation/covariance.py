"""The covariance of an estimate: blocks of neighbouring knots, window by window, and what is asked of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .elimination import chain_variance
from .spill import Spill
from .windows import MOST_INTERVALS, Window

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class Covariance:
    """Blocks of the covariance.

    Attributes:
        windows: The knots whose blocks are put aside together.
        aside: Under the number of each window its knots' covariance (k, B, B), that with the next knot (k - 1, B, B),
            and that with the scalars (k, B, G).
        corner: (G, G) covariance of the scalars.
        axis: (knot, 4, 4) covariance of the point of the axis at each knot, and of the length of the axis up to it.
    """

    windows: Sequence[Window]
    aside: Spill
    corner: np.ndarray
    axis: np.ndarray

    @classmethod
    def of(
        cls, diagonal: np.ndarray, beside: np.ndarray, border: np.ndarray, corner: np.ndarray, axis: np.ndarray
    ) -> Covariance:
        """Return the covariance whose blocks are at hand."""
        aside = Spill(on_disk=False)
        aside.put(0, diagonal, beside, border)
        return cls((Window(0, len(diagonal) - 1, True),), aside, corner, axis)

    def rows(self, first: int, last: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return blocks of the knots from `first` to `last`, both included: of each, with the next, with scalars."""
        parts: list[tuple[np.ndarray, ...]] = []
        for number, window in enumerate(self.windows):
            low, high = max(first, window.first), min(last, window.last)
            # A border knot stands in both windows; it is taken from the earlier one.
            if low > high or (low == high == window.first and first < low):
                continue
            diagonal, beside, border = self.aside.get(number)
            start = low - window.first + (1 if parts else 0)
            stop = high - window.first + 1
            parts.append((diagonal[start:stop], beside[low - window.first : stop - 1], border[start:stop]))
        joined = tuple(np.concatenate(part) if len(part) > 1 else part[0] for part in zip(*parts, strict=True))
        return joined[0], joined[1], joined[2]


@dataclass(frozen=True)
class Stretch:
    """Neighbouring knots as a Markov chain once the scalars are known, and how each leans on the scalars.

    Attributes:
        blocks: (knot, B, B) covariance of each, scalars known.
        beside: (knot - 1, B, B) covariance of each with the next.
        lean: (knot, B, G) change with the scalars.
        corner: (G, G) covariance of the scalars.
    """

    blocks: np.ndarray
    beside: np.ndarray
    lean: np.ndarray
    corner: np.ndarray

    @classmethod
    def of(cls, found: Covariance, first: int, last: int) -> Stretch:
        """Return the knots from `first` to `last`, both included."""
        diagonal, beside, border = found.rows(first, last)
        edge = np.sqrt(np.diag(found.corner))
        lean = border / edge @ np.linalg.inv(found.corner / edge / edge[:, None]) / edge
        blocks = diagonal - lean @ np.swapaxes(border, 1, 2)
        return cls(blocks, beside - lean[:-1] @ np.swapaxes(border[1:], 1, 2), lean, found.corner)

    def together(self, states: slice) -> np.ndarray:
        """Return the covariance (knot, s, knot, s) of some states of all knots."""
        count = len(self.blocks)
        lean = self.lean[:, states]
        out = np.einsum("iag,gh,jbh->iajb", lean, self.corner, lean)
        through = np.linalg.solve(self.blocks[:-1], self.beside)
        for i in range(count):
            shared = self.blocks[i, states]
            out[i, :, i] += shared[:, states]
            for j in range(i + 1, count):
                shared = shared @ through[j - 1]
                out[i, :, j] += shared[:, states]
                out[j, :, i] += shared[:, states].T
        return out


def sigma_of_sum(found: Covariance, first: int, weights: np.ndarray) -> float:
    """Return the one-sigma of the sum of weights (knot, B) times the states of knots from `first` on."""
    total, shared = 0.0, np.zeros(weights.shape[1])
    scalars = np.zeros(len(found.corner))
    # However long the stretch, no more of it is held than a window.
    for start in range(0, len(weights), MOST_INTERVALS):
        stop = min(start + MOST_INTERVALS, len(weights) - 1)
        part = Stretch.of(found, first + start, first + stop)
        count = len(part.blocks) if stop == len(weights) - 1 else len(part.beside)
        own = weights[start : start + count]
        scalars += np.einsum("kb,kbg->g", own, part.lean[:count])
        total += chain_variance(part.blocks[:count], part.beside, own, shared)
        if stop == len(weights) - 1:
            break
    return float(np.sqrt(max(total + scalars @ found.corner @ scalars, 0.0)))
