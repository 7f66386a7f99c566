"""Comparing walls: how well rings are placed on rings, how small a dent is told, how often chance is told as one."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from bench._compare_walls import again, off, repeat
from springline.compare import compare, match, refine, wall_of
from springline.compare.scan import DETECTION

if TYPE_CHECKING:
    from collections.abc import Iterable

    from springline.survey import Survey

_ALL: list[tuple[int, float]] = []
_FIRST = 51  # of the seeds that judge ready scenarios: what is worked out is worked out on others
_SCORE = 5.0  # from which a dent of 190 mm x 35 degrees is told, nearly

DENT = '{{ chainage = {x:.3f}, clock_h = {clock}, depth = "{depth}mm", length = {length}, width_deg = {width} }}'


def chainage(pipes: int = 6) -> None:
    for rms in (0.3, 0.0):
        errors, plain, flagged, count, taken = [], [], 0, 0, []
        for seed in range(pipes):
            a, b = repeat(seed, rms=rms)
            found = match(a.features, b.features)
            lists = (a.features, b.features) if found else None
            walls = wall_of(a.result), wall_of(b.result)
            start = time.process_time()
            placed = refine(found, *walls, lists)
            taken.append(time.process_time() - start)
            if placed is None:
                print(f"  pipe {seed}: not placed, {found.reason}")
                continue
            error, _, fine = off(placed, a, b)
            x = a.counter[20:-20:5]
            y = b.at(a.place(x))
            ok = np.isfinite(y)
            if rms:
                errors += error[fine].tolist()
                flagged, count = flagged + int((~fine).sum()), count + len(fine)
            elif found:
                good = found.reliable(x[ok])
                errors += error[good].tolist()
                plain += (found.drift.at(x[ok])[0] - y[ok])[good].tolist()
        rmse = 1e3 * np.sqrt(np.mean(np.square(errors)))
        if rms:
            most = 1e3 * np.quantile(np.abs(errors), 0.99)
            print(
                f"rough wall, {rms} mm rms, {pipes} pipes x 30 m: rms {rmse:.2f} mm, 99 % within {most:.2f} mm,"
                f" {100 * flagged / count:.1f} % flagged, {np.mean(taken):.2f} s of CPU per pair"
            )
        else:
            alone = 1e3 * np.sqrt(np.mean(np.square(plain)))
            print(f"smooth wall: rms {rmse:.1f} mm, features alone {alone:.1f} mm, ratio {rmse / alone:.3f}")


def identical(pipes: int = 12) -> None:
    pairs = (tuple(run.result for run in repeat(seed)) for seed in range(1100, 1100 + pipes))
    _alarms("straight rough pipes, other robot, odometer and roll", pairs)


def ready() -> None:
    """Ready scenarios whose sections are near ellipses and whose joints or relief place them."""
    for name, count in (("weaving", 3), ("hinged", 5), ("joints", 6), ("sewer", 2)):
        _alarms(f"ready scenario {name}", (again(name, seed) for seed in range(_FIRST, _FIRST + count)))


def _alarms(words: str, pairs: Iterable[tuple[Survey, Survey]]) -> None:
    """Tell what is said to have changed between inspections of unchanged pipes."""
    told, length, count, refused = {}, 0.0, 0, []
    for a, b in pairs:
        found, count = compare(a, b), count + 1
        if not found:
            refused.append(found.reason.partition(":")[0])
            continue
        length += found.scan.searched
        for c in found.changes:
            if c.quantity != "found":
                told[c.quantity] = told.get(c.quantity, 0) + 1
    alarms = ", ".join(f"{k} {v}" for k, v in told.items()) or "nothing"
    print(f"unchanged, {words}: {count} pairs, {length:.0f} m compared, told {alarms}", flush=True)
    for reason in refused:
        print(f"  refused: {reason}")
    _ALL.append((sum(told.values()), length))


def dents(depth: float, length: float, width: float, spacing: float, pipes: int) -> None:
    seen = there = 0
    stated, errors = [], []
    for seed in range(1200, 1200 + pipes):
        rng = np.random.default_rng(seed)
        x = np.arange(3.7, 17.0, 2.5) + rng.uniform(-0.3, 0.3, 6)
        clocks = rng.uniform(0.5, 12.0, x.size).round(2)
        tables = ", ".join(
            DENT.format(x=u, clock=c, depth=depth, length=length, width=width) for u, c in zip(x, clocks, strict=True)
        )
        a, b = repeat(seed, length=20.0, spacing=spacing, dents=tables, slips=False, lateral_every=100.0)
        found = compare(a.result, b.result)
        if not found:
            continue
        stated.append((found.detectable["patch"], found.detectable_edge))
        y = a.at(x)
        compared = np.isfinite(y) & found.placed.reliable(np.nan_to_num(y))
        for u in y[compared]:
            near = [c for c in found.changes if c.quantity == "patch" and abs(c.chainage - u) < 0.15 and c.change < 0]
            seen, there = seen + bool(near), there + 1
            errors += [(1e3 * near[0].change + depth) / (1e3 * near[0].sigma)] if near else []
    half, edge = 1e3 * np.median(stated, axis=0)
    own = half if (length, width) == (0.38, 70.0) else edge
    expected = norm.cdf(DETECTION + (_SCORE + DETECTION) * (depth / own - 1.0))
    print(
        f"dents {depth} mm, {1e3 * length:.0f} mm x {width:g} degrees from edge to edge, rings every {spacing:g} mm,"
        f" noise 1 mm: {seen} of {there} told, {100 * expected:.0f} % expected;"
        f" depth off by {np.mean(errors):+.2f} +- {np.std(errors):.2f} sigmas;"
        f" stated as told in 95 %: {half:.2f} mm at half depth, {edge:.2f} mm from edge to edge"
    )


def main() -> None:
    chainage()
    identical()
    ready()
    told, length = np.sum(_ALL, axis=0)
    print(f"unchanged pipes in all: told {told:.0f} in {length:.0f} m, {100 * told / length:.2f} in 100 m")
    dents(0.6, 0.38, 70.0, 10.0, pipes=11)
    dents(0.5, 0.38, 70.0, 10.0, pipes=5)
    dents(1.1, 0.19, 35.0, 10.0, pipes=3)
    dents(0.6, 0.19, 35.0, 3.0, pipes=2)


if __name__ == "__main__":
    main()
