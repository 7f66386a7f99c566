"""Constant-perimeter ellipses against the perimeter itself and against the dissertation's printed numbers."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe

from springline.errors import ParameterError
from springline.geometry.sections import ellipses


def test_the_exact_major_axis_keeps_the_perimeter():
    s = np.concatenate([np.geomspace(1e-6, 1.0, 400), np.linspace(0.4, 1.0, 601)])
    a = ellipses.semi_major(s)
    np.testing.assert_allclose(4 * a * ellipe(1 - (s / a) ** 2), 2 * np.pi, rtol=1e-13)
    assert np.all(np.diff(ellipses.semi_major(np.linspace(0.01, 1, 500))) < 0)


def test_ramanujan_keeps_its_own_perimeter_and_misses_the_exact_one_as_the_errata_say():
    s = np.linspace(1e-3, 1.0, 300)
    a = ellipses.semi_major(s, rule="ramanujan")
    np.testing.assert_allclose(ellipses.perimeter_ramanujan(a, s), 2 * np.pi, rtol=1e-14)
    error = ellipses.semi_major([0.9, 0.5], rule="ramanujan") - ellipses.semi_major([0.9, 0.5])
    assert error[0] == pytest.approx(3e-9, abs=1e-9)
    assert error[1] == pytest.approx(4.0e-5, abs=2e-6)


@pytest.mark.parametrize("rule", ellipses.RULES)
def test_severity_of_major_inverts_semi_major_down_to_the_flat_pipe(rule):
    s = np.geomspace(1e-3, 1.0, 200)
    back = ellipses.severity_of_major(2.5 * ellipses.semi_major(s, rule=rule), 2.5, rule=rule)
    np.testing.assert_allclose(back, s, rtol=1e-7)  # the flat ellipse's axis no longer tells its severity
    np.testing.assert_allclose(back[s > 0.05], s[s > 0.05], rtol=1e-11)


def test_perimeters_and_mean_radius_against_integrals():
    for a, b in ((1.0, 1.0), (1.2, 1.0), (1.0, 5.0), (1.0, 0.02)):
        length = 4 * quad(lambda t, a=a, b=b: np.hypot(a * np.sin(t), b * np.cos(t)), 0, np.pi / 2, limit=200)[0]
        mean = quad(lambda t, a=a, b=b: ellipses.polar_ellipse(t, a, b), 0, np.pi / 2, limit=200)[0] / (np.pi / 2)
        assert ellipses.perimeter(a, b) == pytest.approx(length, rel=1e-9)
        assert ellipses.mean_radius(a, b) == pytest.approx(mean, rel=1e-9)
        assert ellipses.perimeter_ramanujan(a, b, order=2) == pytest.approx(length, rel=3e-4)


def test_polar_ellipse_about_another_origin_lies_on_the_ellipse():
    theta = np.linspace(0, 2 * np.pi, 37)
    radius = ellipses.polar_ellipse_about(theta, 1.2, 0.8, 0.3, 3.9, -0.25)
    point = radius * np.exp(1j * theta) - 0.3 * np.exp(3.9j)
    own = point * np.exp(0.25j)
    np.testing.assert_allclose((own.real / 1.2) ** 2 + (own.imag / 0.8) ** 2, 1.0, rtol=1e-13)
    missed = ellipses.polar_circle_about([np.pi, 0.0], 1.0, 2.0, 0.0)
    assert np.isnan(ellipses.polar_circle_about(np.pi / 2, 1.0, 2.0, 0.0))
    assert missed[1] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ellipses.semi_major(0.0), "s = 0 is out of range; expected 0 < s <= 1"),
        (lambda: ellipses.semi_major([0.9, 1.0001]), "element 1: s = 1.0001 is out of range"),
        (
            lambda: ellipses.severity_of_major(1.58),
            "a = 1.58 is out of range; expected 1 <= a < 1.570796327 with r = 1",
        ),
        (lambda: ellipses.severity_of_major(0.99), "a = 0.99 is out of range"),
        (lambda: ellipses.perimeter(1.0, -1.0), "semi_b = -1 is out of range"),
        (lambda: ellipses.semi_major(0.9, rule="euler"), "rule = 'euler' is not known"),
    ],
)
def test_out_of_range_is_refused_by_name_value_and_range(call, message):
    with pytest.raises(ParameterError, match=message.replace("(", r"\(")):
        call()


def test_unknown_stays_unknown():
    assert np.isnan(ellipses.semi_major(np.nan))
    assert np.isnan(ellipses.perimeter(np.nan, 1.0))
