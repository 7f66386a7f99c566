"""Simulated rings with known truth: the stated 95 % intervals hold it, and no fit is biased.

The rings are cast from a sensor off the centre by intersecting rays with the ellipse as a quadratic, which shares
nothing with the fits.
"""

from __future__ import annotations

import numpy as np
import pytest

from springline.geometry.fitting import (
    amplitude_interval,
    fit_circles,
    fit_circles_to_ranges,
    fit_ellipses,
    fit_ellipses_to_ranges,
)

TRIALS = 1000
BEARINGS = np.radians(np.arange(0.0, 360.0, 1.0))
CENTRE = (0.08, -0.05)
"""Where the pipe's centre lies from the sensor, in radii."""


def wall(bearings, *, half, axis=0.4, centre=CENTRE):
    """Return the range to an ellipse of mean semi-axis 1 and half difference `half`, along each bearing."""
    ray = np.exp(1j * (bearings - axis))
    origin = -complex(*centre) * np.exp(-1j * axis)
    a, b = 1.0 + half, 1.0 - half
    squared = (ray.real / a) ** 2 + (ray.imag / b) ** 2
    linear = origin.real * ray.real / a**2 + origin.imag * ray.imag / b**2
    constant = (origin.real / a) ** 2 + (origin.imag / b) ** 2 - 1.0
    return (-linear + np.sqrt(linear**2 - squared * constant)) / squared


def truth(half, axis=0.4):
    return np.array([*CENTRE, 1.0, half * np.cos(2 * axis), half * np.sin(2 * axis)])


def rings(noise, *, half, missing=0.0, trials=TRIALS, seed=0, bearings=BEARINGS):
    """Return noisy ranges, with a run of them missing."""
    ranges = wall(bearings, half=half) + noise * np.random.default_rng(seed).standard_normal((trials, bearings.size))
    ranges[:, : round(missing * bearings.size)] = np.nan
    return ranges


def held(estimate, sigma, true):
    """Return the share of the trials in which estimate +- 1.96 sigma holds the truth."""
    return (np.abs(estimate - true) <= 1.959964 * sigma).mean(axis=0)


def oval_of(noise, count=BEARINGS.size, sigmas=6.0):
    """Return a half difference of that many of its own sigmas, sqrt(2/n) of the noise on a full ring."""
    return sigmas * noise * np.sqrt(2.0 / count)


@pytest.mark.parametrize("robust", [True, False])
@pytest.mark.parametrize("missing", [0.0, 0.25])
@pytest.mark.parametrize("noise", [0.002, 0.01, 0.03])
def test_ellipse_intervals_hold_the_truth(noise, missing, robust):
    # twice the sigmas of a full ring: what is missing costs ovality up to half of its certainty
    half = oval_of(noise, sigmas=12.0)
    fits = fit_ellipses_to_ranges(rings(noise, half=half, missing=missing), BEARINGS, robust=robust)
    assert fits.fitted.all()
    share = held(fits.parameters, fits.sigma, truth(half))
    assert (share >= 0.93).all(), share
    assert (share <= 0.97).all(), share
    axes = np.stack([fits.semi_major, fits.semi_minor], axis=-1)
    share = held(axes, fits.semi_axes_sigma, [1.0 + half, 1.0 - half])
    assert (share >= 0.92).all(), share
    assert (share <= 0.98).all(), share
    assert fits.noise_sigma.mean() == pytest.approx(noise, rel=0.02)


@pytest.mark.parametrize("robust", [True, False])
@pytest.mark.parametrize("missing", [0.0, 0.25])
@pytest.mark.parametrize("noise", [0.002, 0.01, 0.03])
def test_circle_intervals_hold_the_truth(noise, missing, robust):
    fits = fit_circles_to_ranges(rings(noise, half=0.0, missing=missing), BEARINGS, robust=robust)
    assert fits.fitted.all()
    share = held(fits.parameters, fits.sigma, truth(0.0)[:3])
    assert (share >= 0.93).all(), share
    assert (share <= 0.97).all(), share


@pytest.mark.parametrize("count", [8, 12, 24, 40, 90])
@pytest.mark.parametrize("robust", [True, False])
def test_intervals_hold_the_truth_with_few_readings(count, robust):
    bearings = np.arange(count) * 2.0 * np.pi / count
    ranges = rings(0.01, half=0.05, trials=2 * TRIALS, bearings=bearings, seed=3)
    fits = fit_ellipses_to_ranges(ranges, bearings, robust=robust)
    share = held(fits.parameters[fits.fitted], fits.sigma[fits.fitted], truth(0.05))
    assert fits.fitted.mean() > 0.995
    assert (share >= 0.90).all(), share
    assert (share <= 0.98).all(), share


@pytest.mark.parametrize("robust", [True, False])
def test_intervals_hold_the_truth_with_the_sensor_far_off_centre(robust):
    """Rays then meet the wall aslant, and distances to it vary less than the ranges do."""
    centre = (0.3, -0.45)
    noise = 0.03 * np.random.default_rng(8).standard_normal((TRIALS, BEARINGS.size))
    fits = fit_ellipses_to_ranges(wall(BEARINGS, half=0.04, centre=centre) + noise, BEARINGS, robust=robust)
    share = held(fits.parameters, fits.sigma, [*centre, *truth(0.04)[2:]])
    assert (share >= 0.92).all(), share
    assert (share <= 0.98).all(), share


