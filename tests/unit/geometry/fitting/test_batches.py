"""Many rings at once: the same answers as one by one, missing readings, masks, options and stated failures."""

from __future__ import annotations

import numpy as np
import pytest

from springline.conventions import FIT_STATUS
from springline.errors import ParameterError
from springline.geometry.fitting import (
    fit_circle,
    fit_circles,
    fit_circles_to_ranges,
    fit_ellipse,
    fit_ellipses,
    fit_ellipses_to_ranges,
)

BEARINGS = np.radians(np.arange(0.0, 360.0, 4.0))


def rings(count, *, noise=0.002, seed=0):
    """Return ranges of rings about the centre of an ellipse, from its polar form."""
    rng = np.random.default_rng(seed)
    a, b, axis = 0.16, 0.14, 0.5
    wall = a * b / np.hypot(b * np.cos(BEARINGS - axis), a * np.sin(BEARINGS - axis))
    return wall + noise * rng.standard_normal((count, BEARINGS.size))


@pytest.mark.parametrize("method", ["geometric", "fitzgibbon"])
def test_batch_over_chunks_and_threads_is_ring_by_ring(method):
    ranges = rings(1030)
    ranges[::7, 20:40] = np.nan
    one_thread = fit_ellipses_to_ranges(ranges, BEARINGS, method=method, workers=1)
    two_threads = fit_ellipses_to_ranges(ranges, BEARINGS, method=method, workers=2)
    assert np.array_equal(one_thread.parameters, two_threads.parameters)
    assert np.array_equal(one_thread.covariance, two_threads.covariance)
    for ring in (0, 1, 1023, 1024, 1029):
        points = np.stack([ranges[ring] * np.cos(BEARINGS), ranges[ring] * np.sin(BEARINGS)], axis=-1)
        single = fit_ellipse(points, method=method, noise="range")
        assert np.array_equal(single.parameters, one_thread[ring].parameters)


def test_ranges_and_points_are_the_same_readings():
    ranges = rings(3).astype(np.float32)
    z, y = ranges * np.cos(BEARINGS), ranges * np.sin(BEARINGS)
    by_ranges = fit_ellipses_to_ranges(ranges, BEARINGS)
    by_points = fit_ellipses(z, y)
    by_own_bearings = fit_ellipses_to_ranges(ranges, np.tile(BEARINGS, (3, 1)))
    assert by_ranges.parameters == pytest.approx(by_points.parameters, abs=1e-12)
    assert by_ranges.parameters == pytest.approx(by_own_bearings.parameters, abs=1e-12)
    by_floats = fit_ellipses(z.astype(np.float32), y.astype(np.float32))
    assert by_floats.parameters == pytest.approx(by_points.parameters, abs=1e-7)


@pytest.mark.parametrize("method", ["geometric", "taubin"])
def test_missing_readings_count_as_absent(method):
    ranges = rings(1)
    some = np.ones(BEARINGS.size, bool)
    some[[3, 4, 30]] = False
    missing = np.where(some, ranges, np.nan)
    whole = fit_circles_to_ranges(missing, BEARINGS, method=method)
    fewer = fit_circles_to_ranges(ranges[:, some], BEARINGS[some], method=method)
    masked = fit_circles_to_ranges(ranges, BEARINGS, weights=some, method=method)
    unknown = fit_circles_to_ranges(ranges, BEARINGS, weights=np.where(some, 1.0, np.nan), method=method)
    for other in (fewer, masked, unknown):
        assert other.parameters == pytest.approx(whole.parameters, abs=1e-12)
        assert other.n_used[0] == 87


def test_readings_are_not_touched():
    ranges = rings(2)
    before = ranges.copy()
    fit_ellipses_to_ranges(ranges, BEARINGS)
    assert np.array_equal(ranges, before)


