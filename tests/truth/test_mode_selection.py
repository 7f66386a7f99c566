"""Mode recovery on simulated rings: classes, honest indecision, parameters inside their intervals.

The rings are built here from scratch (a root of the perimeter, a rigid rotation found from the chord's ends, a ray and
a quadratic), not with the sections under test.
"""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe
from tests.spoilt import BEARINGS, NOISE, READINGS, spoil

from springline.geometry.fitting.modes import select_modes

RINGS = 2000
MODES = (1, 2, 3, 4, 5)

_S = np.linspace(0.5, 1.0, 1001)
_MAJOR = np.array([brentq(lambda a, s=s: 4 * a * ellipe(1 - (s / a) ** 2) - 2 * np.pi, s, 1.6) for s in _S])


def major(s):
    return np.interp(s, _S, _MAJOR)


def quarter(folded, s0, half_width):
    """Polar radius of a quarter arc of severity s0 whose springline end is moved to half_width, by turning it."""
    a, b = major(s0), s0
    crown = np.sqrt(a * a + b * b - half_width**2)
    turn = np.arctan2(crown, -half_width) - np.arctan2(b, -a)
    c, s = np.cos(turn), np.sin(turn)
    cz, cy = half_width - c * a, -s * a
    uz, uy = c * np.cos(folded) + s * np.sin(folded), -s * np.cos(folded) + c * np.sin(folded)
    vz, vy = -(c * cz + s * cy), s * cz - c * cy
    two, one, zero = (uz / a) ** 2 + (uy / b) ** 2, uz * vz / a**2 + uy * vy / b**2, (vz / a) ** 2 + (vy / b) ** 2 - 1
    return (-one + np.sqrt(one * one - two * zero)) / two


def simulated(mode, rng):
    """One clean ring of unit radius and its true s1, s02, s01."""
    while True:
        s1 = rng.uniform(0.80, 0.97)
        s01, s02 = np.sort(rng.uniform(s1, 1.0, 2)) if mode == 5 else (s1, rng.uniform(s1, 1.0))
        top, bottom, half_width = {
            1: (s1, s1, major(s1)),
            2: (1.0, 1.0, np.sqrt(2 - s1 * s1)),
            3: (1.0, s1, major(s1)),
            4: (s02, s1, major(s1)),
            5: (s02, s01, np.sqrt(major(s01) ** 2 + s01**2 - s1 * s1)),
        }[mode]
        if major(top) ** 2 + top**2 > half_width**2:
            break
    folded = np.arcsin(np.abs(np.sin(BEARINGS)))
    up = np.sin(BEARINGS) >= 0
    return np.where(up, quarter(folded, top, half_width), quarter(folded, bottom, half_width)), (s1, s02, s01)


@pytest.fixture(scope="module")
def trial():
    rng = np.random.default_rng(20)
    modes = rng.integers(1, 6, RINGS)
    clean = [simulated(mode, rng) for mode in modes]
    rings = np.array([spoil(radius, rng) for radius, _ in clean])
    return modes, np.array([truth for _, truth in clean]), select_modes(rings, BEARINGS)


def test_named_classes_are_right_and_few_are_left_undecided(trial):
    modes, _, found = trial
    confusion = np.array([[np.sum((modes == m) & (found.mode == k)) for k in (-1, 0, *MODES)] for m in MODES])
    named = found.mode >= 0
    assert np.mean(found.mode[named] == modes[named]) >= 0.95, confusion
    assert np.mean(~named) <= 0.30, confusion


def test_the_posterior_is_no_worse_than_its_baseline(trial):
    modes, _, found = trial
    fitted = np.isfinite(found.probability).all(axis=1)
    by_posterior = found.probability[fitted].argmax(axis=1) == modes[fitted]
    by_criterion = found.bic[fitted].argmin(axis=1) == modes[fitted]
    assert by_criterion.mean() > 0.85
    assert by_posterior.mean() > by_criterion.mean() - 0.005


