"""Exact orthogonal distances: against a minimisation that knows nothing of the kernel's iteration."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from springline.geometry.fitting._feet import circle_feet, ellipse_feet

PARAMETERS = [
    [0.1, -0.2, 1.0, 0.0, 0.0],
    [0.1, -0.2, 1.0, 0.05, 0.02],
    [0.0, 0.0, 1.0, -0.3, 0.0],
    [0.0, 0.0, 1.0, 0.0, -0.6],
    [3.0, 1.0, 0.02, 0.001, 0.015],
    [0.0, 0.0, 1.0, 0.95, 0.0],
]


def wall(par, psi):
    """Return the ellipse's points z + i y from semi-axes and bearing, not from the kernel's own form."""
    zc, yc, mean, u, v = par
    half, axis = np.hypot(u, v), 0.5 * np.arctan2(v, u)
    return zc + 1j * yc + np.exp(1j * axis) * ((mean + half) * np.cos(psi) + 1j * (mean - half) * np.sin(psi))


def distance(par, point):
    """Return the distance from the point to the ellipse: the best of a fine search, then polished."""
    psi = np.linspace(0.0, 2.0 * np.pi, 2001)
    best = psi[np.abs(wall(par, psi) - point).argsort()[:3]]
    found = [
        minimize_scalar(lambda a: np.abs(wall(par, a) - point), bounds=(b - 0.01, b + 0.01), options={"xatol": 1e-11})
        for b in best
    ]
    return min(f.fun for f in found)


def kernel(par, z, y):
    z, y = np.asarray(z, float), np.asarray(y, float)
    signed, jacobian, foot = np.empty(z.size), np.empty((5, z.size)), np.empty(z.size)
    ellipse_feet(z, y, z.size, np.array(par), signed, jacobian, foot)
    return signed, jacobian


@pytest.mark.parametrize("par", PARAMETERS)
def test_distances_are_exact_anywhere_in_the_plane(par):
    rng = np.random.default_rng(7)
    points = par[0] + 1j * par[1] + par[2] * 3.0 * (rng.uniform(-1, 1, 60) + 1j * rng.uniform(-1, 1, 60))
    # the centre, and both axes inside and outside the evolute
    axis = np.exp(0.5j * np.arctan2(par[4], par[3]))
    special = par[0] + 1j * par[1] + par[2] * axis * np.array([0.0, 0.01, 0.3, 1.9, 0.3j, 1.9j])
    points = np.concatenate([points, special])
    signed, _ = kernel(par, points.real, points.imag)
    expected = [distance(par, p) for p in points]
    assert np.abs(signed) == pytest.approx(expected, abs=1e-10 * par[2])


@pytest.mark.parametrize("par", PARAMETERS)
def test_points_of_the_wall_are_on_it(par):
    points = wall(par, np.arange(0.0, 6.0, 0.1))
    assert kernel(par, points.real, points.imag)[0] == pytest.approx(np.zeros(60), abs=1e-14)


@pytest.mark.parametrize("par", PARAMETERS)
def test_sign_is_positive_outside(par):
    psi = np.arange(0.0, 6.0, 0.5)
    centre = par[0] + 1j * par[1]
    for factor, sign in ((1.05, 1.0), (0.95, -1.0)):
        points = centre + factor * (wall(par, psi) - centre)
        assert (np.sign(kernel(par, points.real, points.imag)[0]) == sign).all()


@pytest.mark.parametrize("par", PARAMETERS[1:5])
def test_jacobian_is_minus_the_derivative_of_the_distance(par):
    rng = np.random.default_rng(1)
    points = wall(par, rng.uniform(0, 2 * np.pi, 40)) + 0.01 * par[2] * rng.standard_normal(40)
    _, jacobian = kernel(par, points.real, points.imag)
    step = 1e-6 * par[2]
    for k in range(5):
        high, low = np.array(par), np.array(par)
        high[k] += step
        low[k] -= step
        difference = kernel(high, points.real, points.imag)[0] - kernel(low, points.real, points.imag)[0]
        assert jacobian[k] == pytest.approx(-difference / (2 * step), abs=1e-6)


def test_circle_is_the_ellipse_without_ovality():
    rng = np.random.default_rng(2)
    z, y = rng.uniform(-2, 2, (2, 50))
    signed, jacobian = kernel([0.1, 0.2, 1.0, 0.0, 0.0], z, y)
    of_circle, slopes = np.empty(50), np.empty((5, 50))
    circle_feet(z, y, 50, np.array([0.1, 0.2, 1.0]), of_circle, slopes)
    assert of_circle == pytest.approx(signed, abs=1e-14)
    assert slopes[:3] == pytest.approx(jacobian[:3], abs=1e-13)
