"""Block-tridiagonal systems with a border: solution and the blocks of the inverse that covariances need.

The matrix is [[T, F], [F', H]]: T has blocks D[k] on its diagonal and E[k] = T[k, k+1] beside it, F joins every block
with the border, H is the border's own. Memory and time grow with the number of blocks alone.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ..errors import InputError
from .elimination import add_products, chain_variance, eliminate, selected, ways
from .states import AXIS, ORIGIN


@dataclass
class Normal:
    """Normal equations: blocks of the information matrix and of the right side.

    Attributes:
        diagonal: (knot, B, B).
        beside: (knot - 1, B, B), rows of knot k, columns of knot k + 1.
        border: (knot, B, G).
        corner: (G, G).
        right: (knot, B).
        right_corner: (G,).
    """

    diagonal: np.ndarray
    beside: np.ndarray
    border: np.ndarray
    corner: np.ndarray
    right: np.ndarray
    right_corner: np.ndarray

    @classmethod
    def zeros(cls, knots: int, block: int, scalars: int) -> Normal:
        """Return empty normal equations."""
        return cls(
            np.zeros((knots, block, block)),
            np.zeros((knots - 1, block, block)),
            np.zeros((knots, block, scalars)),
            np.zeros((scalars, scalars)),
            np.zeros((knots, block)),
            np.zeros(scalars),
        )

    def copy(self) -> Normal:
        """Return equations that may be used up."""
        return Normal(*(getattr(self, field.name).copy() for field in fields(self)))


@dataclass
class Factored:
    """Solution and the needed part of the inverse.

    Attributes:
        knots: (knot, B) solution.
        scalars: (G,) solution.
        diagonal: (knot, B, B) covariance of each knot.
        beside: (knot - 1, B, B) covariance of knot k with knot k + 1.
        border: (knot, B, G) covariance with the scalars.
        corner: (G, G) covariance of the scalars.
        axis: (knot, 4, 4) covariance of the point of the axis at each knot, and of the length of the axis up to it.
    """

    knots: np.ndarray
    scalars: np.ndarray
    diagonal: np.ndarray
    beside: np.ndarray
    border: np.ndarray
    corner: np.ndarray
    axis: np.ndarray

    def local(self, interval: np.ndarray) -> np.ndarray:
        """Return the joint covariance (n, 2B + G, 2B + G) of the two knots of each interval and the scalars."""
        block, scalars = self.border.shape[1:]
        out = np.empty((len(interval), 2 * block + scalars, 2 * block + scalars))
        a, b, c = slice(0, block), slice(block, 2 * block), slice(2 * block, None)
        out[:, a, a], out[:, b, b] = self.diagonal[interval], self.diagonal[interval + 1]
        out[:, a, b] = self.beside[interval]
        out[:, b, a] = np.swapaxes(out[:, a, b], 1, 2)
        out[:, a, c], out[:, b, c] = self.border[interval], self.border[interval + 1]
        out[:, c, a], out[:, c, b] = np.swapaxes(out[:, a, c], 1, 2), np.swapaxes(out[:, b, c], 1, 2)
        out[:, c, c] = self.corner
        return out


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
    def of(cls, found: Factored, first: int, last: int) -> Stretch:
        """Return the knots from `first` to `last`, both included."""
        rows, edge = slice(first, last + 1), np.sqrt(np.diag(found.corner))
        lean = found.border[rows] / edge @ np.linalg.inv(found.corner / edge / edge[:, None]) / edge
        blocks = found.diagonal[rows] - lean @ np.swapaxes(found.border[rows], 1, 2)
        beside = found.beside[first:last] - lean[:-1] @ np.swapaxes(found.border[rows][1:], 1, 2)
        return cls(blocks, beside, lean, found.corner)

    def sigma(self, weights: np.ndarray) -> float:
        """Return the one-sigma of the sum of weights (knot, B) times states."""
        scalars = np.einsum("kb,kbg->g", weights, self.lean)
        own = chain_variance(self.blocks, self.beside, weights)
        return float(np.sqrt(own + scalars @ self.corner @ scalars))

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

    def _weights(self, knots: int) -> np.ndarray:
        rows = np.arange(knots)[:, None]
        return np.where(rows < self.interval, 1.0, np.where(rows == self.interval, self.share, 0.0))

    def columns(self, knots: int, block: int) -> np.ndarray:
        """Return how each thread's three coordinates depend on the knots, (knot, block, 3 t)."""
        out = np.zeros((knots, block, len(self.interval), 3))
        for axis in range(3):
            out[:, AXIS.start + axis, :, axis] = self._weights(knots)
        return out.reshape(knots, block, -1)

    def at_origin(self) -> np.ndarray:
        """Return how they depend on the origin, (3, 3 t)."""
        return np.tile(np.eye(3), len(self.interval))

    def along(self, knots: np.ndarray, scalars: np.ndarray) -> np.ndarray:
        """Return the threads' coordinates (3 t, n) for changes of the knots (knot, block, n) and scalars (G, n)."""
        ways = np.einsum("kt,kan->tan", self._weights(len(knots)), knots[:, AXIS])
        return (ways + scalars[ORIGIN]).reshape(-1, knots.shape[2])


