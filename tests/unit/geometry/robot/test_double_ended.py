import numpy as np
import pytest

from springline.geometry.robot import double_ended, frame


def scan_both_ends(pitch, yaw, roll, length, centre):
    """Offsets of both origins from the pipe's axis, read in their ring planes and along the pipe's axes."""
    x, y, z = frame(pitch, yaw, roll)
    read, along = [], []
    for end in (0.5, -0.5):
        origin = np.asarray(centre) + end * length * x
        crossing = np.array([origin @ x / x[0], 0.0, 0.0])  # where the ring plane meets the pipe's axis
        read.append(((origin - crossing) @ y, (origin - crossing) @ z))
        along.append(origin[1:])
    return np.subtract(*read), np.subtract(*along)


@pytest.mark.parametrize("pose", [(10, 0, 0), (15, -7.5, 0), (-20, 20, 12), (0, 0, 5), (30, 30, -40)])
def test_both_readings_of_the_offsets_give_the_attitude(pose):
    pitch, yaw, roll = np.radians(pose)
    ring, pipe = scan_both_ends(pitch, yaw, roll, 0.6, (0.0, 0.01, -0.02))
    from_ring = double_ended(*ring, 0.6, roll=roll)
    from_pipe = double_ended(*pipe, 0.6, measured="pipe")
    np.testing.assert_allclose([from_ring.pitch, from_ring.yaw], [pitch, yaw], atol=1e-13)
    np.testing.assert_allclose([from_pipe.pitch, from_pipe.yaw], [pitch, yaw], atol=1e-13)


@pytest.mark.parametrize(("degrees", "excess"), [(10, 0.32), (15, 1.15), (20, 3.00)])
def test_the_sine_correction_would_add_what_erratum_5_says(degrees, excess):
    tangent = np.tan(np.radians(degrees))
    corrected = double_ended(tangent, tangent, 1.0, measured="pipe")
    assert np.degrees(corrected.pitch) - degrees == pytest.approx(excess, abs=0.005)


def test_the_covariance_is_that_of_noisy_offsets_and_length():
    rng = np.random.default_rng(2)
    ring, _ = scan_both_ends(*np.radians([12, -8, 6]), 0.5, (0, 0, 0))
    covariance = np.array([[4e-7, 1e-7], [1e-7, 9e-7]])
    noisy = ring + rng.multivariate_normal([0, 0], covariance, size=20000)
    length = 0.5 + 2e-3 * rng.normal(size=20000)
    found = double_ended(*noisy.T, length, roll=np.radians(6))
    stated = double_ended(*ring, 0.5, roll=np.radians(6), covariance=covariance, length_sigma=2e-3)
    np.testing.assert_allclose(stated.covariance, np.cov(found.pitch, found.yaw), rtol=0.05, atol=6e-8)
    assert stated.detected.tolist() == [True, True]


def test_an_angle_within_its_noise_is_not_detected():
    found = double_ended([0.001, 0.05], 0.0, 0.5, covariance=1e-6 * np.eye(2))
    assert found.detected.tolist() == [[False, False], [True, False]]
    assert not double_ended(0.05, 0.0, 0.5).detected.any()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: double_ended(0.4, 0.4, 0.5, measured="pipe"), "offset / length = 1.13137"),
        (lambda: double_ended(0.1, 0.0, 0.0), "length = 0"),
        (lambda: double_ended(0.1, 0.0, 0.5, measured="rings"), "did you mean 'ring'"),
        (lambda: double_ended(0.1, 0.0, 0.5, covariance=[1e-6, 1e-6]), "covariance has shape"),
        (lambda: double_ended(0.1, 0.0, 0.5, covariance=np.eye(2), length_sigma=-1.0), "length_sigma = -1"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
