"""Invariances of the bend's geometry."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from springline.geometry.bends import bend_ovality, bend_section, centreline, locate, ring_bend, tilt_ovality
from springline.geometry.robot import frame

TILT = st.floats(-0.6, 0.6)
TIGHTNESS = st.floats(1.05, 50.0)
SQUASH = st.floats(0.6, 1.6)


@given(TIGHTNESS, SQUASH, TILT, TILT, st.floats(-np.pi, np.pi), st.floats(0, 0.9), st.floats(-np.pi, np.pi))
def test_ring_points_lie_on_the_torus(big, r1, pitch, yaw, roll, depth, where):
    offset = (depth * np.sin(where), depth * r1 * np.cos(where))
    phi = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    rho = ring_bend(phi, big, r1, 1.0, pitch, yaw, roll, offset=offset)
    rows = frame(pitch, yaw, roll)
    points = rho[:, None] * (np.cos(phi)[:, None] * rows[2] + np.sin(phi)[:, None] * rows[1])
    x, y, z = (points + np.array([0, offset[0] - big, offset[1]])).T
    np.testing.assert_allclose((np.hypot(x, y) - big) ** 2 + (z / r1) ** 2, 1.0, atol=1e-9)
    assert (rho > 0).all()


@given(TIGHTNESS, SQUASH, TILT, TILT)
def test_bends_mirror_with_the_yaw(big, r1, pitch, yaw):
    phi = np.linspace(0, np.pi, 9)
    right = ring_bend(phi, big, r1, 1.0, pitch, yaw)
    left = ring_bend(np.pi - phi, big, r1, 1.0, pitch, -yaw)
    np.testing.assert_allclose(right, left, rtol=1e-9)


@given(TIGHTNESS, SQUASH, TILT, TILT, st.floats(-0.9, 0.9), st.floats(0.01, 100))
def test_curves_scale_and_mirror(big, r1, pitch, yaw, part, factor):
    z = part * r1
    one = bend_section(z, big, r1, 1.0, pitch, yaw)
    scaled = bend_section(factor * z, factor * big, factor * r1, factor, pitch, yaw)
    mirrored = bend_section(-z, big, r1, 1.0, pitch, -yaw)
    np.testing.assert_allclose([scaled / factor, mirrored], one, rtol=1e-7, atol=1e-7)


@settings(max_examples=25)
@given(st.floats(1.5, 50.0), TILT, TILT)
def test_a_bend_never_fakes_less_than_nothing(big, pitch, yaw):
    for shown in (bend_ovality(big, 1.0, 1.0, pitch, yaw), tilt_ovality(1.0, 1.0, pitch, yaw)):
        assert min(shown[2:]) >= -1e-9
        assert shown.diameter_max >= shown.diameter_min


@given(st.floats(0.3, 20), st.floats(0.05, 3.0), st.floats(-5, 40))
def test_the_centreline_lies_on_itself(big, angle, chainage):
    start, rows = np.array([1.0, -2.0, 0.5]), frame(0.3, -0.4, 1.0)
    place = locate(centreline(chainage, start, rows, big, angle), start, rows, big, angle)
    np.testing.assert_allclose(place.out, 0.0, atol=1e-9)
    np.testing.assert_allclose(place.across, 0.0, atol=1e-9)
    if angle < np.pi / 2:
        np.testing.assert_allclose(place.along, chainage, atol=1e-7)
