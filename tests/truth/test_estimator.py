"""The joint estimate against simulated truth, within the accuracy and the uncertainty that it states."""

import numpy as np
import pytest
from bench._joint import given, radii, true_axis, true_pose, true_radii

from springline.estimation import Inertial, Rings, Ties, estimate_joint, pooled_harmonics
from springline.simulate import parse, simulate

WEAVING = """
name = "short weave"
[pipe]
diameter = "300mm"
heading_deg = {heading}
gradient = -0.008
start = [1000.0, 2000.0, 50.0]
seed = 3
run = [
    {{ kind = "straight", length = 5.0 }},
    {{ kind = "bend", radius = 1.5, angle_deg = 22.5, towards = "right" }},
    {{ kind = "straight", length = 6.4 }},
]
joints = {{ spacing = 2.5, gap = "4mm", kink_sigma_deg = 0.1 }}
water = [{{ depth = "8mm", start = 1.0 }}]
[[pipe.section]]
shape = "mode"
mode = 1
s1 = {{ mean = 0.975, amplitude = 0.005, period = 9.0 }}
[robot]
length = 0.5
wheelbase = 0.35
offset_z = {{ amplitude = 0.025, period = 3.0 }}
offset_y = {{ amplitude = 0.004, period = 4.3 }}
roll_deg = {{ amplitude = 3.0, period = 3.7 }}
side_slip_deg = 0.3
standstill = [{{ chainage = 0.25, duration = {stand} }}]
[rings]
spacing = "10mm"
noise = "1mm"
outliers = 0.02
water_returns = 0.0
[inertial]
rate = 100.0
gyro_bias_deg_h = [10.0, -10.0, 10.0]
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [0.01, -0.01, 0.01]
accel_noise = 0.0005
[odometer]
scale_error = 0.005
[ties]
chainages = [0.25, 11.7]
sigma = "10mm"
"""


def survey(heading=30.0, stand=60.0, seed=0, text=None):
    """Return rings, inertial log, ties and truth of a short weave."""
    made = simulate(parse((text or WEAVING).format(heading=heading, stand=stand)), seed=seed)
    return *given(made), made.truth


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.fixture(scope="module")
def weave():
    rings, log, ties, truth = survey()
    return rings, log, ties, truth, estimate_joint(rings, log, ties)


def test_pose_section_and_layout_come_out_together(weave):
    rings, _, _, truth, found = weave
    error = found.pose - true_pose(truth)
    assert found.converged
    assert rms(error[:, :2]) < 0.1e-3
    assert rms(error[:, 2:4]) < np.radians(0.25)
    assert rms(error[:, 4]) < np.radians(0.1)
    section, _ = radii(found)
    alone = rings.parameters[:, 2:3] + rings.parameters[:, 3:4] * np.array([[1.0, -1.0]])
    assert rms(section - true_radii(truth)) < 0.05e-3
    assert rms(section - true_radii(truth)) < 0.25 * np.sqrt(np.nanmean((alone - true_radii(truth)) ** 2))
    assert rms(np.linalg.norm(found.axis - true_axis(truth), axis=1)) < 0.02


def test_the_bend_is_a_line_an_arc_and_a_line(weave):
    (bend,) = weave[4].bends
    assert np.degrees(bend.angle) == pytest.approx(22.5, abs=0.5)
    assert bend.radius == pytest.approx(1.5, rel=0.05)
    assert np.degrees((bend.towards + np.pi) % (2.0 * np.pi) - np.pi) == pytest.approx(0.0, abs=2.0)
    assert bend.start + 0.25 == pytest.approx(5.0, abs=0.03)


def test_scalars_are_found_within_their_sigma(weave):
    found = weave[4]
    hour = np.radians(1.0) / 3600.0
    truth = {
        "gyro_bias_x": 10.0 * hour,
        "gyro_bias_y": -10.0 * hour,
        "gyro_bias_z": 10.0 * hour,
        "odometer_scale": 1.0 / 1.005 - 1.0,
        "slip_right": -np.tan(np.radians(0.3)),
        "slip_up": 0.0,
        "clock_offset": 0.0,
        "axles": 0.0,
    }
    for name, value in truth.items():
        estimate, sigma = found.scalars[name]
        assert abs(estimate - value) < 3.0 * sigma, name
    assert found.scalars["slip_right"][1] < 0.002


def test_turning_the_earth_turns_the_layout_and_nothing_else(weave):
    rings, log, ties, _, found = weave
    c, s = np.cos(1.0), np.sin(1.0)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    other = estimate_joint(rings, log, Ties(ties.distance, ties.position @ turn.T + 5.0, ties.sigma))
    # To a hundredth of what is stated: the iteration stops at a tenth of it.
    assert np.max(np.abs(other.pose - found.pose) / found.pose_sigma) < 0.02
    assert np.max(np.abs(other.section - found.section) / found.section_sigma) < 0.02
    assert np.max(np.abs(other.axis - (found.axis @ turn.T + 5.0)) / found.axis_sigma) < 0.02
    np.testing.assert_allclose(other.pose_sigma, found.pose_sigma, rtol=0.02)


