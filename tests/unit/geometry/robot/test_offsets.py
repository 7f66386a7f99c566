import numpy as np
import pytest
from scipy.optimize import brentq

from springline.geometry.robot import deformed_r1, offset_deformation, offset_pitch, ride_height


@pytest.mark.parametrize("s", [0.3, 0.5, 0.8, 0.95, 1.0])
def test_ramanujans_perimeter_is_kept(s):
    a, b = deformed_r1(s, r=2.0), 2.0 * s
    perimeter = np.pi * (3 * (a + b) - np.sqrt((3 * a + b) * (a + 3 * b)))
    assert perimeter == pytest.approx(4 * np.pi, rel=1e-14)


@pytest.mark.parametrize(("s", "half_span"), [(0.9, 0.3), (0.8, 0.85), (0.6, 0.0), (1.0, 0.5)])
def test_the_rise_is_where_the_wheels_touch_the_ellipse(s, half_span):
    a = deformed_r1(s)
    floor = brentq(lambda y: (half_span / a) ** 2 + (y / s) ** 2 - 1, -s, 0)
    height = np.sqrt(1 - half_span**2)
    assert offset_deformation(s, half_span=half_span) == pytest.approx(floor + height, abs=1e-12)


@pytest.mark.parametrize(("s", "w"), [(0.99, 0.713), (0.9, 0.765), (0.8, 0.815)])
def test_offsets_turn_negative_where_erratum_25_says(s, w):
    assert brentq(lambda span: offset_deformation(s, half_span=span), 0.5, 0.95) == pytest.approx(w, abs=6e-4)


@pytest.mark.parametrize(("s", "w"), [(0.4, 0.653), (0.3, 0.836)])
def test_the_narrowest_wheels_that_fit_are_those_of_erratum_25(s, w):
    assert brentq(lambda span: offset_deformation(s, half_span=span) - s, 0.1, 0.99) == pytest.approx(w, abs=6e-4)


@pytest.mark.parametrize(("length", "height", "pitch"), [(0.4, 0.09, 20.0), (-0.3, 0.09, 10.0), (0.1, 0.2, -35.0)])
def test_pitch_turns_the_scanner_about_the_axle(length, height, pitch):
    angle = np.radians(pitch)
    turned = length * np.sin(angle) + height * np.cos(angle)
    assert offset_pitch(angle, length=length, height=height) == pytest.approx(turned - height, abs=1e-15)


def test_ride_height_uses_the_half_span():
    assert ride_height(0.15, wheel_radius=0.03) == pytest.approx(0.12)
    assert ride_height(0.15, wheel_radius=0.03, half_span=0.12) == pytest.approx(0.06)


def test_a_slit_is_finite():
    assert offset_deformation((3 + 2 * np.sqrt(6)) / 5, half_span=0.0, r=1.0) == pytest.approx(1 - 1.5797958971)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: deformed_r1(1.6), "s = 1.6 .* 0 <= s <= 1.5798"),
        (lambda: deformed_r1(-0.1), "s = -0.1"),
        (lambda: deformed_r1(0.9, r=0.0), "r = 0 .* r > 0"),
        (lambda: offset_deformation(0.9, half_span=1.1), "half_span = 1.1 .* HALF"),
        (lambda: offset_deformation(1.4, half_span=0.9), "half_span = 0.9 .* narrower"),
        (lambda: ride_height(0.1, wheel_radius=0.2), "wheel_radius = 0.2"),
        (lambda: offset_pitch(2.0, length=1.0, height=1.0), "pitch = 2"),
    ],
)
def test_impossible_robots_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
