"""What is taken away makes the joint estimate worse, and its sigma says so; what does not matter changes nothing."""

import numpy as np
import pytest

from springline.estimation import Inertial, Rings, Ties, estimate_joint
from springline.geometry.fitting import fit_ellipses_to_ranges
from springline.simulate import parse, simulate

SCENARIO = """
name = "short"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.008
start = [1000.0, 2000.0, 50.0]
seed = 5
run = [
    {{ kind = "straight", length = 4.0 }},
    {{ kind = "bend", radius = {radius}, angle_deg = 22.5, towards = "right" }},
    {{ kind = "straight", length = 5.0 }},
]
sag = [{{ chainage = 7.0, length = 3.5, depth = "20mm" }}]
joints = {{ spacing = 2.5, gap = "4mm", kink_sigma_deg = 0.3 }}
[[pipe.section]]
shape = "ellipse"
semi_major = "153mm"
semi_minor = "147mm"
[robot]
length = 0.5
wheelbase = 0.3
from_end = {from_end}
offset_z = {{ amplitude = 0.025, period = 3.0 }}
offset_y = {{ amplitude = 0.004, period = 4.3 }}
roll_deg = {{ amplitude = 3.0, period = 3.7 }}
side_slip_deg = 0.3
standstill = [{{ chainage = {stand}, duration = {wait} }}]
[rings]
spacing = "10mm"
noise = "1mm"
outliers = 0.02
[inertial]
rate = 100.0
gyro_bias_deg_h = [10.0, -10.0, 10.0]
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [0.01, -0.01, 0.01]
accel_noise = 0.0005
{inertial}
[odometer]
scale_error = 0.005
{odometer}
[ties]
chainages = [0.3, 9.2]
sigma = "10mm"
"""
USUAL = {
    "radius": 1.5,
    "from_end": "false",
    "stand": 0.25,
    "wait": 60.0,
    "inertial": "",
    "odometer": "",
}
TERMS = ("offset_y", "offset_z", "pitch", "yaw", "roll")
AXES = ("easting", "northing", "elevation")


def survey(seed=1, **changes):
    """Return a simulated survey."""
    return simulate(parse(SCENARIO.format(**(USUAL | changes))), seed=seed)


def parts(made):
    """Return rings, log and ties."""
    data, known = made.rings, made.ties
    fits = fit_ellipses_to_ranges(data["range"].values, data["bearing"].values)
    rings = Rings(data["distance"].values, fits.parameters, fits.covariance, data["time"].values)
    form = ("gyro", "accel") if "gyro" in made.inertial else ("heading", "inclination", "bank")
    make = Inertial if "gyro" in made.inertial else Inertial.from_attitude
    log = make(made.inertial["time"].values, *(made.inertial[name].values for name in form))
    points = np.stack([known[name].values for name in AXES], axis=1)
    return rings, log, Ties(known["distance"].values, points, known["sigma"].values)


def true_axis(truth):
    return np.stack([np.interp(truth["ring_chainage"], truth["chainage"], truth[name]) for name in AXES], axis=1)


def true_pose(truth):
    return np.stack([truth[name].values for name in TERMS], axis=1)


def rms(values):
    return np.sqrt(np.mean(np.square(values), axis=0))


@pytest.fixture(scope="module")
def usual():
    made = survey()
    given = parts(made)
    return made, given, estimate_joint(*given)


def test_every_second_ring_tells_the_same_with_less_certainty(usual):
    _, (rings, log, ties), found = usual
    some = slice(None, None, 2)
    half = estimate_joint(
        Rings(rings.distance[some], rings.parameters[some], rings.covariance[some], rings.time[some]), log, ties
    )
    moved = np.abs(half.pose - found.pose[some]) / found.pose_sigma[some]
    assert rms(moved).max() < 1.5
    assert np.median(half.pose_sigma / found.pose_sigma[some], axis=0)[:2].min() > 1.1
    assert np.median(half.pose_sigma / found.pose_sigma[some], axis=0).max() < 2.0
    assert rms(half.axis - found.axis[some]).max() < 0.005


