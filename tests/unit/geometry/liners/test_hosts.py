"""The host in polar form against its own equation and arc lengths by integration."""

import numpy as np
import pytest
from scipy.integrate import quad

from springline.geometry.liners import host_arc, host_polar, polar_curvature


@pytest.mark.parametrize(("r1", "r2"), [(12.0, 10.0), (10.0, 12.0), (10.0, 10.0), (5.0, 1.0)])
def test_radius_and_derivatives(r1, r2):
    theta = np.linspace(-4, 4, 81)
    radius, first, second = host_polar(theta, r1, r2)
    z, y = radius * np.cos(theta), radius * np.sin(theta)
    np.testing.assert_allclose((z / r1) ** 2 + (y / r2) ** 2, 1.0, rtol=1e-13)
    h = 1e-4
    (_, before, _), (_, after, _) = host_polar(theta - h, r1, r2), host_polar(theta + h, r1, r2)
    np.testing.assert_allclose(second, (after - before) / (2 * h), rtol=1e-5, atol=1e-4)
    near, far = host_polar(theta - h, r1, r2)[0], host_polar(theta + h, r1, r2)[0]
    np.testing.assert_allclose(first, (far - near) / (2 * h), rtol=1e-5, atol=1e-6)
    bend = r1 * r2 / ((r2 * z / r1) ** 2 + (r1 * y / r2) ** 2) ** 1.5
    np.testing.assert_allclose(polar_curvature(radius, first, second), bend, rtol=1e-11)


@pytest.mark.parametrize(("low", "high"), [(0.3, 1.2), (-2.0, 4.0), (1.0, 1.0 + 2 * np.pi), (3.0, 9.5)])
def test_arc_length(low, high):
    def speed(t):
        radius, first, _ = host_polar(t, 12.0, 9.0)
        return float(np.hypot(radius, first))

    assert host_arc(low, high, 12.0, 9.0) == pytest.approx(
        quad(speed, low, high, epsabs=1e-12, limit=200)[0], rel=1e-11
    )
