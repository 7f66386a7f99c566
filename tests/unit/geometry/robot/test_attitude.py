import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from springline.geometry.robot import axis, frame, implicit_roll, pitch_after_yaw, pitch_yaw_roll, yaw_after_pitch

ANGLES = np.radians([-60.0, -25.0, -7.5, 0.0, 1e-6, 15.0, 40.0])


def rotated(first, second):
    """Rows x, y, z of a body turned by two rotations about its own axes, by scipy."""
    return (Rotation.from_rotvec(first) * Rotation.from_rotvec(second)).as_matrix().T


@pytest.mark.parametrize("pitch", ANGLES)
@pytest.mark.parametrize("yaw", ANGLES)
def test_stepwise_frames_equal_successive_rotations_of_a_body(pitch, yaw):
    pitch_first = rotated([0, 0, pitch], [0, -yaw_after_pitch(pitch, yaw), 0])
    yaw_first = rotated([0, -yaw, 0], [0, 0, pitch_after_yaw(pitch, yaw)])
    np.testing.assert_allclose(frame(pitch, yaw, order="pitch_yaw"), pitch_first, atol=1e-14)
    np.testing.assert_allclose(frame(pitch, yaw, order="yaw_pitch"), yaw_first, atol=1e-14)


@pytest.mark.parametrize("pitch", ANGLES)
@pytest.mark.parametrize("yaw", ANGLES)
def test_the_direct_frame_is_one_rotation_of_x_onto_the_axis(pitch, yaw):
    forward = axis(pitch, yaw)
    normal = np.cross([1.0, 0.0, 0.0], forward)
    length = np.linalg.norm(normal)
    turn = np.arctan2(length, forward[0]) * (normal / length if length else normal)
    np.testing.assert_allclose(frame(pitch, yaw), Rotation.from_rotvec(turn).as_matrix().T, atol=1e-13)


@pytest.mark.parametrize("order", ["pitch_yaw", "yaw_pitch"])
@pytest.mark.parametrize(("pitch", "yaw"), [(10, 10), (10, -10), (-15, 7.5), (40, 20), (-30, -30)])
def test_implicit_roll_is_the_turn_about_the_axis_that_scipy_measures(order, pitch, yaw):
    pitch, yaw = np.radians([pitch, yaw])
    between = Rotation.from_matrix(frame(pitch, yaw, order=order).T @ frame(pitch, yaw))
    # Right-handed about the forward axis takes y towards z; roll is positive from z towards y.
    signed = -between.as_rotvec() @ axis(pitch, yaw)
    assert implicit_roll(pitch, yaw, order=order) == pytest.approx(signed, abs=1e-13)


def test_the_printed_magnitude_of_the_implicit_roll_is_kept():
    pitch, yaw = np.radians([15.0, 15.0])
    y2 = np.array([-np.sin(pitch), np.cos(pitch), 0.0])
    assert abs(implicit_roll(pitch, yaw)) == pytest.approx(np.arccos(y2 @ frame(pitch, yaw)[1]), abs=1e-9)


def test_attitudes_broadcast_and_come_back():
    pitch, yaw, roll = ANGLES[:, None, None], ANGLES[:, None], np.radians([-170.0, 0.0, 33.0])
    found = pitch_yaw_roll(frame(pitch, yaw, roll))
    for got, given in zip(found, np.broadcast_arrays(pitch, yaw, roll), strict=True):
        np.testing.assert_allclose(got, given, atol=1e-13)


def test_a_robot_that_looks_back_has_no_pitch():
    assert np.isnan(pitch_yaw_roll(np.diag([-1.0, 1.0, -1.0]))).all()


def test_nan_stays_nan():
    assert np.isnan(axis(np.nan, 0.1)).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: axis(np.pi / 2, 0.0), r"pitch = 1.570796327 .* -pi/2 < pitch < pi/2"),
        (lambda: axis(0.0, [0.1, -15.0]), "yaw = -15"),
        (lambda: frame(0.1, 0.1, order="yaw_ptch"), "did you mean 'yaw_pitch'"),
        (lambda: frame(0.1, 0.1, np.inf), "roll = inf"),
        (lambda: axis("steep", 0.0), "pitch = 'steep' is not a number"),
    ],
)
def test_bad_angles_are_refused_by_name(call, message):
    with pytest.raises(ValueError, match=message):
        call()
