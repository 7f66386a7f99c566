"""Range scale, boresight and noise law from simulated scans of a reference, against what the scanner was given."""

import json

import numpy as np
import pytest
import xarray as xr

from springline.calibration import calibrate_ring
from springline.config import Config
from springline.errors import InputError
from springline.simulate import parse, simulate
from springline.simulate.attitude import in_pipe
from springline.stages.rings import rings
from springline.survey import Survey

SCAN = """
name = "reference"
[pipe]
diameter = "300mm"
run = [{{ kind = "straight", length = 1.0 }}]
[robot]
length = 0.3
wheelbase = 0.2
path = "prescribed"
follow = false
pitch_deg = {pitch}
yaw_deg = {yaw}
offset_y = "{up}mm"
offset_z = "{right}mm"
start = 0.4
end = 0.65
[rings]
noise = "1mm"
noise_relative = 0.002
outliers = 0.01
scale_error = 0.005
boresight_pitch_deg = {boresight}
boresight_yaw_deg = -0.2
"""
TILTS = [(20, 0), (-20, 0), (0, 20), (0, -20), (20, 0), (-20, 0), (0, 20), (0, -20), (20, 20), (-20, -20)]


def scans(boresight=0.3):
    """Twenty scans, the first ten upright, and the tilts that are known of each [rad]."""
    made, known = {}, {}
    place = np.random.default_rng(5).uniform(-40.0, 40.0, (20, 2)).round(1)
    for k, (pitch, yaw) in enumerate([(0, 0)] * 10 + TILTS):
        text = SCAN.format(pitch=pitch, yaw=yaw, up=place[k, 0], right=place[k, 1], boresight=boresight)
        made[f"scan {k}"] = simulate(parse(text), seed=k)
        known[f"scan {k}"] = tuple(np.radians([pitch, yaw]))
    return made, known


@pytest.fixture(scope="module")
def twenty():
    return scans()


def test_scale_and_boresight_come_out_of_twenty_scans(twenty):
    made, known = twenty
    found = calibrate_ring(made, 0.3, diameter_sigma=0.0, tilts=known, tilt_sigma=0.0)
    assert float(found["range_scale"]) == pytest.approx(1.005, abs=0.0002)
    assert np.degrees(float(found["boresight_pitch"])) == pytest.approx(0.3, abs=0.05)
    assert np.degrees(float(found["boresight_yaw"])) == pytest.approx(-0.2, abs=0.05)
    for name, truth in (
        ("range_scale", 1.005),
        ("boresight_pitch", np.radians(0.3)),
        ("boresight_yaw", np.radians(-0.2)),
        ("boresight_roll", 0.0),
    ):
        assert abs(float(found[name]) - truth) < 3.0 * float(found[f"{name}_sigma"]), name
    assert json.loads(found.attrs["why_missing"]) == {}


def test_the_noise_law_comes_out_with_the_part_that_grows(twenty):
    made, known = twenty
    found = calibrate_ring(made, 0.3, diameter_sigma=0.0, tilts=known)
    at = np.array([0.11, 0.15, 0.19])
    law = np.hypot(float(found["noise_constant"]), float(found["noise_relative"]) * at)
    # What the scanner adds to 1.005 times the true range, in true metres.
    np.testing.assert_allclose(law, np.hypot(0.001, 0.002 * at) / 1.005, rtol=0.02)
    assert float(found["range_low"]) < 0.12 and float(found["range_high"]) > 0.18


def test_without_tilts_scale_stays_and_boresight_says_why_it_is_missing(twenty):
    made, _ = twenty
    upright = {name: made[name] for name in list(made)[:10]}
    for tilts in (None, dict.fromkeys(upright, (0.0, 0.0))):
        found = calibrate_ring(upright, 0.3, diameter_sigma=0.0, tilts=tilts)
        assert float(found["range_scale"]) == pytest.approx(1.005, abs=0.0002)
        for name in ("boresight_pitch", "boresight_yaw", "boresight_roll"):
            assert np.isnan(found[name]) and np.isnan(found[f"{name}_sigma"])
            assert "known tilt" in json.loads(found.attrs["why_missing"])[name]
        # Nobody knows how well it was aligned; a degree of it is 0.015 % of the radius.
        assert float(found["range_scale_sigma"]) > 1e-4


