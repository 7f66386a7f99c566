"""The inertial unit: its samples integrate back to the motion they were taken from."""

from __future__ import annotations

import numpy as np
import pytest

from springline.simulate.inertial import GRAVITY
from springline.simulate.reading import parse
from springline.simulate.simulation import simulate
from springline.simulate.world import set_up

BASE = """
name = "test"
[pipe]
diameter = 0.3
heading_deg = 30.0
gradient = {gradient}
run = [{{kind = "straight", length = 2.0}}, {{kind = "bend", radius = 1.0, angle_deg = {angle}, towards = "{towards}"}},
       {{kind = "straight", length = 2.0}}]
joints = {{spacing = 0.7, kink_sigma_deg = 0.2}}
[robot]
wheelbase = 0.3
speed = 0.2
{robot}
[rings]
spacing = 1.0
bearings = 8
[inertial]
rate = 100.0
{unit}
"""


def make(robot="", unit="", angle=40.0, towards="right", gradient=-0.02):
    return parse(BASE.format(robot=robot, unit=unit, angle=angle, towards=towards, gradient=gradient))


def turn(vector: np.ndarray) -> np.ndarray:
    """Return the rotation matrix of a rotation vector, by Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k


def body(heading: float, inclination: float, bank: float) -> np.ndarray:
    """Return body-to-Earth columns x forward, y up, z right for heading, inclination and bank."""
    ch, sh, ci, si = np.cos(heading), np.sin(heading), np.cos(inclination), np.sin(inclination)
    forward = np.array([sh * ci, ch * ci, si])
    right = np.array([ch, -sh, 0.0])
    up = np.cross(right, forward)
    cb, sb = np.cos(bank), np.sin(bank)
    return np.stack([forward, cb * up + sb * right, cb * right - sb * up], axis=1)


WEAVING = "offset_z = {amplitude = 0.03, period = 1.5}\noffset_y = {amplitude = 0.01, period = 1.1}\n"
WEAVING += "roll_deg = {amplitude = 8.0, period = 0.9}"


def test_gyro_integrates_back_to_the_true_attitude():
    survey = simulate(make(robot=WEAVING))
    gyro, truth = survey.inertial["gyro"].values, survey.truth
    angles = [truth[f"sample_{name}"].values for name in ("heading", "inclination", "bank")]
    columns = body(*(a[0] for a in angles))
    worst = 0.0
    for k in range(len(gyro) - 1):
        # A sample is the mean over the interval centred on its time: from one time to the next, the mean of two.
        columns = columns @ turn(0.5 * (gyro[k] + gyro[k + 1]) / 100.0)
        if k % 50 == 0:
            there = body(*(a[k + 1] for a in angles))
            worst = max(worst, np.arccos(np.clip(0.5 * (np.trace(columns.T @ there) - 1.0), -1.0, 1.0)))
    assert worst < 2e-5


def test_specific_force_integrates_back_to_the_true_place():
    scenario = make(robot=WEAVING, unit="position = [0.1, 0.02, -0.03]")
    survey = simulate(scenario)
    world = set_up(scenario, 0)
    truth = survey.truth
    angles = np.stack([truth[f"sample_{name}"].values for name in ("heading", "inclination", "bank")], axis=1)
    force = np.stack([body(*a) @ f for a, f in zip(angles, survey.inertial["accel"].values, strict=True)])
    change = (force - [0.0, 0.0, GRAVITY]) / 100.0
    speed = np.cumsum(change, axis=0) - 0.5 * change
    place = np.cumsum(0.5 * (speed[1:] + speed[:-1]), axis=0) / 100.0
    u = truth["sample_chainage"].values
    true = world.motion.point(u, np.array([0.1, 0.02, -0.03]))
    assert np.abs(place - (true[1:] - true[0])).max() < 2e-4


def test_at_rest_the_unit_feels_gravity_alone():
    survey = simulate(make(robot="standstill = [{chainage = 0.2, duration = 20.0}]"))
    accel, gyro = survey.inertial["accel"].values[:1900], survey.inertial["gyro"].values[:1900]
    slope = np.arctan(-0.02)
    # Nose down: gravity's reaction has a part backwards, +g on y at rest, nothing to the right.
    assert np.allclose(accel, [GRAVITY * np.sin(slope), GRAVITY * np.cos(slope), 0.0], atol=1e-6)
    assert np.abs(gyro).max() < 1e-12


@pytest.mark.parametrize(("towards", "axis", "sign"), [("right", 1, -1), ("left", 1, 1), ("up", 2, 1), ("down", 2, -1)])
def test_a_bend_turns_about_the_right_axis(towards, axis, sign):
    """Yaw rate = -gyro_y, pitch rate = +gyro_z: a right bend turns negatively about up, an upward one about right."""
    survey = simulate(make(towards=towards, gradient=0.0, unit="rate = 50.0".replace("rate = 50.0", "")))
    total = survey.inertial["gyro"].values.sum(axis=0) / 100.0
    expected = np.zeros(3)
    expected[axis] = sign * np.radians(40.0)
    assert np.allclose(total, expected, atol=np.radians(2.0))  # the joints' kinks do the rest


def test_rolling_is_minus_the_rate_about_forward():
    survey = simulate(make(robot="roll_deg = [[1.0, 0.0], [3.0, 10.0]]", angle=1.0))
    total = survey.inertial["gyro"].values.sum(axis=0) / 100.0
    assert np.degrees(-total[0]) == pytest.approx(10.0, abs=0.1)


def test_errors_have_their_stated_size():
    unit = (
        "gyro_bias_deg_h = [10.0, -20.0, 30.0]\ngyro_noise_deg_sqrt_h = 0.5\n"
        "accel_bias = [0.1, -0.2, 0.3]\naccel_noise = 0.001"
    )
    clean, noisy = simulate(make()), simulate(make(unit=unit), seed=3)
    rate = noisy.inertial["gyro"].values - clean.inertial["gyro"].values
    force = noisy.inertial["accel"].values - clean.inertial["accel"].values
    n = len(rate)
    sigma = np.radians(0.5) / 60.0 * 10.0  # deg per root hour to rad per root second, times root of 100 Hz
    assert np.abs(rate.mean(axis=0) - np.radians([10.0, -20.0, 30.0]) / 3600.0).max() < 4 * sigma / np.sqrt(n)
    assert rate.std() == pytest.approx(sigma, rel=0.05)
    assert np.allclose(force.mean(axis=0), [0.1, -0.2, 0.3], atol=0.001)
    assert force.std(axis=0) == pytest.approx(np.full(3, 0.01), rel=0.06)


def test_a_wandering_bias_is_in_the_truth():
    survey = simulate(make(unit="gyro_walk_deg_h_sqrt_h = 30.0\naccel_walk = 0.01"), seed=4)
    clean = simulate(make())
    drift = survey.inertial["gyro"].values - clean.inertial["gyro"].values
    assert np.allclose(drift, survey.truth["gyro_bias"].values, atol=1e-12)
    steps = np.diff(survey.truth["gyro_bias"].values, axis=0)
    assert steps.std() == pytest.approx(np.radians(30.0) / 3600.0 / 60.0 / 10.0, rel=0.06)
    assert np.diff(survey.truth["accel_bias"].values, axis=0).std() == pytest.approx(0.001, rel=0.06)


def test_gap_and_clock():
    survey = simulate(make(unit="gap = [[3.0, 4.0]]\nclock_offset = 0.05"))
    time = survey.inertial["time"].values
    assert time[0] == pytest.approx(0.05)
    assert np.diff(time).max() == pytest.approx(1.01)
    assert survey.truth.sizes["sample"] == time.size


def test_attitude_output_is_the_true_attitude():
    survey = simulate(make(unit='output = "attitude"'))
    assert "gyro" not in survey.inertial
    assert np.degrees(survey.inertial["heading"].values[0]) == pytest.approx(30.0, abs=0.1)
    assert np.tan(survey.inertial["inclination"].values[0]) == pytest.approx(-0.02, abs=1e-3)
    assert np.degrees(survey.inertial["heading"].values[-1]) == pytest.approx(70.0, abs=2.0)
