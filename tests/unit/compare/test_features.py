"""Feature lists: what is refused, and that mirroring is what driving from the other end does."""

from __future__ import annotations

import numpy as np
import pytest

from springline.compare import KINDS, feature_list
from springline.conventions import bearing_from_clock, clock_from_bearing
from springline.errors import InputError


def test_mirrored_twice_is_the_list_itself():
    rng = np.random.default_rng(0)
    kind = rng.choice(np.array(KINDS, dtype=object), 30)
    a = feature_list(np.sort(rng.uniform(0, 100, 30)), kind, bearing=rng.uniform(0, 6, 30), extent=(-1.0, 104.0))
    back = a.mirrored().mirrored()
    np.testing.assert_allclose(back.chainage, a.chainage)
    np.testing.assert_allclose(back.bearing, a.bearing)
    np.testing.assert_array_equal(back.kind, a.kind)


def test_a_tap_at_three_o_clock_is_at_nine_from_the_other_end():
    a = feature_list([1.0, 2.0], "lateral", bearing=bearing_from_clock(np.array([3.0, 11.0])))
    np.testing.assert_allclose(clock_from_bearing(a.mirrored().bearing), [1.0, 9.0])


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (([], "joint"), "there is no feature in it"),
        (([0.0, 3.0, 2.0], "joint"), "feature 3: chainage 2 m comes after 3 m"),
        (([0.0, np.nan], "joint"), "feature 2: the chainage is missing"),
        (([0.0, 1.0], "latteral"), "did you mean 'lateral'"),
        (([0.0, 1.0, 2.0], ["joint", "joint"]), "expected 3 values"),
        ((["1", "a"], "joint"), "chainage holds something else than numbers"),
    ],
)
def test_a_bad_list_is_refused_by_place_and_reason(arguments, told):
    with pytest.raises(InputError, match=told) as caught:
        feature_list(*arguments, name="tally.csv")
    assert "tally.csv" in str(caught.value)


def test_an_extent_must_hold_its_features():
    with pytest.raises(InputError, match="does not hold"):
        feature_list([0.0, 5.0], "joint", extent=(0.0, 4.0))


def test_infinite_values_are_refused_by_place():
    for extent in ((-np.inf, 5.0), (0.0, np.inf), (np.nan, 5.0)):
        with pytest.raises(InputError, match="does not hold"):
            feature_list([0.0, 5.0], "joint", extent=extent)
    for name in ("bearing", "size"):
        with pytest.raises(InputError, match=f"feature 2: the {name} is infinite"):
            feature_list([0.0, 5.0], "lateral", **{name: [np.nan, np.inf]})