def test_weights_say_which_readings_were_rejected():
    ranges = rings(1, noise=0.0005)
    ranges[0, 10:20] += 0.05
    ranges[0, 50] = np.nan
    fits = fit_ellipses_to_ranges(ranges, BEARINGS, keep_weights=True)
    assert fits.weights.shape == ranges.shape
    rejected = np.flatnonzero(fits.weights[0] == 0.0)
    assert rejected.tolist() == [*range(10, 20), 50]
    assert fits.n_used[0] == 90 - 11
    assert fits[0].weights is not None
    assert fit_ellipses_to_ranges(ranges, BEARINGS).weights is None


def test_derived_axes_and_their_sigma():
    fits = fit_ellipses_to_ranges(rings(1, noise=0.0005), BEARINGS)
    fit = fits[0]
    assert fit
    assert fit.reason == ""
    assert fits.semi_major[0] == fit.semi_major == pytest.approx(0.16, abs=5e-4)
    assert fits.semi_minor[0] == fit.semi_minor == pytest.approx(0.14, abs=5e-4)
    assert fits.axis_bearing[0] == fit.axis_bearing == pytest.approx(0.5, abs=0.02)
    assert fits.shape_covariance == pytest.approx(fits.covariance[:, 2:, 2:])
    # by finite differences of the semi-axes in the parameters
    for k, sign in enumerate((1.0, -1.0)):
        slopes = []
        for j in range(3):
            step = np.zeros(3)
            step[j] = 1e-6
            ends = [
                np.dot([1, 0, 0], p) + sign * np.hypot(p[1], p[2]) for p in (fits.shape[0] + step, fits.shape[0] - step)
            ]
            slopes.append((ends[0] - ends[1]) / 2e-6)
        expected = np.sqrt(slopes @ fits.shape_covariance[0] @ slopes)
        assert fits.semi_axes_sigma[0, k] == pytest.approx(expected, rel=1e-6)


def points_on_arc(degrees, count=40, noise=0.0, seed=0):
    angle = np.radians(np.linspace(0.0, degrees, count))
    radius = 1.0 + noise * np.random.default_rng(seed).standard_normal(count)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


LINE = np.stack([np.arange(20.0), 3.0 + 0.5 * np.arange(20.0)], axis=-1)
HYPERBOLA = np.stack([np.cosh(np.linspace(-2, 2, 30)), 2 * np.sinh(np.linspace(-2, 2, 30))], axis=-1)
BLOB = np.random.default_rng(3).standard_normal((200, 2))
ELLIPSES = ("geometric", "bookstein", "fitzgibbon", "gander")
CIRCLES = ("geometric", "kasa", "pratt", "taubin", "svd")
FAILURES = [
    *((fit_ellipse, m, points_on_arc(300, 4), "too few readings") for m in ELLIPSES),
    *((fit_circle, m, points_on_arc(300, 2), "too few readings") for m in CIRCLES),
    *((fit_circle, m, np.full((9, 2), np.nan), "too few readings") for m in CIRCLES),
    *((fit_ellipse, m, LINE, "readings collinear") for m in ELLIPSES),
    *((fit_circle, m, LINE, "readings collinear") for m in CIRCLES),
    *((fit_circle, m, np.ones((9, 2)), "readings collinear") for m in CIRCLES),
    *((fit_circle, m, points_on_arc(29), "arc too short") for m in CIRCLES),
    *((fit_ellipse, m, points_on_arc(29), "arc too short") for m in ELLIPSES),
    *((fit_circle, m, points_on_arc(20, noise=0.001), "arc too short") for m in CIRCLES),
    *((fit_circle, m, BLOB, "readings too scattered") for m in CIRCLES),
]


@pytest.mark.parametrize("robust", [False, True])
@pytest.mark.parametrize(("fit", "method", "points", "reason"), FAILURES)
def test_degenerate_readings_are_a_stated_failure(fit, method, points, reason, robust):
    found = fit(points, method=method, robust=robust)
    assert not found
    assert found.reason == reason
    assert reason in FIT_STATUS.values()
    for value in (found.parameters, found.covariance, found.residual_rms, found.noise_sigma):
        assert np.isnan(value).all()


