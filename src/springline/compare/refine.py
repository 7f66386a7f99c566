"""From features to rings: where each ring of A lies in B, by the relief of the wall; the model: docs/compare.md."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from . import chain
from .options import MatchOptions
from .registration import Registration
from .result import Drift, Span
from .rolls import track_roll
from .texture import log_ratio, prepare, relief, shared

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .features import FeatureList
    from .result import Match
    from .texture import Relief, Shared
    from .wall import Wall

_PIECE = 0.5  # m of wall that are placed as one
_LEAST_RINGS = 16
_FINEST = 0.002  # m
_MARGIN = 0.35  # m beside the drift that features gave
_COARSE_WALK = 0.012  # m per root m: bears an odometer scale of 1 % from piece to piece
_ONE_PLACE = 0.95
_FINE_SIGMA = 0.003  # m
_HALF_MODE = 0.03  # m
_LEAST_AGREEMENT = 0.15
_SURE = 20.0  # nats of relief that tell one pipe from two, and one sense of travel from the other
_UPRIGHT_SIGMA = np.radians(3.0)
_FLOOR = 5e-4  # m: what a straight piece of a drift that bends may be off
_SLIP = 0.005  # m
_SLIP_REACH = 0.1  # m: a slip takes some way


@dataclass(frozen=True)
class _Base:
    """A straight guess of B's chainage, y0 + scale (x - x0), and the range of drift from it that is looked at [m]."""

    x0: float
    y0: float
    scale: float
    low: float
    high: float

    def at(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.y0 + self.scale * (x - self.x0)


@dataclass(frozen=True)
class _Pairs:
    """Chainages of matched features [m], B's along A's travel, their probability, and one-sigma of a chainage [m]."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    probability: NDArray[np.float64]
    noise: float


@dataclass(frozen=True)
class _Tracked:
    """The chain of pieces: their middles [m], drift [m], its variance, probability of that place, and the evidence."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    sigma: NDArray[np.float64]
    probability: NDArray[np.float64]
    log_evidence: float


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
    pairs = _Pairs(
        features[0].chainage[match.pairs.index_a],
        back - y if match.reversed else y,
        match.pairs.probability,
        match.noise,
    )
    x = match.drift.chainage_a
    trend = nodes_y - match.scale * (x - x[0])
    y0 = float(np.median(trend))
    low, high = float(trend.min() - y0 - _MARGIN), float(trend.max() - y0 + _MARGIN)
    base = _Base(float(x[0]), y0, match.scale, low, high)
    found = _place(a, turned, base, pairs, match.walk, options)
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
        base = _Base(a.extent[0], other.extent[0], 1.0, -limit, limit)
        found = _place(a, other, base, None, _COARSE_WALK, options, coarse=True)
        if found is None:
            return None
        tops.append(found[0].log_evidence)
        if best is None or tops[-1] > best[0][0].log_evidence:
            best = found, other, turned
    (track, _, _), other, turned = best
    if max(tops) < _SURE or abs(tops[0] - tops[1]) < _SURE:
        return None
    good = track.probability > _ONE_PLACE
    if good.sum() < 2:
        return None
    scale, y0 = _line(track.x[good], track.y[good])
    off = track.y[good] - (y0 + scale * track.x[good])
    base = _Base(0.0, y0, scale, float(off.min()) - 0.1, float(off.max()) + 0.1)
    found = _place(a, other, base, None, options.walk, options)
    if found is None:
        return None
    return _registration(found, a, other, b.extent, turned, options, ())


def _line(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Return slope and intercept of a straight line that bears outliers."""
    from scipy.stats import theilslopes

    slope, intercept, *_ = theilslopes(y, x)
    return float(slope), float(intercept)


def _place(
    a: Wall, b: Wall, base: _Base, pairs: _Pairs | None, walk: float, options: MatchOptions, *, coarse: bool = False
) -> tuple[_Tracked, tuple, float] | None:
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
        rolls, agreement = track_roll(prepare(relief_a, at_b, both), both, _pieces(len(grid), step), step, _level(a, b))
        if agreement < _LEAST_AGREEMENT:
            return None
        if agreement > 0.9:
            break
        both = both.times(agreement)
    return track, rolls, agreement


def _level(a: Wall, b: Wall) -> float:
    """Return the one-sigma [rad] to which both verticals are known; infinite when one is not."""
    return _UPRIGHT_SIGMA if a.upright() and b.upright() else np.inf


def _pieces(rows: int, step: float) -> list[slice]:
    """Return A's rows in pieces of about half a metre."""
    size = max(_LEAST_RINGS, round(_PIECE / step))
    count = max(1, rows // size)
    edges = np.rint(np.linspace(0, rows, count + 1)).astype(int)
    return [slice(int(i), int(j)) for i, j in pairwise(edges)]


def _chain(
    relief_a: Relief, relief_b: Relief, both: Shared, grid: NDArray, step: float, base: _Base, shifts: tuple,
    pairs: _Pairs | None, walk: float, options: MatchOptions, a: Wall, b: Wall, coarse: bool,
) -> _Tracked:  # fmt: skip
    filtered = prepare(relief_a, relief_b, both)
    fine = 1 if coarse else max(1, int(np.ceil(base.scale * step / _FINEST)))
    cell = base.scale * step / fine
    most = int(shifts[1] - shifts[0])
    drift = base.scale * step * shifts[0] + cell * np.arange(most * fine + 1)
    pieces = _pieces(len(grid), step)
    prior = _roll_prior(relief_a.field.shape[1], _level(a, b))
    ratio = np.empty((len(pieces), drift.size))
    for i, rows in enumerate(pieces):
        found = log_ratio(filtered, rows, 0, most, fine, prior)
        top = found.max(axis=1)
        ratio[i] = top + np.log(np.exp(found - top[:, None]).sum(axis=1))
    x = np.array([0.5 * (grid[p.start] + grid[p.stop - 1]) for p in pieces])
    if pairs is not None:
        _add_pairs(ratio, x, drift, base, pairs)
        start = np.full(drift.size, 1.0 / drift.size)
    else:
        start = 1.0 / (1.0 + (drift / options.offset_scale) ** 2)
        start /= start.sum()
    gamma, evidence = chain.posterior(ratio, np.diff(x), walk, options.slip_rate, options.slip_scale, cell, start)
    place, variance, probability = _mode(gamma, drift, max(_HALF_MODE, 2.0 * cell))
    sigma = np.sqrt(variance + cell**2 / 12.0 + _FLOOR**2)
    return _Tracked(x, _rising(x, base.at(x) + place), sigma, probability, float(evidence))


def _roll_prior(cells: int, sigma: float) -> NDArray[np.float64]:
    """Return the log prior (cells,) of the roll of B against A."""
    turn = np.arange(cells) * (2 * np.pi / cells)
    turn = np.mod(turn + np.pi, 2 * np.pi) - np.pi
    log_prior = -0.5 * (turn / sigma) ** 2
    return log_prior - np.log(np.exp(log_prior).sum())


def _add_pairs(ratio: NDArray, x: NDArray, drift: NDArray, base: _Base, pairs: _Pairs) -> None:
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


def _mode(gamma: NDArray, drift: NDArray, half: float) -> tuple[NDArray, NDArray, NDArray]:
    """Return mean (n,), variance (n,) and probability (n,) of the likeliest place, `half` to both sides."""
    width = max(1, round(half / (drift[1] - drift[0])))
    sums = np.concatenate((np.zeros((len(gamma), 1)), np.cumsum(gamma, axis=1, dtype=np.float64)), axis=1)
    cells = np.arange(gamma.shape[1])
    low, high = np.maximum(cells - width, 0), np.minimum(cells + width + 1, gamma.shape[1])
    top = np.argmax(sums[:, high] - sums[:, low], axis=1)
    part = np.where(np.abs(cells[None, :] - top[:, None]) <= width, gamma, 0.0).astype(np.float64)
    mass = part.sum(axis=1)
    mean = part @ drift / mass
    return mean, (part * (drift[None, :] - mean[:, None]) ** 2).sum(axis=1) / mass, np.minimum(mass, 1.0)


def _rising(x: NDArray, y: NDArray) -> NDArray[np.float64]:
    """Return y made to rise with x: a robot that goes on cannot meet the wall in another order."""
    least = 0.2 * (x - x[0])
    return np.maximum.accumulate(y - least) + least


def _registration(
    found: tuple, a: Wall, b: Wall, extent_b: tuple[float, float], turned: bool, options: MatchOptions,
    flagged: tuple[Span, ...],
) -> Registration:  # fmt: skip
    track, (roll, roll_sigma), agreement = found
    fine = (track.sigma < _FINE_SIGMA) & (track.probability > _ONE_PLACE)
    spread = options.walk**2 + 2.0 * options.slip_rate * options.slip_scale**2
    x, y, sigma, probability = _to_ends(track, a.extent, spread)
    ends = [np.r_[v[0], v, v[-1]] for v in (fine, roll, roll_sigma)]
    spans = (*(s for s in flagged if s.reason == "not inspected by both"), *_slips(x, y, sigma, ends[0]))
    if turned:
        y = sum(extent_b) - y
    drift = Drift(x, y, sigma, probability, options.walk**2)
    spans += _doubtful(drift, extent_b, options)
    return Registration(
        drift, ends[0], ends[1], ends[2], "relief", turned, extent_b, agreement, track.log_evidence, spans
    )


def _to_ends(track: _Tracked, extent: tuple[float, float], spread: float) -> tuple[NDArray, ...]:
    """Return nodes carried on to the ends of A with the usual scale."""
    scale = float(np.median(np.diff(track.y) / np.diff(track.x))) if len(track.x) > 1 else 1.0
    out = [extent[0] - track.x[0], extent[1] - track.x[-1]]
    return (
        np.r_[extent[0], track.x, extent[1]],
        np.r_[track.y[0] + scale * out[0], track.y, track.y[-1] + scale * out[1]],
        np.r_[np.hypot(track.sigma[0], _FLOOR), track.sigma, np.hypot(track.sigma[-1], _FLOOR)],
        np.r_[track.probability[0], track.probability, track.probability[-1]],
    )


def _slips(x: NDArray, y: NDArray, sigma: NDArray, fine: NDArray) -> tuple[Span, ...]:
    """Return the stretches between nodes in which one odometer slipped, somewhere."""
    gap, rise = np.diff(x), np.diff(y)
    scale = float(np.median(rise / gap))
    off = np.abs(rise - scale * gap)
    least = _SLIP + 4.0 * np.hypot(sigma[1:], sigma[:-1])
    return tuple(
        Span(float(x[i]) - _SLIP_REACH, float(x[i + 1]) + _SLIP_REACH, "an odometer slipped somewhere in it")
        for i in np.flatnonzero((off > least) & fine[1:] & fine[:-1])
    )


def _doubtful(drift: Drift, extent_b: tuple[float, float], options: MatchOptions) -> tuple[Span, ...]:
    """Return stretches whose place is not clear or not inspected by both, half-way to the next good node."""
    x, y = drift.chainage_a, drift.chainage_b
    why = np.full(len(x), "", dtype=object)
    why[drift.sigma > options.sigma_limit] = f"one-sigma above {options.sigma_limit:g} m"
    why[drift.mode_probability < _ONE_PLACE] = "more than one place is likely"
    why[(y < extent_b[0]) | (y > extent_b[1])] = "not inspected by both"
    edges = np.concatenate((x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]))
    spans: list[Span] = []
    for i in np.flatnonzero(why != ""):
        if spans and spans[-1].reason == why[i] and spans[-1].end == edges[i]:
            spans[-1] = Span(spans[-1].start, float(edges[i + 1]), why[i])
        else:
            spans.append(Span(float(edges[i]), float(edges[i + 1]), why[i]))
    return tuple(spans)


def _features_alone(
    match: Match, a: Wall, b: Wall, extent_b: tuple[float, float], options: MatchOptions
) -> Registration:
    """Return the registration that features alone give: a smooth wall adds nothing."""
    n = len(match.drift.chainage_a)
    level = np.isfinite(_level(a, b))
    return Registration(
        match.drift, np.zeros(n, bool), np.zeros(n), np.full(n, _UPRIGHT_SIGMA if level else np.nan),
        "vertical" if level else "assumed", match.reversed, extent_b, np.nan, 0.0, match.flagged,
    )  # fmt: skip
