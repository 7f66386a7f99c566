"""How alike two features are before their places are looked at, and what B's own features weigh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .features import KINDS

if TYPE_CHECKING:
    from .features import FeatureList
    from .options import MatchOptions

_MOST_SHARED = 0.97
_PRIOR_COUNT = 2.0


@dataclass(frozen=True)
class Likeness:
    """Weights of all pairs of two lists.

    Attributes:
        base: (n, m) probability of B's kind, bearing and size given A's, over their density among B's features [m].
        density_a: (kinds,) features of A per metre.
        density_b: (kinds,) features of B per metre.
    """

    base: np.ndarray
    density_a: np.ndarray
    density_b: np.ndarray


def likeness(a: FeatureList, b: FeatureList, options: MatchOptions) -> Likeness:
    """Return the weights of all pairs; b driven the same way as a."""
    density_a, density_b = (np.bincount(f.kind, minlength=len(KINDS)) / max(f.length, 1.0) for f in (a, b))
    wrong = options.kind_error / (len(KINDS) - 1)
    kinds = np.where(a.kind[:, None] == b.kind[None, :], 1.0 - options.kind_error, wrong)
    base = kinds / density_b[b.kind]
    turn = np.mod(a.bearing[:, None] - b.bearing[None, :] + np.pi, 2 * np.pi) - np.pi
    turn_b = np.mod(b.bearing[:, None] - b.bearing[None, :] + np.pi, 2 * np.pi) - np.pi
    near = np.where(np.abs(turn) > options.bearing_limit, np.inf, turn)
    base *= _ratio(near, turn_b, b.kind, options.bearing_sigma, options.bearing_outliers, 2 * np.pi)
    with np.errstate(divide="ignore", invalid="ignore"):
        log_a, log_b = np.log(a.size), np.log(b.size)
    grow, grow_b = log_a[:, None] - log_b[None, :], log_b[:, None] - log_b[None, :]
    base *= _ratio(grow, grow_b, b.kind, options.size_sigma, options.size_outliers, 4.0)
    return Likeness(base, density_a, density_b)


def _ratio(
    pairs: np.ndarray, own: np.ndarray, kind: np.ndarray, sigma: float, outliers: float, span: float
) -> np.ndarray:
    """Return p(value of B | value of A) over the density of values among B's features of the kind; 1 where unknown.

    The density is a kernel estimate from B itself with a uniform part, so that common values (taps at 3 and 9 o'clock)
    weigh little and rare ones much.
    """
    known = np.isfinite(np.diag(own)) if own.size else np.zeros(0, bool)
    same = (kind[:, None] == kind[None, :]) & known
    near = np.where(same, _normal(own, np.sqrt(2.0) * sigma), 0.0)
    background = (near.sum(axis=1) + _PRIOR_COUNT / span) / (same.sum(axis=1) + _PRIOR_COUNT)
    ratio = (1.0 - outliers) * _normal(pairs, sigma) / background + outliers
    return np.where(np.isnan(pairs), 1.0, ratio)


def _normal(x: np.ndarray, sigma: float) -> np.ndarray:
    return np.exp(-0.5 * (x / sigma) ** 2) / (np.sqrt(2 * np.pi) * sigma)


@dataclass(frozen=True)
class Weights:
    """Weights at given shared fractions.

    Attributes:
        shared: (n,) probability of each feature of A to be in B.
        pairs: (n, m) what `chain.emission` multiplies the density of a pair's distance by.
        sums: (m + 1,) log weight of B's own features up to each of them.
        rate: Log weight of each metre that both have inspected [1/m].
    """

    shared: np.ndarray
    pairs: np.ndarray
    sums: np.ndarray
    rate: float

    def stretch(self, b: FeatureList, y: np.ndarray) -> np.ndarray:
        """Return the log weight of B's own features up to chainage y (any shape) within a stretch common to both."""
        metres = np.minimum(np.maximum(y, b.extent[0]), b.extent[1]) - b.extent[0]
        return self.sums[np.searchsorted(b.chainage, y)] + self.rate * metres


def weigh(like: Likeness, a: FeatureList, b: FeatureList, shared: np.ndarray) -> Weights:
    """Return the weights at shared fractions (kinds,) of A's features that B has.

    As many features are common seen from B as from A, so the fraction of B's features that A has follows.
    """
    of_b = np.zeros_like(shared)
    there = like.density_b > 0
    of_b[there] = np.minimum(shared * like.density_a, _MOST_SHARED * like.density_b)[there] / like.density_b[there]
    own = 1.0 - of_b[b.kind]
    mine = shared[a.kind]
    sums = np.concatenate(([0.0], np.cumsum(np.log(own))))
    return Weights(mine, like.base * (mine[:, None] / own), sums, float(of_b @ like.density_b))
