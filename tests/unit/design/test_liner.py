import numpy as np
import pytest

from springline.design import LinerDesign, design_liner, f1216, f1216_pressure, glock, next_standard

INCH, FOOT, PSI = 0.0254, 0.3048, 6894.757293168361
GRAVITY = {"modulus": 125e3 * PSI, "strength": 4500 * PSI, "water_pressure": 5.2 * PSI}
SOIL = {"condition": "fully", "soil_modulus": 1000 * PSI, "cover": 16 * FOOT, "water": 8 * FOOT, "unit_weight": 18850.0}


def test_the_published_worked_example_is_governed_by_buckling():
    found = design_liner(LinerDesign(**GRAVITY), 48 * INCH, 0.02)
    assert found.thickness / INCH == pytest.approx(0.878, abs=5e-4)
    assert found.checks["X1.2"] / INCH == pytest.approx(0.376, abs=5e-4)
    assert str(found.governing) == "X1.1"
    assert found.dimension_ratio == pytest.approx(48 / 0.878, rel=1e-3)
    assert found.warnings == {}


def test_every_check_of_a_fully_deteriorated_pipe_is_there_and_the_thickest_governs():
    found = design_liner(LinerDesign(**GRAVITY, **SOIL, short_modulus=250e3 * PSI), 48 * INCH, [0.01, 0.02])
    assert list(found.checks) == ["X1.1", "X1.2", "X1.3", "X1.4", "DR limit"]
    table = np.stack(list(found.checks.values()))
    np.testing.assert_array_equal(found.thickness, table.max(axis=0))
    assert found.governing.tolist() == ["X1.3", "X1.3"]
    assert found.worst() == 1


def test_the_edition_and_the_convention_change_the_thickness():
    old = design_liner(LinerDesign(**GRAVITY, **SOIL, edition="before-2007b"), 48 * INCH, 0.04)
    new = design_liner(LinerDesign(**GRAVITY, **SOIL), 48 * INCH, 0.04)
    mean = design_liner(LinerDesign(**GRAVITY, convention="mean"), 48 * INCH, 0.04)
    assert old.checks["X1.3"] > 1.05 * new.checks["X1.3"]
    assert mean.checks["X1.1"] > new.checks["X1.1"]


def test_oval_stress_governs_a_weak_oval_liner():
    found = design_liner(LinerDesign(modulus=5e9, strength=5e6, water_pressure=30e3), 0.6, 0.08)
    assert str(found.governing) == "X1.2"


def test_slender_liners_are_held_at_dr_100():
    found = design_liner(LinerDesign(modulus=5e9, strength=50e6, water_pressure=2e3), 0.6, [0.0, 0.01])
    assert found.governing.tolist() == ["DR limit", "DR limit"]
    np.testing.assert_allclose(found.dimension_ratio, 100.0)
    assert found.warnings["ratio_limit"].all()
    free = design_liner(LinerDesign(modulus=5e9, strength=50e6, water_pressure=2e3, ratio_limit=np.inf), 0.6, 0.0)
    assert free.dimension_ratio > 100


def test_the_limits_of_the_appendix_are_warned_of():
    design = LinerDesign(**GRAVITY, **(SOIL | {"water": 40 * FOOT}), enhancement=5.0)
    found = design_liner(design, 1.2, [0.05, 0.12])
    assert found.warnings["ovality_over_10_percent"].tolist() == [False, True]
    assert found.warnings["buoyancy_at_limit"].all()
    assert found.warnings["enhancement_below_7"].all()


def test_pressure_pipes_use_the_plate_or_the_ring():
    base = GRAVITY | {"internal_pressure": 0.6e6, "tensile_strength": 21e6}
    small, large = (design_liner(LinerDesign(**base, hole=d), 0.3, 0.0) for d in (0.04, 0.15))
    assert small.checks["X1.6"] == f1216_pressure.thickness_hole_span(0.6e6, 0.3, hole=0.04, strength=4500 * PSI)
    assert small.checks["X1.7"] == 0
    assert large.checks["X1.7"] == f1216_pressure.thickness_ring_tension(0.6e6, 0.3, tensile_strength=21e6)
    assert large.warnings["hole_in_ring_tension"].all()
    full = design_liner(LinerDesign(**base, **SOIL), 0.3, 0.0)
    assert full.checks["X1.7"] == large.checks["X1.7"]
    assert "X1.6" not in full.checks


