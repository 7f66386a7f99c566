"""Another odometer, gyro and robot in an unchanged pipe: nothing of it may be told as a change of the pipe."""

from __future__ import annotations

import numpy as np
import pytest

import springline as sl
from springline.compare import compare
from springline.simulate import parse, simulate

_PIPE = """
name = "{name}"
[pipe]
diameter = "300mm"
seed = 4
gradient = -0.008
run = [{{ kind = "straight", length = 15.0 }}]
sag = [{{ chainage = 8.0, length = 8.0, depth = "{sag}mm" }}]
roughness = {{ rms = "0.3mm" }}
joints = {{ spacing = 2.5, spacing_sigma = "8mm", gap = "4mm" }}
[robot]
length = 0.5
wheelbase = 0.35
offset_z = {{ amplitude = {bounce}, period = 3.0 }}
offset_y = {{ amplitude = {weave}, period = 4.3 }}
roll_deg = {{ amplitude = {roll}, period = 3.7 }}
side_slip_deg = {side}
standstill = [{{ chainage = 0.25, duration = 60.0 }}]
[rings]
spacing = "10mm"
noise = "1mm"
[inertial]
rate = 100.0
gyro_bias_deg_h = {bias}
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [0.01, -0.01, 0.01]
accel_noise = 0.0005
[odometer]
scale_error = {scale}
slip = [{slip}]
[ties]
chainages = [0.25, 14.6]
sigma = "5mm"
"""
_FIRST = {
    "bounce": 0.02, "weave": 0.003, "roll": 3.0, "side": 0.3, "scale": -0.006, "slip": "", "bias": [10.0, -10.0, 10.0],
    "sag": 20,
}  # fmt: skip
_SECOND = {
    "bounce": 0.012, "weave": 0.005, "roll": 2.0, "side": -0.2, "scale": 0.008,
    "slip": "{ chainage = 9.3, extra = 0.12 }", "bias": [-15.0, 12.0, -20.0], "sag": 20,
}  # fmt: skip
_LAYOUT = {"gradient", "easting", "northing", "elevation"}


def _inspected(name, seed, **changed):
    return sl.inspect(simulate(parse(_PIPE.format(name=name, **changed)), seed=seed))


@pytest.fixture(scope="module")
def first():
    return _inspected("first", 1, **_FIRST)


def test_another_odometer_gyro_and_robot_are_no_change(first):
    found = compare(first, _inspected("second", 2, **_SECOND))
    assert found
    # Everything was looked at, so that saying nothing says something.
    assert _LAYOUT | {"patch", "diameter_mean", "ovality", "joint gap"} <= set(found.detectable)
    assert all(np.isfinite(found.detectable[name]) for name in _LAYOUT)
    assert found.scan.searched > 10.0
    assert [c for c in found.changes if c.quantity != "found"] == []
    # What the odometers did stands in the drift: rings lie where they were taken.
    (x, true_a), (y, true_b) = ((e.wall.chainage, e.survey.truth["ring_chainage"].values) for e in (found.a, found.b))
    good = found.placed.reliable(x)
    off = found.placed.at(x)[0] - np.interp(true_a, true_b, y)
    assert good.mean() > 0.8
    assert np.sqrt(np.mean(off[good] ** 2)) < 0.005


def test_a_pipe_that_sank_is_told_by_the_same_instruments(first):
    found = compare(first, _inspected("sunk", 3, **_SECOND | {"sag": 120}))
    assert _LAYOUT & {c.quantity for c in found.changes if c.verdict == "change"}
