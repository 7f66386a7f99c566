"""Alignments of two lists, from either end and from starts near or far apart: how probable each is, and why none is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from .fit import Sense
from .overlap import overlaps
from .rival import another_pipe

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .features import FeatureList
    from .fit import Fit
    from .options import MatchOptions

_HOPELESS = 60.0
_WHOLE = (False, 0, 0, 0.0), (True, 0, 0, 0.0)  # sense and place of both lists as they are


@dataclass(frozen=True)
class Alignment:
    """One sense of travel, and one stretch that both lists may have in common.

    Attributes:
        sense: Its chain.
        fit: The state that fits best.
        turned: Whether B was driven from the other end.
        first_a, first_b: Index of the chain's first features in A, and in B seen in A's sense.
        log_prior: Of starts so far apart, against equal ones.
    """

    sense: Sense
    fit: Fit
    turned: bool
    first_a: int = 0
    first_b: int = 0
    log_prior: float = 0.0

    @cached_property
    def rival(self) -> float:
        """Log evidence of another pipe, aligned alike."""
        return another_pipe(self.sense, self.fit)

    @property
    def over_rival(self) -> float:
        """Log evidence, with its prior, beside that of another pipe.

        Joints of one module fall into step the more, the longer the stretch: what they gain another pipe gains too.
        """
        return self.fit.total + self.log_prior - self.rival


@dataclass(frozen=True)
class Judged:
    """The best of several alignments.

    Attributes:
        best: That with the most evidence.
        direction: Posterior of its sense of travel.
        same: Posterior of one pipe, against the better rival.
        evidence: Log of its odds before the prior.
        reason: Why it is refused; empty when it is not.
    """

    best: Alignment
    direction: float
    same: float
    evidence: float
    reason: str


def align(a: FeatureList, b: FeatureList, options: MatchOptions) -> Judged | None:
    """Return the best alignment of two lists; None when no stretch of one looks like one of the other.

    Starts near each other are tried first. Stretches whose starts lie far apart are tried where that is refused, or
    where the lists' lengths differ by more than a grid of drift can span.
    """
    lists = b, b.mirrored()
    whole = [Sense(a, one, options) for one in lists]
    near = [] if whole[0].coarse_grid else _fitted(whole, _WHOLE)
    if near and not (judged := _judged_near(near, options)).reason:
        return judged
    cuts = [(cut, turned) for turned, one in enumerate(lists) for cut in overlaps(a, one, options)]
    far = _fitted(
        [cut.sense(options) for cut, _ in cuts],
        [(bool(turned), cut.first_a, cut.first_b, cut.log_prior) for cut, turned in cuts],
    )
    if not far:
        return judged if near else None
    return _judged_far(near + far, options)


def _fitted(senses: Sequence[Sense], where: Sequence[tuple[bool, int, int, float]]) -> list[Alignment]:
    """Return the alignments that are not hopeless beside the best of them."""
    likely: list[tuple[np.ndarray, np.ndarray] | None] = [None] * len(senses)
    heads = [s.head() for s in senses]
    if all(heads):
        likely = _worth([head.coarse() for head in heads])
    looked = [s.coarse(within=one) if one or not all(heads) else None for s, one in zip(senses, likely, strict=True)]
    worth = zip(senses, _worth(looked), where, strict=True)
    return [Alignment(s, s.fit(one), *place) for s, one, place in worth if one]


def _worth(coarse: list[tuple[np.ndarray, np.ndarray] | None]) -> list[tuple[np.ndarray, np.ndarray] | None]:
    """Return those of the scales and log evidences of all senses that are not hopeless."""
    top = max((one[1].max() for one in coarse if one), default=-np.inf)
    return [one if one and one[1].max() > top - _HOPELESS else None for one in coarse]


def _judged_near(alignments: Sequence[Alignment], options: MatchOptions) -> Judged:
    """Return the best of alignments of the same stretch."""
    best = max(alignments, key=lambda one: one.fit.total)
    return _judged(best, alignments, [one.fit.total - best.rival for one in alignments], options)


def _judged_far(alignments: Sequence[Alignment], options: MatchOptions) -> Judged:
    """Return the best of alignments of several stretches."""
    best = max(alignments, key=lambda one: one.over_rival)
    return _judged(best, alignments, [one.over_rival for one in alignments], options)


def _judged(best: Alignment, alignments: Sequence[Alignment], over: Sequence[float], options: MatchOptions) -> Judged:
    """Return the posteriors where `over` are the log evidences of the alignments beside that of another pipe."""
    by_sense = [[v for v, one in zip(over, alignments, strict=True) if one.turned == t] for t in (False, True)]
    totals = np.array([np.logaddexp.reduce(one) if one else -np.inf for one in by_sense])
    ahead = totals[int(best.turned)] - totals[1 - int(best.turned)]
    direction = float(1.0 / (1.0 + np.exp(-min(ahead, 700.0))))
    evidence = float(np.logaddexp(*totals) - np.log(2.0))
    odds = evidence + np.log(options.prior_same / (1.0 - options.prior_same))
    same = float(1.0 / (1.0 + np.exp(-np.clip(odds, -700.0, 700.0))))
    return Judged(best, direction, same, evidence, _refusal(options, same, direction))


def _refusal(options: MatchOptions, same: float, direction: float) -> str:
    """Return why a match with these posteriors is refused; empty when it is not."""
    if same < options.accept_same:
        return (
            f"the features do not show that both inspections saw the same pipe: probability {same:.2f}, "
            f"at least {options.accept_same:g} is asked for"
        )
    if direction < options.accept_same:
        return f"the features do not tell from which end the second was driven: probability {direction:.2f}"
    return ""
