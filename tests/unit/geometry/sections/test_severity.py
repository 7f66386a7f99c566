"""Limits and relations of the severities against the errata's numbers and the shared springline itself."""

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.sections import chord, hinged, pathway, s1_limits, s2_of_s1
from springline.geometry.sections.ellipses import semi_major


def test_lower_limits_of_mode_4_by_both_rules():
    s02 = np.arange(10, 0, -1) / 10
    published = [0.463431, 0.457427, 0.440412, 0.413596, 0.377916, 0.334097, 0.282694, 0.224078, 0.158379, 0.0851487]
    exact = [0.463322, 0.457309, 0.440265, 0.413394, 0.377618, 0.333644, 0.282001, 0.223030, 0.156849, 0.083167]
    np.testing.assert_allclose(s1_limits(4, s02, rule="ramanujan")[0], published, atol=6e-7)
    np.testing.assert_allclose(s1_limits(4, s02)[0], exact, atol=6e-7)


@pytest.mark.parametrize("rule", ["exact", "ramanujan"])
def test_both_halves_reach_the_same_springline(rule):
    s1, s02, s01 = 0.55, 0.8, 0.6
    for mode, top, bottom in ((3, 1.0, s1), (4, s02, s1), (5, s02, s01)):
        s2 = s2_of_s1(mode, s1, s02, s01, rule=rule)
        assert chord(top, rule=rule) ** 2 - s2**2 == pytest.approx(chord(bottom, rule=rule) ** 2 - s1**2, rel=1e-13)
    assert s2_of_s1(1, 0.7) == pytest.approx(0.7, rel=1e-15)
    assert s2_of_s1(2, 0.7) == pytest.approx(0.7, rel=1e-15)


def test_at_the_lower_limit_the_crown_has_come_down_to_o():
    for mode, s02, s01 in ((3, 1, 1), (4, 0.8, 1), (4, 0.1, 1), (5, 0.8, 0.6), (5, 1.0, 0.47)):
        low, _ = s1_limits(mode, s02, s01)
        assert s2_of_s1(mode, low, s02, s01) == pytest.approx(0.0, abs=2e-7)
        section = hinged(mode, low, s02, s01)
        assert section.polar_radius(np.pi / 2) == pytest.approx(0.0, abs=2e-7)
        assert np.isfinite(section.diameters.caliper)


def test_s1_and_s2_are_nearly_linear_above_nine_tenths():
    s1 = np.linspace(0.9, 1.0, 201)
    s2 = s2_of_s1(3, s1)
    straight = s2[0] + (s2[-1] - s2[0]) * (s1 - 0.9) / 0.1
    assert np.max(np.abs(s2 - straight)) == pytest.approx(0.0014, abs=1e-4)
    slope = np.gradient(s2, s1)
    assert slope.min() == pytest.approx(1.0, abs=0.01)
    assert slope.max() == pytest.approx(1.11, abs=0.01)


def test_pathway_is_continuous_and_names_the_mode():
    s1 = np.linspace(1.0, 0.62, 400)
    mode, s2 = pathway(s1, s02=0.9, s01=0.8)
    assert mode.tolist() == sorted(mode.tolist())
    assert set(mode.tolist()) == {1, 4, 5}
    assert np.max(np.abs(np.diff(s2))) < 3 * (s1[0] - s1[1])
    assert set(pathway(s1, s02=1.0, s01=0.8)[0].tolist()) == {1, 3, 5}
    assert set(pathway(s1, s02=1.0, s01=1.0)[0].tolist()) == {1, 2}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((3, 0.46), "s1 = 0.46 is out of range; expected 0.4633217838 <= s1 <= 1 with mode = 3"),
        ((4, 0.44, 0.8), "expected 0.4402650781 <= s1 <= 0.8 with mode = 4, s02 = 0.8"),
        ((4, 0.9, 0.8), "s1 = 0.9 is out of range; expected 0.4402650781 <= s1 <= 0.8"),
        ((5, 0.5, 0.6, 0.8), "s01 = 0.8 is out of range; expected 0 < s01 <= 0.6 with mode = 5, s02 = 0.6"),
        ((5, 0.15, 1.0, 0.2), "s01 = 0.2 is out of range; expected 0.4633217838 <= s01 <= 1 with mode = 5, s02 = 1"),
        ((5, 0.3, 0.8, 0.6), "expected 0.3058006747 <= s1 <= 0.6 with mode = 5, s02 = 0.8, s01 = 0.6"),
        ((5, 0.65, 0.8, 0.6), "s1 = 0.65 is out of range"),
        ((1, 0.0), "s1 = 0 is out of range; expected 0 < s1 <= 1 with mode = 1"),
        ((2, 1.1), "s1 = 1.1 is out of range"),
        ((4, 0.5, 1.2), "s02 = 1.2 is out of range; expected 0 < s02 <= 1 with mode = 4"),
        ((6, 0.9), "mode = 6 is unknown"),
        (([1, 4], [0.9, 0.9], 0.8), "element 1: s1 = 0.9 is out of range"),
    ],
)
def test_out_of_range_states_the_range_for_the_given_others(arguments, message):
    with pytest.raises(ParameterError) as refused:
        hinged(*arguments)
    assert message in str(refused.value)


def test_severities_that_a_mode_does_not_read_are_ignored():
    assert s2_of_s1(3, 0.9, np.nan, np.nan) == s2_of_s1(3, 0.9)
    assert semi_major(0.9) == pytest.approx(hinged(4, 0.9, 0.95, 0.3).springline)
