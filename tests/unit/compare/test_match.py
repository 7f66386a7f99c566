"""Matches of small lists, and lists that cannot be matched."""

from __future__ import annotations

import numpy as np
import pytest

from springline.compare import Drift, MatchOptions, feature_list, match, match_any
from springline.conventions import bearing_from_clock
from springline.errors import InputError, ParameterError


@pytest.fixture(scope="module")
def pipe():
    rng = np.random.default_rng(2)
    x = np.sort(rng.uniform(0, 90, 14))
    kind = ["lateral"] * 14
    return feature_list(x, kind, bearing=rng.choice([0.1, 1.5, 3.0], 14), extent=(0.0, 92.0), name="A")


def test_a_list_matches_itself_one_to_one(pipe):
    found = match(pipe, pipe)
    np.testing.assert_array_equal(found.pairs.index_a, np.arange(14))
    np.testing.assert_array_equal(found.pairs.index_b, np.arange(14))
    assert not found.reversed
    np.testing.assert_allclose(found.drift.at(pipe.chainage)[0], pipe.chainage, atol=0.02)


def test_from_the_other_end_indices_and_chainages_are_b_s_own(pipe):
    b = pipe.mirrored()
    found = match(pipe, b)
    assert found.reversed
    np.testing.assert_array_equal(found.pairs.index_b, 13 - found.pairs.index_a)
    place, sigma = found.drift.at(pipe.chainage)
    np.testing.assert_allclose(place, 92.0 - pipe.chainage, atol=0.02)
    assert (np.abs(place - b.chainage[::-1]) < 3 * sigma).all()
    np.testing.assert_allclose(found.pairs.residual, b.chainage[found.pairs.index_b] - place, atol=1e-9)


def test_the_roles_can_be_swapped(pipe):
    b = pipe.take(np.arange(14) != 5)
    there, back = match(pipe, b), match(b, pipe)
    np.testing.assert_array_equal(there.pairs.index_a, back.pairs.index_b)
    np.testing.assert_array_equal(there.pairs.index_b, back.pairs.index_a)
    assert 5 not in there.pairs.index_a


def test_a_single_feature_is_refused(pipe):
    with pytest.raises(InputError, match="B: it holds a single feature"):
        match(pipe, feature_list([3.0], "joint", name="B"))


def test_one_against_many_finds_its_own(pipe):
    rng = np.random.default_rng(8)
    others = [
        feature_list(np.sort(rng.uniform(0, 90, 14)), "lateral", bearing=rng.choice([0.1, 1.5, 3.0], 14))
        for _ in range(2)
    ]
    said = match_any(pipe, [others[0], pipe.mirrored(), others[1]])
    assert [bool(m) for m in said] == [False, True, False]
    for refused in (said[0], said[2]):
        assert "do not show" in refused.reason
        assert len(refused.pairs) == 0
        assert np.isnan(refused.drift.at(10.0)[0])
        assert not refused.reliable(10.0)


def test_a_stretch_that_b_has_not_seen_is_flagged(pipe):
    kept = pipe.chainage < 60.0
    b = feature_list(pipe.chainage[kept], "lateral", bearing=pipe.bearing[kept], extent=(0.0, 60.0))
    found = match(pipe, b)
    assert found
    assert not found.reliable(80.0)
    assert found.reliable(30.0)
    assert {s.reason for s in found.flagged} & {"not inspected by both", "more than one place is likely"}


def test_joints_alone_of_equal_lengths_are_never_sure():
    a = feature_list(2.5 * np.arange(40), "joint")
    b = feature_list(2.5 * np.arange(38) + 0.02, "joint")
    found = match(a, b)
    assert not found or not found.reliable(a.chainage).any()


def test_drift_between_nodes_is_less_sure_than_at_them():
    drift = Drift(np.array([0.0, 10.0]), np.array([0.0, 10.0]), np.array([0.01, 0.01]), np.ones(2), 1e-4)
    sigma = drift.at(np.array([0.0, 5.0, 10.0]))[1]
    assert sigma[1] > sigma[0] == sigma[2]
    assert np.isnan(drift.at(np.array([-0.1, 10.1]))[0]).all()


@pytest.mark.parametrize("name", ["noise", "walk", "accept_same"])
def test_options_out_of_range_are_named(name):
    with pytest.raises(ParameterError, match=f"{name} is -1"):
        MatchOptions(**{name: -1.0})


