import json
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from springline.design import f1216, f1216_pressure

INCH, FOOT, PSI = 0.0254, 0.3048, 6894.757293168361
VECTORS = Path(__file__).parents[3] / ".." / "shared" / "vectors" / "sections.json"


def test_the_published_worked_example():
    """D = 48 in, q = 2 %, E = 125,000 psi, P = 5.20 psi, N = 2, S = 4,500 psi: 0.878 in and 0.376 in."""
    factor = f1216.ovality_factor(0.02)
    buckling = f1216.thickness_buckling(5.2 * PSI, 48 * INCH, modulus=125e3 * PSI, factor=factor)
    stress = f1216.thickness_oval_stress(5.2 * PSI, 48 * INCH, ovality=0.02, strength=4500 * PSI)
    assert buckling / INCH == pytest.approx(0.878, abs=5e-4)
    assert stress / INCH == pytest.approx(0.376, abs=5e-4)


def test_the_dissertations_case():
    carried = f1216.buckling_pressure(32.49 + 1, modulus=72500 * PSI, poisson=0.35)
    assert carried / PSI == pytest.approx(16.86, abs=0.005)


@pytest.mark.parametrize("convention", ["outer", "mean"])
def test_thickness_and_pressure_are_inverses(convention):
    pressure, diameter = np.array([10e3, 50e3, 200e3]), 0.4
    common = {"modulus": 1.7e9, "poisson": 0.35, "factor": 0.8, "enhancement": 7.0, "safety": 1.5}
    t = f1216.thickness_buckling(pressure, diameter, convention=convention, **common)
    outer = diameter if convention == "outer" else diameter + t
    np.testing.assert_allclose(f1216.buckling_pressure(outer / t, **common), pressure, rtol=1e-12)


def test_the_mean_convention_is_thicker_by_t_over_d():
    outer, mean = (f1216.thickness_buckling(40e3, 0.3, modulus=1.7e9, convention=c) for c in ("outer", "mean"))
    assert mean / outer - 1 == pytest.approx(outer / 0.3, rel=0.05)


@pytest.mark.parametrize("q", [1e-4, 0.02, 0.1])
def test_oval_stress_solves_the_printed_quadratic(q):
    pressure, strength, safety, diameter = 35e3, 31e6, 2.0, 0.45
    ratio = diameter / f1216.thickness_oval_stress(pressure, diameter, ovality=q, strength=strength, safety=safety)
    printed = 1.5 * q * (1 + q) * ratio**2 - 0.5 * (1 + q) * ratio
    assert printed == pytest.approx(strength / (pressure * safety), rel=1e-12)


@pytest.mark.parametrize("edition", f1216.EDITIONS)
def test_fully_deteriorated_solves_x13_of_its_edition(edition):
    cover, water, factor, diameter = 16.0, 8.0, 0.836, 48.0  # feet and inches, as printed
    buoyancy, support = 1 - 0.33 * water / cover, 1 / (1 + 4 * np.exp(-0.065 * cover))

    def carried(t):
        inside = 32 * buoyancy * support * 1000 * 125e3 * (t**3 / 12) / diameter**3
        return np.sqrt(inside * factor) / 2 if edition == "2007b" else factor * np.sqrt(inside) / 2

    thickness = f1216.thickness_fully_deteriorated(
        14.9 * PSI,
        48 * INCH,
        modulus=125e3 * PSI,
        soil_modulus=1000 * PSI,
        cover=cover * FOOT,
        water=water * FOOT,
        factor=factor,
        edition=edition,
    )
    assert thickness / INCH == pytest.approx(brentq(lambda t: carried(t) - 14.9, 0.1, 5), rel=1e-10)


def test_the_older_edition_is_thicker():
    common = {"modulus": 1.7e9, "soil_modulus": 6.9e6, "cover": 4.0, "water": 2.0, "factor": 0.7}
    new, old = (f1216.thickness_fully_deteriorated(90e3, 0.6, edition=e, **common) for e in f1216.EDITIONS)
    assert old / new == pytest.approx(0.7 ** (-1 / 3), rel=1e-12)


def test_the_load_is_the_printed_sum():
    """q_t = 0.433 H_w + w H R_w/144 + W_s in psi, feet and pounds per cubic foot."""
    newton = 4.4482216152605
    load = f1216.total_load(16 * FOOT, 8 * FOOT, unit_weight=120 * newton / FOOT**3, live_load=1.5 * PSI)
    assert load / PSI == pytest.approx(0.433 * 8 + 120 * 16 * 0.835 / 144 + 1.5, rel=1e-12)


def test_both_sets_of_printed_constants_agree_within_a_percent():
    for function, arguments in (
        (f1216.elastic_support, (4.0,)),
        (f1216.total_load, (4.0, 2.0)),
        (f1216.thickness_stiffness, (0.6,)),
    ):
        more = {f1216.total_load: {"unit_weight": 19e3}, f1216.thickness_stiffness: {"modulus": 2.5e9}}
        pair = [function(*arguments, constants=c, **more.get(function, {})) for c in f1216.CONSTANTS]
        assert pair[0] != pair[1]
        assert pair[0] == pytest.approx(pair[1], rel=0.008)


def test_water_above_the_cover_is_held_at_the_least_buoyancy():
    np.testing.assert_allclose(f1216.buoyancy_factor(3.0, [0.0, 3.0, 30.0]), [1.0, 0.67, 0.67])


def test_x14_reaches_its_least_stiffness():
    ratio = 48 * INCH / f1216.thickness_stiffness(48 * INCH, modulus=250e3 * PSI)
    assert 250e3 / (12 * ratio**3) == pytest.approx(0.093, rel=1e-12)


