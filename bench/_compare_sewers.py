"""Real repeat inspections of US sewers, coded by eye, beside the checkout; nothing of them is copied."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from springline.compare import KINDS, FeatureList, Match, MatchOptions, match, pacp_features
from springline.conventions import clock_from_bearing

if TYPE_CHECKING:
    from collections.abc import Iterator

FOLDER = Path(__file__).resolve().parents[1] / ".." / "shared" / "data" / "pacp-repeat-inspections"
FOOT = 0.3048
REACH, HOUR = 4.0 * FOOT, 1.01
TAP = KINDS.index("lateral")
MISLABELLED = (
    "30/972", "426/3408", "427/3409", "263/1449", "265/1451", "1374/1375", "3485/3488", "3485/3489",
)  # fmt: skip
"""Pairs whose recorded direction, or pipe, contradicts their own taps."""


@dataclass(frozen=True)
class Repeat:
    """Two inspections of one pipe, whether the second is recorded as driven from the other end, and its manholes."""

    a: FeatureList
    b: FeatureList
    other_end: bool
    manholes: tuple[str, str]


def repeats(least_taps: int = 0, every: int = 1) -> Iterator[Repeat]:
    """Yield the repeat pairs with at least so many taps in both, every so many of them."""
    import pandas as pd

    rows = pd.read_csv(FOLDER / "Conditions.csv", dtype=str)
    tables = dict(list(rows.groupby("InspectionID")))
    pairs = pd.read_csv(FOLDER / "derived_repeat_pairs.csv")
    pairs = pairs[(pairs.taps_1 >= least_taps) & (pairs.taps_2 >= least_taps)].iloc[::every]
    for row in pairs.itertuples():
        numbers = str(row.inspection_id_1), str(row.inspection_id_2)
        a, b = (pacp_features(tables[n], n, sort=True) for n in numbers)
        yield Repeat(a, b, row.direction == "reversed", (row.manhole_a, row.manhole_b))


def label(one: Repeat) -> str:
    """Return the numbers of both inspections."""
    return "/".join(f.name.removeprefix("inspection ") for f in (one.a, one.b))


def taps(features: FeatureList) -> int:
    """Return the number of taps."""
    return int((features.kind == TAP).sum())


def hours_apart(a: FeatureList, b: FeatureList, found: Match) -> np.ndarray:
    """Return the difference of clock of each pair [h], B's clock seen along A's travel."""
    bearing = b.bearing[found.pairs.index_b]
    if found.reversed:
        bearing = np.pi - bearing
    turn = clock_from_bearing(a.bearing[found.pairs.index_a]) - clock_from_bearing(bearing)
    return np.abs(np.mod(turn + 6.0, 12.0) - 6.0)


def good_taps(one: Repeat, found: Match) -> int:
    """Return how many pairs of taps lie within 4 ft and one clock hour."""
    tap = one.a.kind[found.pairs.index_a] == TAP
    near = (np.abs(found.pairs.residual) <= REACH) & (hours_apart(one.a, one.b, found) <= HOUR)
    return int((tap & near).sum())


def without_each(one: Repeat, found: Match, options: MatchOptions) -> Iterator[tuple[int, Match]]:
    """Yield which pair of taps is left out, and the match without both of it."""
    for k, (i, j) in enumerate(zip(found.pairs.index_a, found.pairs.index_b, strict=True)):
        if one.a.kind[i] == TAP and min(len(one.a), len(one.b)) > 2:
            yield k, match(*(f.take(np.arange(len(f)) != n) for f, n in ((one.a, i), (one.b, j))), options)


def left_out(one: Repeat, found: Match, options: MatchOptions) -> np.ndarray:
    """Return (k, 4) per pair of taps: its probability; distance [m] to where the match without both puts it; that of a
    scaling by length; its difference of clock [h]."""
    rows = []
    hours = hours_apart(one.a, one.b, found)
    for k, again in without_each(one, found, options):
        i, j = found.pairs.index_a[k], found.pairs.index_b[k]
        share = (one.a.chainage[i] - one.a.extent[0]) / one.a.length
        scaled = one.b.extent[0] + one.b.length * (1.0 - share if found.reversed else share)
        place = float(again.drift.at(one.a.chainage[i])[0])
        rows.append((found.pairs.probability[k], place - one.b.chainage[j], scaled - one.b.chainage[j], hours[k]))
    return np.array(rows).reshape(-1, 4)


def thinned(
    one: Repeat, options: MatchOptions, rng: np.random.Generator, doubtful: tuple[float, float] = (0.8, 0.98)
) -> tuple[Match | None, np.ndarray]:
    """Hide a fifth of the taps of both; return the match, and (k, 4) per pair of taps of so `doubtful` a probability:
    its place in A [m], its probability, its distance [m] to where the match without it puts it, and its difference of
    clock [h]."""
    a, b = (f.take((f.kind != TAP) | (rng.random(len(f)) > 0.2)) for f in (one.a, one.b))
    if min(len(a), len(b)) < 2:
        return None, np.empty((0, 4))
    found = match(a, b, options)
    hours = hours_apart(a, b, found)
    rows = []
    # The match without the pair only has to place it: that both saw one pipe was shown with it.
    bold = replace(options, accept_same=1e-9)
    for k in np.flatnonzero((found.pairs.probability >= doubtful[0]) & (found.pairs.probability < doubtful[1])):
        i, j = found.pairs.index_a[k], found.pairs.index_b[k]
        if a.kind[i] == TAP and min(len(a), len(b)) > 2:
            again = match(*(f.take(np.arange(len(f)) != n) for f, n in ((a, i), (b, j))), bold)
            off = float(again.drift.at(a.chainage[i])[0]) - b.chainage[j]
            rows.append((a.chainage[i], found.pairs.probability[k], off, hours[k]))
    return found, np.array(rows).reshape(-1, 4)


def hidden(one: Repeat, found: Match, options: MatchOptions, rng: np.random.Generator) -> tuple[Match | None, int, int]:
    """Hide a fifth of B's taps; return the match, its right and its given pairs of taps; right as in the full match."""
    keep = np.flatnonzero((one.b.kind != TAP) | (rng.random(len(one.b)) > 0.2))
    if len(keep) < 2:
        return None, 0, 0
    again = match(one.a, one.b.take(keep), options)
    full = dict(zip(found.pairs.index_a.tolist(), found.pairs.index_b.tolist(), strict=True))
    tap = one.a.kind[again.pairs.index_a] == TAP
    pairs = zip(again.pairs.index_a[tap].tolist(), keep[again.pairs.index_b[tap]].tolist(), strict=True)
    right = [full.get(i) == j for i, j in pairs]
    return again, sum(right), len(right)