def test_taps_of_one_place_two_clock_hours_apart_are_two_taps():
    rng = np.random.default_rng(5)
    x = np.sort(rng.uniform(0.0, 90.0, 12))
    hours = rng.choice([2.0, 3.0, 9.0, 10.0], 12)
    lists = []
    for late in (0.0, 1.0, 2.0):
        clock = hours + late * (np.arange(12) == 6)
        lists.append(feature_list(x, "lateral", bearing=bearing_from_clock(clock), extent=(0.0, 92.0)))
    one, two = (match(lists[0], b, MatchOptions.cctv()) for b in lists[1:])
    assert 6 in one.pairs.index_a
    assert 6 not in two.pairs.index_a
    assert len(two.pairs) == 11


def test_a_list_with_every_feature_twice_is_that_list(pipe):
    twice = np.repeat(np.arange(14), 2)
    found = match(pipe.take(twice), pipe)
    np.testing.assert_array_equal(found.pairs.index_a, 2 * np.arange(14))
    np.testing.assert_array_equal(found.pairs.index_b, np.arange(14))
    found = match(pipe, pipe.mirrored().take(twice))
    np.testing.assert_array_equal(found.pairs.index_b, 2 * (13 - np.arange(14)))


@pytest.mark.parametrize("options", [MatchOptions(), MatchOptions.cctv()])
def test_features_of_one_place_are_refused(pipe, options):
    heap = feature_list([5.0, 5.0, 5.0], "lateral", bearing=[0.0, 1.5, 3.0], name="heap")
    for pair in ((heap, pipe), (pipe, heap)):
        with pytest.raises(InputError, match="heap: its 3 features all stand at 5 m"):
            match(*pair, options)


@pytest.mark.parametrize("options", [MatchOptions(), MatchOptions.cctv()])
def test_a_palindrome_does_not_tell_its_end(options):
    x = np.array([0.0, 7.3, 20.0, 31.2, 50.0, 68.8, 80.0, 92.7, 100.0])
    b = feature_list(np.sort(x + np.random.default_rng(1).normal(0.0, 0.01, 9)), "lateral", bearing=np.pi / 2)
    found = match(feature_list(x, "lateral", bearing=np.pi / 2), b, options)
    assert not found
    assert "from which end" in found.reason
    assert found.probability_direction < 0.6


@pytest.mark.parametrize("options", [MatchOptions(), MatchOptions.cctv()])
def test_a_list_in_the_wrong_unit_is_refused(pipe, options):
    for factor in (1e3, 1.0 / 0.3048):
        b = feature_list(factor * pipe.chainage, "lateral", bearing=pipe.bearing)
        found = match(pipe, b, options)
        assert not found
        assert found.reason
        assert len(found.pairs) == 0


def test_lists_without_bearings_match_by_place(pipe):
    blind = feature_list(pipe.chainage, "lateral", extent=pipe.extent)
    assert len(match(blind, pipe).pairs) == len(match(blind, blind.mirrored()).pairs) == 14


def test_evidence_and_prior_make_the_posterior_of_one_pipe(pipe):
    b = pipe.take(np.arange(14) < 4)
    found = [match(pipe.take(np.arange(14) < 4), b, MatchOptions(prior_same=prior)) for prior in (0.5, 0.001)]
    assert found[0].evidence == pytest.approx(found[1].evidence)
    for one, prior in zip(found, (0.5, 0.001), strict=True):
        odds = np.exp(one.evidence) * prior / (1.0 - prior)
        assert one.probability_same == pytest.approx(odds / (1.0 + odds))


def test_a_list_of_mostly_triple_lengths_is_laid_on_its_neighbours_lattice():
    # Three lengths between most joints of A: taken for the module, they laid its second joint 0.9 m off in B.
    a = [2.259, 9.766, 14.740, 22.256, 24.765, 32.268, 39.756, 44.779, 49.779]
    b = [2.255, 7.246, 14.725, 19.734, 22.230, 24.734, 27.215, 29.722, 32.228, 34.719, 37.220, 39.702, 44.724, 49.712]
    lists = []
    for x, bend in ((a, 20.056), (b, 20.03)):
        before = int(np.searchsorted(x, bend))
        kinds = ["joint"] * before + ["bend"] + ["joint"] * (len(x) - before)
        lists.append(feature_list([*x[:before], bend, *x[before:]], kinds, extent=(0.0, 50.4)))
    found = match(*lists)
    assert found
    assert np.abs(found.drift.at(np.array(a))[0] - np.array(a)).max() < 0.1
