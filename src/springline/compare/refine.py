"""From features to rings: where each ring of A lies in B, by the relief of the wall; the model: docs/compare.md."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .options import MatchOptions
from .pieces import FLOOR, UPRIGHT_SIGMA, Base, KnownPairs, Tracked, level, place_pieces
from .registration import Registration
from .result import ONE_PLACE, Drift, Span

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .features import FeatureList
    from .result import Match
    from .wall import Wall

_MARGIN = 0.35  # m beside the drift that features gave
_COARSE_WALK = 0.012  # m per root m: bears an odometer scale of 1 % from piece to piece
_FINE_SIGMA = 0.003  # m
_SURE = 20.0  # nats of relief that tell one pipe from two, and one sense of travel from the other
_SLIP = 0.005  # m
_MOST_TURN = np.radians(15.0)  # from piece to piece
_SLIP_REACH = 0.1  # m: a slip takes some way


def refine(
    match: Match | None,
    a: Wall,
    b: Wall,
    features: tuple[FeatureList, FeatureList] | None = None,
    options: MatchOptions | None = None,
) -> Registration | None:
    """Return where A's rings lie in B, by the wall's relief together with matched features.

    Each piece of A's wall is laid on B at every drift and roll; the likelihood ratio of one wall to two independent
    ones (`texture`) joins the matched features in the chain of the drift. Where the relief says nothing, the features
    alone remain; where it contradicts them, it decides.

    Args:
        match: Of the features; None, or refused, when the relief alone must tell.
        a: Wall of the first inspection.
        b: Wall of the second, as driven.
        features: The lists that `match` was made from.
        options: Priors, as for `match`.

    Returns:
        The registration; None when neither features nor relief tell.
    """
    options = options or MatchOptions()
    if match is None or not match.accepted or features is None:
        return _by_relief(a, b, options)
    turned = b.mirrored() if match.reversed else b
    back = sum(b.extent)
    nodes_y = back - match.drift.chainage_b if match.reversed else match.drift.chainage_b
    y = features[1].chainage[match.pairs.index_b]
    pairs = KnownPairs(
        features[0].chainage[match.pairs.index_a],
        back - y if match.reversed else y,
        match.pairs.probability,
        match.noise,
    )
    x = match.drift.chainage_a
    trend = nodes_y - match.scale * (x - x[0])
    y0 = float(np.median(trend))
    low, high = float(trend.min() - y0 - _MARGIN), float(trend.max() - y0 + _MARGIN)
    base = Base(float(x[0]), y0, match.scale, low, high)
    found = place_pieces(a, turned, base, pairs, match.walk, options)
    if found is None:
        # A rough wall that does not agree where the features put it may agree elsewhere, and then it is surer.
        return _by_relief(a, b, options) or _features_alone(match, a, turned, b.extent, options)
    return _registration(found, a, turned, b.extent, match.reversed, options, match.flagged)


def _by_relief(a: Wall, b: Wall, options: MatchOptions) -> Registration | None:
    """Return the registration by relief alone, from whichever end B was driven; None when it does not tell."""
    best, tops = None, []
    for turned in (False, True):
        other = b.mirrored() if turned else b
        limit = options.offset_limit or 12.0 + abs(np.diff(a.extent)[0] - np.diff(b.extent)[0])
        base = Base(a.extent[0], other.extent[0], 1.0, -limit, limit)
        found = place_pieces(a, other, base, None, _COARSE_WALK, options, coarse=True)
        if found is None:
            return None
        tops.append(found[0].log_evidence)
        if best is None or tops[-1] > best[0][0].log_evidence:
            best = found, other, turned
    (track, _, _), other, turned = best
    if max(tops) < _SURE or abs(tops[0] - tops[1]) < _SURE:
        return None
    good = track.probability > ONE_PLACE
    if good.sum() < 2:
        return None
    scale, y0 = _line(track.x[good], track.y[good])
    off = track.y[good] - (y0 + scale * track.x[good])
    base = Base(0.0, y0, scale, float(off.min()) - 0.1, float(off.max()) + 0.1)
    found = place_pieces(a, other, base, None, options.walk, options)
    if found is None:
        return None
    return _registration(found, a, other, b.extent, turned, options, ())


def _line(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Return slope and intercept of a straight line that bears outliers."""
    from scipy.stats import theilslopes

    slope, intercept, *_ = theilslopes(y, x)
    return float(slope), float(intercept)


