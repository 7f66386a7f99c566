"""A section that swells as slowly as the robot weaves looks like side-slip, and must not be taken for it."""

import numpy as np
import pytest
from bench.two_passes import errors

import springline as sl
from springline.simulate import parse, simulate

SCENARIO = """
name = "slow"
[pipe]
diameter = "300mm"
gradient = -0.008
run = [{ kind = "straight", length = 6.5 }]
[[pipe.section]]
shape = "ellipse"
semi_major = { mean = 0.153, amplitude = 0.001, period = 4.0 }
semi_minor = 0.148
axis_deg = 20.0
[robot]
length = 0.5
wheelbase = 0.35
offset_z = { amplitude = 0.025, period = 3.0 }
offset_y = { amplitude = 0.004, period = 4.3 }
roll_deg = { amplitude = 3.0, period = 3.7 }
side_slip_deg = 0.3
standstill = [{ chainage = 0.25, duration = 30.0 }]
[rings]
spacing = "20mm"
bearings = 240
noise = "1mm"
[inertial]
rate = 50.0
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [0.01, -0.01, 0.01]
accel_noise = 0.0005
[odometer]
noise = 0.002
[ties]
chainages = [0.25, 6.2]
sigma = "10mm"
"""


@pytest.mark.parametrize("seed", [21, 22, 23])
def test_a_section_that_changes_slowly_is_not_taken_for_side_slip(seed):
    made = simulate(parse(SCENARIO), seed=seed)
    found, truth = sl.inspect(made), made.truth
    assert found.has("layout")
    off = errors(found, truth)
    for name in ("diameter_x", "diameter_y"):
        error, sigma = off[name]
        assert np.sqrt(np.mean(error**2)) < 2.0e-4
        assert np.sqrt(np.mean((error / sigma) ** 2)) < 1.5
    yaw = found.pose["yaw"].values - truth["yaw"].values
    assert np.sqrt(np.mean((yaw / found.pose["yaw_sigma"].values) ** 2)) < 1.5
