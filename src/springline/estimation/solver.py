"""Block-tridiagonal systems with a border: solution and the blocks of the inverse that covariances need.

The matrix is [[T, F], [F', H]]: T has blocks D[k] on its diagonal and E[k] = T[k, k+1] beside it, F joins every block
with the border, H is the border's own. It is eliminated window by window, forwards, and solved window by window,
backwards; what is held beside the windows are the solution, and matrices of the border's size.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from .covariance import Covariance
from .elimination import add_products, eliminate, selected, substitute, ways
from .states import AXIS, ORIGIN

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from .spill import Spill
    from .windows import Window


@dataclass
class Normal:
    """Normal equations of one window: blocks of the information matrix and of the right side.

    Attributes:
        diagonal: (knot, B, B).
        beside: (knot - 1, B, B), rows of knot k, columns of knot k + 1.
        border: (knot, B, G).
        right: (knot, B).
        corner: (G, G).
        right_corner: (G,).
        first: Number of the first knot.
    """

    diagonal: np.ndarray
    beside: np.ndarray
    border: np.ndarray
    right: np.ndarray
    corner: np.ndarray
    right_corner: np.ndarray
    first: int = 0

    @classmethod
    def zeros(cls, knots: int, block: int, scalars: int, first: int = 0) -> Normal:
        """Return empty normal equations."""
        return cls(
            np.zeros((knots, block, block)),
            np.zeros((knots - 1, block, block)),
            np.zeros((knots, block, scalars)),
            np.zeros((knots, block)),
            np.zeros((scalars, scalars)),
            np.zeros(scalars),
            first,
        )

    @property
    def arrays(self) -> list[np.ndarray]:
        """All arrays, in their order."""
        return [getattr(self, field.name) for field in fields(self) if field.name != "first"]


@dataclass(frozen=True)
class Threads:
    """Known points of the axis: each holds the origin and the sum of all ways before it.

    Attributes:
        interval: Knot before each (t,).
        share: Of the interval that is passed (t,); outside 0..1 beyond the ends.
        residual: Known less estimated point [m] (t, 3).
        sigma: One-sigma of each coordinate [m] (t,).
    """

    interval: np.ndarray
    share: np.ndarray
    residual: np.ndarray
    sigma: np.ndarray

    @classmethod
    def none(cls) -> Threads:
        """Return no known points."""
        return cls(np.empty(0, np.int64), np.empty(0), np.empty((0, 3)), np.empty(0))

    def columns(self, knots: np.ndarray, block: int) -> np.ndarray:
        """Return how each thread's three coordinates depend on knots, by their numbers, (knot, block, 3 t)."""
        rows = knots[:, None]
        weights = np.where(rows < self.interval, 1.0, np.where(rows == self.interval, self.share, 0.0))
        out = np.zeros((len(knots), block, len(self.interval), 3))
        for axis in range(3):
            out[:, AXIS.start + axis, :, axis] = weights
        return out.reshape(len(knots), block, -1)

    def at_origin(self) -> np.ndarray:
        """Return how they depend on the origin, (3, 3 t)."""
        return np.tile(np.eye(3), len(self.interval))