def _registration(
    found: tuple, a: Wall, b: Wall, extent_b: tuple[float, float], turned: bool, options: MatchOptions,
    flagged: tuple[Span, ...],
) -> Registration:  # fmt: skip
    track, (roll, roll_sigma), agreement = found
    fine = (track.sigma < _FINE_SIGMA) & (track.probability > ONE_PLACE)
    spread = options.walk**2 + 2.0 * options.slip_rate * options.slip_scale**2
    x, y, sigma, probability = _to_ends(track, a.extent, spread)
    ends = [np.r_[v[0], v, v[-1]] for v in (fine, roll, roll_sigma)]
    spans = (*(s for s in flagged if s.reason == "not inspected by both"), *_slips(x, y, sigma))
    if turned:
        y = sum(extent_b) - y
    drift = Drift(x, y, sigma, probability, options.walk**2)
    spans += _turns(x, ends[1])
    spans += drift.doubtful(extent_b, options.sigma_limit)
    return Registration(
        drift, ends[0], ends[1], ends[2], "relief", turned, extent_b, agreement, track.log_evidence, spans
    )


def _to_ends(track: Tracked, extent: tuple[float, float], spread: float) -> tuple[NDArray, ...]:
    """Return nodes carried on to the ends of A with the usual scale."""
    scale = float(np.median(np.diff(track.y) / np.diff(track.x))) if len(track.x) > 1 else 1.0
    out = [extent[0] - track.x[0], extent[1] - track.x[-1]]
    return (
        np.r_[extent[0], track.x, extent[1]],
        np.r_[track.y[0] + scale * out[0], track.y, track.y[-1] + scale * out[1]],
        np.r_[np.hypot(track.sigma[0], FLOOR), track.sigma, np.hypot(track.sigma[-1], FLOOR)],
        np.r_[track.probability[0], track.probability, track.probability[-1]],
    )


def _slips(x: NDArray, y: NDArray, sigma: NDArray) -> tuple[Span, ...]:
    """Return the stretches between nodes in which one odometer slipped, somewhere."""
    gap, rise = np.diff(x), np.diff(y)
    scale = float(np.median(rise / gap))
    off = np.abs(rise - scale * gap)
    least = _SLIP + 4.0 * np.hypot(sigma[1:], sigma[:-1])
    return tuple(
        Span(float(x[i]) - _SLIP_REACH, float(x[i + 1]) + _SLIP_REACH, "an odometer slipped somewhere in it")
        for i in np.flatnonzero(off > least)
    )


def _turns(x: NDArray, roll: NDArray) -> tuple[Span, ...]:
    """Return the stretches between nodes in which the roll turns further than a robot does: one of them is wrong."""
    turn = np.abs(np.mod(np.diff(roll) + np.pi, 2 * np.pi) - np.pi)
    return tuple(
        Span(float(x[i]), float(x[i + 1]), "how the sensor was rolled is not certain")
        for i in np.flatnonzero(turn > _MOST_TURN)
    )


def _features_alone(
    match: Match, a: Wall, b: Wall, extent_b: tuple[float, float], options: MatchOptions
) -> Registration:
    """Return the registration that features alone give: a smooth wall adds nothing."""
    n = len(match.drift.chainage_a)
    upright = np.isfinite(level(a, b))
    return Registration(
        match.drift, np.zeros(n, bool), np.zeros(n), np.full(n, UPRIGHT_SIGMA if upright else np.nan),
        "vertical" if upright else "assumed", match.reversed, extent_b, np.nan, 0.0, match.flagged,
    )  # fmt: skip