def test_pressure_pipes_solve_the_printed_equations():
    diameter, hole, pressure, strength = 0.3, 0.05, 0.8e6, 31e6
    ratio = diameter / f1216_pressure.thickness_hole_span(pressure, diameter, hole=hole, strength=strength)
    assert 5.33 / (ratio - 1) ** 2 * (diameter / hole) ** 2 * strength / 2 == pytest.approx(pressure, rel=1e-12)
    ratio = diameter / f1216_pressure.thickness_ring_tension(pressure, diameter, tensile_strength=21e6)
    assert 2 * 21e6 / ((ratio - 2) * 2) == pytest.approx(pressure, rel=1e-12)
    edge = 1.83 * np.sqrt(0.006 / 0.3) * 0.3
    assert f1216_pressure.spans_as_plate(0.006, 0.3, hole=[edge * 0.999, edge * 1.001]).tolist() == [True, False]


def test_without_load_there_is_no_thickness():
    assert f1216.thickness_buckling(0.0, 0.3, modulus=1e9) == 0
    assert f1216.thickness_oval_stress(0.0, 0.3, ovality=0.02, strength=3e7) == 0
    assert f1216_pressure.thickness_hole_span(1e5, 0.3, hole=0.0, strength=3e7) == 0
    assert f1216_pressure.thickness_ring_tension(0.0, 0.3, tensile_strength=2e7) == 0


def test_the_factor_falls_by_nine_percent_a_point():
    slope = (np.log(f1216.ovality_factor(0.021)) - np.log(f1216.ovality_factor(0.019))) / 0.2
    assert slope == pytest.approx(-0.0893, abs=2e-3)
    assert np.isnan(f1216.ovality_factor(np.nan))


@pytest.mark.shared
@pytest.mark.skipif(not VECTORS.exists(), reason="the reference folder ../shared is absent")
def test_every_liner_case_of_the_independent_program_agrees():
    cases = [case for case in json.loads(VECTORS.read_text())["cases"] if case["function"] in CALLS]
    assert len(cases) > 10
    for case in cases:
        got = CALLS[case["function"]](**case["inputs"])
        assert got == pytest.approx(case["expected"], rel=1e-10, abs=1e-12), case["id"]


CALLS = {
    "ovality_factor": lambda q: f1216.ovality_factor(q / 100),
    "pcr": lambda K, E, nu, SDR, C, N: f1216.buckling_pressure(
        SDR, modulus=E, poisson=nu, factor=C, enhancement=K, safety=N
    ),
    "thickness_mean_diameter": lambda P, K, E, nu, C, N, Dm: f1216.thickness_buckling(
        P, Dm, modulus=E, poisson=nu, factor=C, enhancement=K, safety=N, convention="mean"
    ),
    "thickness_outer_diameter": lambda P, K, E, nu, C, N, Do: f1216.thickness_buckling(
        P, Do, modulus=E, poisson=nu, factor=C, enhancement=K, safety=N
    ),
    "thickness_oval_stress": lambda P, N, sigma, q, Do: f1216.thickness_oval_stress(
        P, Do, ovality=q / 100, strength=sigma, safety=N
    ),
    "thickness_fully_deteriorated": lambda qt, N, E, Es, C, Do, H, Hw, c_inside=True: (
        f1216.thickness_fully_deteriorated(
            qt * PSI,
            Do * INCH,
            modulus=E * PSI,
            soil_modulus=Es * PSI,
            cover=H * FOOT,
            water=Hw * FOOT,
            factor=C,
            safety=N,
            edition="2007b" if c_inside else "before-2007b",
        )
        / INCH
    ),
}


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: f1216.ovality_factor(2.0), "ovality = 2 .* 2 % is 0.02"),
        (lambda: f1216.ovality_factor(-0.01), "ovality = -0.01"),
        (lambda: f1216.buckling_pressure(1.0, modulus=1e9), "dimension_ratio = 1"),
        (lambda: f1216.buckling_pressure(50.0, modulus=0.0), "modulus = 0"),
        (lambda: f1216.buckling_pressure(50.0, modulus=1e9, poisson=1.0), "poisson = 1"),
        (lambda: f1216.thickness_buckling(-1.0, 0.3, modulus=1e9), "pressure = -1"),
        (lambda: f1216.thickness_buckling(1.0, 0.3, modulus=1e9, convention="inner"), "convention = 'inner'"),
        (lambda: f1216.thickness_oval_stress(1.0, 0.3, ovality=0.0, strength=1e7), "ovality = 0 "),
        (lambda: f1216.buoyancy_factor(0.0, 1.0), "cover = 0"),
        (lambda: f1216.buoyancy_factor(1.0, -1.0), "water = -1 .* below the top"),
        (lambda: f1216.elastic_support(1.0, constants="metric"), "constants = 'metric'"),
        (lambda: f1216.total_load(1.0, 0.0, unit_weight=2e4, live_load=-5.0), "live_load = -5"),
        (lambda: f1216_pressure.thickness_hole_span(1e5, 0.3, hole=-0.1, strength=1e7), "hole = -0.1"),
        (lambda: f1216_pressure.thickness_ring_tension(-1e5, 0.3, tensile_strength=1e7), "pressure = -100000"),
        (
            lambda: f1216.thickness_fully_deteriorated(
                1e5, 0.3, modulus=1e9, soil_modulus=1e6, cover=2.0, water=0.0, edition="2007"
            ),
            "edition = '2007'",
        ),
    ],
)
def test_bad_input_is_refused_by_name(call, message):
    with pytest.raises(ValueError, match=message):
        call()
