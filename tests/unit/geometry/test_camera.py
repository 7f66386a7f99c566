"""The camera against a plain pinhole, the robot's frames, and what must not fold into the image."""

from __future__ import annotations

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry import camera, robot
from springline.geometry.lenses import Lens

EYE, LOOK, UP = [-15.0, -1.0, -4.0], [0.71, 0.71, 0.0], [0.2, 1.0, -0.1]
POINTS = np.random.default_rng(1).uniform(-10.0, 10.0, (40, 3))


def test_the_matrix_is_a_mirror_frame_that_puts_the_eye_at_the_origin():
    matrix = camera.camera_matrix(EYE, LOOK, UP)
    np.testing.assert_allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-14)
    assert np.linalg.det(matrix) == pytest.approx(-1.0)
    np.testing.assert_allclose(matrix @ [*EYE, 1.0], [0, 0, 0, 1], atol=1e-13)
    ahead = matrix @ [*LOOK, 1.0]
    np.testing.assert_allclose(ahead[1:3], 0, atol=1e-13)
    assert ahead[0] == pytest.approx(-np.linalg.norm(np.subtract(LOOK, EYE)))
    # up appears upright
    assert matrix[2, :3] @ UP == pytest.approx(0.0, abs=1e-14)
    assert matrix[1, :3] @ UP > 0
    homogeneous = np.c_[POINTS, np.ones(len(POINTS))] @ matrix.T
    np.testing.assert_allclose(camera.to_camera(matrix, POINTS), homogeneous[:, :3], atol=1e-12)


def test_a_pinhole_divides_by_depth():
    """x = f X / Z in a computer-vision frame made from scratch: X right, Y down, Z ahead."""
    ahead = np.subtract(LOOK, EYE) / np.linalg.norm(np.subtract(LOOK, EYE))
    right = np.cross(ahead, UP) / np.linalg.norm(np.cross(ahead, UP))
    down = np.cross(ahead, right)
    relative = POINTS - EYE
    depth = relative @ ahead
    columns, rows = 300 * (relative @ right) / depth + 384, 300 * (relative @ down) / depth + 288
    assert np.all(depth > 0)
    seen = camera.project(camera.camera_matrix(EYE, LOOK, UP), POINTS, Lens("perspective", 300.0))
    pixels = camera.to_pixels(seen, [384, 288])
    np.testing.assert_allclose(pixels, np.stack([columns, rows], axis=-1), rtol=1e-10)
    np.testing.assert_allclose(camera.from_pixels(pixels, [384, 288]), seen, atol=1e-9)


@pytest.mark.parametrize("model", ["equidistant", "sine", "equisolid", "perspective", "stereographic"])
def test_rays_go_back_to_their_points(model):
    matrix = camera.camera_matrix(EYE, LOOK, UP)
    lens = Lens(model, 443.0)
    along = camera.rays(matrix, camera.project(matrix, POINTS, lens), lens)
    wanted = POINTS - EYE
    np.testing.assert_allclose(along, wanted / np.linalg.norm(wanted, axis=1, keepdims=True), atol=1e-10)


def test_nothing_from_behind_folds_into_the_image():
    ahead = camera.camera_matrix([0, 0, 0], [1, 0, 0])
    behind = np.array([[-5.0, 1.0, 0.0], [-0.1, 0.0, 3.0], [0.0, 0.0, 0.0], [np.nan, 1.0, 1.0]])
    for model in ("sine", "perspective"):
        assert np.isnan(camera.project(ahead, behind, Lens(model, 100.0))).all()
    # a fisheye may see a little behind itself, where its view angle says so and no further
    seen = camera.project(ahead, behind, Lens("equidistant", 100.0, view_angle=np.radians(190)))
    assert np.isfinite(seen[1]).all()
    assert np.isnan(seen[[0, 2, 3]]).all()
    assert seen[1, 0] > 100 * np.pi / 2