def test_glock_takes_the_place_of_x11():
    found = design_liner(LinerDesign(**GRAVITY, method="glock", gap=1e-3), 1.2, [0.0, 0.03])
    assert list(found.checks) == ["Glock", "X1.2", "DR limit"]
    alone = glock.thickness_glock(5.2 * PSI, 1.2, modulus=125e3 * PSI, ovality=[0.0, 0.03], gap=1e-3)
    np.testing.assert_allclose(found.checks["Glock"], alone)
    hopeless = design_liner(LinerDesign(modulus=1e6, strength=1e9, water_pressure=1e6, method="glock"), 1.2, 0.0)
    assert np.isnan(hopeless.thickness)
    assert hopeless.warnings["no_thickness"].all()


@pytest.mark.parametrize("method", ["f1216", "glock"])
@pytest.mark.parametrize("condition", [{}, SOIL])
def test_the_sigma_is_that_of_scattered_scans(method, condition):
    rng = np.random.default_rng(6)
    design = LinerDesign(**GRAVITY, **condition, method=method)
    covariance = np.array([[0.002**2, 0.3 * 0.002 * 0.004], [0.3 * 0.002 * 0.004, 0.004**2]])
    diameter, ovality = rng.multivariate_normal([1.2, 0.03], covariance, size=4000).T
    scattered = design_liner(design, diameter, ovality).thickness.std()
    stated = design_liner(design, 1.2, 0.03, diameter_sigma=0.002, ovality_sigma=0.004, correlation=0.3)
    assert stated.sigma == pytest.approx(scattered, rel=0.05)


def test_one_point_of_ovality_costs_three_percent_of_thickness():
    found = design_liner(LinerDesign(**GRAVITY), 1.2, 0.02, ovality_sigma=0.01)
    assert found.sigma / found.thickness == pytest.approx(0.03, abs=0.002)


def test_missing_stations_stay_missing_and_noise_below_zero_is_round():
    found = design_liner(LinerDesign(**GRAVITY), [1.2, np.nan, 1.2], [0.0, 0.02, -0.001], ovality_sigma=0.001)
    assert np.isnan(found.thickness).tolist() == [False, True, False]
    assert found.governing.tolist() == ["X1.1", "", "X1.1"]
    assert np.isnan(found.sigma[1])
    assert found.thickness[2] == found.thickness[0]
    with pytest.raises(ValueError, match="no station has a thickness"):
        design_liner(LinerDesign(**GRAVITY), np.nan, 0.02).worst()


def test_the_next_thickness_that_is_made():
    np.testing.assert_allclose(next_standard([0.0, 0.0061, np.nan], step=0.003), [0.0, 0.009, np.nan])
    np.testing.assert_allclose(next_standard([0.004, 0.005, 0.02], sizes=[0.01, 0.005]), [0.005, 0.005, np.nan])
    assert np.isnan(next_standard(np.nan, sizes=[0.005]))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: LinerDesign(**GRAVITY, condition="partly"), "did you mean 'partially'"),
        (lambda: LinerDesign(**GRAVITY, condition="fully"), "soil_modulus, cover, unit_weight not given"),
        (lambda: LinerDesign(**GRAVITY, method="wrc"), "method = 'wrc'"),
        (lambda: LinerDesign(**GRAVITY, edition="2007"), "edition = '2007'"),
        (lambda: LinerDesign(**GRAVITY, ratio_limit=1.0), "ratio_limit = 1"),
        (lambda: LinerDesign(**GRAVITY, internal_pressure=1e5, hole=0.1), "tensile_strength not given"),
        (lambda: design_liner(LinerDesign(**GRAVITY), 1.2, 2.0), "ovality = 2"),
        (lambda: design_liner(LinerDesign(**GRAVITY), 1.2, -0.05), "ovality = -0.05"),
        (lambda: design_liner(LinerDesign(**GRAVITY), -1.2, 0.0), "diameter = -1.2"),
        (lambda: next_standard(0.004, step=0.0), "step = 0"),
    ],
)
def test_bad_input_is_refused_by_name(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_partial_deterioration_ignores_the_soil():
    assert f1216.EDITIONS[0] == LinerDesign(**GRAVITY).edition
    found = design_liner(LinerDesign(**GRAVITY), 1.2, 0.02)
    assert "X1.3" not in found.checks
