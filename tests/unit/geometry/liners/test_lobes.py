"""Lobes against the published equations as printed, their boundary conditions, and differences."""

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.liners import Lobe, SmoothLobe, glock_radius, host_polar

HALF = np.radians(30.0)


def published(theta, r1, r2, phi, oc, p):
    """(7.18) to (7.23) as printed, with the power 3/2 of the errata; theta from the crown."""
    base = (r1 * np.cos(phi)) ** 2 + (r2 * np.sin(phi)) ** 2
    k3 = r1 * r2 / np.sqrt(base)
    k1 = oc - k3
    slope = r1 * r2 * (r1**2 - r2**2) * np.sin(phi) * np.cos(phi) / base**1.5
    k2 = 1.0 / (1.0 + 2.0 * phi / (k1 * np.pi) * slope)
    return k1 * (1.0 - np.abs(theta) ** p / (k2 * phi**p)) * np.cos(np.pi * theta / (2.0 * phi)) + k3


@pytest.mark.parametrize("p", [1.5, 2.0, 3.0, 4.5, 8.0])
@pytest.mark.parametrize("bearing", [np.pi / 2, -np.pi / 2])
def test_the_lobe_on_the_minor_axis_is_the_published_one(p, bearing):
    theta = np.linspace(-HALF, HALF, 41)
    radius, slope, _ = Lobe(HALF, 8.0, p, bearing).polar(theta, 12.0, 10.0)
    np.testing.assert_allclose(radius, published(theta, 12.0, 10.0, HALF, 8.0, p), rtol=1e-13)
    assert slope[[0, -1]] == pytest.approx([-1.4905862032437331, 1.4905862032437331])


@pytest.mark.parametrize("lobe", [Lobe(0.6, 7.0, 2.5, 0.9), Lobe(1.4, 8.0, 3.0, -2.0), SmoothLobe(0.6, 7.0, 3.0, 0.9)])
def test_boundary_conditions_at_any_clock(lobe):
    for side in (-1.0, 1.0):
        edge, slope, _ = lobe.polar(side * lobe.phi, 12.0, 9.0)
        host = host_polar(lobe.bearing + side * lobe.phi, 12.0, 9.0)
        assert edge == pytest.approx(host[0], rel=1e-13)
        assert slope == pytest.approx(host[1], rel=1e-10)
        radius, level, _ = lobe.polar(0.0, 12.0, 9.0, side=side)
        assert radius == pytest.approx(lobe.oc)
        if isinstance(lobe, Lobe):
            assert level == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    "lobe",
    [Lobe(0.6, 7.0, 2.5, 0.9), Lobe(0.6, 7.0, 1.5, 0.9), SmoothLobe(0.6, 7.0, 2.0), SmoothLobe(0.6, 7.0, 3.5, 2.0)],
)
def test_derivatives(lobe):
    offset, h = np.array([-0.55, -0.3, -0.1, 0.1, 0.3, 0.55]), 1e-4
    before, at, after = (lobe.polar(offset + step, 12.0, 9.0) for step in (-h, 0.0, h))
    np.testing.assert_allclose(at[1], (after[0] - before[0]) / (2 * h), rtol=1e-5)
    np.testing.assert_allclose(at[2], (after[1] - before[1]) / (2 * h), rtol=1e-4, atol=1e-4)


def test_edge_second_and_curvature_of_the_smooth_lobe():
    lobe = Lobe(HALF, 8.0, 4.0)
    _, _, second = lobe.polar(HALF, 12.0, 10.0)
    assert lobe.edge_second(12.0, 10.0) == pytest.approx(second)
    for n, continuous in ((2.0, False), (2.5, True), (3.0, True), (4.0, True)):
        _, _, second = SmoothLobe(HALF, 8.0, n).polar(HALF, 12.0, 10.0)
        host = host_polar(np.pi / 2 + HALF, 12.0, 10.0)[2]
        # between 2 and 3 the last cosine falls with a power below 1, so it is small rather than exact in floats
        assert (abs(second - host) < 1e-6) == continuous


def test_k2_is_infinite_where_kappa_vanishes():
    circle = Lobe(HALF, 10.0).coefficients(10.0, 10.0)
    assert (circle.kappa, circle.k2) == (0.0, np.inf)
    edge, slope, _ = host_polar(np.pi / 2 + HALF, 12.0, 10.0)
    vanishing = Lobe(HALF, edge - 2 * HALF * slope / np.pi)
    assert vanishing.coefficients(12.0, 10.0).kappa == 0.0
    radius, slope_there, _ = vanishing.polar(np.array([-HALF, 0.0, HALF]), 12.0, 10.0)
    assert radius == pytest.approx([edge, float(vanishing.oc), edge])
    assert slope_there == pytest.approx([-slope, 0.0, slope])


def test_glock_is_the_smooth_lobe_of_power_two_in_a_circle():
    theta = np.linspace(0, 2 * HALF, 21)
    smooth = SmoothLobe(HALF, 8.0, 2.0).polar(theta - HALF, 10.0, 10.0)[0]
    np.testing.assert_allclose(glock_radius(theta, 10.0, 2.0, HALF), smooth, rtol=1e-14)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Lobe(-0.1, 8.0), "phi = -0.1 is out of range; expected 0 < phi < 3.141592654"),
        (lambda: Lobe(np.pi, 8.0), "phi = 3.141592654 is out of range"),
        (lambda: Lobe(0.5, 0.0), "oc = 0 is out of range"),
        (lambda: Lobe(0.5, 8.0, -2.0), "p = -2 is out of range"),
        (lambda: SmoothLobe(0.5, 8.0, 1.5), "n = 1.5 is out of range; expected 2 <= n"),
        (lambda: Lobe(0.5, 8.0).polar(0.6, 12.0, 10.0), "offset = 0.6 is out of range; expected -0.5 <= offset <= 0.5"),
        (lambda: Lobe(0.5, 8.0).polar(0.1, 0.0, 10.0), "r1 = 0 is out of range"),
        (lambda: glock_radius(1.1, 10.0, 2.0, 0.5), "theta = 1.1 is out of range; expected"),
        (
            lambda: glock_radius(0.1, 10.0, 10.0, 0.5),
            "depth = 10 is out of range; expected 0 <= depth < 10",
        ),
    ],
)
def test_out_of_range_is_refused(call, message):
    with pytest.raises(ParameterError) as refused:
        call()
    assert message in str(refused.value)
