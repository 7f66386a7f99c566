"""Pieces of A's wall laid on B at every drift and roll, and joined in the chain of the drift."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from . import chain
from .rolls import track_roll
from .texture import log_ratio, prepare, relief, shared

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .options import MatchOptions
    from .texture import Relief, Shared
    from .wall import Wall

_PIECE = 0.5  # m of wall that are placed as one, or less where so many rings are closer
_RINGS, _LEAST_RINGS = 50, 16
_FINEST = 0.002  # m
_HALF_MODE = 0.03  # m
_LEAST_AGREEMENT = 0.15
_MISREAD = 1e-3  # share of pieces that say nothing: covered, changed, or read past a fault
_OUT_OF_ORDER = 1e-6  # m
UPRIGHT_SIGMA = np.radians(3.0)
FLOOR = 5e-4  # m: what a straight piece of a drift that bends may be off


@dataclass(frozen=True)
class Base:
    """A straight guess of B's chainage, y0 + scale (x - x0), and the range of drift from it that is looked at [m]."""

    x0: float
    y0: float
    scale: float
    low: float
    high: float

    def at(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the guess at chainage x in A [m]."""
        return self.y0 + self.scale * (x - self.x0)


@dataclass(frozen=True)
class KnownPairs:
    """Chainages of matched features [m], B's along A's travel, their probability, and one-sigma of a chainage [m]."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    probability: NDArray[np.float64]
    noise: float


@dataclass(frozen=True)
class Tracked:
    """The chain of pieces: their middles [m], drift [m], its variance, probability of that place, and the evidence."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    sigma: NDArray[np.float64]
    probability: NDArray[np.float64]
    log_evidence: float


def place_pieces(
    a: Wall, b: Wall, base: Base, pairs: KnownPairs | None, walk: float, options: MatchOptions, *, coarse: bool = False
) -> tuple[Tracked, tuple, float] | None:
    """Return the chain of A's pieces in B, their roll, and how far the reliefs agree; None when they say nothing."""
    step = max(a.spacing, b.spacing / base.scale)
    grid = np.arange(a.extent[0], a.extent[1] + 0.5 * step, step)
    relief_a = relief(a, grid, step)
    first, last = np.floor(base.low / (base.scale * step)), np.ceil(base.high / (base.scale * step))
    wide = grid[0] + step * np.arange(first, len(grid) + last)
    relief_b = relief(b, base.at(wide), step * base.scale)
    both = shared(relief_a, relief_b)
    if both.expected <= 0.0:
        return None
    agreement = np.nan
    for _ in range(1 if coarse else 3):
        track = _chain(relief_a, relief_b, both, grid, step, base, (first, last), pairs, walk, options, a, b, coarse)
        if coarse:
            return track, (), np.nan
        at_b = relief(b, np.interp(grid, track.x, track.y), step * base.scale)
        rolls, agreement = track_roll(prepare(relief_a, at_b, both), both, _pieces(len(grid), step), step, level(a, b))
        if agreement < _LEAST_AGREEMENT:
            return None
        if agreement > 0.9:
            break
        both = both.times(agreement)
    return track, rolls, agreement


def level(a: Wall, b: Wall) -> float:
    """Return the one-sigma [rad] to which both verticals are known; infinite when one is not."""
    return UPRIGHT_SIGMA if a.upright() and b.upright() else np.inf


def _pieces(rows: int, step: float) -> list[slice]:
    """Return A's rows in pieces of about half a metre, of fifty rings where those are closer than a centimetre."""
    size = max(_LEAST_RINGS, min(_RINGS, round(_PIECE / step)))
    count = max(1, rows // size)
    edges = np.rint(np.linspace(0, rows, count + 1)).astype(int)
    return [slice(int(i), int(j)) for i, j in pairwise(edges)]


def _chain(
    relief_a: Relief, relief_b: Relief, both: Shared, grid: NDArray, step: float, base: Base, shifts: tuple,
    pairs: KnownPairs | None, walk: float, options: MatchOptions, a: Wall, b: Wall, coarse: bool,
) -> Tracked:  # fmt: skip
    filtered = prepare(relief_a, relief_b, both)
    fine = 1 if coarse else max(1, int(np.ceil(base.scale * step / _FINEST)))
    cell = base.scale * step / fine
    most = int(shifts[1] - shifts[0])
    drift = base.scale * step * shifts[0] + cell * np.arange(most * fine + 1)
    pieces = _pieces(len(grid), step)
    prior = _roll_prior(relief_a.field.shape[1], level(a, b))
    ratio = np.empty((len(pieces), drift.size))
    for i, rows in enumerate(pieces):
        found = log_ratio(filtered, rows, 0, most, fine, prior)
        top = found.max(axis=1)
        told = top + np.log(np.exp(found - top[:, None]).sum(axis=1))
        ratio[i] = np.logaddexp(np.log1p(-_MISREAD) + told, np.log(_MISREAD))
    x = np.array([0.5 * (grid[p.start] + grid[p.stop - 1]) for p in pieces])
    if pairs is not None:
        _add_pairs(ratio, x, drift, base, pairs)
        start = np.full(drift.size, 1.0 / drift.size)
    else:
        start = 1.0 / (1.0 + (drift / options.offset_scale) ** 2)
        start /= start.sum()
    gamma, evidence = chain.posterior(ratio, np.diff(x), walk, options.slip_rate, options.slip_scale, cell, start)
    place, variance, probability = chain.likeliest(gamma, drift, max(_HALF_MODE, 2.0 * cell))
    sigma = np.sqrt(variance + cell**2 / 12.0 + FLOOR**2)
    y = base.at(x) + place
    rising = _rising(x, y)
    # A place that had to be put in order is not known, however sharp its own likelihood.
    probability = np.where(np.abs(rising - y) > _OUT_OF_ORDER, 0.0, probability)
    return Tracked(x, rising, sigma, probability, float(evidence))


def _roll_prior(cells: int, sigma: float) -> NDArray[np.float64]:
    """Return the log prior (cells,) of the roll of B against A."""
    turn = np.arange(cells) * (2 * np.pi / cells)
    turn = np.mod(turn + np.pi, 2 * np.pi) - np.pi
    log_prior = -0.5 * (turn / sigma) ** 2
    return log_prior - np.log(np.exp(log_prior).sum())


def _add_pairs(ratio: NDArray, x: NDArray, drift: NDArray, base: Base, pairs: KnownPairs) -> None:
    """Add to the log ratios (n, cells) what matched features say of the drift at the piece nearest to each."""
    apart = pairs.y - base.at(pairs.x)
    piece = np.abs(pairs.x[:, None] - x[None, :]).argmin(axis=1)
    sigma = np.sqrt(2.0) * pairs.noise
    span = drift[-1] - drift[0]
    for i, d, p in zip(piece, apart, pairs.probability, strict=True):
        z = (drift - d) / sigma
        narrow, wide = np.exp(-0.5 * z**2), np.exp(-0.5 * (z / chain.WIDE) ** 2) / chain.WIDE
        near = ((1.0 - chain.WIDE_SHARE) * narrow + chain.WIDE_SHARE * wide) / (np.sqrt(2 * np.pi) * sigma)
        ratio[i] += np.log(p * near * span + (1.0 - p) + 1e-12)


def _rising(x: NDArray, y: NDArray) -> NDArray[np.float64]:
    """Return y made to rise with x: a robot that goes on cannot meet the wall in another order."""
    least = 0.2 * (x - x[0])
    return np.maximum.accumulate(y - least) + least
