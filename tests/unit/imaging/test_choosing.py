"""Which frames are looked at, and how the interval is learned."""

import numpy as np

from springline.imaging.choosing import Bias, choose_frames


def test_every_place_is_seen_well_from_a_chosen_frame():
    cameras = np.arange(0.0, 20.0, 0.1)
    places = np.array([3.03, 9.51, 17.77])
    chosen = choose_frames(cameras, places, 0.2, 0.4)
    ahead = places[:, None] - cameras[chosen]
    assert len(chosen) == 3
    assert ((ahead > 0.2) & (ahead < 0.4)).any(axis=1).all()


def test_one_frame_serves_places_that_lie_together():
    cameras = np.arange(0.0, 20.0, 0.1)
    rng = np.random.default_rng(1)
    places = np.sort(rng.uniform(1.0, 19.0, 40))
    chosen = choose_frames(cameras, places, 0.2, 0.5)
    ahead = places[:, None] - cameras[chosen]
    assert ((ahead >= 0.2) & (ahead <= 0.5)).any(axis=1).all()
    # the shortest cover takes the farthest frame that still sees the first place that is left, and so on
    fewest, left = 0, list(places)
    while left:
        at = cameras[cameras <= left[0] - 0.2 + 1e-9].max()
        left = [place for place in left if not 0.2 <= place - at + 1e-9 <= 0.5 + 2e-9]
        fewest += 1
    assert fewest <= len(chosen) <= 1.3 * fewest


def test_a_place_worth_little_calls_for_no_frame_but_sways_the_choice():
    cameras = np.arange(0.0, 4.0, 0.1)
    assert len(choose_frames(cameras, [1.0, 2.0], 0.2, 0.4, worth=0.3)) == 0
    (alone,) = choose_frames(cameras, [2.0], 0.2, 0.5)
    (swayed,) = choose_frames(cameras, [2.0, 1.85], 0.2, 0.5, worth=[1.0, 0.9])
    assert abs(2.0 - cameras[alone] - 0.35) < 0.051
    assert 0.2 <= 1.85 - cameras[swayed] <= 0.5 and 2.0 - cameras[swayed] <= 0.5


def test_places_out_of_reach_and_frames_without_a_place_are_left_out():
    assert list(choose_frames([np.nan, 0.1, 0.2], [0.5, 9.0], 0.3, 0.4)) in ([1], [2])
    assert len(choose_frames([np.nan], [1.0], 0.1, 0.2)) == 0
    assert len(choose_frames([], [1.0], 0.1, 0.2)) == 0
    assert len(choose_frames([0.0, 0.1], [], 0.1, 0.2)) == 0
    assert list(choose_frames([0.0, 0.1, 0.2], [0.4], 0.2, 0.4, without={0, 1})) == [2]


def test_a_place_between_sparse_frames_gets_the_nearest():
    chosen = choose_frames(np.arange(0.0, 10.0, 0.5), [5.05], 0.2, 0.4)
    assert list(chosen) == [10] or list(chosen) == [9]


def test_learning_narrows_the_interval_and_never_loses_what_was_needed():
    rng = np.random.default_rng(0)
    bias = Bias(0.1, 2.0)
    needed = rng.uniform(0.2, 0.45, 12)
    for ahead in needed:
        bias = bias.learn(ahead)
        assert bias.high >= ahead
    assert bias.learned == 12 and bias.high <= 1.25 * needed.max() + 1e-12
