"""Coefficients to shapes and back, through points that lie on the curve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from springline.geometry.fitting import circle_from_coefficients, conic_to_ellipse, ellipse_to_conic

lengths = st.floats(0.05, 5.0)
places = st.floats(-10.0, 10.0)


@given(places, places, lengths, st.floats(0.0, 0.9), st.floats(-np.pi, np.pi), st.sampled_from([-3.0, -1e-6, 0.5, 1e6]))
def test_points_of_the_ellipse_satisfy_its_conic_and_the_conic_gives_it_back(zc, yc, mean, share, double, factor):
    half = share * mean
    parameters = [zc, yc, mean, half * np.cos(double), half * np.sin(double)]
    conic = ellipse_to_conic(parameters)
    assert 4 * conic[0] * conic[2] - conic[1] ** 2 == pytest.approx(1.0, rel=1e-9)
    psi = np.linspace(0.0, 6.0, 13)
    point = np.exp(0.5j * double) * ((mean + half) * np.cos(psi) + 1j * (mean - half) * np.sin(psi))
    z, y = point.real + zc, point.imag + yc
    values = conic @ [z * z, z * y, y * y, z, y, np.ones_like(z)]
    size = np.abs(conic[[0, 1, 2]]).max() * (np.abs(z).max() + np.abs(y).max()) ** 2 + abs(conic[5])
    assert values == pytest.approx(np.zeros(13), abs=1e-12 * size)
    shape = conic_to_ellipse(*(factor * conic))
    scale = mean + abs(zc) + abs(yc)
    assert shape.centre_z == pytest.approx(zc, abs=1e-9 * scale)
    assert shape.centre_y == pytest.approx(yc, abs=1e-9 * scale)
    # the level is the difference of terms of the centre's size squared
    loss = 1e-12 * scale**2 / (mean * (1 - share)) ** 2
    assert shape.semi_major == pytest.approx(mean + half, rel=loss + 1e-9)
    assert shape.semi_minor == pytest.approx(mean - half, rel=loss + 1e-9)
    assert -np.pi / 2 < shape.axis_bearing <= np.pi / 2 + 1e-12
    if share > 1e-3:
        turn = np.exp(2j * shape.axis_bearing) * np.exp(-1j * double)
        assert abs(np.angle(turn)) < 1e-6


def test_upright_ellipse_lies_at_plus_a_quarter_turn():
    assert conic_to_ellipse(4.0, 0.0, 1.0, 0.0, 0.0, -4.0).axis_bearing == np.pi / 2
    assert conic_to_ellipse(4.0, -0.0, 1.0, 0.0, 0.0, -4.0).axis_bearing == np.pi / 2


@pytest.mark.parametrize(
    "conic",
    [
        (1, 0, -1, 0, 0, -1),  # hyperbola
        (1, 0, 0, 0, 1, 0),  # parabola
        (1, 0, 1, 0, 0, 1),  # no real point
        (1, 0, 1, 0, 0, 0),  # one point
        (1, 2, 1, 0, 0, -1),  # two parallel lines
        (0, 0, 0, 1, 1, 1),  # one line
    ],
)
def test_conic_that_is_no_ellipse_is_missing(conic):
    assert all(np.isnan(value) for value in conic_to_ellipse(*conic))


def test_coefficients_broadcast():
    shape = conic_to_ellipse([1.0, 1.0], 0.0, [[1.0], [4.0]], 0.0, 0.0, -4.0)
    assert shape.semi_major.tolist() == [[2.0, 2.0], [2.0, 2.0]]
    assert shape.semi_minor.tolist() == [[2.0, 2.0], [1.0, 1.0]]


@given(places, places, lengths, st.floats(-3.0, 3.0).filter(lambda x: abs(x) > 1e-3))
def test_circle_from_its_coefficients(zc, yc, radius, a):
    circle = circle_from_coefficients(a, -2 * a * zc, -2 * a * yc, a * (zc * zc + yc * yc - radius * radius))
    assert circle.centre_z == pytest.approx(zc, abs=1e-12)
    assert circle.centre_y == pytest.approx(yc, abs=1e-12)
    assert circle.radius == pytest.approx(radius, rel=1e-10 * (1 + (zc * zc + yc * yc) / radius**2))


@pytest.mark.parametrize("coefficients", [(0, 1, 1, 1), (1, 0, 0, 1), (1, 0, 0, 0)])
def test_coefficients_of_no_circle_are_missing(coefficients):
    assert all(np.isnan(value) for value in circle_from_coefficients(*coefficients))