def test_the_optical_axis_lands_in_the_middle():
    matrix = camera.camera_matrix(EYE, LOOK, UP)
    seen = camera.project(matrix, [LOOK], Lens("sine", 443.0))
    np.testing.assert_allclose(seen, 0.0, atol=1e-5)
    np.testing.assert_allclose(
        camera.rays(camera.camera_matrix([0, 0, 0], [1, 0, 0]), [[0.0, 0.0]], Lens("sine", 1.0)), [[1, 0, 0]]
    )


def test_a_tilted_up_vector_shrinks_no_zenith():
    """The listing's u was not of unit length, and every zenith came out wrong (erratum 35)."""
    straight = camera.camera_matrix([-30, 5, 0], [0, 0, 0], [0, 1, 0])
    seen = camera.to_camera(straight, POINTS)
    np.testing.assert_allclose(np.linalg.norm(seen, axis=1), np.linalg.norm(POINTS - [-30, 5, 0], axis=1))


@pytest.mark.parametrize("attitude", [(0.2, 0.0, 0.0), (0.0, -0.3, 0.0), (0.0, 0.0, 0.7), (0.2, -0.3, 0.7)])
def test_a_camera_turns_as_the_robot_does(attitude):
    """A turned camera looks along the robot's axes: yaw then pitch then roll about its own axes."""
    pitch, yaw, roll = attitude
    turned = camera.turn_camera(camera.camera_matrix(EYE, np.add(EYE, [1, 0, 0])), pitch, yaw, roll)
    # tan(pitch) = b/a after a yaw first: the second rotation is the pitch as seen from the yawed robot
    seen_pitch = np.arctan(np.tan(pitch) / np.cos(yaw))
    rows = robot.frame(seen_pitch, yaw, roll, order="yaw_pitch")
    np.testing.assert_allclose(turned, camera.camera_at(EYE, rows), atol=1e-12)
    np.testing.assert_allclose(camera.camera_eye(turned), EYE, atol=1e-12)


def test_many_cameras_at_once_are_each_alone():
    eyes = np.array([[-30.0, 0, 0], [-8, 1, -1], EYE])
    lens = Lens("equisolid", 443.0)
    together = camera.project(camera.camera_matrix(eyes, LOOK, UP), POINTS, lens)
    assert together.shape == (3, 40, 2)
    for one, eye in zip(together, eyes, strict=True):
        np.testing.assert_allclose(one, camera.project(camera.camera_matrix(eye, LOOK, UP), POINTS, lens), rtol=1e-12)


def test_directions_keep_their_quadrant():
    rng = np.random.default_rng(2)
    points = rng.normal(size=(100, 3))
    distance, zenith, azimuth = camera.spherical(points)
    np.testing.assert_allclose(np.cos(zenith), points[:, 0] / np.linalg.norm(points, axis=1), atol=1e-12)
    np.testing.assert_allclose(camera.from_spherical(distance, zenith, azimuth), points, atol=1e-12)
    assert camera.spherical([-1.0, 0.0, -0.0])[2] == 0.0
    assert camera.spherical([1.0, -0.0, -1.0])[2] == np.pi
    assert np.isnan(camera.spherical([0.0, 0.0, 0.0])[1:]).all()


def test_cameras_that_cannot_be_are_refused():
    with pytest.raises(ParameterError, match="eye and look coincide"):
        camera.camera_matrix(EYE, EYE)
    with pytest.raises(ParameterError, match="up lies along"):
        camera.camera_matrix([0, -3, 0], [0, 0, 0])
    with pytest.raises(ParameterError, match="shape"):
        camera.project(np.eye(3), POINTS, Lens("sine", 1.0))
    with pytest.raises(ParameterError, match="shape"):
        camera.project(np.eye(4), POINTS[:, :2], Lens("sine", 1.0))
    with pytest.raises(ParameterError, match="shape"):
        camera.rays(np.eye(4), POINTS, Lens("sine", 1.0))
    with pytest.raises(ParameterError, match="shape"):
        camera.camera_at(EYE, np.eye(4))
