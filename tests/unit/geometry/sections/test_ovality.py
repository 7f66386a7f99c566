"""Ovality and its noise floor against the errata and against draws."""

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.sections import ellipse, expected_maximum, hinged, mean_radius_of_circular_hinges, ovality


def test_definitions_of_an_ellipse_side_by_side():
    found = ellipse(1.2, 1.0).diameters
    means = ("axes", "polar", "area", "caliper")
    largest = [100 * found.ovality(mean) for mean in means]
    smallest = [100 * found.ovality(mean, extreme="min") for mean in means]
    assert largest == pytest.approx([9.09090909, 9.77213763, 9.54451150, 8.86586320], abs=1e-8)
    assert smallest == pytest.approx([9.09090909, 8.52321865, 8.71290708, 9.27844733], abs=1e-8)
    assert ovality(found.largest.length, found.polar) == pytest.approx(found.ovality("polar"))
    with pytest.raises(ParameterError, match="mean = 'median' is not known"):
        found.ovality("median")


def test_corrected_last_rows_of_the_tables():
    for mode, percent in ((3, 10.51), (4, 10.53), (5, 10.33)):
        section = hinged(mode, 0.9, 0.95, 0.92, rule="ramanujan")
        assert 100 * section.diameters.ovality("polar") == pytest.approx(percent, abs=0.006)


def test_closed_mean_radius_of_mode_2():
    s = np.linspace(0.02, 1.0, 50)
    np.testing.assert_allclose(mean_radius_of_circular_hinges(s), hinged(2, s).mean_radius, rtol=1e-11)
    with pytest.raises(ParameterError, match="s = 0 is out of range"):
        mean_radius_of_circular_hinges(0.0)


def test_expected_maximum_of_normal_numbers():
    assert expected_maximum([1, 2, 3]) == pytest.approx([0, 1 / np.sqrt(np.pi), 1.5 / np.sqrt(np.pi)], abs=1e-12)
    draws = np.random.default_rng(7).standard_normal((20000, 120)).max(axis=1)
    assert expected_maximum(120) == pytest.approx(draws.mean(), abs=4 * draws.std() / np.sqrt(20000))
    assert 5 * expected_maximum([120, 360]) == pytest.approx([12.9, 14.7], abs=0.05)
