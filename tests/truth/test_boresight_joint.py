"""A calibrated boresight in the joint estimate: the log turned to the scanner's axes, its attitude turned back."""

import numpy as np
import pytest
from bench._joint import given, true_radii

import springline as sl
from springline.estimation import Inertial, estimate_joint
from springline.geometry.robot.boresight import on_scanner, robot_attitude
from springline.simulate import parse, simulate

BORESIGHT = np.radians([-0.5, 1.0, 0.0])
SCENARIO = """
name = "weave"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.008
run = [{ kind = "straight", length = 10.0 }]
[[pipe.section]]
shape = "mode"
mode = 1
s1 = 0.975
[robot]
length = 0.5
wheelbase = 0.35
offset_z = { amplitude = 0.025, period = 3.0 }
offset_y = { amplitude = 0.004, period = 4.3 }
roll_deg = { amplitude = 3.0, period = 3.7 }
standstill = [{ chainage = 0.25, duration = 60.0 }]
[rings]
spacing = "10mm"
noise = "1mm"
boresight_pitch_deg = -0.5
boresight_yaw_deg = 1.0
[inertial]
rate = 100.0
gyro_noise_deg_sqrt_h = 0.3
accel_noise = 0.0005
[ties]
chainages = [0.25, 9.7]
sigma = "10mm"
"""


@pytest.fixture(scope="module")
def weave():
    made = simulate(parse(SCENARIO), seed=0)
    rings, log, ties = given(made)
    return rings, (log.time, log.gyro, log.accel), ties, made.truth


def ovality_error(found, truth):
    true = [np.interp(truth["ring_chainage"], truth["chainage"], truth[f"diameter_{axis}"]) for axis in "xy"]
    seen = np.hypot(found.section[:, 1], found.section[:, 2]) / found.section[:, 0]
    return 100.0 * float(np.sqrt(np.mean((seen - np.abs(true[0] - true[1]) / (true[0] + true[1])) ** 2)))


def test_a_boresight_taken_out_leaves_neither_section_nor_attitude_wrong(weave):
    rings, (time, gyro, accel), ties, truth = weave
    blind = estimate_joint(rings, Inertial(time, gyro, accel), ties)
    found = estimate_joint(rings, Inertial(time, on_scanner(gyro, BORESIGHT), on_scanner(accel, BORESIGHT)), ties)
    robot, covariance = robot_attitude(found.pose[:, 2:], BORESIGHT, found.pose_covariance[:, 2:, 2:])
    true = np.stack([truth[name].values for name in ("pitch", "yaw", "roll")], axis=1)
    assert ovality_error(found, truth) < 0.01
    # Blind, the estimate takes the scanner's yaw against the robot for the robot's own against the pipe.
    assert abs(np.mean(blind.pose[:, 3] - true[:, 1])) > np.radians(0.6)
    error = np.abs(np.mean(robot - true, axis=0))
    assert np.all(error < 3.0 * np.sqrt(np.mean(np.einsum("nii->ni", covariance), axis=0)))
    assert np.all(error < np.radians(0.2))


def test_an_inspection_uses_the_boresight_of_a_calibration():
    made = simulate(parse(SCENARIO.replace("length = 10.0", "length = 6.0").replace("0.25, 9.7", "0.25, 5.7")), seed=1)
    attrs = dict(zip(("boresight_pitch", "boresight_yaw", "boresight_roll"), BORESIGHT, strict=True))
    told = made.corrected("rings", made.rings.assign_attrs(attrs))
    truth, errors = made.truth, []
    for survey in (made, told):
        found = sl.inspect(survey)
        shape = found.section["parameters"].values
        across, up = true_radii(truth).T
        wrong = np.hypot(shape[:, 1], shape[:, 2]) / shape[:, 0] - np.abs(across - up) / (across + up)
        assert 100.0 * np.sqrt(np.nanmean(wrong**2)) < 0.012
        # The pose is the scanner's, and no accelerometer is as wrong as one read on axes half a degree off.
        errors.append(abs(np.mean(found.pose["pitch"].values - truth["pitch"].values) - BORESIGHT[0]))
    assert errors[1] < np.radians(0.15)
    assert errors[0] > np.radians(0.25)
