"""Invariances of lenses, cameras, openings and contours over their whole valid range."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from springline.geometry import camera, contours, openings
from springline.geometry.lenses import MODELS, Lens

ANGLE = st.floats(-1.3, 1.3)
FULL = st.floats(-np.pi, np.pi)
WITHIN = st.floats(-5.0, 5.0)
TURN = np.linspace(0.0, 2 * np.pi, 96, endpoint=False)


@given(st.sampled_from(MODELS), st.floats(1e-3, 1e4), st.floats(0.0, 0.999))
def test_radius_and_zenith_are_inverse(model, k, share):
    lens = Lens(model, k)
    zenith = share * lens.max_zenith
    assert lens.zenith(lens.radius(zenith)) == pytest.approx(zenith, rel=1e-9, abs=1e-12)


@given(st.lists(st.floats(-0.3, 0.3), max_size=4), st.floats(0.0, 1.0))
def test_the_polynomial_comes_back_over_its_whole_range(coefficients, share):
    lens = Lens("polynomial", 250.0, tuple(coefficients))
    radius = lens.radius(share * lens.max_zenith)
    assert lens.radius(lens.zenith(radius)) == pytest.approx(float(radius), rel=1e-12, abs=1e-12)


@given(ANGLE, ANGLE, FULL, WITHIN, WITHIN, WITHIN)
def test_turning_keeps_frames_and_roll_only_turns_the_image(pitch, yaw, roll, x, y, z):
    still = camera.turn_camera(camera.camera_matrix([x, y, z], [x + 1, y, z]), pitch, yaw)
    rolled = camera.turn_camera(still, roll=roll)
    np.testing.assert_allclose(rolled[:3, :3] @ rolled[:3, :3].T, np.eye(3), atol=1e-12)
    points = np.random.default_rng(1).normal(size=(20, 3)) * 10
    lens = Lens("stereographic", 100.0)
    a, b = (camera.project(matrix, points, lens) @ [1, 1j] for matrix in (still, rolled))
    np.testing.assert_allclose(b, a * np.exp(-1j * roll), rtol=1e-6, atol=1e-6)


@given(st.floats(0.5, 2.0), st.floats(0.05, 0.9), FULL, ANGLE, FULL)
def test_turning_a_circular_pipe_turns_its_lateral(radius, share, bearing, inclination, more):
    one = openings.lateral_contour(TURN, radius, radius, share * radius, bearing=bearing, inclination=inclination)
    two = openings.lateral_contour(
        TURN, radius, radius, share * radius, bearing=bearing + more, inclination=inclination
    )
    np.testing.assert_allclose(two[:, 0], one[:, 0], atol=1e-9)
    np.testing.assert_allclose(two[:, 2] + 1j * two[:, 1], (one[:, 2] + 1j * one[:, 1]) * np.exp(1j * more), atol=1e-9)


@given(
    st.floats(-0.4, 0.4), st.floats(-0.2, 0.2), st.floats(0.1, 20.0), FULL, WITHIN, st.integers(0, 95), st.booleans()
)
def test_shape_distances_leave_out_place_size_turn_start_and_sense(oval, lobe, size, turn, place, start, backwards):
    assume(abs(oval) > 0.02)  # a first ellipse that is a circle leaves the elliptic start open
    curve = np.exp(1j * TURN) + oval * np.exp(-1j * TURN) + lobe * np.exp(2j * TURN)
    moved = np.roll(size * np.exp(1j * turn) * curve + place * (1 - 2j), start)
    a, b = contours.from_complex(curve), contours.from_complex(moved[::-1] if backwards else moved)
    assert contours.descriptor_norm(a) == pytest.approx(contours.descriptor_norm(b), rel=1e-9)
    assert contours.elliptic_distance(a, b) < 1e-6
    # first points between those tried cost the others a little
    assert contours.fourier_distance(a, b) < 0.02
    assert contours.procrustes_distance(a, b) < 0.05