def test_clock_offset_of_50_ms_is_found_or_harmless(weave):
    rings, log, ties, _, found = weave
    late = estimate_joint(rings, Inertial(log.time + 0.05, log.gyro, log.accel), ties)
    value, sigma = late.scalars["clock_offset"]
    assert abs(value - 0.05) < 3.0 * sigma
    assert rms(late.section - found.section) < 0.01e-3


def test_rings_and_odometer_alone_tell_offsets_tilt_and_section(weave):
    rings, _, _, truth, _ = weave
    found = estimate_joint(rings)
    before_bend = rings.distance < 4.0
    assert set(found.why_missing) == {"roll", "axis", "gradient"}
    assert np.isnan(found.pose[:, 4]).all() and np.isnan(found.axis).all()
    # Without a log the sensor's own upright stands for up: what does not ask for it is how far, and how steeply.
    pose = true_pose(truth)
    far = [np.hypot(*values[before_bend, :2].T) for values in (found.pose, pose)]
    steep = [np.hypot(*values[before_bend, 2:4].T) for values in (found.pose, pose)]
    assert rms(far[0] - far[1]) < 0.15e-3
    sigma = np.linalg.norm(found.pose_sigma[before_bend, 2:4], axis=1)
    assert rms((steep[0] - steep[1]) / sigma) < 2.0
    assert np.median(sigma) < np.radians(2.0)


def test_rings_alone_tell_no_tilt():
    rings = survey()[0]
    found = estimate_joint(Rings(rings.distance, rings.parameters, rings.covariance, odometer=False))
    assert {"pitch", "yaw", "roll", "axis", "chainage"} <= set(found.why_missing)
    assert np.isnan(found.pose[:, 2:]).all() and np.isfinite(found.pose[:, :2]).all()


def test_rings_in_another_order_are_refused(weave):
    rings = weave[0]
    order = np.random.default_rng(0).permutation(len(rings.distance))
    with pytest.raises(ValueError, match="does not increase"):
        Rings(rings.distance[order], rings.parameters[order], rings.covariance[order])


EVENTS = {
    "knock": ("[rings]", "knock = [{{ chainage = 8.0, length = 0.2, roll_deg = 15.0 }}]\n[rings]"),
    "slip": ("scale_error = 0.005", "scale_error = 0.005\nslip = [{{ chainage = 8.3, length = 0.1, extra = 0.1 }}]"),
    "stop and gap": (
        "duration = {stand} }}]",
        "duration = {stand} }}, {{ chainage = 8.3, duration = 60.0 }}]",
        "accel_noise = 0.0005",
        "accel_noise = 0.0005\ngap = [[100.0, 101.0]]",
    ),
    "outliers and occlusion": ("outliers = 0.02", "outliers = 0.2\nblind_deg = [[20.0, 110.0]]"),
}


@pytest.mark.parametrize("event", EVENTS)
def test_what_happens_on_the_way_does_no_harm(event):
    text = WEAVING
    for old, new in zip(EVENTS[event][::2], EVENTS[event][1::2], strict=True):
        assert old in text
        text = text.replace(old, new, 1)
    rings, log, ties, truth = survey(text=text)
    found = estimate_joint(rings, log, ties)
    error = found.pose - true_pose(truth)
    assert rms(error[:, :2]) < 0.1e-3
    assert rms(error[:, 2:4]) < np.radians(0.25)
    assert rms(error[:, 4]) < np.radians(0.1)
    # What is wrong all along one survey, as pitch by the slip upwards, is so by its sigma; see `bench.pose_study`.
    assert (np.sqrt(np.mean((error / found.pose_sigma) ** 2, axis=0)) < 2.5).all()
    section, sigma = radii(found)
    wrong = section - true_radii(truth)
    assert rms(wrong) < 0.05e-3
    assert np.mean(np.abs(wrong) < 1.96 * sigma) > 0.9
    off = found.axis - true_axis(truth)
    assert rms(np.linalg.norm(off, axis=1)) < 0.05
    assert rms(off / found.axis_sigma) < 2.5


def test_a_section_that_is_no_ellipse_is_said_and_does_not_pull_the_centre():
    text = WEAVING.replace("[robot]", "[[pipe.harmonic]]\norder = 3\namplitude = 0.0007\n[robot]")
    made = simulate(parse(text.format(heading=30.0, stand=60.0)), seed=0)
    ranges, bearings = made.rings["range"].values, made.rings["bearing"].values
    (rings, log, ties), truth = given(made), made.truth
    shape = pooled_harmonics(ranges, bearings, rings.parameters)
    assert shape.significant.all()
    assert shape.amplitude == pytest.approx(0.0007, rel=0.1)
    found = estimate_joint(rings, log, ties, harmonics=shape)
    assert "no ellipse" in found.warnings[0]
    section, sigma = radii(found)
    assert np.mean(np.abs(section - true_radii(truth)) < 1.96 * sigma) > 0.9
    freed = found.pose[:, 1] - truth["offset_z"].values
    bound = estimate_joint(rings, log, ties).pose[:, 1] - truth["offset_z"].values
    assert rms(freed) < 0.7 * rms(bound)