def test_a_tilt_typed_wrong_is_said(twenty):
    made, known = twenty
    wrong = {**known, "scan 12": tuple(np.radians([0.0, 15.0]))}
    found = calibrate_ring(made, 0.3, diameter_sigma=0.0, tilts=wrong)
    assert "'scan 12'" in json.loads(found.attrs["notes"])[0]
    right = calibrate_ring(made, 0.3, diameter_sigma=0.0, tilts=known)
    assert float(found["boresight_yaw_sigma"]) > 3.0 * float(right["boresight_yaw_sigma"])


CAMERA = """
name = "reference"
[pipe]
diameter = "300mm"
run = [{ kind = "straight", length = 3.0 }]
[robot]
pitch_deg = 2.0
offset_y = 0.01
[depth_camera]
captures = [0.3]
width = 160
height = 120
focal_px = 80.0
noise_quadratic = 0.004
"""


def test_a_depth_cameras_scale_comes_out_of_its_cloud():
    points = simulate(parse(CAMERA), seed=1).points
    longer = points.assign({axis: 1.008 * points[axis] for axis in "xyz"})
    made = {"cloud": rings(Survey({"points": longer}, {"nominal_diameter": 0.3}), Config())}
    found = calibrate_ring(made, 0.3, diameter_sigma=0.0)
    assert float(found["range_scale"]) == pytest.approx(1.008, abs=0.0002)
    assert abs(float(found["range_scale"]) - 1.008) < 3.0 * float(found["range_scale_sigma"])
    why = json.loads(found.attrs["why_missing"])
    assert "axis already" in why["boresight_pitch"] and "cloud" in why["noise_constant"]
    with pytest.raises(InputError, match="Leave the tilts out"):
        calibrate_ring(made, 0.3, tilts=dict.fromkeys(made, (0.0, 0.0)))


def ring(rng, scale, boresight, tilt, section, count=4, bearings=120, noise=0.001):
    """Rings that a scanner reads in a straight pipe of semi-axes and bearing `section`, cast by their own formula."""
    axes = in_pipe(*boresight) @ in_pipe(*tilt)
    t = np.arange(bearings) * 2.0 * np.pi / bearings
    ray = np.cos(t)[:, None] * axes[2] + np.sin(t)[:, None] * axes[1]
    y0, z0 = rng.uniform(-0.03, 0.03, 2)
    major, minor, turn = section
    # Directions of the section's axes on z and y.
    u = np.array([np.cos(turn), np.sin(turn)])
    along, across = ray[:, [2, 1]] @ u / major, ray[:, [2, 1]] @ [-u[1], u[0]] / minor
    a0, c0 = np.array([z0, y0]) @ u / major, np.array([z0, y0]) @ [-u[1], u[0]] / minor
    two, one, zero = along**2 + across**2, a0 * along + c0 * across, a0**2 + c0**2 - 1.0
    true = (np.sqrt(one**2 - two * zero) - one) / two
    reading = scale * true + noise * rng.standard_normal((count, bearings))
    return Survey({"rings": xr.Dataset({"range": (("ring", "bearing"), reading), "bearing": ("bearing", t)})})


def test_intervals_hold_the_truth():
    rng = np.random.default_rng(11)
    hits, trials = np.zeros(4), 80
    tilt_sigma, size_sigma = np.radians(0.1), 0.0002
    stated = np.radians([(0, 0)] * 10 + TILTS)
    for _ in range(trials):
        truth = np.array([1.0 + 0.01 * rng.standard_normal(), *np.radians(rng.uniform(-1.0, 1.0, 3))])
        flat = 0.15 * 0.001 * rng.standard_normal()
        section = (0.15 + flat, 0.15 - flat, rng.uniform(0.0, np.pi))
        made = {
            str(k): ring(rng, truth[0], truth[1:], [*(tilt + tilt_sigma * rng.standard_normal(2)), 0.0], section)
            for k, tilt in enumerate(stated)
        }
        found = calibrate_ring(
            made,
            0.3 + size_sigma * rng.standard_normal(),
            diameter_sigma=size_sigma,
            tilts={str(k): tuple(tilt) for k, tilt in enumerate(stated)},
            tilt_sigma=tilt_sigma,
        )
        values = [float(found[name]) for name in found["calibration_term"].values[:4]]
        sigma = np.sqrt(np.diagonal(found["covariance"].values))[:4]
        hits += np.abs(np.array(values) - truth) < 1.96 * sigma
    # Of 600 such trials 95.5, 95.2, 94.0 and 95.5 % hold; of 80 each may stray by three points.
    assert np.all(hits / trials >= 0.90), hits / trials
    assert 0.90 <= hits.sum() / (4 * trials) <= 0.98
