"""Polar radii of sections: a million (section, bearing) pairs, by the kernel and through the Section interface."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.liners import lobed
from springline.geometry.sections import FAMILIES, egg, hinged, s1_limits

if TYPE_CHECKING:
    from collections.abc import Callable

PAIRS = 1_000_000


def _time(what: str, run: Callable[[], object], repeats: int = 5) -> None:
    run()  # compiles
    taken = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        taken.append(time.perf_counter() - start)
    print(f"{what:<68} {1e3 * min(taken):8.1f} ms")


def main() -> None:
    rng = np.random.default_rng(0)
    s02 = rng.uniform(0.8, 1.0, PAIRS)
    s01 = rng.uniform(0.7, s02)
    low, _ = s1_limits(5, s02, s01)
    s1 = np.maximum(rng.uniform(0.6, s01), low)
    parameters = np.stack([np.full(PAIRS, 0.15), s1, s02, s01], axis=-1)
    own = rng.uniform(0.0, 2 * np.pi, (PAIRS, 1))
    ring = np.linspace(0.0, 2 * np.pi, 360, endpoint=False)
    rings = PAIRS // 360
    family, few = FAMILIES["mode 5"], parameters[:rings]
    batch = hinged(5, s1[:rings], s02[:rings], s01[:rings], 0.15)
    print(f"Polar radius of {PAIRS:,} (section, bearing) pairs; the target for mode 5 is 250 ms")
    _time("mode 5, every pair a section of its own, exact perimeter", lambda: family.polar_radius(own, parameters))
    _time(f"mode 5, {rings} sections at 360 bearings", lambda: family.polar_radius(ring, few))
    _time(f"mode 5, {rings} sections at 360 bearings, with derivatives", lambda: family.derivatives(ring, few))
    _time(f"mode 5, {rings} sections at 360 bearings, Section interface", lambda: batch.polar_radius(ring))
    height = np.full(rings, 0.9)
    _time(f"egg, {rings} sections at 360 bearings", lambda: egg(0.6, height, 0.15).polar_radius(ring), 2)
    depth = np.full(rings, 0.12)
    _time(f"lobe, {rings} sections at 360 bearings", lambda: lobed(0.15, 0.15, 0.5, depth).polar_radius(ring), 2)
    many = {"s1": s1[:100_000], "s02": s02[:100_000], "s01": s01[:100_000]}
    _time("all diameters of 100,000 sections of mode 5", lambda: hinged(5, **many).diameters, 2)
