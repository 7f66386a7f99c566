"""What a match of two inspections says: pairs, drift, and where it cannot say."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ONE_PLACE = 0.95
"""Probability from which a place is the only one."""


@dataclass(frozen=True)
class Pairs:
    """Features seen in both inspections, in the order of A.

    Attributes:
        index_a: (k,) index into A's features.
        index_b: (k,) index into B's features, as B was given.
        probability: (k,) posterior of each pair.
        residual: (k,) chainage in B less the drift's [m], positive when B's feature lies further along B.
    """

    index_a: np.ndarray
    index_b: np.ndarray
    probability: np.ndarray
    residual: np.ndarray

    def __len__(self) -> int:
        return len(self.index_a)


@dataclass(frozen=True)
class Drift:
    """Chainage in B as a function of chainage in A.

    Attributes:
        chainage_a: (n,) nodes [m], rising.
        chainage_b: (n,) where they lie in B [m]; falling when B was driven from the other end.
        sigma: (n,) one-sigma [m].
        mode_probability: (n,) probability that the node lies at that place, rather than at another.
        spread: Variance that a metre between nodes adds [m], by the odometers' walk and slips.
    """

    chainage_a: np.ndarray
    chainage_b: np.ndarray
    sigma: np.ndarray
    mode_probability: np.ndarray
    spread: float

    def at(self, chainage: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return chainage in B and its one-sigma [m] at `chainage` in A [m]; NaN outside the nodes.

        >>> d = Drift(np.array([0.0, 10.0]), np.array([1.0, 11.1]), np.array([0.01, 0.01]), np.ones(2), 1e-5)
        >>> [float(v.round(4)) for v in d.at(5.0)]
        [6.05, 0.0087]
        """
        x = np.asarray(chainage, dtype=np.float64)
        if len(self.chainage_a) < 2:
            return np.full(x.shape, np.nan), np.full(x.shape, np.nan)
        i = np.clip(np.searchsorted(self.chainage_a, x, side="right") - 1, 0, len(self.chainage_a) - 2)
        gap = self.chainage_a[i + 1] - self.chainage_a[i]
        t = np.clip((x - self.chainage_a[i]) / np.where(gap > 0, gap, 1.0), 0.0, 1.0)
        y = (1 - t) * self.chainage_b[i] + t * self.chainage_b[i + 1]
        ends = ((1 - t) * self.sigma[i]) ** 2 + (t * self.sigma[i + 1]) ** 2
        sigma = np.sqrt(ends + self.spread * gap * t * (1 - t))
        outside = ~((x >= self.chainage_a[0]) & (x <= self.chainage_a[-1]))
        return np.where(outside, np.nan, y), np.where(outside, np.nan, sigma)

    def clear(self, chainage: np.ndarray, flagged: tuple[Span, ...]) -> np.ndarray:
        """Return whether `chainage` in A [m] (any shape) has a place in B and lies in none of the stretches."""
        x = np.asarray(chainage, dtype=np.float64)
        good = np.isfinite(self.at(x)[0])
        for span in flagged:
            good &= ~((x >= span.start) & (x <= span.end))
        return good

    def doubtful(self, extent_b: tuple[float, float], sigma_limit: float, margin: float = 0.0) -> tuple[Span, ...]:
        """Return the stretches of A whose place is not to be relied on, half-way to the next good node.

        Args:
            extent_b: First and last chainage of B [m].
            sigma_limit: Largest one-sigma that is good [m].
            margin: How far outside `extent_b` a node may lie [m].
        """
        x, y = self.chainage_a, self.chainage_b
        why = np.full(len(x), "", dtype=object)
        why[self.sigma > sigma_limit] = f"one-sigma above {sigma_limit:g} m"
        why[self.mode_probability < ONE_PLACE] = "more than one place is likely"
        why[(y < extent_b[0] - margin) | (y > extent_b[1] + margin)] = "not inspected by both"
        edges = np.concatenate((x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]))
        spans: list[Span] = []
        for i in np.flatnonzero(why != ""):
            start = float(edges[i])
            if spans and spans[-1].reason == why[i] and spans[-1].end == start:
                start = spans.pop().start
            spans.append(Span(start, float(edges[i + 1]), why[i]))
        return tuple(spans)


@dataclass(frozen=True)
class Span:
    """A stretch of A [m] in which the match is not to be relied on, and why."""

    start: float
    end: float
    reason: str


@dataclass(frozen=True)
class Match:
    """Two inspections matched, or refused; true when matched.

    Attributes:
        accepted: Whether both saw the same pipe, as far as the features tell.
        reason: Why not; empty when accepted.
        probability_same: Posterior that both saw the same pipe.
        evidence: Log of the odds of the same pipe over the better rival, before the prior.
        reversed: Whether B was driven from the other end.
        probability_direction: Posterior of that sense of travel.
        scale: Odometer of B over that of A.
        noise: One-sigma of a feature's chainage in one inspection [m], as found.
        walk: Drift of one odometer against the other [m per root m], as found.
        shared: Fraction of A's features found in B, by kind.
        pairs: Features seen in both; none when refused.
        drift: Chainage in B by chainage in A; without nodes when refused.
        flagged: Stretches of A not to be relied on.
    """

    accepted: bool
    reason: str
    probability_same: float
    evidence: float
    reversed: bool
    probability_direction: float
    scale: float
    noise: float
    walk: float
    shared: dict[str, float]
    pairs: Pairs
    drift: Drift
    flagged: tuple[Span, ...]

    def __bool__(self) -> bool:
        return self.accepted

    def reliable(self, chainage: np.ndarray) -> np.ndarray:
        """Return whether `chainage` in A [m] (any shape) has a place in B and lies in no flagged stretch."""
        return self.drift.clear(chainage, self.flagged)
