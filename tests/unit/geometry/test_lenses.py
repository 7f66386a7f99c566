"""Lens models against OpenCV and their own geometry; fits against the lenses that the pairs were drawn from."""

from __future__ import annotations

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.lenses import LENS_MODELS, MODELS, Lens, fit_lens, polynomial_limit, scale_of_view_angle

WIDE = np.radians(np.linspace(2.0, 74.0, 100))
REAL = (0.03, -0.02, 0.004, -0.0006)
LENSES = [*(Lens(model, 300.0) for model in MODELS), Lens("polynomial", 300.0, REAL)]
EACH = pytest.mark.parametrize("lens", LENSES, ids=LENS_MODELS)


def pairs(lens, seed, count=100, noise=0.5, widest=74.0):
    rng = np.random.default_rng(seed)
    zenith = np.radians(rng.uniform(2.0, widest, count))
    return zenith, lens.radius(zenith) + rng.normal(0.0, noise, count)


@pytest.mark.parametrize("coefficients", [(), (0.05,), REAL])
def test_polynomial_is_the_fisheye_of_opencv(coefficients):
    cv2 = pytest.importorskip("cv2")
    if not hasattr(cv2, "fisheye"):
        pytest.skip("this OpenCV has no fisheye camera")
    points = np.random.default_rng(3).uniform([-1.0, -1.0, 0.3], [1.0, 1.0, 2.3], (50, 3))
    distortion = np.zeros(4)
    distortion[: len(coefficients)] = coefficients
    matrix = np.array([[300.0, 0.0, 320.0], [0.0, 300.0, 240.0], [0.0, 0.0, 1.0]])
    seen, _ = cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), matrix, distortion)
    from_centre = seen[:, 0] - [320.0, 240.0]
    zenith = np.arctan2(np.hypot(points[:, 0], points[:, 1]), points[:, 2])
    lens = Lens("polynomial", 300.0, coefficients)
    np.testing.assert_allclose(lens.radius(zenith), np.hypot(*from_centre.T), atol=1e-9)


@EACH
def test_inverse_and_slope_belong_to_the_radius(lens):
    np.testing.assert_allclose(lens.zenith(lens.radius(WIDE)), WIDE, rtol=1e-12)
    step = 1e-6
    slope = (lens.radius(WIDE + step) - lens.radius(WIDE - step)) / (2 * step)
    np.testing.assert_allclose(lens.slope(WIDE), slope, rtol=1e-8)


@EACH
def test_nothing_beyond_the_one_to_one_range(lens):
    beyond = np.array([lens.max_zenith * (1 + 1e-9), np.pi, -0.1])
    beyond = beyond[(beyond > lens.max_zenith) | (beyond < 0)]
    assert np.isnan(lens.radius(beyond)).all()
    assert np.isnan(lens.slope(beyond)).all()
    assert np.isnan(lens.zenith([-1.0])).all()
    inside = np.linspace(0.0, lens.max_zenith * (1 - 1e-9), 500)
    assert np.all(np.diff(lens.radius(inside)) > 0)
    if np.isfinite(lens.max_radius):
        assert np.isnan(lens.zenith(lens.max_radius * 1.001))
        assert lens.zenith(lens.max_radius) == pytest.approx(lens.max_zenith, rel=1e-6)


def test_range_of_the_polynomial_ends_where_its_slope_does():
    lens = Lens("polynomial", 1.0, (-0.2, 0.01))
    limit = polynomial_limit(lens.coefficients)
    raw = np.linspace(0.0, limit * 1.05, 20001)
    radius = raw - 0.2 * raw**3 + 0.01 * raw**5
    assert raw[np.argmax(radius)] == pytest.approx(limit, abs=2e-4)
    assert lens.max_zenith == limit


def test_a_view_angle_ends_the_lens():
    lens = Lens.of_view_angle("stereographic", np.radians(120), 384.0)
    assert lens.radius(np.radians(60.0)) == pytest.approx(384.0)
    assert np.isnan(lens.radius(np.radians(60.1)))
    assert np.isnan(lens.zenith(385.0))
    assert lens.max_radius == pytest.approx(384.0)


def test_what_cannot_be_a_lens_is_refused():
    for wrong in (
        lambda: Lens("sinus", 1.0),
        lambda: Lens("sine", 0.0),
        lambda: Lens("sine", np.nan),
        lambda: Lens("sine", 1.0, (0.1,)),
        lambda: Lens("polynomial", 1.0, (0.1,) * 5),
        lambda: Lens("polynomial", 1.0, (np.inf,)),
        lambda: Lens("sine", 1.0, view_angle=-1.0),
        lambda: scale_of_view_angle(np.pi, 1.0, model="perspective"),
        lambda: scale_of_view_angle(np.radians(200), 1.0, model="sine"),
    ):
        with pytest.raises(ParameterError):
            wrong()
    with pytest.raises(ParameterError, match="did you mean 'sine'"):
        Lens("sinee", 1.0)


