import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from springline.design import f1216, glock

MODULUS, POISSON = 1.5e9, 0.3
PLATE = MODULUS / (1 - POISSON**2)


def greatest_pressure(thickness, perimeter, curved, gap):
    """Greatest equilibrium pressure of the module's energy, by numeric differentiation and search alone."""
    bending = PLATE * thickness**3 / 12

    def without_load(w, half):
        relieved = w * half / curved - np.pi**2 * w**2 / (8 * half) - 2 * np.pi * gap
        return bending * w**2 * np.pi**4 / (8 * half**3) + PLATE * thickness / (2 * perimeter) * relieved**2

    def pressures(w, half):
        h = 1e-6
        by_w = (without_load(w * (1 + h), half) - without_load(w * (1 - h), half)) / (2 * h * w)
        by_half = (without_load(w, half * (1 + h)) - without_load(w, half * (1 - h))) / (2 * h * half)
        return by_w / half, by_half / w

    def equilibrium(log_half):
        half = np.exp(log_half)
        # y = pi^2 w R/l^2 runs from 0 to 4 along the branch; both derivatives give one pressure at equilibrium.
        scale = half**2 / (np.pi**2 * curved)
        grid = np.linspace(1e-3, 4.0, 400)
        gap_between = [np.subtract(*pressures(y * scale, half)) for y in grid]
        changes = np.flatnonzero(np.diff(np.sign(gap_between)))
        if not changes.size:
            return -np.inf
        y = brentq(lambda v: np.subtract(*pressures(v * scale, half)), grid[changes[0]], grid[changes[0] + 1])
        return pressures(y * scale, half)[0]

    start = (5 / 36 * thickness**2 * perimeter * np.pi**4 * curved**2) ** 0.2
    halves = np.log(start) + np.linspace(-0.2, 1.5, 60)
    best = halves[np.argmax([equilibrium(v) for v in halves])]
    return -minimize_scalar(lambda v: -equilibrium(v), bounds=(best - 0.04, best + 0.04), method="bounded").fun


@pytest.mark.parametrize(("ovality", "gap"), [(0.0, 0.0), (0.05, 0.0), (0.0, 0.0006), (0.04, 0.001)])
def test_the_closed_form_is_the_energys_greatest_pressure(ovality, gap):
    thickness, diameter = 0.006, 0.3
    radius = (diameter - thickness) / 2
    a, b = radius * (1 + ovality), radius * (1 - ovality)
    t = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    perimeter = 2 * np.pi * np.mean(np.hypot(a * np.sin(t), b * np.cos(t)))
    expected = greatest_pressure(thickness, perimeter, a**2 / b, gap)
    found = glock.glock_pressure(thickness, diameter, modulus=MODULUS, ovality=ovality, gap=gap)
    assert found == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize("ratio", [30.0, 60.0, 100.0])
def test_a_close_round_liner_follows_glocks_law(ratio):
    thickness = 0.3 / ratio
    law = PLATE * (thickness / 0.3) ** 2.2
    found = glock.glock_pressure(thickness, 0.3 + thickness, modulus=MODULUS)
    assert found / law == pytest.approx(1.0, abs=0.005)


def test_glock_carries_more_than_f1216_in_slender_liners_and_ovality_costs_less():
    assert glock.glock_pressure(0.003, 0.3, modulus=MODULUS) > f1216.buckling_pressure(100, modulus=MODULUS, safety=1)
    assert glock.ovality_knockdown(0.05) > f1216.ovality_factor(0.05)
    assert glock.ovality_knockdown(0.0) == 1.0


def test_gaps_only_weaken_and_weaken_thin_liners_most():
    gaps = np.array([0.0, 1e-4, 1e-3, 5e-3])
    thick, thin = (glock.gap_knockdown(t, 0.3, gap=gaps) for t in (0.009, 0.003))
    assert (np.diff(thick) < 0).all()
    assert (np.diff(thin) < 0).all()
    assert (thin[1:] < thick[1:]).all()
    assert thick[0] == thin[0] == 1.0
    assert np.isnan(glock.gap_knockdown(0.006, 0.3, gap=np.nan))


@pytest.mark.parametrize("gap", [0.0, 0.0008])
def test_thickness_inverts_the_pressure(gap):
    pressure, ovality = np.array([[10e3], [80e3]]), np.array([0.0, 0.03, 0.08])
    t = glock.thickness_glock(pressure, 0.4, modulus=MODULUS, ovality=ovality, gap=gap, safety=1.5)
    carried = glock.glock_pressure(t, 0.4, modulus=MODULUS, ovality=ovality, gap=gap)
    np.testing.assert_allclose(carried, np.broadcast_to(1.5 * pressure, (2, 3)), rtol=1e-10)
    assert (np.diff(t, axis=1) > 0).all()


def test_no_wall_is_returned_that_does_not_suffice():
    assert np.isnan(glock.thickness_glock(1e9, 0.3, modulus=MODULUS))
    assert glock.thickness_glock(0.0, 0.3, modulus=MODULUS) == 0.0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: glock.glock_pressure(0.2, 0.3, modulus=1e9), "thickness = 0.2 .* diameter/2"),
        (lambda: glock.glock_pressure(0.01, 0.3, modulus=1e9, ovality=5.0), "ovality = 5 .* 2 % is 0.02"),
        (lambda: glock.glock_pressure(0.01, 0.3, modulus=1e9, gap=-1e-3), "gap = -0.001"),
        (lambda: glock.glock_pressure(0.01, 0.3, modulus=1e9, poisson=2.0), "poisson = 2"),
        (lambda: glock.thickness_glock(-1.0, 0.3, modulus=1e9), "pressure = -1"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
