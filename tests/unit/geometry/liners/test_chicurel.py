"""Chicurel's lobe against its own differential equation, its edges, and the numbers of the errata."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from springline.errors import ParameterError
from springline.geometry.liners import (
    DEEPEST_K,
    ChicurelLobe,
    chicurel_arc_ratio,
    chicurel_height,
    chicurel_lobed,
    chicurel_protrusion,
    chicurel_u,
    host_polar,
    polar_curvature,
)


def test_u_is_the_root_of_the_buckled_branch():
    k = np.array([1e-4, 0.05, 0.3, 0.7, 0.95, 0.98, 0.999, 1 - 1e-9])
    w = np.sqrt(1 - k**2)
    u = chicurel_u(k)
    assert np.all((np.pi < u) & (u < 3 * np.pi / 2))
    expected = [brentq(lambda x, w=w: 2 * w * np.sin(x) - (1 + w) * x * np.cos(x), np.pi, 1.5 * np.pi) for w in w]
    np.testing.assert_allclose(u, expected, rtol=1e-11)


@pytest.mark.parametrize("k", [0.1, 0.5, 0.9, 0.999])
def test_the_lobe_joins_the_host_in_place_and_slope_and_obeys_the_beam(k):
    length, w = 2 * k, np.sqrt(1 - k**2)
    z = np.linspace(0, length, 400001)
    y = chicurel_height(z, k)
    assert y[[0, -1]] == pytest.approx([0, 0], abs=1e-12)
    slope = np.gradient(y, z, edge_order=2)
    assert slope[0] == pytest.approx(k / w, rel=1e-6)
    # y'' + (2u/l)^2 y = const
    u, inner = chicurel_u(k), slice(1000, -1000, 500)
    balance = np.gradient(slope, z)[inner] + (2 * u / length) ** 2 * y[inner]
    np.testing.assert_allclose(balance, balance[0], rtol=1e-4)


def test_protrusion_and_stretch_of_the_errata():
    k = np.array([0.25, 0.5, 0.75, 0.9])
    protrusion, where = chicurel_protrusion(k)
    assert protrusion == pytest.approx([5.6e-8, 2.4e-5, 1.9e-3, 3.0e-2], rel=0.03)
    for i, one in enumerate(k):
        z = 2 * one * where[i]
        outside = np.hypot(z - one, np.sqrt(1 - one**2) + chicurel_height(z, one)) - 1
        assert outside == pytest.approx(protrusion[i], rel=1e-6, abs=1e-15)
    assert 100 * (chicurel_arc_ratio(k) - 1) == pytest.approx([0.6, 3.0, 12, 37], rel=0.07)
    assert chicurel_protrusion(0.05)[0] > 0


@pytest.mark.parametrize("k", [0.05, 0.5, 0.9, 0.98])
def test_arc_ratio_against_integration(k):
    def speed(z):
        h = 1e-6 * k
        return np.hypot(1.0, (chicurel_height(z + h, k) - chicurel_height(z - h, k)) / (2 * h))

    half = quad(speed, 1e-5 * k, k, epsabs=1e-10, limit=400)[0] + 1e-5 * k * speed(2e-5 * k)
    assert chicurel_arc_ratio(k) == pytest.approx(2 * half / (2 * np.arcsin(k)), rel=1e-7)


@pytest.mark.parametrize("bearing", [np.pi / 2, 0.4, -2.5])
@pytest.mark.parametrize(("r1", "r2"), [(10.0, 10.0), (12.0, 9.0)])
def test_the_lobe_in_a_section_lies_on_the_published_curve(bearing, r1, r2):
    k = 0.6
    section = chicurel_lobed(r1, r2, k, bearing)
    x = np.linspace(-k, k, 31)
    middle = np.arctan2(np.sin(bearing) / r2, np.cos(bearing) / r1)
    unit = np.exp(1j * middle) * (np.sqrt(1 - k * k) + chicurel_height(x + k, k) + 1j * x)
    z, y = r1 * unit.real, r2 * unit.imag
    np.testing.assert_allclose(section.polar_radius(np.arctan2(y, z)), np.hypot(z, y), rtol=1e-11)
    joints = section.joints()
    np.testing.assert_allclose(joints.slope, 0.0, atol=1e-9)
    assert np.min(np.abs(joints.curvature[[0, 2]])) > 1e-3
    away = bearing + np.pi
    assert section.polar_radius(away) == pytest.approx(host_polar(away, r1, r2)[0])
    assert section.curvature(away) == pytest.approx(polar_curvature(*host_polar(away, r1, r2)))


def test_on_an_axis_it_is_the_published_equation_with_the_hosts_own_chord():
    section = chicurel_lobed(12.0, 9.0, 0.6)
    x = np.linspace(-7.0, 7.0, 15)
    height = 9.0 * (0.8 + chicurel_height((x / 12.0 + 0.6), 0.6))
    np.testing.assert_allclose(section.polar_radius(np.arctan2(height, x)), np.hypot(x, height), rtol=1e-11)


def test_deepest_k_is_where_a_ray_first_grazes_the_lobe():
    def least_turn(k):
        x = np.linspace(0, k, 200001)
        y = np.sqrt(1 - k * k) + chicurel_height(x + k, k)
        return np.min(np.diff(np.arctan2(x, y)))

    assert least_turn(DEEPEST_K) > 0
    assert least_turn(DEEPEST_K + 1e-4) < 0


def test_out_of_range_is_refused():
    for k in (0.0, 1.0, -0.1):
        with pytest.raises(ParameterError, match="expected 0 < k < 1"):
            chicurel_u(k)
    with pytest.raises(ParameterError, match=r"k = 0\.86 is out of range; expected 0 < k <= 0\.85086"):
        ChicurelLobe(0.86)
    with pytest.raises(ParameterError, match="z = 6 is out of range"):
        chicurel_height(6.0, 0.25, 10.0)
