"""Invariances of the robot's geometry over the whole valid range."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from springline.geometry.robot import axis, double_ended, frame, oblique_ellipse, ring_cylinder, section_from_ring

ANGLE = st.floats(-1.2, 1.2)
ROLL = st.floats(-np.pi, np.pi)
AXIS = st.floats(0.05, 2.0)
ORDER = st.sampled_from(["direct", "pitch_yaw", "yaw_pitch"])


@given(ANGLE, ANGLE, ROLL, ORDER)
def test_frames_are_right_handed_and_face_along_the_axis(pitch, yaw, roll, order):
    rows = frame(pitch, yaw, roll, order=order)
    np.testing.assert_allclose(rows @ rows.T, np.eye(3), atol=1e-13)
    assert np.linalg.det(rows) == pytest.approx(1.0)
    np.testing.assert_allclose(rows[0], axis(pitch, yaw), atol=1e-13)
    assert np.tan(pitch) == pytest.approx(rows[0, 1] / rows[0, 0], abs=1e-12)


@given(AXIS, AXIS, ANGLE, ANGLE, ROLL, ORDER)
def test_sections_come_back_from_their_rings(r1, r2, pitch, yaw, roll, order):
    ring = oblique_ellipse(r1, r2, pitch, yaw, roll, order=order)
    found = section_from_ring(*ring, pitch, yaw, roll, order=order)
    np.testing.assert_allclose([found.r1, found.r2], [r1, r2], rtol=1e-6)


@given(AXIS, AXIS, ANGLE, ANGLE, ROLL, st.floats(-3, 3))
def test_roll_only_turns_the_ring(r1, r2, pitch, yaw, roll, phi):
    still = ring_cylinder(phi + roll, r1, r2, pitch, yaw)
    assert ring_cylinder(phi, r1, r2, pitch, yaw, roll) == pytest.approx(still, rel=1e-9)


@given(AXIS, AXIS, ANGLE, ANGLE, st.floats(0.01, 100))
def test_rings_scale_with_the_pipe(r1, r2, pitch, yaw, factor):
    one, other = (oblique_ellipse(k * r1, k * r2, pitch, yaw) for k in (1.0, factor))
    np.testing.assert_allclose(other[:2], factor * np.array(one[:2]), rtol=1e-12)


@settings(max_examples=50)
@given(AXIS, AXIS, ANGLE, ANGLE, st.floats(0, 0.95), ROLL)
def test_every_ray_meets_the_wall_on_both_sides(r1, r2, pitch, yaw, depth, where):
    offset = (depth * r2 * np.sin(where), depth * r1 * np.cos(where))
    phi = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rho = ring_cylinder(phi, r1, r2, pitch, yaw, offset=offset)
    assert (rho > 0).all()
    # The chords through a point obey the power of the point over the form, which is even in phi.
    power = (1 - depth**2) / ring_form_along(phi, r1, r2, pitch, yaw)
    np.testing.assert_allclose(rho[:12] * rho[12:], power[:12], rtol=1e-7)


def ring_form_along(phi, r1, r2, pitch, yaw):
    rows = frame(pitch, yaw)
    direction = np.cos(phi)[:, None] * rows[2] + np.sin(phi)[:, None] * rows[1]
    return (direction[:, 1] / r2) ** 2 + (direction[:, 2] / r1) ** 2


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.1, 5), ROLL)
def test_a_double_ended_scanner_may_roll(offset_v, offset_h, length, roll):
    cos, sin = np.cos(roll), np.sin(roll)
    rolled = double_ended(cos * offset_v - sin * offset_h, cos * offset_h + sin * offset_v, length, roll=roll)
    upright = double_ended(offset_v, offset_h, length)
    np.testing.assert_allclose([rolled.pitch, rolled.yaw], [upright.pitch, upright.yaw], atol=1e-12)
