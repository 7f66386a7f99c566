"""Match two inspections of one pipe by their features; the model is in docs/compare.md."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from .features import JOINT, KINDS
from .fit import Sense
from .options import MatchOptions
from .placing import Placed, place
from .result import Drift, Match, Pairs, Span
from .rival import another_pipe

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .features import FeatureList
    from .fit import Fit

_FEWEST = 2
_HOPELESS = 60.0
_TELLING = 0.88


def match(a: FeatureList, b: FeatureList, options: MatchOptions | None = None) -> Match:
    """Return which features of `b` are which of `a`, and where every chainage of `a` lies in `b`.

    Args:
        a: Features of the first inspection.
        b: Features of the second, as its own counter and operator gave them, from whichever end.
        options: Priors and limits; `MatchOptions()` suits features measured by a profiler, `MatchOptions.cctv()`
            observations coded by eye.

    Raises:
        InputError: A list has fewer than two features.

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
    for one in (a, b):
        if len(one) < _FEWEST:
            raise InputError(
                "it holds a single feature",
                where=one.name,
                expected="at least two: one cannot tell an offset from a change of scale",
                mend="add joints, laterals or manholes to the list",
            )
    senses = Sense(a, b, options), Sense(a, b.mirrored(), options)
    fits = _fits(senses)
    totals = np.array([f.total if f else -np.inf for f in fits])
    best = int(totals[1] > totals[0])
    sense, fit = senses[best], fits[best]
    direction = float(1.0 / (1.0 + np.exp(-min(totals[best] - totals[1 - best], 700.0))))
    same = _probability_same(sense, fit, float(np.logaddexp(*totals) - np.log(2.0)))
    placed = place(sense, fit)
    reason = _refusal(options, same, direction) or _joints_alone(sense, fit, a.kind[placed.index_a])
    return _result(a, b, options, bool(best), direction, same, fit, placed, reason)


def _fits(senses: tuple[Sense, Sense]) -> list[Fit | None]:
    """Return the fit of each sense of travel; None for one that is hopeless beside the other."""
    likely: list[tuple[np.ndarray, np.ndarray] | None] = [None, None]
    heads = [s.head() for s in senses]
    if all(heads):
        likely = _worth([head.coarse() for head in heads])
    looked = [s.coarse(within=one) if one or not all(heads) else None for s, one in zip(senses, likely, strict=True)]
    return [one and s.fit(one) for s, one in zip(senses, _worth(looked), strict=True)]


def _worth(coarse: list[tuple[np.ndarray, np.ndarray] | None]) -> list[tuple[np.ndarray, np.ndarray] | None]:
    """Return those of the scales and log evidences of both senses that are not hopeless."""
    top = max(one[1].max() for one in coarse if one)
    return [one if one and one[1].max() > top - _HOPELESS else None for one in coarse]


def match_any(a: FeatureList, others: Sequence[FeatureList], options: MatchOptions | None = None) -> list[Match]:
    """Return the match of `a` with each of `others`, in their order: one tally against many."""
    return [match(a, b, options) for b in others]


def _probability_same(sense: Sense, fit: Fit, total: float) -> float:
    """Return the posterior of one pipe against the better of its rivals; `total` is the log evidence of one pipe."""
    rival = another_pipe(sense, fit)
    prior = sense.options.prior_same
    odds = total - rival + np.log(prior / (1.0 - prior))
    return float(1.0 / (1.0 + np.exp(-np.clip(odds, -700.0, 700.0))))


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


def _joints_alone(sense: Sense, fit: Fit, kinds: np.ndarray) -> str:
    """Return why joints cannot be told apart; empty when another kind is paired or their spacing tells them."""
    if not sense.laid.regular or (kinds != JOINT).any() or sense.telling(fit.state) >= _TELLING:
        return ""
    return (
        f"only joints of one module ({sense.laid.module:.2f} m) are common to both, and their spacing varies by "
        f"{1e3 * sense.laid.spacing:.0f} mm, too little beside the noise of {1e3 * fit.state.noise:.0f} mm, to tell "
        "one from the next: add laterals, bends or manholes to the lists"
    )


def _result(
    a: FeatureList, b: FeatureList, options: MatchOptions, turned: bool, direction: float, same: float, fit: Fit,
    placed: Placed, reason: str,
) -> Match:  # fmt: skip
    accepted = not reason
    pairs, drift, flagged = _nothing() if reason else _placed(b, options, turned, placed)
    return Match(
        accepted=accepted,
        reason=reason,
        probability_same=same,
        reversed=turned,
        probability_direction=direction,
        scale=fit.state.scale,
        noise=fit.state.noise,
        walk=fit.state.walk,
        shared={k: float(fit.state.shared[i]) for i, k in enumerate(KINDS) if np.any(a.kind == i)},
        pairs=pairs,
        drift=drift,
        flagged=flagged if accepted else (Span(*a.extent, reason),),
    )


def _nothing() -> tuple[Pairs, Drift, tuple[Span, ...]]:
    none, index = np.empty(0), np.empty(0, np.int64)
    return Pairs(index, index, none, none), Drift(none, none, none, none, 0.0), ()


def _placed(
    b: FeatureList, options: MatchOptions, turned: bool, placed: Placed
) -> tuple[Pairs, Drift, tuple[Span, ...]]:
    """Return pairs, drift and flags in B's own chainage."""
    y, sign = placed.chainage_b, 1.0
    index_b = placed.index_b
    if turned:
        y, sign, index_b = sum(b.extent) - y, -1.0, len(b) - 1 - index_b
    residual = sign * placed.residual
    pairs = Pairs(placed.index_a, index_b, placed.probability, residual)
    drift = Drift(placed.chainage_a, y, placed.sigma, placed.mode_probability, placed.spread)
    return pairs, drift, drift.doubtful(b.extent, options.sigma_limit, margin=options.sigma_limit)
