"""Matches of simulated pipes against truth; the long tables are in bench/compare.py."""

from __future__ import annotations

import numpy as np
import pytest
from bench._compare_pipes import repeat, score

from springline.compare import match


@pytest.fixture(scope="module")
def found():
    """Eight pipes of 150 m, a fifth of the features missing in each epoch."""
    rng = np.random.default_rng(21)
    cases = [repeat(rng, missing=0.2, length=150.0, lateral_every=10.0) for _ in range(8)]
    return [(a, b, other_end, match(a.features, b.features)) for a, b, other_end in cases]


def test_both_ends_are_driven_from_and_found(found):
    assert {other_end for *_, other_end, _ in found} == {True, False}
    assert all(m.reversed == other_end for *_, other_end, m in found if m)
    assert sum(bool(m) for *_, m in found) >= 7


def test_pairs_are_right_and_few_are_missed(found):
    right, given, both = np.sum([score(a, b, m.pairs.index_a, m.pairs.index_b) for a, b, _, m in found if m], axis=0)
    assert right / given >= 0.98
    assert right / both >= 0.95


def test_chainage_and_its_interval(found):
    errors, inside = [], []
    for a, b, _, m in found:
        if not m:
            continue
        true = np.arange(10.0, 140.0, 0.5)
        x = a.counter(true)
        place, sigma = m.drift.at(x)
        good = m.reliable(x) & np.isfinite(place)
        off = (place - b.counter(true))[good]
        errors += off.tolist()
        inside += (np.abs(off) < 1.96 * sigma[good]).tolist()
    assert np.sqrt(np.mean(np.square(errors))) < 0.04
    assert np.mean(inside) > 0.9


def test_two_pipes_of_one_module_are_refused():
    rng = np.random.default_rng(5)
    cases = (repeat(rng, missing=0.1, length=120.0, lateral_every=8.0, same=False)[:2] for _ in range(4))
    assert not any(match(a.features, b.features) for a, b in cases)
