"""Simulated repeat inspections: features of one pipe seen twice, with the odometers' faults; for bench and tests."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from springline.compare import KINDS, FeatureList, feature_list

if TYPE_CHECKING:
    from collections.abc import Callable

MODULE, SPREAD = 2.5, 0.008


@dataclass(frozen=True)
class Seen:
    """One inspection: its list, which feature of the pipe each entry is (-1: false), counter by true chainage."""

    features: FeatureList
    identity: np.ndarray
    counter: Callable[[np.ndarray], np.ndarray]

    def between(self, first: float, last: float) -> Seen:
        """Return what an inspection of that part [m] alone would have seen, its counter at 0 in `first`."""
        x = self.features.chainage
        part = self.features.between(first, last)
        moved = replace(part, chainage=part.chainage - first, extent=tuple(end - first for end in part.extent))
        return Seen(moved, self.identity[(x >= first) & (x <= last)], lambda v: self.counter(v) - first)


def pipe(rng: np.random.Generator, length: float, lateral_every: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return true chainages, kinds and bearings: joints, laterals mostly at 3 and 9 o'clock, a few bends."""
    joints = np.cumsum(rng.normal(MODULE, SPREAD, int(length / MODULE) + 6)) - 2.0 * MODULE
    laterals = rng.uniform(0.0, length, rng.poisson(length / lateral_every) if np.isfinite(lateral_every) else 0)
    bends = rng.uniform(0.0, length, rng.poisson(length / 150.0) if laterals.size else 0)
    kind = np.repeat([0, 1, 2], [joints.size, laterals.size, bends.size])
    bearing = np.full(kind.size, np.nan)
    bearing[kind == 1] = rng.choice([0.2, np.pi - 0.2, np.pi / 2], laterals.size) + rng.normal(0, 0.25, laterals.size)
    x = np.concatenate((joints, laterals, bends))
    order = np.argsort(x)
    return x[order], kind[order], bearing[order]


def inspect(rng: np.random.Generator, truth: tuple, length: float, missing: float, noise: float) -> Seen:
    """Return one inspection: missed and 5 % false features, scale, slips of 0.05 to 0.4 m, its own ends."""
    x, kind, bearing = truth
    first, last = rng.uniform(0, 8), length - rng.uniform(0, 8)
    scale = 1 + rng.normal(0, 0.01) / np.sqrt(2)
    slips = rng.poisson(length / 100.0)
    at, size = rng.uniform(first, last, slips), rng.uniform(0.05, 0.4, slips) * rng.choice([-1, 1], slips)

    def counter(v: np.ndarray) -> np.ndarray:
        return (v - first) * scale + (size * (np.asarray(v)[..., None] > at)).sum(axis=-1)

    there = np.flatnonzero((x >= first) & (x <= last) & (rng.random(x.size) >= missing))
    false = rng.poisson(0.05 * there.size)
    kinds = np.concatenate((kind[there], rng.choice(kind, false)))
    angles = np.concatenate((bearing[there] + rng.normal(0, 0.1, there.size), rng.uniform(0, 2 * np.pi, false)))
    places = counter(np.concatenate((x[there], rng.uniform(first, last, false)))) + rng.normal(0, noise, kinds.size)
    identity = np.concatenate((there, np.full(false, -1)))
    order = np.argsort(places)
    listed = feature_list(
        places[order],
        np.array(KINDS, dtype=object)[kinds[order]],
        bearing=np.where(kinds == 1, angles, np.nan)[order],
        extent=(min(0.0, places.min()), max(places.max(), float(counter(np.array(last))))),
    )
    return Seen(listed, identity[order], counter)


def turned(seen: Seen) -> Seen:
    """Return the inspection as driven from the other end."""
    both = sum(seen.features.extent)
    return Seen(seen.features.mirrored(), seen.identity[::-1], lambda v: both - seen.counter(v))


def repeat(
    rng: np.random.Generator,
    *,
    missing: float,
    length: float = 300.0,
    noise: float = 0.01,
    lateral_every: float = 12.0,
    same: bool = True,
) -> tuple[Seen, Seen, bool]:
    """Return two inspections of one pipe (or of two when not `same`) and whether the second came from the other end."""
    first = pipe(rng, length, lateral_every)
    second = first if same else pipe(rng, length, lateral_every)
    a, b = (inspect(rng, truth, length, missing, noise) for truth in (first, second))
    other_end = bool(rng.random() < 0.5)
    return a, (turned(b) if other_end else b), other_end


def score(a: Seen, b: Seen, index_a: np.ndarray, index_b: np.ndarray) -> tuple[int, int, int]:
    """Return right pairs, pairs given, and features that both inspections hold."""
    right = (a.identity[index_a] == b.identity[index_b]) & (a.identity[index_a] >= 0)
    both = np.intersect1d(a.identity[a.identity >= 0], b.identity[b.identity >= 0])
    return int(right.sum()), len(right), both.size
