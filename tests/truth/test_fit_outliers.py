"""Outliers of known place: the robust fits come out as if they were not there."""

from __future__ import annotations

import numpy as np
import pytest

from springline.geometry.fitting import fit_circles_to_ranges, fit_ellipses_to_ranges

TRIALS = 300
BEARINGS = np.radians(np.arange(360.0))
HALF, AXIS = 0.036, 0.3
TRUTH = np.array([0.0, 0.0, 1.0, HALF * np.cos(2 * AXIS), HALF * np.sin(2 * AXIS)])


def rings(noise, seed, half=HALF):
    """Return noisy ranges about the centre of an ellipse, from its polar form."""
    a, b = 1.0 + half, 1.0 - half
    wall = a * b / np.hypot(b * np.cos(BEARINGS - AXIS), a * np.sin(BEARINGS - AXIS))
    rng = np.random.default_rng(seed)
    return wall + noise * rng.standard_normal((TRIALS, BEARINGS.size)), rng


def assert_as_if_absent(fits, true, *, most_failed=0.0):
    """Hold the intervals to the truth, and no trial far from it but for a few in a thousand."""
    assert (~fits.fitted).mean() <= most_failed
    off = np.abs(fits.parameters - true)[fits.fitted] / fits.sigma[fits.fitted]
    share = (off <= 1.96).mean(axis=0)
    assert (share >= 0.90).all(), share
    assert (off.max(axis=1) > 6.0).mean() <= 0.01


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("share", [0.2, 0.3])
@pytest.mark.parametrize("noise", [0.002, 0.01, 0.03])
def test_one_sided_outliers_all_round(noise, share, side):
    ranges, rng = rings(noise, 1)
    struck = rng.random(ranges.shape).argsort(axis=1)[:, : int(share * BEARINGS.size)]
    shift = side * rng.uniform(5.0 * noise, 0.3, struck.shape)
    np.put_along_axis(ranges, struck, np.take_along_axis(ranges, struck, axis=1) + shift, axis=1)
    assert_as_if_absent(fit_ellipses_to_ranges(ranges, BEARINGS), TRUTH)


@pytest.mark.parametrize("noise", [0.002, 0.01, 0.03])
def test_a_fifth_of_outliers_with_two_fifths_of_the_wall_missing(noise):
    ranges, rng = rings(noise, 2)
    struck = rng.random((TRIALS, 216)).argsort(axis=1)[:, :43]
    shift = rng.uniform(5.0 * noise, 0.3, struck.shape)
    np.put_along_axis(ranges, struck, np.take_along_axis(ranges, struck, axis=1) + shift, axis=1)
    ranges[:, 216:] = np.nan
    assert_as_if_absent(fit_ellipses_to_ranges(ranges, BEARINGS), TRUTH)


@pytest.mark.parametrize(("noise", "share"), [(0.002, 0.3), (0.005, 0.3), (0.01, 0.2)])
def test_flat_water_line_anywhere(noise, share):
    """A chord leaves the wall gradually, so that its ends cannot be told from noise; the more noise, the more of it."""
    ranges, rng = rings(noise, 3)
    run = int(share * BEARINGS.size)
    for ring, first in enumerate(rng.integers(0, BEARINGS.size, TRIALS)):
        struck = (first + np.arange(run)) % BEARINGS.size
        angle = np.linspace(-share * np.pi, share * np.pi, run)
        ranges[ring, struck] = np.cos(share * np.pi) / np.cos(angle) + noise * rng.standard_normal(run)
    fits = fit_ellipses_to_ranges(ranges, BEARINGS)
    assert fits.fitted.all()
    assert np.abs(fits.parameters - TRUTH).max() < 1.5 * noise
    assert np.abs(fits.mean_radius - 1.0).max() < 0.01
    plain = fit_ellipses_to_ranges(ranges, BEARINGS, robust=False)
    assert np.abs(plain.mean_radius - 1.0).min() > 0.015


def test_circle_with_a_quarter_of_far_outliers():
    ranges, rng = rings(0.01, 4, half=0.0)
    struck = rng.random(ranges.shape).argsort(axis=1)[:, :90]
    np.put_along_axis(ranges, struck, rng.uniform(0.1, 3.0, struck.shape), axis=1)
    assert_as_if_absent(fit_circles_to_ranges(ranges, BEARINGS), TRUTH[:3])


@pytest.mark.parametrize("method", ["fitzgibbon", "gander", "bookstein"])
def test_robust_algebraic_fit_leaves_out_what_the_geometric_does(method):
    ranges, rng = rings(0.005, 5)
    ranges[:, 20:80] += rng.uniform(0.1, 0.4, (TRIALS, 60))
    fits = fit_ellipses_to_ranges(ranges, BEARINGS, method=method, robust=True)
    assert_as_if_absent(fits, TRUTH)
    assert fits.n_used.max() <= 300


def test_robustness_costs_little_when_there_are_no_outliers():
    """Tukey's bisquare at 4.685 keeps 95 % of the efficiency of least squares on Gaussian noise."""
    ranges, _ = rings(0.01, 6)
    robust = fit_ellipses_to_ranges(ranges, BEARINGS).parameters.std(axis=0)
    plain = fit_ellipses_to_ranges(ranges, BEARINGS, robust=False).parameters.std(axis=0)
    assert ((plain / robust) ** 2 > 0.88).all()
