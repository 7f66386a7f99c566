"""The interval of an amplitude: its critical distances, its ends, and its limits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import ncx2, rice

from springline.errors import ParameterError
from springline.geometry.fitting import amplitude_interval
from springline.geometry.fitting.boundary import STEP, critical_distances


@pytest.mark.parametrize("level", [0.68, 0.95, 0.99])
def test_critical_distances_hold_the_level_of_a_rice_distribution(level):
    table = critical_distances(level)
    for k in (0, 10, 60, 150, 400, 600):
        amplitude, c = k * STEP, table[k]
        if amplitude == 0.0:
            assert c**2 == pytest.approx(ncx2.ppf(level, 2, 0.0), rel=1e-9)
        else:
            held = rice.cdf(amplitude + c, amplitude) - rice.cdf(max(amplitude - c, 0.0), amplitude)
            assert held == pytest.approx(level, abs=1e-9)


def test_ends_are_where_the_estimate_is_at_the_critical_distance():
    lengths = np.linspace(0.0, 11.0, 45)
    low, high = amplitude_interval(np.stack([0.6 * lengths, -0.8 * lengths], axis=-1), np.eye(2))
    table, at = critical_distances(0.95), STEP * np.arange(601)
    inside = low > 0.0
    assert (inside == (lengths > 2.4477)).all()
    assert (lengths - low)[inside] == pytest.approx(np.interp(low, at, table)[inside], abs=1e-6)
    assert high - lengths == pytest.approx(np.interp(high, at, table), abs=1e-6)


def test_interval_is_two_sided_normal_far_from_zero():
    """With unequal and correlated sigmas it is the sigma along the vector that counts."""
    covariance = np.array([[4.0, 1.0], [1.0, 2.0]])
    direction = np.array([np.cos(1.0), np.sin(1.0)])
    sigma = np.sqrt(direction @ covariance @ direction)
    low, high = amplitude_interval(1000.0 * direction, covariance)
    assert (1000.0 - low) / sigma == pytest.approx(1.96, abs=0.01)
    assert (high - 1000.0) / sigma == pytest.approx(1.96, abs=0.01)


@pytest.mark.parametrize("aspect", [1.0, 3.0])
def test_zero_is_held_as_long_as_the_chi_square_of_the_estimate_allows(aspect):
    covariance = np.diag([aspect**2, 1.0])
    for angle in np.linspace(0.0, np.pi, 9):
        unit = np.array([aspect * np.cos(angle), np.sin(angle)])
        just_inside, just_outside = (amplitude_interval(c * unit, covariance)[0] for c in (2.447, 2.449))
        assert just_inside == 0.0
        assert 0.0 < just_outside < 0.2


@pytest.mark.parametrize("covariance", [np.eye(2), np.array([[3.0, 0.5], [0.5, 1.0]])])
def test_ends_change_without_a_jump_where_one_sided_becomes_two_sided(covariance):
    direction = np.array([1.0, 0.3])
    turning = 2.447747 / np.sqrt(direction @ np.linalg.inv(covariance) @ direction)
    # the lower end leaves zero like a square root, so the steps are fine there
    for lengths, most in ((np.linspace(0.0, 6.0, 601), 0.2), (turning + np.linspace(-1e-4, 1e-4, 201), 2e-3)):
        low, high = amplitude_interval(lengths[:, None] * direction, covariance)
        for end in (low, high):
            assert np.abs(np.diff(end)).max() < most
        length = lengths * np.hypot(*direction)
        assert (low <= length).all()
        assert (length <= high).all()
        assert low[0] == 0.0 < low[-1]


def test_unit_and_rotation_do_not_matter():
    vector, covariance = np.array([3.0, 1.0]), np.array([[1.0, 0.3], [0.3, 0.5]])
    cos, sin = np.cos(0.7), np.sin(0.7)
    turn = np.array([[cos, -sin], [sin, cos]])
    expected = amplitude_interval(vector, covariance)
    turned = amplitude_interval(turn @ vector, turn @ covariance @ turn.T)
    grown = amplitude_interval(1e-3 * vector, 1e-6 * covariance)
    assert np.array(turned) == pytest.approx(np.array(expected), abs=1e-7)
    assert 1e3 * np.array(grown) == pytest.approx(np.array(expected), abs=1e-7)


def test_missing_stays_missing_and_shapes_broadcast():
    low, high = amplitude_interval([[[np.nan, 1.0], [1.0, 0.0]]], np.eye(2))
    assert low.shape == high.shape == (1, 2)
    assert np.isnan(low[0, 0])
    assert np.isnan(high[0, 0])
    assert np.isfinite(high[0, 1])
    low, _ = amplitude_interval([1.0, 0.0], np.full((2, 2), np.nan))
    assert np.isnan(low)


def test_wrong_arguments_are_named():
    with pytest.raises(ParameterError, match=r"vector has shape \(3,\)"):
        amplitude_interval(np.ones(3), np.eye(2))
    with pytest.raises(ParameterError, match="level is 95"):
        amplitude_interval(np.ones(2), np.eye(2), level=95)
