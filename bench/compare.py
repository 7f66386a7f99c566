"""Matching two inspections: simulated pipes beside baselines, refusals, a long tally, and real sewers."""

from __future__ import annotations

import resource
import time
from itertools import pairwise

import numpy as np

from bench import _compare_baselines as baselines
from bench import _compare_sewers as sewers
from bench._compare_pipes import repeat, score
from springline.compare import MatchOptions, feature_list, match

PIPES = 20
_APART = (20, 33, 57)  # the pairs of one pipe stand together in the table
_SEEDS = range(201, 221)  # of hidden taps, for the posterior


def simulated() -> None:
    heading(f"{PIPES} pipes of one sequence of numbers")
    for missing in (0.0, 0.1, 0.2, 0.4):
        table_row([np.random.default_rng(7)] * PIPES, missing)


def heading(which: str) -> None:
    print(f"\n{which}: 300 m, a lateral every 12 m, noise 10 mm")
    print(
        "missing precision recall rmse[mm] in95 flagged refused wrong-end wrong-run s/pair | P/R nearest, linear, DTW"
    )


def table_row(pipes: list[np.random.Generator], missing: float) -> None:
    """Print what matching two inspections of each of the `pipes` reaches; one generator for all is drawn on."""
    scores, simple, errors, ratios = [], [], [], []
    flagged = nodes = refused = wrong_end = wrong_run = 0
    taken = []
    for rng in pipes:
        a, b, other_end = repeat(rng, missing=missing)
        start = time.process_time()
        found = match(a.features, b.features)
        taken.append(time.process_time() - start)
        one = score(a, b, found.pairs.index_a, found.pairs.index_b)
        scores.append(one)
        told = b.features.mirrored() if other_end else b.features
        for method in (baselines.nearest, baselines.linear, baselines.warped):
            i, j = method(a.features, told)
            simple.append(score(a, b, i, len(told) - 1 - j if other_end else j))
        refused += not found
        wrong_end += bool(found) and found.reversed != other_end
        if not found:
            continue
        true = np.arange(10.0, 290.0, 0.5)
        x, y = a.counter(true), b.counter(true)
        place, sigma = found.drift.at(x)
        good = found.reliable(x) & np.isfinite(place)
        flagged, nodes = flagged + int((~good).sum()), nodes + true.size
        errors += (place - y)[good].tolist()
        ratios += (np.abs(place - y) < 1.96 * sigma)[good].tolist()
        sure = found.pairs.probability > 0.95
        right, given, _ = score(a, b, found.pairs.index_a[sure], found.pairs.index_b[sure])
        wrong_run += given > 0 and right < 0.5 * given
    right, given, both = np.sum(scores, axis=0)
    others = np.sum(np.reshape(simple, (-1, 3, 3)), axis=0)
    peers = "  ".join(f"{r / max(g, 1):.2f}/{r / n:.2f}" for r, g, n in others)
    rmse = 1e3 * float(np.sqrt(np.mean(np.square(errors)))) if errors else np.nan
    held = np.mean(ratios) if ratios else np.nan
    print(
        f"{100 * missing:5.0f} %   {right / max(given, 1):9.4f} {right / both:6.4f} {rmse:9.1f}"
        f" {held:5.3f} {100 * flagged / max(nodes, 1):6.1f}% {refused:6d} {wrong_end:8d}"
        f" {wrong_run:10d} {np.mean(taken):7.2f} | {peers}",
        flush=True,
    )


def refusals(pairs: int = 10) -> None:
    rng = np.random.default_rng(11)
    for lateral_every in (12.0, np.inf):
        lists = (repeat(rng, missing=0.2, lateral_every=lateral_every, same=False)[:2] for _ in range(pairs))
        said = [match(a.features, b.features).accepted for a, b in lists]
        print(f"two pipes of one module, a lateral every {lateral_every:g} m: {sum(said)} of {pairs} accepted")


def tally() -> None:
    rng = np.random.default_rng(3)
    lengths = rng.choice([12.2, 11.6, 10.8], 1600, p=[0.6, 0.25, 0.15]) + rng.normal(0, 0.15, 1600)
    weld = np.cumsum(lengths) * 17_000 / lengths.sum()
    lists = []
    for scale in (1.0, 1.006):
        keep = rng.random(weld.size) > 0.02
        slips = (rng.normal(0, 0.3, 12) * (weld[:, None] > rng.uniform(0, weld[-1], 12))).sum(axis=1)
        x = weld * scale + 2.0 * np.sin(weld / 3000) + slips + rng.normal(0, 0.05, weld.size)
        lists.append((feature_list(x[keep], "joint"), np.flatnonzero(keep)))
    (a, in_a), (b, in_b) = lists
    start = time.process_time()
    found = match(a, b)
    taken = time.process_time() - start
    right = int((in_a[found.pairs.index_a] == in_b[found.pairs.index_b]).sum())
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(
        f"17 km, {len(a)} and {len(b)} joints: {right} of {np.intersect1d(in_a, in_b).size} right,"
        f" {len(found.pairs) - right} wrong, {taken:.2f} s of CPU, at most {memory:.2f} GiB held by the process"
    )