def solve(
    normal: Normal, threads: Threads | None = None, along: np.ndarray | None = None, *, covariance: bool = True
) -> Factored:
    """Return the solution of the normal equations and the covariance blocks; the equations are used up.

    Args:
        normal: The equations; their matrix must be positive definite. Blocks and corner are laid out as in `states`.
        threads: Known points of the axis, which no block alone can hold.
        along: Unit vector of the way from each knot to the next (knot - 1, 3), for the covariance of the length; the
            first coordinate's unless given.
        covariance: Whether covariances of the knots are wanted; without, they are empty arrays.

    Raises:
        InputError: The matrix is not positive definite: some state has no information at all.
    """
    # Every state is measured in its own one-sigma, so that metres and radians/second meet as equals.
    scale = 1.0 / np.sqrt(np.maximum(np.einsum("kii->ki", normal.diagonal), 1e-300))
    edge = 1.0 / np.sqrt(np.maximum(np.diag(normal.corner), 1e-300))
    normal.diagonal *= scale[:, :, None]
    normal.diagonal *= scale[:, None, :]
    normal.beside *= scale[:-1, :, None]
    normal.beside *= scale[1:, None, :]
    count = len(normal.corner)
    pulls = np.empty((*scale.shape, 0)) if threads is None else threads.columns(len(scale), scale.shape[1])
    solved = np.concatenate([normal.border * edge, normal.right[..., None], pulls], axis=2)
    solved *= scale[:, :, None]
    tied, good = eliminate(normal.diagonal, normal.beside, solved, count)
    if not good:
        raise InputError(
            "the survey's equations are singular: a state has no information",
            expected="finite measurements and priors",
        )
    schur = normal.corner * edge[:, None] * edge - tied[:, :count]
    corner = np.linalg.inv(0.5 * (schur + schur.T)) * edge[:, None] * edge
    ends = np.concatenate([normal.right_corner[:, None], np.zeros((count, pulls.shape[2]))], axis=1)
    if threads is not None:
        ends[ORIGIN, 1:] = threads.at_origin()
    # Columns: the solution without threads, then what each thread's pull would do.
    moved_scalars = corner @ (ends - tied[:, count:] / edge[:, None])
    solved *= scale[:, :, None]
    follow = solved[..., :count]
    follow /= edge
    moved = solved[..., count:] - follow @ moved_scalars
    reach = _reach(len(scale), along)
    empty = np.empty((0, *normal.diagonal.shape[1:]))
    plain = Factored(moved[..., 0], moved_scalars[:, 0], empty, empty, empty, corner, np.empty((0, 4, 4)))
    if covariance:
        selected(normal.diagonal, normal.beside, scale)
        lean = _START @ np.eye(count)[ORIGIN] - _running(reach @ follow[:, AXIS])
        plain.axis = ways(normal.diagonal, normal.beside, reach) + lean @ corner @ np.swapaxes(lean, 1, 2)
        plain.diagonal, plain.beside, plain.border = normal.diagonal, normal.beside, -follow @ corner
        add_products(plain.diagonal, plain.beside, -plain.border, follow)
    return plain if threads is None else _pulled(plain, threads, reach, moved[..., 1:], moved_scalars[:, 1:])


def _pulled(
    plain: Factored, threads: Threads, reach: np.ndarray, moved: np.ndarray, moved_scalars: np.ndarray
) -> Factored:
    """Return the solution that also keeps the threads (Woodbury)."""
    noise = np.repeat(threads.sigma**2, 3)
    spread = threads.along(moved, moved_scalars)
    gain = np.linalg.inv(0.5 * (spread + spread.T) + np.diag(noise))
    left = threads.residual.ravel() - threads.along(plain.knots[..., None], plain.scalars[:, None])[:, 0]
    pull = gain @ left
    drawn_scalars = moved_scalars @ gain
    plain.knots, plain.scalars = plain.knots + moved @ pull, plain.scalars + moved_scalars @ pull
    plain.corner = plain.corner - drawn_scalars @ moved_scalars.T
    if len(plain.diagonal):
        drawn = moved @ gain
        points = _START @ moved_scalars[ORIGIN] + _running(reach @ moved[:, AXIS])
        add_products(plain.diagonal, plain.beside, -drawn, moved)
        plain.border -= drawn @ moved_scalars.T
        plain.axis -= points @ gain @ np.swapaxes(points, 1, 2)
    return plain


_START = np.eye(4)[:, :3]
"""What the origin adds to east, north, up and length."""


def _reach(knots: int, along: np.ndarray | None) -> np.ndarray:
    """Return what each way adds to east, north, up and length (knot, 4, 3); the last knot has no way."""
    out = np.zeros((knots, 4, 3))
    out[:, :3] = np.eye(3)
    out[:-1, 3] = np.array([1.0, 0.0, 0.0]) if along is None else along
    return out


def _running(values: np.ndarray) -> np.ndarray:
    """Return the sums of all blocks before each."""
    out = np.zeros_like(values)
    np.cumsum(values[:-1], axis=0, out=out[1:])
    return out
