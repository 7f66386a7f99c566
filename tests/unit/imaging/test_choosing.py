"""Which frames are looked at, and how the interval is learned."""

import numpy as np

from springline.imaging.choosing import Bias, choose_frames


def test_every_place_gets_the_frames_from_which_it_is_seen_well():
    cameras = np.arange(0.0, 20.0, 0.1)
    places = np.array([3.03, 9.51, 17.77])
    bias = Bias(0.2, 0.4)
    chosen, by_place = choose_frames(cameras, places, bias, each=3)
    ahead = places[:, None] - cameras[by_place]
    assert (ahead > 0.14).all() and (ahead < 0.46).all()
    assert np.array_equal(chosen, np.unique(by_place))
    assert len(chosen) / len(cameras) < 0.05


def test_places_out_of_reach_and_frames_without_a_place_are_left_out():
    chosen, by_place = choose_frames([np.nan, 0.1, 0.2], [0.5, 9.0], Bias(0.3, 0.4))
    assert list(chosen) == [1, 2] and (by_place[1] == -1).all()
    assert len(choose_frames([np.nan], [1.0], Bias(0.1, 0.2))[0]) == 0


def test_learning_narrows_the_interval_and_never_loses_what_was_needed():
    rng = np.random.default_rng(0)
    bias = Bias(0.1, 2.0)
    needed = rng.uniform(0.2, 0.45, 12)
    for ahead in needed:
        bias = bias.learn(ahead)
        assert bias.high >= ahead
    assert bias.learned == 12 and bias.high <= 1.25 * needed.max() + 1e-12
