"""Matches of real repeat inspections; the rest of what is asked of them is in bench/compare.py."""

from __future__ import annotations

import numpy as np
import pytest
from bench import _compare_sewers as sewers

from springline.compare import MatchOptions, match

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not sewers.FOLDER.exists(), reason="../shared/data/pacp-repeat-inspections is absent"),
]


@pytest.fixture(scope="module")
def whole():
    """All pairs with three taps or more in both inspections."""
    return [(one, match(one.a, one.b, MatchOptions.cctv())) for one in sewers.repeats(3)]


@pytest.fixture(scope="module")
def found(whole):
    """Every eighth of them."""
    return whole[::8]


def test_direction(whole):
    assert np.mean([m.reversed == one.other_end for one, m in whole]) >= 0.98


def test_taps_within_four_feet_and_an_hour(whole):
    given = sum(sewers.good_taps(one, m) for one, m in whole)
    assert given / sum(min(sewers.taps(one.a), sewers.taps(one.b)) for one, _ in whole) >= 0.92


def test_a_tap_left_out_lands_nearer_than_by_scaling(found):
    rows = np.concatenate([sewers.left_out(one, m, MatchOptions.cctv()) for one, m in found[::2]])
    apart, scaled = np.nanmedian(np.abs(rows[:, 1:3]), axis=0) / sewers.FOOT
    assert apart <= 0.25 < scaled


def test_hidden_taps_leave_the_rest_right(found):
    rng = np.random.default_rng(3)
    right, given = np.sum([sewers.hidden(one, m, MatchOptions.cctv(), rng)[1:] for one, m in found], axis=0)
    assert right / given >= 0.98


def test_other_sewers_are_refused(found):
    strangers = [(one.a, found[(k + 7) % len(found)][0].b) for k, (one, _) in enumerate(found)]
    said = [match(a, b, MatchOptions.cctv()).accepted for a, b in strangers]
    assert np.mean(said) <= 0.02
