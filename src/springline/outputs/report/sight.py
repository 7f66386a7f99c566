"""What was seen: how many readings were used, which stations have a section, and which stretches are unseen."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...conventions import FIT_STATUS, MASK_REASONS
from ..unroll import REASON_WORDS
from .listings import Table

if TYPE_CHECKING:
    from ..results import Results
    from .scales import Scales

_STRETCHES = 20
_SEEN = 0.5


def readings_table(results: Results) -> Table:
    """Return how many readings were used, and why not the others."""
    counts = results.reason_counts
    total = max(sum(counts.values()), 1)
    rows = tuple(
        (REASON_WORDS[MASK_REASONS[flag]], f"{count:,}".replace(",", "\u2009"), f"{100 * count / total:.2f}")
        for flag, count in counts.items()
        if flag in MASK_REASONS
    )
    return Table(("Readings", "Number", "Share [%]"), rows)


def statuses_table(results: Results, scales: Scales) -> Table:
    """Return how many stations have a section, and why not the others."""
    start, end = results.extents
    rows = tuple(
        (
            word,
            str(int((results.status == flag).sum())),
            scales.length.number(float((end - start)[results.status == flag].sum()), 2),
        )
        for flag, word in FIT_STATUS.items()
        if (results.status == flag).any()
    )
    return Table(("Stations", "Number", f"Length [{scales.length.name}]"), rows)


def unseen_table(results: Results, scales: Scales) -> Table:
    """Return the unseen stretches, the twenty longest of them in their order: too little coverage, or no stations."""
    start, end = results.extents
    unseen = ~(np.nan_to_num(results.coverage) >= _SEEN)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], unseen, [False]))))
    apart = np.flatnonzero(start[1:] > end[:-1] + 1e-9)
    # A run of stations is cut where a gap without any lies in it.
    runs = [(float(start[i]), float(end[j - 1]), "coverage under 50 %") for i, j in _cut(edges, apart)]
    runs += [(float(end[k]), float(start[k + 1]), "no stations") for k in apart]
    longest = sorted(sorted(runs, key=lambda run: run[0] - run[1])[:_STRETCHES])
    length = scales.length
    rows = tuple(
        (length.number(low, 2), length.number(high, 2), length.number(high - low, 2), why) for low, high, why in longest
    )
    return Table(
        (f"Unseen from [{length.name}]", f"To [{length.name}]", f"Length [{length.name}]", "Why"), rows, frozenset({3})
    )


def _cut(edges: np.ndarray, apart: np.ndarray) -> list[tuple[int, int]]:
    """Return first and one past last station of each run, cut behind the stations of `apart`."""
    pieces = []
    for i, j in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        cuts = [i, *(int(k) + 1 for k in apart if i <= k < j - 1), j]
        pieces += list(pairwise(cuts))
    return pieces
