"""Centrelines: where points lie about straight and curved axes, and how the pipe's frame stands."""

import numpy as np
import pytest

from springline.geometry.axis import Centreline


def bend(turn, number=12, radius=1.0):
    """Nodes of a level bend to the right, from the origin along x."""
    angle = np.linspace(0.0, turn, number)
    return np.column_stack([radius * np.sin(angle), np.zeros(number), radius * (1.0 - np.cos(angle))])


def test_points_of_a_torus_lie_at_its_radius_bearing_and_arc_length():
    rng = np.random.default_rng(0)
    turn, theta = rng.uniform(0.1, 1.4, 5000), rng.uniform(-np.pi, np.pi, 5000)
    reach = 1.0 - 0.2 * np.cos(theta)
    points = np.column_stack([reach * np.sin(turn), 0.2 * np.sin(theta), 1.0 - reach * np.cos(turn)])
    placed = Centreline(bend(np.pi / 2)).place(points)
    assert placed.along == pytest.approx(turn, abs=2e-4)
    assert np.hypot(placed.y, placed.z) == pytest.approx(0.2, abs=5e-5)
    assert np.arctan2(placed.y, placed.z) == pytest.approx(theta, abs=5e-4)


def test_length_and_place_along_a_curve():
    line = Centreline(bend(np.pi / 2))
    assert line.length == pytest.approx(np.pi / 2, abs=1e-4)
    assert line.at(line.place(bend(1.0)).along) == pytest.approx(bend(1.0), abs=1e-4)
    assert line.direction(np.array([line.length]))[0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-3)


def test_beyond_its_ends_a_curve_goes_on_straight():
    line = Centreline(bend(np.pi / 2))
    ahead = line.at(np.array([line.length + 0.5]))[0]
    assert ahead == pytest.approx([1.0, 0.0, 1.5], abs=1e-3)
    assert line.place(ahead[None]).along[0] == pytest.approx(line.length + 0.5, abs=1e-6)


@pytest.mark.parametrize("direction", [(1.0, 0.3, -0.2), (0.2, -0.4, 0.9), (-1.0, 0.0, 0.1)])
def test_frame_is_right_handed_with_y_in_the_vertical_plane_and_z_level(direction):
    frame = Centreline(np.stack([np.zeros(3), np.array(direction)])).frames(np.zeros(1))[0]
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1.0)
    assert frame[0] @ np.array(direction) == pytest.approx(np.linalg.norm(direction))
    assert frame[2, 1] == pytest.approx(0.0, abs=1e-12)
    assert frame[1, 1] > 0.0


def test_in_a_shaft_y_turns_to_the_clouds_forward():
    frame = Centreline(np.array([[0.0, 0.0, 0.0], [0.1, 3.0, 0.0]])).frames(np.zeros(1))[0]
    assert frame[1, 0] > 0.99


def test_turned_line_sees_the_same_radii_and_mirrored_bearings():
    points = np.random.default_rng(1).normal(size=(50, 3))
    line = Centreline(np.array([[0.0, 0.0, 0.0], [2.0, 0.4, 0.1]]))
    ahead, back = line.place(points), line.turned().place(points)
    assert back.along == pytest.approx(line.length - ahead.along)
    assert back.y == pytest.approx(ahead.y)
    assert back.z == pytest.approx(-ahead.z)
