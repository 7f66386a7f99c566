"""Match two inspections of one pipe by their features; the model is in docs/compare.md."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from .alignment import align
from .features import JOINT, KINDS
from .options import MatchOptions
from .placing import place
from .result import Drift, Match, Pairs, Span

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .alignment import Judged
    from .features import FeatureList
    from .fit import Fit, Sense
    from .placing import Placed

_FEWEST = 2
_TELLING = 0.88


def match(a: FeatureList, b: FeatureList, options: MatchOptions | None = None) -> Match:
    """Return which features of `b` are which of `a`, and where every chainage of `a` lies in `b`.

    Features that repeat another of their list in place, kind, bearing and size are paired once.

    Args:
        a: Features of the first inspection.
        b: Features of the second, as its own counter and operator gave them, from whichever end.
        options: Priors and limits; `MatchOptions()` suits features measured by a profiler, `MatchOptions.cctv()`
            observations coded by eye.

    Raises:
        InputError: A list has fewer than two features, or all of them at one place.

    Source: docs/compare.md. Forward-backward passes: L. R. Rabiner, Proc. IEEE 77 (1989) 257-286.

    >>> import numpy as np
    >>> from springline.compare import feature_list, match
    >>> x = np.array([0.0, 2.5, 5.02, 7.49, 10.0, 12.53, 15.0])
    >>> kind = ["joint", "joint", "lateral", "joint", "lateral", "joint", "joint"]
    >>> bearing = [np.nan, np.nan, 0.2, np.nan, 2.9, np.nan, np.nan]
    >>> a = feature_list(x, kind, bearing=bearing)
    >>> found = match(a, feature_list(1.004 * x + 1.2, kind, bearing=bearing).mirrored())
    >>> found.reversed, len(found.pairs)
    (True, 7)
    """
    options = options or MatchOptions()
    index_a, index_b = a.first_of_each(), b.first_of_each()
    for one in (a, b):
        _check(one)
    judged = align(a.take(index_a), b.take(index_b), options)
    if judged is None:
        return _unlike(a)
    best = judged.best
    placed = place(best.sense, best.fit, a.extent)
    in_b = placed.index_b + best.first_b
    pairs = index_a[placed.index_a + best.first_a], index_b[len(index_b) - 1 - in_b if best.turned else in_b]
    reason = (
        judged.reason or _joints_alone(best.sense, best.fit, a.kind[pairs[0]]) or _nothing_common(pairs[0], options)
    )
    return _result(a, b, options, judged, replace(placed, index_a=pairs[0], index_b=pairs[1]), reason)


def _check(one: FeatureList) -> None:
    """Refuse a list whose features stand at one place."""
    if np.unique(one.chainage).size >= _FEWEST:
        return
    many = len(one) > 1
    raise InputError(
        f"its {len(one)} features all stand at {one.chainage[0]:g} m" if many else "it holds a single feature",
        where=one.name,
        expected=("features at two places at least" if many else "at least two")
        + ": one cannot tell an offset from a change of scale",
        mend="check which column holds the chainage" if many else "add joints, laterals or manholes to the list",
    )


def match_any(a: FeatureList, others: Sequence[FeatureList], options: MatchOptions | None = None) -> list[Match]:
    """Return the match of `a` with each of `others`, in their order: one tally against many."""
    return [match(a, b, options) for b in others]


def _joints_alone(sense: Sense, fit: Fit, kinds: np.ndarray) -> str:
    """Return why joints cannot be told apart; empty when another kind is paired or their spacing tells them."""
    if not sense.laid.regular or (kinds != JOINT).any() or sense.telling(fit.state) >= _TELLING:
        return ""
    return (
        f"only joints of one module ({sense.laid.module:.2f} m) are common to both, and their spacing varies by "
        f"{1e3 * sense.laid.spacing:.0f} mm, too little beside the noise of {1e3 * fit.state.noise:.0f} mm, to tell "
        "one from the next: add laterals, bends or manholes to the lists"
    )


def _nothing_common(pairs: np.ndarray, options: MatchOptions) -> str:
    return (
        "" if pairs.size else f"no feature of one is surely one of the other: no pair reaches {options.accept_pair:g}"
    )


def _result(
    a: FeatureList, b: FeatureList, options: MatchOptions, judged: Judged, placed: Placed, reason: str
) -> Match:
    accepted = not reason
    best = judged.best
    state = best.fit.state
    pairs, drift, flagged = _nothing() if reason else _placed(b, options, best.turned, placed)
    return Match(
        accepted=accepted,
        reason=reason,
        probability_same=judged.same,
        evidence=judged.evidence,
        reversed=best.turned,
        probability_direction=judged.direction,
        scale=state.scale,
        noise=state.noise,
        walk=state.walk,
        shared={k: float(state.shared[i]) for i, k in enumerate(KINDS) if np.any(a.kind == i)},
        pairs=pairs,
        drift=drift,
        flagged=flagged if accepted else (Span(*a.extent, reason),),
    )


def _unlike(a: FeatureList) -> Match:
    reason = "no stretch of one is like a stretch of the other"
    nan = float("nan")
    return Match(False, reason, 0.0, nan, False, 0.5, nan, nan, nan, {}, *_nothing()[:2], (Span(*a.extent, reason),))


def _nothing() -> tuple[Pairs, Drift, tuple[Span, ...]]:
    none, index = np.empty(0), np.empty(0, np.int64)
    return Pairs(index, index, none, none), Drift(none, none, none, none, 0.0), ()


def _placed(
    b: FeatureList, options: MatchOptions, turned: bool, placed: Placed
) -> tuple[Pairs, Drift, tuple[Span, ...]]:
    """Return pairs, drift and flags in B's own chainage."""
    y, sign = (sum(b.extent) - placed.chainage_b, -1.0) if turned else (placed.chainage_b, 1.0)
    pairs = Pairs(placed.index_a, placed.index_b, placed.probability, sign * placed.residual)
    drift = Drift(placed.chainage_a, y, placed.sigma, placed.mode_probability, placed.spread)
    return pairs, drift, drift.doubtful(b.extent, options.sigma_limit, margin=options.sigma_limit)