@EACH
def test_the_right_model_is_found_among_noisy_pairs(lens):
    """Thirty sets of pairs with 0.5 px noise: at least 95 % right, the scale of those within 0.3 %."""
    fits = [fit_lens(*pairs(lens, seed)) for seed in range(30)]
    right = [fit for fit in fits if fit and fit.lens.model == lens.model]
    assert len(right) >= 29
    if lens.model != "polynomial":
        assert max(abs(fit.lens.k / lens.k - 1) for fit in right) < 3e-3
    zenith = np.radians([20.0, 45.0, 65.0])
    for fit in right:
        np.testing.assert_allclose(fit.lens.radius(zenith), lens.radius(zenith), atol=0.8)
        assert fit.noise_sigma == pytest.approx(0.5, rel=0.35)


@pytest.mark.parametrize("stated", [None, 0.5])
@pytest.mark.parametrize("lens", [LENSES[1], LENSES[5]], ids=["sine", "polynomial"])
def test_intervals_hold_the_truth(lens, stated):
    zenith, held = np.radians([15.0, 40.0, 65.0]), []
    for seed in range(400):
        candidates = fit_lens(*pairs(lens, 1000 + seed, count=40), sigma=stated).candidates
        found = next(c for c in candidates if c.lens.model == lens.model)
        error = found.lens.radius(zenith) - lens.radius(zenith)
        held.append(np.abs(error) < 1.96 * found.radius_sigma(zenith))
        assert found.sigma.shape == found.parameters.shape
    assert 0.90 <= np.mean(held) <= 0.98


def test_exact_pairs_and_missing_ones():
    zenith, radius = WIDE.copy(), LENSES[2].radius(WIDE)
    zenith[3], radius[5] = np.nan, np.nan
    fit = fit_lens(zenith, radius)
    assert (fit.lens.model, fit.n_used) == ("equisolid", 98)
    assert fit.lens.k == pytest.approx(300.0, rel=1e-12)
    assert len(fit.best.residuals) == 98


def test_a_polynomial_says_nothing_beyond_its_pairs():
    fit = fit_lens(*pairs(LENSES[5], 5, widest=60.0), models=("polynomial",))
    assert fit.lens.max_zenith < np.radians(60.0)
    assert np.isnan(fit.lens.radius(np.radians(61.0)))
    assert np.isnan(fit.best.radius_sigma(np.radians(61.0)))


@pytest.mark.parametrize(
    ("zenith", "radius", "options", "reason"),
    [
        (WIDE[:7], 300 * WIDE[:7], {}, "too few pairs"),
        (0 * WIDE, 0 * WIDE, {}, "optical axis"),
        (WIDE, 300 * WIDE[::-1], {}, "no model fits"),
        (WIDE, 300 * np.sin(WIDE) + 5 * np.cos(90 * WIDE), {"sigma": 0.5}, "no model fits"),
        (WIDE, 300 * np.sin(WIDE), {"models": ("equidistant", "equisolid")}, "no model"),
        (WIDE / 8, 300 * np.sin(WIDE / 8) + np.cos(90 * WIDE), {}, "do not tell"),
        (WIDE + 0.9, 300 * np.sqrt(WIDE + 0.9), {"models": ("perspective",)}, "can image"),
    ],
    ids=["few", "axis", "mirrored", "rough", "other models", "narrow", "behind"],
)
def test_pairs_that_make_no_lens_are_told_why(zenith, radius, options, reason):
    fit = fit_lens(zenith, radius, **options)
    assert not fit
    assert fit.lens is None
    assert reason in fit.reason


def test_a_pattern_in_the_residuals_speaks_against_the_only_model_asked_for():
    """Within 2 % of the radii, yet not that lens: noise alone would have no pattern."""
    zenith, radius = pairs(LENSES[2], 7, widest=45.0)
    assert "pattern" in fit_lens(zenith, radius, models=("equidistant",)).reason
    assert fit_lens(zenith, radius, models=("equisolid",))


def test_pairs_too_near_the_axis_still_list_what_fits():
    fit = fit_lens(*pairs(LENSES[1], 11, count=12, widest=8.0))
    assert "apart" in fit.reason
    assert len(fit.candidates) > 3
    assert sum(c.probability for c in fit.candidates) == pytest.approx(1.0)
    assert fit_lens(*pairs(LENSES[1], 11, count=12, widest=8.0), models=("sine",)).lens.k == pytest.approx(
        300, rel=0.02
    )


def test_arguments_of_a_fit_are_checked():
    good = 300 * WIDE
    for wrong in (
        lambda: fit_lens(WIDE, good[1:]),
        lambda: fit_lens(np.degrees(WIDE), good),
        lambda: fit_lens(WIDE, -good),
        lambda: fit_lens(WIDE, good, sigma=0.0),
        lambda: fit_lens(WIDE, good, models=()),
        lambda: fit_lens(WIDE, good, models=("fisheye",)),
        lambda: fit_lens(WIDE, good, confidence=1.0),
    ):
        with pytest.raises(ParameterError):
            wrong()