@pytest.mark.parametrize(
    ("method", "points", "reason"),
    [
        ("bookstein", HYPERBOLA, "not an ellipse"),
        ("gander", HYPERBOLA, "not an ellipse"),
        ("fitzgibbon", BLOB, "readings too scattered"),
        ("gander", BLOB, "readings too scattered"),
    ],
)
def test_readings_of_no_ellipse_are_refused(method, points, reason):
    assert fit_ellipse(points, method=method).reason == reason
    assert not fit_ellipse(points, method=method, robust=True)
    assert not fit_ellipse(points)
    assert not fit_ellipse(points, robust=False)


@pytest.mark.parametrize("fit", [fit_ellipse, fit_circle])
def test_arc_of_31_degrees_is_answered(fit):
    assert fit(points_on_arc(31)).parameters[2] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("fit", "count", "parameters"), [(fit_circle, 3, 3), (fit_ellipse, 5, 5)])
def test_as_many_readings_as_parameters_have_no_sigma(fit, count, parameters):
    """The fit passes through them all, and nothing is left that would tell the noise."""
    found = fit(points_on_arc(300, count))
    assert found
    assert found.parameters[2] == pytest.approx(1.0, abs=1e-9)
    assert np.isnan(found.covariance).all()
    assert np.isnan(found.noise_sigma)


def test_failed_rings_do_not_disturb_their_neighbours():
    ranges = rings(3)
    ranges[1] = np.nan
    fits = fit_ellipses_to_ranges(ranges, BEARINGS)
    assert fits.fitted.tolist() == [True, False, True]
    assert [fits.reason(k) for k in range(3)] == ["", "too few readings", ""]
    assert np.isnan(fits.semi_major[1])
    assert np.isnan(fits.semi_axes_sigma[1]).all()
    assert fits.n_used.tolist() == [90, 0, 90]


def test_no_rings_are_no_fits():
    assert len(fit_circles(np.empty((0, 9)), np.empty((0, 9)))) == 0


def test_exact_readings_are_fitted_robustly():
    ranges = rings(1, noise=0.0)
    ranges[0, :20] = 0.1
    fits = fit_ellipses_to_ranges(ranges, BEARINGS)
    assert fits.semi_major[0] == pytest.approx(0.16, abs=1e-9)
    assert fits.n_used[0] == 70


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fit_circles(np.ones((2, 9)), np.ones((2, 8))), r"\(2, 9\) and y \(2, 8\)"),
        (lambda: fit_circles(np.ones(9), np.ones(9)), r"same shape \(ring, point\)"),
        (lambda: fit_circles_to_ranges(np.ones(9), np.ones(9)), r"ranges has shape \(9,\)"),
        (lambda: fit_circles_to_ranges(np.ones((2, 9)), np.ones(8)), r"bearings has shape \(8,\)"),
        (lambda: fit_circle(np.ones((4, 3))), r"points has shape \(4, 3\)"),
        (lambda: fit_circle(np.ones((4, 2)), method="tauben"), "did you mean 'taubin'"),
        (lambda: fit_ellipse(np.ones((4, 2)), method="kasa"), "expected one of geometric, bookstein"),
        (lambda: fit_ellipse(np.ones((4, 2)), noise="ranges"), "did you mean 'range'"),
        (lambda: fit_ellipse(np.ones((4, 2)), robustly=True), "did you mean 'robust'"),
        (lambda: fit_ellipse(np.ones((4, 2)), least_arc=30.0), "an angle in radians"),
        (lambda: fit_ellipse(np.ones((4, 2)), most_scatter=0.0), "a positive share"),
        (lambda: fit_ellipse(np.ones((4, 2)), workers=0), "one or more threads"),
        (lambda: fit_ellipse(np.ones((4, 2)), weights=np.ones(5)), r"weights has shape \(5,\)"),
    ],
)
def test_wrong_arguments_are_named(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