@dataclass(frozen=True)
class Solved:
    """One window of the solution.

    Attributes:
        knots: (k, B) solution.
        diagonal: (k, B, B) blocks of T^-1; empty when no covariance was asked.
        beside: (k - 1, B, B) those beside them.
        lean: (k, B, G + 3 t) T^-1 times the border and the threads.
    """

    knots: np.ndarray
    diagonal: np.ndarray
    beside: np.ndarray
    lean: np.ndarray

    def covariance(self, mix: np.ndarray, scalars: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the covariance of each knot, with the next, and with the scalars; the blocks of T^-1 are used up."""
        through = self.lean @ mix
        add_products(self.diagonal, self.beside, through, self.lean)
        return self.diagonal, self.beside, -through[..., :scalars]


class Sweep:
    """One solution of the equations, to and fro over the windows.

    Args:
        windows: The windows.
        scale: One-sigma of every state (knot, B), roughly: every state is measured in its own, so that metres and
            radians per second meet as equals.
        edge: The same of the scalars (G,).
        threads: Known points of the axis, which no block alone can hold.
        aside: Where eliminated windows are put.

    Attributes:
        scalars: (G,) solution, once `forward` is done.
        corner: (G, G) covariance of the scalars.
        mix: (G + 3 t, G + 3 t): a knot's covariance is its block of T^-1 and `lean mix lean'`.
    """

    def __init__(
        self, windows: Sequence[Window], scale: np.ndarray, edge: np.ndarray, threads: Threads, aside: Spill
    ) -> None:
        self._windows, self._scale, self._edge, self._threads, self._aside = windows, scale, edge, threads, aside

    def forward(self, equations: Callable[[int], Normal]) -> None:
        """Eliminate all windows; `equations` gives those of a window by its number, and they are used up.

        Raises:
            InputError: The matrix is not positive definite: some state has no information at all.
        """
        count, edge = len(self._edge), self._edge
        corner, right_corner = np.zeros((count, count)), np.zeros(count)
        tied: np.ndarray | float = 0.0
        carried = None
        for number, window in enumerate(self._windows):
            normal, scale = equations(number), self._scale[window.knots]
            corner += normal.corner
            right_corner += normal.right_corner
            normal.diagonal *= scale[:, :, None]
            normal.diagonal *= scale[:, None, :]
            normal.beside *= scale[:-1, :, None]
            normal.beside *= scale[1:, None, :]
            pulls = self._threads.columns(np.arange(window.first, window.last + 1), scale.shape[1])
            if not window.ends:
                pulls[-1] = 0.0
            solved = np.concatenate([normal.border * edge, normal.right[..., None], pulls], axis=2)
            solved *= scale[:, :, None]
            if carried is not None:
                normal.diagonal[0] += carried[0]
                solved[0] += carried[1]
            part, good = eliminate(normal.diagonal, normal.beside, solved, window.ends)
            if not good:
                raise InputError(
                    "the survey's equations are singular: a state has no information",
                    expected="finite measurements and priors",
                )
            tied = tied + part
            carried = normal.diagonal[-1].copy(), solved[-1].copy()
            self._aside.put(("eliminated", number), normal.diagonal, normal.beside, solved)
        self._close(corner, right_corner, np.asarray(tied))

    def _close(self, corner: np.ndarray, right_corner: np.ndarray, tied: np.ndarray) -> None:
        """Solve for the scalars and for the pull of the threads (Woodbury)."""
        count, threads = len(self._edge), self._threads
        border, right, pulls = slice(0, count), count, slice(count + 1, None)
        scaled = self._edge[:, None]
        schur = corner * scaled * self._edge - tied[border, border]
        corner = np.linalg.inv(0.5 * (schur + schur.T)) * scaled * self._edge
        origin = np.zeros((count, tied.shape[0] - count - 1))
        origin[ORIGIN] = threads.at_origin()
        plain = corner @ (right_corner - tied[border, right] / self._edge)
        drawn = corner @ (origin - tied[border, pulls] / scaled)
        reach = origin - tied[border, pulls] / scaled
        spread = tied[pulls, pulls] + reach.T @ drawn
        gain = np.linalg.inv(0.5 * (spread + spread.T) + np.diag(np.repeat(threads.sigma**2, 3)))
        self._pull = gain @ (threads.residual.ravel() - tied[pulls, right] - reach.T @ plain)
        self.scalars, self.corner = plain + drawn @ self._pull, corner - drawn @ gain @ drawn.T
        self.mix = np.block([[self.corner, drawn @ gain], [gain @ drawn.T, -gain]])

    def widen(self, column: int, variance: float) -> None:
        """Make the variance of a scalar at least as large, and with it that of all that hangs on it."""
        hangs, count = self.mix[:, column], len(self._edge)
        more = max(variance / hangs[column] - 1.0, 0.0)
        self.mix = self.mix + more / hangs[column] * np.outer(hangs, hangs)
        self.corner = self.mix[:count, :count]

    def backward(self, *, covariance: bool) -> Iterator[tuple[int, Solved]]:
        """Return every window's number and solution, the last window first."""
        count, ahead = len(self._edge), None
        empty = np.empty((0, *self._scale.shape[1:], self._scale.shape[1]))
        for number in range(len(self._windows) - 1, -1, -1):
            diagonal, beside, solved = self._aside.get(("eliminated", number))
            scale = self._scale[self._windows[number].knots]
            if ahead is not None:
                diagonal[-1], solved[-1] = ahead
            substitute(beside, solved)
            if covariance:
                selected(diagonal, beside)
            ahead = diagonal[0].copy(), solved[0].copy()
            solved *= scale[:, :, None]
            lean = np.concatenate([solved[..., :count] / self._edge, solved[..., count + 1 :]], axis=2)
            knots = solved[..., count] - lean[..., :count] @ self.scalars + lean[..., count:] @ self._pull
            if not covariance:
                yield number, Solved(knots, empty, empty, lean)
                continue
            diagonal *= scale[:, :, None]
            diagonal *= scale[:, None, :]
            beside *= scale[:-1, :, None]
            beside *= scale[1:, None, :]
            yield number, Solved(knots, diagonal, beside, lean)

    def covariance(self, along: np.ndarray) -> Covariance:
        """Return the covariance of everything; `along` is the unit vector of the way from each knot (knot - 1, 3)."""
        count, aside = len(self._edge), self._aside
        for number, one in self.backward(covariance=True):
            aside.put(number, one.knots, one.diagonal, one.beside, one.lean)
        axis = np.empty((len(self._scale), 4, 4))
        before, shared = np.zeros((4, 4)), np.zeros((4, self._scale.shape[1]))
        lean = np.zeros((4, len(self.mix)))
        # What the origin adds to east, north, up; to the length it adds nothing.
        lean[:3, ORIGIN] = -np.eye(3)
        for number, window in enumerate(self._windows):
            one = Solved(*aside.get(number))
            reach = _reach(along[window.first : window.last])
            sums = np.concatenate([lean[None], lean + np.cumsum(reach @ one.lean[:-1, AXIS], axis=0)])
            own = ways(one.diagonal, one.beside, reach, before, shared)
            axis[window.knots] = own + sums @ self.mix @ np.swapaxes(sums, 1, 2)
            before, lean = own[-1], sums[-1]
            aside.put(number, *one.covariance(self.mix, count))
        return Covariance(self._windows, aside, self.corner, axis)


def _reach(along: np.ndarray) -> np.ndarray:
    """Return what each way adds to east, north, up and length (interval, 4, 3)."""
    out = np.zeros((len(along), 4, 3))
    out[:, :3] = np.eye(3)
    out[:, 3] = along
    return out
