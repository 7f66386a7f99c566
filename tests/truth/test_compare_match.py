"""Matches of simulated pipes against truth; the long tables are in bench/compare.py."""

from __future__ import annotations

import numpy as np
import pytest
from bench._compare_pipes import repeat, score, turned

from springline.compare import feature_list, match


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


@pytest.mark.parametrize(("in_a", "in_b"), [((0, 290), (120, 220)), ((120, 220), (0, 290)), ((0, 240), (50, 290))])
@pytest.mark.parametrize("other_end", [False, True])
def test_starts_far_apart(in_a, in_b, other_end):
    a, b, driven = repeat(np.random.default_rng(930), missing=0.1)
    a, b = a.between(*in_a), (turned(b) if driven else b).between(*in_b)
    found = match(a.features, (turned(b) if other_end else b).features)
    assert found
    assert found.reversed == other_end
    told = len(b.identity) - 1 - found.pairs.index_b if other_end else found.pairs.index_b
    right, given, both = score(a, b, found.pairs.index_a, told)
    assert right >= 0.95 * given
    assert right >= 0.9 * both
    true = np.arange(5.0, 285.0)
    x, y = a.counter(true), b.counter(true)
    here = (x > a.features.extent[0]) & (x < a.features.extent[1])
    outside = here & ((y < b.features.extent[0] - 6.0) | (y > b.features.extent[1] + 6.0))
    assert not found.reliable(x[outside]).any()
    assert found.reliable(x[here & (y > b.features.extent[0] + 6.0) & (y < b.features.extent[1] - 6.0)]).mean() > 0.8


def test_a_stretch_of_a_long_tally_is_found_and_another_is_refused():
    rng = np.random.default_rng(4)
    weld, other = (np.cumsum(rng.choice([12.2, 11.6, 10.8], 500) + rng.normal(0, 0.15, 500)) for _ in range(2))
    whole = feature_list(weld, "joint")
    first = 2000.0
    for places, same in ((weld, True), (other, False)):
        cut = places[(places > first) & (places < first + 400.0)]
        part = feature_list(1.003 * (cut - first) + rng.normal(0, 0.03, cut.size), "joint")
        found = match(whole, part.mirrored())
        assert bool(found) == same
        if same:
            assert found.reversed
            np.testing.assert_allclose(weld[found.pairs.index_a], cut[::-1][found.pairs.index_b])