@pytest.mark.parametrize("method", ["bookstein", "fitzgibbon", "gander"])
def test_algebraic_ellipse_intervals_hold_the_truth_at_little_noise(method):
    """Their bias is of the second order in the noise: under a tenth of a sigma at 0.2 % even on an oval pipe."""
    ranges = rings(0.002, half=0.15, missing=0.25)
    fits = fit_ellipses_to_ranges(ranges, BEARINGS, method=method)
    share = held(fits.parameters, fits.sigma, truth(0.15))
    assert (share >= 0.92).all(), share
    assert (share <= 0.98).all(), share


@pytest.mark.parametrize("method", ["kasa", "pratt", "taubin"])
def test_algebraic_circle_intervals_hold_the_truth_at_little_noise(method):
    fits = fit_circles_to_ranges(rings(0.002, half=0.0, missing=0.25), BEARINGS, method=method)
    share = held(fits.parameters, fits.sigma, truth(0.0)[:3])
    assert (share >= 0.92).all(), share
    assert (share <= 0.98).all(), share


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.3, -0.45)])
@pytest.mark.parametrize("robust", [True, False])
def test_no_bias_of_noise_squared_over_radius_along_rays(centre, robust):
    """At 5 % noise sigma^2/R is 25e-4 of the radius; the mean of 4,000 rings tells a twentieth, off-centre as well."""
    noise, trials = 0.05, 4000
    rng = np.random.default_rng(11)
    ranges = wall(BEARINGS, half=0.0, centre=centre) + noise * rng.standard_normal((trials, BEARINGS.size))
    for fits in (
        fit_circles_to_ranges(ranges, BEARINGS, robust=robust),
        fit_ellipses_to_ranges(ranges, BEARINGS, robust=robust),
    ):
        expected = [*centre, 1.0, 0.0, 0.0][: fits.parameters.shape[1]]
        bias = fits.parameters.mean(axis=0) - expected
        standard_error = fits.parameters.std(axis=0) / np.sqrt(trials)
        assert (np.abs(bias) < 4.0 * standard_error + 0.02 * noise**2).all(), bias / noise**2


@pytest.mark.parametrize("fit", [fit_circles, fit_ellipses])
def test_isotropic_noise_is_told_from_noise_along_rays(fit):
    """Points that err in both directions lie sigma^2/(2R) outside on average; said so, the fit removes it."""
    noise, trials = 0.05, 4000
    rng = np.random.default_rng(12)
    z, y = (f(BEARINGS) + noise * rng.standard_normal((trials, BEARINGS.size)) for f in (np.cos, np.sin))
    removed = fit(z, y, noise="isotropic").parameters[:, 2].mean() - 1.0
    left = fit(z, y, noise="orthogonal").parameters[:, 2].mean() - 1.0
    assert abs(removed) < 0.1 * noise**2
    assert left == pytest.approx(0.5 * noise**2, rel=0.2)


def test_raw_maximum_of_a_perfect_circle_reads_as_oval_and_the_fit_does_not():
    """5 % noise: the raw maximum reads 14.7 % of ovality at 360 readings (erratum A15); the fit 0.5 %."""
    ranges = 1.0 + 0.05 * np.random.default_rng(4).standard_normal((TRIALS, BEARINGS.size))
    raw = (ranges.max(axis=1) - ranges.mean(axis=1)) / ranges.mean(axis=1)
    assert raw.mean() == pytest.approx(0.147, abs=0.003)
    fits = fit_ellipses_to_ranges(ranges, BEARINGS)
    fitted = np.hypot(fits.oval_cos, fits.oval_sin) / fits.mean_radius
    assert fitted.mean() < 0.006


@pytest.mark.parametrize("missing", [0.0, 0.25])
@pytest.mark.parametrize("noise", [0.002, 0.01, 0.03])
def test_ovality_interval_holds_zero_in_round_pipes(noise, missing):
    fits = fit_ellipses_to_ranges(rings(noise, half=0.0, missing=missing, seed=5), BEARINGS)
    low, _ = amplitude_interval(fits.parameters[:, 3:], fits.covariance[:, 3:, 3:])
    assert 0.93 <= (low == 0.0).mean() <= 0.97


@pytest.mark.parametrize("missing", [0.0, 0.25])
@pytest.mark.parametrize("sigmas", [0.5, 1.0, 2.0, 3.0, 5.0, 8.0])
def test_ovality_interval_holds_the_truth_at_every_size(sigmas, missing):
    half = oval_of(0.01, sigmas=sigmas)
    ranges = rings(0.01, half=half, missing=missing, seed=6)
    fits = fit_ellipses_to_ranges(ranges, BEARINGS)
    low, high = amplitude_interval(fits.parameters[:, 3:], fits.covariance[:, 3:, 3:])
    assert 0.92 <= ((low <= half) & (half <= high)).mean() <= 0.98