def real() -> None:
    if not sewers.FOLDER.exists():
        print("real sewers: left out, ../shared is absent")
        return
    options, rng = MatchOptions.cctv(), np.random.default_rng(1)
    match(*(next(sewers.repeats(3)).__dict__[k] for k in "ab"), options)  # compiles
    taken, off, wrong, seen = [], [], [], []
    hidden, good, taps, count = np.zeros(2, int), 0, 0, 0
    strangers, kept = {n: [] for n in _APART}, []
    for one in sewers.repeats():
        start = time.process_time()
        found = match(one.a, one.b, options)
        taken.append(time.process_time() - start)
        least = min(sewers.taps(one.a), sewers.taps(one.b))
        if least < 3:
            continue
        count, taps, good = count + 1, taps + least, good + sewers.good_taps(one, found)
        if found.reversed != one.other_end:
            wrong.append(f"{sewers.label(one)} ({found.probability_direction:.2f})")
        off.append(sewers.left_out(one, found, options))
        hidden += sewers.hidden(one, found, options, rng)[1:]
        seen.append(one.a)
        kept.append(one)
        for apart, said in strangers.items():
            if count % 2 and count > apart:
                said.append(match(seen[-apart], one.b, options).accepted)
    rows = np.concatenate(off)
    _tell(rows)
    print(f"  {len(taken)} pairs, mean {np.mean(taken):.3f} s, slowest {max(taken):.3f} s of CPU")
    share = 100 - 100 * len(wrong) / count
    print(f"  direction right in {count - len(wrong)} of {count} ({share:.1f} %); not: {', '.join(wrong)}")
    print(f"  taps within 4 ft and 1 h: {good} of {taps} ({100 * good / taps:.1f} %)")
    print(f"  a fifth of the taps hidden: {hidden[0]} of {hidden[1]} pairs right ({100 * hidden[0] / hidden[1]:.2f} %)")
    told = "; ".join(f"{sum(said)} of {len(said)}, {apart} rows apart" for apart, said in strangers.items())
    print(f"  different pipes accepted: {told}")
    _doubtful(kept, options)


def _doubtful(kept: list[sewers.Repeat], options: MatchOptions) -> None:
    """Tell how often pairs that are not sure are right, over many ways of hiding a fifth of the taps of both lists."""
    rows, names = [], []
    for seed in _SEEDS:
        rng = np.random.default_rng(seed)
        for one in kept:
            _, found = sewers.thinned(one, options, rng)
            rows.append(found)
            names += [sewers.label(one)] * len(found)
    place, probability, apart, hours = np.abs(np.concatenate(rows)).T
    names = np.array(names)
    right = (apart <= sewers.REACH) & (hours <= sewers.HOUR)
    print(f"  a fifth of the taps of both hidden, {len(_SEEDS)} times over:")
    for low, high in ((0.8, 0.9), (0.9, 0.95), (0.95, 0.98)):
        inside = (probability >= low) & (probability < high)
        placed = inside & np.isfinite(apart)
        sure = placed & ~np.isin(names, sewers.MISLABELLED)
        taps = len(set(zip(names[placed].tolist(), place[placed].tolist(), strict=True)))
        print(
            f"    given {low:.2f} to {high:.2f}: {right[placed].mean():.3f} right of {placed.sum()} ({taps} taps;"
            f" {inside.sum() - placed.sum()} no place), {right[sure].mean():.3f} of {sure.sum()} well labelled"
        )


def _tell(rows: np.ndarray) -> None:
    probability, apart, scaled, hours = np.abs(rows).T
    print(
        f"real sewers, {len(rows)} taps left out one by one: median {np.nanmedian(apart) / sewers.FOOT:.3f} ft,"
        f" scaled by length {np.median(scaled) / sewers.FOOT:.3f} ft; no place for {int(np.isnan(apart).sum())}"
    )
    right = (apart <= sewers.REACH) & (hours <= sewers.HOUR)
    edges = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 1.01)
    for low, high in pairwise(edges):
        inside = (probability >= low) & (probability < high) & np.isfinite(apart)
        if inside.any():
            print(f"  given {low:.2f} to {min(high, 1):.2f}: {right[inside].mean():.3f} right of {inside.sum()}")


def compile_first() -> None:
    a, b, _ = repeat(np.random.default_rng(0), missing=0.2, length=60.0)
    match(a.features, b.features)


def main() -> None:
    compile_first()
    simulated()
    refusals()
    tally()
    real()


if __name__ == "__main__":
    main()
