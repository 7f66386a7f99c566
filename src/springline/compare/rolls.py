"""How the bearings of one inspection are turned against those of the other, piece by piece along the pipe."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .texture import Prepared, Shared

_FINE = 8
_WALK = np.radians(1.5)  # per root m
_FLOOR = np.radians(0.1)


def track_roll(
    one: Prepared, both: Shared, pieces: list[slice], step: float, level: float
) -> tuple[tuple[NDArray[np.float64], NDArray[np.float64]], float]:
    """Return the roll of B against A in each piece, and how far the reliefs agree.

    Circular correlation of the filtered reliefs, B laid on A already, gives the likelihood of each roll; a random walk
    round the circle joins the pieces.

    Args:
        one: The filtered reliefs, row by row at the same place.
        both: What they may share.
        pieces: Rows of each piece.
        step: Between rows [m].
        level: One-sigma of the roll where both verticals were measured [rad]; infinite where one was not.

    Returns:
        Roll (n,) and its one-sigma (n,) [rad]: what B's bearings are turned by to be A's; and the share of the
        agreement that was expected, 0 to 1.
    """
    m = one.a.shape[1]
    waves = (np.conj(fft.rfft(one.b[p], axis=1)) * fft.rfft(one.a[p], axis=1) for p in pieces)
    like = np.array([fft.irfft(w.sum(axis=0), n=m * _FINE) * _FINE for w in waves])
    turn = np.arange(m * _FINE) * (2 * np.pi / (m * _FINE))
    turn = np.mod(turn + np.pi, 2 * np.pi) - np.pi
    start = np.exp(-0.5 * (turn / level) ** 2)
    gamma = _circular(like, start / start.sum(), pieces, step)
    mean = np.unwrap(np.angle(gamma @ np.exp(1j * turn)))
    spread = np.abs(gamma @ np.exp(1j * turn))
    sigma = np.sqrt(np.maximum(-2.0 * np.log(np.clip(spread, 1e-9, 1.0)), 0.0) + _FLOOR**2)
    mean -= 2 * np.pi * np.round(np.median(mean) / (2 * np.pi))
    at = np.rint(mean * m * _FINE / (2 * np.pi)).astype(int) % (m * _FINE)
    cells = np.array([float(np.minimum(one.seen_a[p], one.seen_b[p] * m).sum()) for p in pieces])
    expected = both.expected * cells.sum()
    agreement = float(like[np.arange(len(pieces)), at].sum() / expected) if expected > 0 else np.nan
    return (mean, sigma), float(np.clip(agreement, 0.0, 1.0))


def _circular(like: NDArray, start: NDArray, pieces: list[slice], step: float) -> NDArray[np.float64]:
    """Return the smoothed posterior (n, cells) of a random walk round the circle with log likelihoods (n, cells)."""
    cells = like.shape[1]
    turn = np.minimum(np.arange(cells), cells - np.arange(cells)) * (2 * np.pi / cells)
    gaps = [0.5 * step * (p.stop - p.start + q.stop - q.start) for p, q in pairwise(pieces)]
    kernels = []
    for gap in gaps:
        kernel = np.exp(-0.5 * (turn / (_WALK * np.sqrt(gap))) ** 2)
        kernels.append(fft.rfft(kernel / kernel.sum()))
    weight = np.exp(like - like.max(axis=1, keepdims=True))

    def carried(p: NDArray, kernel: NDArray) -> NDArray:
        return np.maximum(fft.irfft(fft.rfft(p) * kernel, n=cells), 0.0)

    forward = np.empty_like(weight)
    p = start
    for i in range(len(like)):
        p = (p if i == 0 else carried(p, kernels[i - 1])) * weight[i] + 1e-300
        p = p / p.sum()
        forward[i] = p
    beta = np.ones(cells)
    for i in range(len(like) - 2, -1, -1):
        beta = carried(beta * weight[i + 1], kernels[i]) + 1e-300
        beta /= beta.max()
        forward[i] *= beta
        forward[i] /= forward[i].sum()
    return forward
