"""Simulated matching on seeds that nothing was set on: the table of `compare`, 50 runs at 20 and 40 %, strangers."""

from __future__ import annotations

import numpy as np

from bench._compare_pipes import repeat, score, turned
from bench.compare import compile_first, heading, table_row
from springline.compare import match

SEEDS = range(500, 520)
RUNS = range(500, 550)
STRANGERS = range(600, 625)
PART_SEEDS = range(940, 950)
PARTS = (
    ("100 m in 290 m", (0.0, 290.0), (120.0, 220.0)),
    ("290 m about 100 m", (120.0, 220.0), (0.0, 290.0)),
    ("starts 50 m apart, 190 m in both", (0.0, 240.0), (50.0, 290.0)),
    ("starts 100 m apart, 90 m in both", (0.0, 190.0), (100.0, 290.0)),
)


def strangers() -> None:
    """Tell how many pairs of different pipes with joints of one module are accepted, and the largest posterior."""
    for lateral_every in (12.0, np.inf):
        for missing in (0.0, 0.2):
            said = [_stranger(seed, missing, lateral_every) for seed in STRANGERS]
            accepted = sum(found.accepted for found in said)
            most = max(found.probability_same for found in said)
            print(
                f"two pipes of one module, {100 * missing:.0f} % missing, a lateral every {lateral_every:g} m:"
                f" {accepted} of {len(said)} accepted, largest posterior of one pipe {most:.3f}",
                flush=True,
            )


def _stranger(seed: int, missing: float, lateral_every: float):
    a, b, _ = repeat(np.random.default_rng(seed), missing=missing, lateral_every=lateral_every, same=False)
    return match(a.features, b.features)


def far_starts() -> None:
    """Tell how many inspections of a part of each other are found: pairs right, given and in both."""
    for name, in_a, in_b in PARTS:
        scores, found_all, wrong_end = [], 0, 0
        for seed in PART_SEEDS:
            a, b, other_end = repeat(np.random.default_rng(seed), missing=0.1)
            a, b = a.between(*in_a), (turned(b) if other_end else b).between(*in_b)
            found = match(a.features, (turned(b) if other_end else b).features)
            told = len(b.identity) - 1 - found.pairs.index_b if other_end else found.pairs.index_b
            found_all += bool(found)
            wrong_end += bool(found) and found.reversed != other_end
            scores.append(score(a, b, found.pairs.index_a, told))
        right, given, both = np.sum(scores, axis=0)
        print(
            f"{name}: {found_all} of {len(scores)} found, {wrong_end} from the wrong end,"
            f" {right} of {given} pairs right, {both} features in both",
            flush=True,
        )


def main() -> None:
    compile_first()
    for seeds, all_missing in ((SEEDS, (0.0, 0.1, 0.2, 0.4)), (RUNS, (0.2, 0.4))):
        heading(f"seeds {seeds[0]} to {seeds[-1]}")
        for missing in all_missing:
            table_row([np.random.default_rng(seed) for seed in seeds], missing)
    strangers()
    far_starts()


if __name__ == "__main__":
    main()