def test_travel_from_the_other_end_finds_the_same_pipe(usual):
    made, _, found = usual
    back = survey(from_end="true")
    other = estimate_joint(*parts(back))
    length = 9.0 + 1.5 * np.radians(22.5)
    at = length - back.truth["ring_chainage"].values
    order, here = np.argsort(at), made.truth["ring_chainage"].values
    both = (here > at.min()) & (here < at.max())
    moved = np.stack([np.interp(here, at[order], other.axis[order, k]) for k in range(3)], axis=1) - found.axis
    spread = np.hypot(found.axis_sigma, np.median(other.axis_sigma, axis=0))
    assert np.mean(np.abs(moved[both]) < 2.5 * spread[both]) > 0.9
    (bend,), (mirrored,) = found.bends, other.bends
    assert mirrored.angle == pytest.approx(bend.angle, abs=3.0 * np.hypot(bend.angle_sigma, mirrored.angle_sigma))
    assert mirrored.radius == pytest.approx(bend.radius, abs=3.0 * np.hypot(bend.radius_sigma, mirrored.radius_sigma))
    # To the right one way is to the left the other way.
    assert np.cos(bend.towards) > 0.99
    assert np.cos(mirrored.towards) < -0.99
    assert np.interp(5.0, here, found.gradient) == pytest.approx(
        -np.interp(5.0, at[order], other.gradient[order]), abs=0.004
    )


def test_without_ties_error_and_sigma_of_the_centreline_grow(usual):
    made, (rings, log, _), found = usual
    free = estimate_joint(rings, log)
    assert free.axis_sigma[-1].max() > 2.5 * found.axis_sigma[-1].max()
    truth = true_axis(made.truth)
    # Turned to the true first heading, what is left is what the log alone knows.
    heading = np.arctan2(*(truth[100] - truth[0])[:2]) - np.arctan2(*(free.axis[100] - free.axis[0])[:2])
    c, s = np.cos(heading), np.sin(heading)
    turned = (free.axis - free.axis[0]) @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) + truth[0]
    assert np.linalg.norm(turned[-1] - truth[-1]) > 1.5 * np.linalg.norm(found.axis[-1] - truth[-1])


def test_without_standstill_sigma_of_centreline_and_bias_grow(usual):
    _, _, found = usual
    hasty = estimate_joint(*parts(survey(wait=0.5)))
    middle = len(found.axis) // 2
    assert hasty.axis_sigma[middle, :2].max() > found.axis_sigma[middle, :2].max()
    for axis in "xyz":
        assert hasty.scalars[f"gyro_bias_{axis}"][1] > 1.2 * found.scalars[f"gyro_bias_{axis}"][1]


def test_the_sag_and_the_angles_at_joints_are_as_built(usual):
    made, (rings, log, ties), _ = usual
    truth = made.truth
    joints = np.sort(truth["feature_chainage"].values[truth["feature_kind"].values == 5])
    inside = joints[(joints > 1.3) & (joints < 8.3)]
    rows = [int(np.flatnonzero(truth["feature_chainage"].values == place)[0]) for place in inside]
    asked = np.interp(inside, truth["ring_chainage"].values, rings.distance)
    found = estimate_joint(rings, log, ties, joints=asked)
    straight = [k for k, one in enumerate(found.joints) if abs(one.chainage + 0.26 - 4.3) > 1.0]
    assert straight
    for k in straight:
        one = found.joints[k]
        assert one.right == pytest.approx(truth["feature_kink_right"].values[rows[k]], abs=3.0 * one.right_sigma + 3e-4)
        # The sag turns the pipe upwards too, by its own curvature over the run.
        assert one.right_sigma < np.radians(0.1)
    sag = max((s for s in found.sags if s.start < 6.8 < s.start + s.length), key=lambda s: s.depth)
    assert sag.depth == pytest.approx(0.020, abs=0.008)
    assert sag.depth_sigma < 0.004


EVENTS = {
    "slip of the wheels": {"odometer": "slip = [{ chainage = 7.3, length = 0.1, extra = 0.1 }]"},
    "clock 50 ms late": {"inertial": "clock_offset = 0.05"},
    "a missing second": {"inertial": "gap = [[90.0, 91.0]]"},
    "sharp bend": {"radius": 0.6},
    "attitude instead of rates": {"inertial": 'output = "attitude"\nattitude_noise_deg = 0.05'},
}


@pytest.mark.parametrize("event", EVENTS)
def test_what_goes_wrong_is_borne_or_stands_in_sigma(event):
    made = survey(**EVENTS[event])
    found = estimate_joint(*parts(made))
    error = found.pose - true_pose(made.truth)
    assert (rms(error) < [1e-4, 1e-4, *np.radians([0.25, 0.25, 0.1])]).all()
    assert (np.mean(np.abs(error) < 1.96 * found.pose_sigma, axis=0) > 0.85).all()
    off = found.axis - true_axis(made.truth)
    assert rms(np.linalg.norm(off, axis=1)) < 0.05
    assert rms(off / found.axis_sigma).max() < 3.0