def test_the_posterior_is_honest(trial):
    modes, _, found = trial
    fitted = np.isfinite(found.probability).all(axis=1)
    assert fitted.mean() > 0.99
    best = found.probability[fitted].argmax(axis=1)
    sure = found.probability[fitted].max(axis=1)
    for low, high in ((0.5, 0.8), (0.8, 0.95), (0.95, 1.0)):
        some = (sure >= low) & (sure <= high)
        right = best[some] == modes[fitted][some]
        assert np.mean(right) == pytest.approx(sure[some].mean(), abs=0.03 + 2 * np.sqrt(0.25 / some.sum()))


def test_undecided_rings_lie_near_a_shared_limit(trial):
    modes, truth, found = trial
    s1, s02, s01 = truth.T
    # Mode 4 meets mode 3 at s02 = 1 and mode 1 at s02 = s1; mode 5 meets mode 4 at s01 = s1 and mode 2 at s01 = 1.
    gap = np.where(modes == 4, np.minimum(1 - s02, s02 - s1), np.minimum(1 - s01, s01 - s1))
    free = modes >= 4
    undecided = found.mode < 0
    assert np.median(gap[free & undecided]) < 0.5 * np.median(gap[free & ~undecided])


def test_true_severities_lie_in_their_intervals(trial):
    modes, truth, found = trial
    right = found.mode == modes
    held = {}
    for name, column, source, some in (("s1", 0, 0, MODES), ("s02", 2, 1, (4, 5)), ("s01", 3, 2, (5,))):
        for mode in some:
            rows = right & (modes == mode)
            error = np.abs(found.severities[rows, column] - truth[rows, source])
            held[name, mode] = np.mean(error <= 1.96 * found.sigma[rows, column])
    assert {key: share for key, share in held.items() if not 0.90 <= share <= 0.98} == {}


def test_a_noisy_circle_is_never_called_deformed():
    rng = np.random.default_rng(4)
    rings = np.array([spoil(np.ones(READINGS), rng) for _ in range(500)])
    found = select_modes(rings, BEARINGS)
    deformed = (found.mode > 0) & (found.severities[:, 0] < 0.99)
    assert not deformed.any()
    assert np.mean(found.mode == 0) > 0.9


def test_upside_down_sections_are_recognised():
    rng = np.random.default_rng(5)
    clean = [quarter(np.arcsin(np.abs(np.sin(BEARINGS))), 1.0, major(s)) for s in np.linspace(0.82, 0.94, 40)]
    other = [quarter(np.arcsin(np.abs(np.sin(BEARINGS))), s, major(s)) for s in np.linspace(0.82, 0.94, 40)]
    up = np.sin(BEARINGS) >= 0
    rings = np.array([spoil(np.where(up, top, bottom), rng) for top, bottom in zip(other, clean, strict=True)])
    found = select_modes(rings, BEARINGS)
    named = found.mode >= 0
    assert named.mean() > 0.6
    assert (found.mode[named] == 3).mean() > 0.9
    assert found.inverted[named].all()


def test_a_shape_that_no_mode_describes_is_undecided():
    rng = np.random.default_rng(6)
    lobed = 1 + 0.03 * np.cos(3 * BEARINGS + 0.4)
    found = select_modes(np.array([spoil(lobed, rng) for _ in range(20)]), BEARINGS)
    assert (found.mode == -1).all()
    assert set(found.reason) == {"no mode describes it"}


def test_offset_of_the_sensor_and_size_do_not_matter():
    rng = np.random.default_rng(7)
    radius, _ = simulated(2, rng)
    z, y = 0.15 * radius * np.cos(BEARINGS) - 0.02, 0.15 * radius * np.sin(BEARINGS) + 0.03
    seen = np.arctan2(y, z) % (2 * np.pi)
    order = np.argsort(seen)
    ranges = np.interp(BEARINGS, seen[order], np.hypot(z, y)[order], period=2 * np.pi)
    found = select_modes((ranges + 0.15 * NOISE * rng.standard_normal(READINGS))[None], BEARINGS)
    assert found.mode[0] == 2
    assert found.radius[0] == pytest.approx(0.15, rel=1e-3)
    assert found.centre[0] == pytest.approx([-0.02, 0.03], abs=3e-4)
