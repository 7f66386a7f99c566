"""Real sewers in halves: what `MatchOptions.cctv` assumes is chosen on one half and judged on the other.

The halves are drawn by sewer, and once by the area that the manholes' numbers begin with. Rule, on one half:

1. of each prior of the model the value with the most evidence that the pairs are of one sewer, the others at `START`;
2. of the limits of clock that whose doubtful pairs (posterior 0.8 to 0.98, a fifth of the taps of both hidden) come
   nearest to their word;
3. the greatest prior of one sewer at which no more than 1 in 200 pairs of different sewers is accepted.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log, pi

import numpy as np
from scipy.stats import beta

from bench import _compare_sewers as sewers
from springline.compare import Match, MatchOptions, match

START = replace(
    MatchOptions.cctv(), noise=0.1, walk=0.02, scale_sigma=0.012, slip_rate=0.01, offset_scale=0.5, bearing_sigma=0.25,
    shared=MatchOptions().shared, prior_same=0.5, accept_same=1e-12,
)  # fmt: skip
"""Priors to start from: a tap told to 0.1 m, a counter set to half a metre, 85 taps of 100 seen again."""

GRIDS = {
    "noise": (0.05, 0.07, 0.1),
    "walk": (0.014, 0.02),
    "scale_sigma": (0.012, 0.016),
    "slip_rate": (0.003, 0.01),
    "offset_scale": (0.1, 0.2, 0.5),
    "bearing_sigma": (0.25, 0.3),
    "lateral": (0.85, 0.95),
    "manhole": (0.9, 0.97),
}
LIMITS = {"1.5 h": pi / 4, "none": pi}
PRIORS = (0.5, 0.1, 0.03, 0.01, 0.003, 0.001)
MOST_STRANGERS = 0.005
SPLITS = 6
_APART = (20, 33)
_SEEDS = range(301, 306)  # of hidden taps
_DOUBTFUL = (0.8, 0.98)
_BANDS = ((0.5, 0.8), (0.8, 0.9), (0.9, 0.95), (0.95, 0.98), (0.98, 0.99))
_ALL_DOUBTFUL = _BANDS[0][0], _BANDS[-1][1]
_TINY = 1e-12


def at(options: MatchOptions, name: str, value: float) -> MatchOptions:
    """Return options with one prior at a value; names of kinds are their shared fractions."""
    if name in options.shared:
        return replace(options, shared={**options.shared, name: value})
    return replace(options, **{name: value})


def evidence(kept: list[sewers.Repeat]) -> dict[tuple[str, float], np.ndarray]:
    """Return the evidence (pairs,) of one sewer at each value of each prior, the others at `START` [nats]."""
    there = {name: START.shared.get(name) or getattr(START, name) for name in GRIDS}
    start = np.array([match(one.a, one.b, START).evidence for one in kept])
    return {
        (name, value): start
        if value == there[name]
        else np.array([match(one.a, one.b, at(START, name, value)).evidence for one in kept])
        for name, values in GRIDS.items()
        for value in values
    }


def likeliest(found: dict[tuple[str, float], np.ndarray], half: np.ndarray) -> tuple[float, ...]:
    """Return the value of each prior with the most evidence over a half (pairs,)."""
    return tuple(max(values, key=lambda v: found[name, v][half].sum()) for name, values in GRIDS.items())


@dataclass(frozen=True)
class Told:
    """What one limit of clock gives of all pairs, whatever the prior. Odds are log odds of one sewer at an even prior,
    -inf where the direction is not clear; distances in ft.

    Attributes:
        whole: (pairs, 4) odds, whether the direction is right, taps that both can have, taps matched.
        out: (k, 4) each tap left out: pair, odds of the pair, odds without the tap, how far from its place it lands.
        hidden: (pairs, 4) pair, odds with a fifth of B's taps hidden, right pairs, given pairs.
        strangers: (k, 3) two pairs, odds that they are one sewer.
        doubtful: (k, 5) pair, odds, place of the tap [m], posterior, whether right (NaN: no place without it).
    """

    whole: np.ndarray
    out: np.ndarray
    hidden: np.ndarray
    strangers: np.ndarray
    doubtful: np.ndarray


def told(kept: list[sewers.Repeat], options: MatchOptions) -> Told:
    """Return what all pairs give with these options, whatever their prior."""
    given = replace(options, prior_same=0.5, accept_same=_TINY)
    rng = np.random.default_rng(1)
    whole, out, hidden, doubtful = [], [], [], []
    for n, one in enumerate(kept):
        found = match(one.a, one.b, given)
        least = min(sewers.taps(one.a), sewers.taps(one.b))
        whole.append((_odds(found), found.reversed == one.other_end, least, sewers.good_taps(one, found)))
        for k, again in sewers.without_each(one, found, given):
            place = float(again.drift.at(one.a.chainage[found.pairs.index_a[k]])[0])
            off = abs(place - one.b.chainage[found.pairs.index_b[k]]) / sewers.FOOT
            out.append((n, whole[-1][0], _odds(again), off))
        again, right, count = sewers.hidden(one, found, given, rng)
        hidden.append((n, _odds(again), right, count))
    for seed in _SEEDS:
        rng = np.random.default_rng(seed)
        for n, one in enumerate(kept):
            again, rows = sewers.thinned(one, replace(given, accept_pair=_BANDS[0][0]), rng, _ALL_DOUBTFUL)
            for place, probability, off, hours in rows:
                right = abs(off) <= sewers.REACH and hours <= sewers.HOUR
                doubtful.append((n, _odds(again), place, probability, right if np.isfinite(off) else np.nan))
    strangers = [
        (n, n - apart, _odds(match(kept[n - apart].a, kept[n].b, given)))
        for apart in _APART
        for n in range(apart, len(kept))
        if kept[n].manholes != kept[n - apart].manholes
    ]
    return Told(*(np.array(rows, dtype=float) for rows in (whole, out, hidden, strangers, doubtful)))


def _odds(found: Match | None) -> float:
    if found is None or found.probability_direction < MatchOptions.cctv().accept_same:
        return -np.inf
    p = found.probability_same
    return log(max(p, _TINY) / max(1.0 - p, _TINY))


def _bar(prior: float) -> float:
    """Return the odds at an even prior from which a match is accepted at this one."""
    accept = MatchOptions.cctv().accept_same
    return log(accept / (1.0 - accept)) - log(prior / (1.0 - prior))


def figures(one: Told, prior: float, half: np.ndarray) -> dict[str, float]:
    """Return the figures of the pairs of a half (pairs,) at a prior."""
    bar = _bar(prior)
    direction, least, good = one.whole[half, 1:].T
    accepted = one.whole[half, 0] >= bar
    pair = one.out[:, 0].astype(int)
    mine = half[pair] & (one.out[:, 1] >= bar)
    off = np.where(one.out[mine, 2] >= bar, one.out[mine, 3], np.nan)
    rest = one.hidden[half & (one.hidden[:, 1] >= bar) & (one.whole[:, 0] >= bar), 2:].sum(axis=0)
    both = half[one.strangers[:, 0].astype(int)] & half[one.strangers[:, 1].astype(int)]
    said = one.strangers[both, 2] >= bar
    return {
        "direction": direction.mean(),
        "taps": (good * accepted).sum() / least.sum(),
        "left out": float(np.nanmedian(off)),
        "hidden": rest[0] / rest[1],
        "strangers": said.mean(),
        "of": float(said.size),
    }


def doubtful(one: Told, prior: float, half: np.ndarray, low: float, high: float) -> np.ndarray:
    """Return (k, 3) pair, posterior and rightness of the pairs of a half within a band; each tap by its mean."""
    rows = one.doubtful
    keep = half[rows[:, 0].astype(int)] & (rows[:, 1] >= _bar(prior)) & np.isfinite(rows[:, 4])
    rows = rows[keep & (rows[:, 3] >= low) & (rows[:, 3] < high)]
    _, tap = np.unique(rows[:, [0, 2]], axis=0, return_inverse=True)
    count = np.bincount(tap.ravel()) if len(rows) else np.empty(0)
    return np.column_stack([np.bincount(tap.ravel(), rows[:, c]) / count for c in (0, 3, 4)]) if len(rows) else rows


def chosen(of_all: dict[str, Told], half: np.ndarray) -> tuple[str, float]:
    """Return limit and prior that the rule picks on a half (pairs,)."""

    def dishonest(limit: str) -> float:
        rows = doubtful(of_all[limit], 0.5, half, *_DOUBTFUL)
        return abs(float((rows[:, 1] - rows[:, 2]).mean())) if len(rows) else np.inf

    limit = min(of_all, key=dishonest)
    few = [p for p in PRIORS if figures(of_all[limit], p, half)["strangers"] <= MOST_STRANGERS]
    return limit, max(few, default=PRIORS[-1])


def halves(kept: list[sewers.Repeat]) -> list[tuple[str, np.ndarray]]:
    """Return names and masks (pairs,) of one half each; the other half is the rest."""
    names = sorted({one.manholes for one in kept})
    of_sewer = np.array([names.index(one.manholes) for one in kept])
    found = [("area 1 or the rest", np.array([one.manholes[0].startswith("1-") for one in kept]))]
    for seed in range(SPLITS):
        first = np.random.default_rng(400 + seed).permutation(len(names)) < len(names) // 2
        found.append((f"by sewer, draw {seed + 1}", first[of_sewer]))
    return found


def interval(right: float, count: int) -> tuple[float, float]:
    """Return the exact 95 % interval of a share of `count`."""
    hits = right * count
    low = beta.ppf(0.025, hits, count - hits + 1) if hits > 0 else 0.0
    return float(low), float(beta.ppf(0.975, hits + 1, count - hits)) if hits < count else 1.0


def _line(values: dict[str, float]) -> str:
    return (
        f"direction {100 * values['direction']:.1f} %, taps {100 * values['taps']:.1f} %,"
        f" left out {values['left out']:.3f} ft, hidden {100 * values['hidden']:.2f} %,"
        f" strangers {100 * values['strangers']:.2f} % of {values['of']:.0f}"
    )


def _bands(rows: list[np.ndarray]) -> None:
    for low, high in (*_BANDS, (0.5, 0.99)):
        inside = np.concatenate([one[(one[:, 1] >= low) & (one[:, 1] < high)] for one in rows])
        if len(inside):
            ends = interval(float(inside[:, 2].mean()), len(inside))
            print(
                f"    given {low:.2f} to {high:.2f}, {inside[:, 1].mean():.3f} in the mean: {inside[:, 2].mean():.3f}"
                f" right of {len(inside)} taps ({ends[0]:.2f} to {ends[1]:.2f})"
            )


def main() -> None:
    if not sewers.FOLDER.exists():
        print("real sewers: left out, ../shared is absent")
        return
    kept = list(sewers.repeats(3))
    found = evidence(kept)
    judged: dict[tuple[float, ...], dict[str, Told]] = {}
    for title, first in halves(kept):
        held, rows = [], []
        for half in (first, ~first):
            picked = likeliest(found, half)
            if picked not in judged:
                judged[picked] = _all_limits(kept, picked)
            limit, prior = chosen(judged[picked], half)
            held.append(figures(judged[picked][limit], prior, ~half))
            rows.append(doubtful(judged[picked][limit], prior, ~half, *_ALL_DOUBTFUL))
            print(f"{title}: chosen on {half.sum()}: set {list(judged).index(picked) + 1}, {limit}, {prior:g}")
            print(f"  held out: {_line(held[-1])}", flush=True)
        _bands(rows)


def _all_limits(kept: list[sewers.Repeat], picked: tuple[float, ...]) -> dict[str, Told]:
    """Return what the pairs give with the picked priors at each limit of clock, and print the set's own figures."""
    options = MatchOptions.cctv()
    for name, value in zip(GRIDS, picked, strict=True):
        options = at(options, name, value)
    of_all = {name: told(kept, replace(options, bearing_limit=limit)) for name, limit in LIMITS.items()}
    print("a set: " + ", ".join(f"{name} {value:g}" for name, value in zip(GRIDS, picked, strict=True)))
    everywhere = np.ones(len(kept), bool)
    for name, one in of_all.items():
        for prior in PRIORS:
            print(f"  all pairs, {name}, {prior:g}: {_line(figures(one, prior, everywhere))}", flush=True)
    return of_all


if __name__ == "__main__":
    main()
