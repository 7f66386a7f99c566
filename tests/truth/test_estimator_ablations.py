"""What is taken away makes the joint estimate worse, and its sigma says so; what does not matter changes nothing."""

import numpy as np
import pytest
from bench._joint import given, true_axis, true_pose

import springline as sl
from springline.estimation import Rings, estimate_joint
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
sigma = "{tie}"
"""
USUAL = {
    "radius": 1.5,
    "from_end": "false",
    "stand": 0.25,
    "wait": 60.0,
    "inertial": "",
    "odometer": "",
    "tie": "10mm",
}


def survey(seed=1, **changes):
    """Return a simulated survey."""
    return simulate(parse(SCENARIO.format(**(USUAL | changes))), seed=seed)


def rms(values):
    return np.sqrt(np.mean(np.square(values), axis=0))


@pytest.fixture(scope="module")
def usual():
    made = survey()
    arrays = given(made)
    return made, arrays, estimate_joint(*arrays)


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
    other = estimate_joint(*given(back))
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


SEEDS = range(1, 4)


def test_without_ties_error_and_sigma_of_the_centreline_grow():
    tied, free = [], []
    for seed in SEEDS:
        made = survey(seed)
        rings, log, ties = given(made)
        truth = true_axis(made.truth)
        found, alone = estimate_joint(rings, log, ties), estimate_joint(rings, log)
        tied.append((np.linalg.norm(found.axis[-1] - truth[-1]), found.axis_sigma[-1].max()))
        # Turned to the true first heading, what is left is what the log alone knows.
        heading = np.arctan2(*(truth[100] - truth[0])[:2]) - np.arctan2(*(alone.axis[100] - alone.axis[0])[:2])
        c, s = np.cos(heading), np.sin(heading)
        turned = (alone.axis - alone.axis[0]) @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) + truth[0]
        free.append((np.linalg.norm(turned[-1] - truth[-1]), alone.axis_sigma[-1].max()))
    (error, sigma), (error_free, sigma_free) = rms(tied), rms(free)
    assert error_free > 1.5 * error
    assert sigma_free > 2.5 * sigma


def test_without_standstill_error_and_sigma_of_the_centreline_and_the_bias_grow():
    calm, hasty = [], []
    for out, wait in ((calm, 60.0), (hasty, 0.5)):
        for seed in SEEDS:
            # Ties of a millimetre, so that it is the log that tells the middle.
            made = survey(seed, wait=wait, tie="1mm")
            found = estimate_joint(*given(made))
            middle = len(found.axis) // 2
            off = (found.axis - true_axis(made.truth))[middle, :2]
            bias = [found.scalars[f"gyro_bias_{axis}"][1] for axis in "xyz"]
            out.append((np.linalg.norm(off), np.linalg.norm(found.axis_sigma[middle, :2]), *bias))
    grown = rms(hasty) / rms(calm)
    assert grown[0] > 1.1
    assert grown[1] > 1.2
    assert (grown[2:] > 1.2).all()


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


FOOT, INCH = 0.3048, 0.0254
TOML = """
name = "units"
nominal_diameter = "300mm"
[parts]
rings = "rings.csv"
inertial = "inertial.csv"
ties = "ties.csv"
[units]
range = "{range}"
"""


def written(made, folder, *, imperial):
    """Return a survey written as plain text and read again: in metres, or in inches, feet, degrees and g."""
    folder.mkdir()
    inch, foot, turn, force = (INCH, FOOT, np.radians(1.0), 9.80665) if imperial else (1.0, 1.0, 1.0, 1.0)
    far, rate, pull = ("ft", "deg_s", "g") if imperial else ("m", "rad_s", "m_s2")
    rings, log, ties = made.rings, made.inertial, made.ties
    (folder / "survey.toml").write_text(TOML.format(range="in" if imperial else "m"))
    some = slice(None, None, 2)
    count = rings.sizes["bearing"]
    table(
        folder / "rings.csv",
        ["time_s", f"distance_{far}", *(f"r_{k}" for k in range(count))],
        [rings["time"].values[some], rings["distance"].values[some] / foot, *(rings["range"].values[some] / inch).T],
    )
    names = [f"gyro_{axis}_{rate}" for axis in "xyz"] + [f"accel_{axis}_{pull}" for axis in "xyz"]
    columns = [log["time"].values, *(log["gyro"].values / turn).T, *(log["accel"].values / force).T]
    table(folder / "inertial.csv", ["time_s", *names], columns)
    names = [f"{name}_{far}" for name in ("distance", "easting", "northing", "elevation", "sigma")]
    columns = [ties[name].values / foot for name in ("distance", "easting", "northing", "elevation", "sigma")]
    table(folder / "ties.csv", names, columns)
    return sl.read(folder)


def table(path, names, columns):
    np.savetxt(path, np.column_stack(columns), "%.12g", ",", header=",".join(names), comments="")


def test_units_change_nothing(usual, tmp_path):
    metric, imperial = (
        estimate_joint(*given(written(usual[0], tmp_path / str(imperial), imperial=imperial)))
        for imperial in (False, True)
    )
    for name in ("pose", "section", "axis"):
        moved = np.abs(getattr(imperial, name) - getattr(metric, name)) / getattr(metric, f"{name}_sigma")
        # The iteration stops within a tenth of a sigma.
        assert np.quantile(moved, 0.98) < 0.1
    np.testing.assert_allclose(imperial.axis_sigma, metric.axis_sigma, rtol=0.01)
    # Read again they are the survey that was written.
    assert rms(metric.axis - usual[2].axis[::2]).max() < 0.005


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
    found = estimate_joint(*given(made))
    error = found.pose - true_pose(made.truth)
    assert (rms(error) < [1e-4, 1e-4, *np.radians([0.25, 0.25, 0.1])]).all()
    assert (np.mean(np.abs(error) < 1.96 * found.pose_sigma, axis=0) > 0.85).all()
    off = found.axis - true_axis(made.truth)
    assert rms(np.linalg.norm(off, axis=1)) < 0.05
    assert rms(off / found.axis_sigma).max() < 3.0
