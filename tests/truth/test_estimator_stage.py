"""A simulated survey inspected from end to end: the columns of `stations.csv` against the truth, within their sigma."""

import json

import numpy as np
import pytest
from bench._joint import here

import springline as sl
from springline.config import make_config
from springline.errors import InputError
from springline.estimation import Ties
from springline.outputs.tables import stations_sigma_table, stations_table
from springline.simulate import parse, simulate
from springline.stages.estimate.plausible import check_ties

SCENARIO = """
name = "short survey"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.008
start = [1000.0, 2000.0, 50.0]
run = [
    { kind = "straight", length = 4.0 },
    { kind = "bend", radius = 1.5, angle_deg = 22.5, towards = "right" },
    { kind = "straight", length = 4.0 },
]
water = [{ depth = "8mm", start = 1.0 }]
[[pipe.section]]
shape = "ellipse"
semi_major = "154mm"
semi_minor = "146mm"
[robot]
length = 0.5
wheelbase = 0.35
offset_z = { amplitude = 0.025, period = 3.0 }
offset_y = { amplitude = 0.004, period = 4.3 }
roll_deg = { amplitude = 3.0, period = 3.7 }
side_slip_deg = 0.3
standstill = [{ chainage = 0.25, duration = 60.0 }]
[rings]
spacing = "10mm"
noise = "1mm"
outliers = 0.02
water_returns = 0.0
position = [0.1, 0.02, 0.0]
[inertial]
rate = 100.0
gyro_bias_deg_h = [10.0, -10.0, 10.0]
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [0.01, -0.01, 0.01]
accel_noise = 0.0005
[odometer]
scale_error = 0.005
[ties]
chainages = [0.25, 8.3]
sigma = "10mm"
"""


@pytest.fixture(scope="module")
def made():
    return simulate(parse(SCENARIO), seed=1)


@pytest.fixture(scope="module")
def result(made):
    return sl.inspect(made)


def true_columns(truth):
    """Return the truth abreast of every ring, in the units of `stations.csv`."""
    mm, deg = 1e3, 180.0 / np.pi
    return {
        "chainage_m": truth["ring_chainage"].values - 0.25,
        "offset_y_mm": mm * truth["offset_y"].values,
        "offset_z_mm": mm * truth["offset_z"].values,
        "pitch_deg": deg * truth["pitch"].values,
        "yaw_deg": deg * truth["yaw"].values,
        "roll_deg": deg * truth["roll"].values,
        "ovality_polar_pct": 1e2 * here(truth, "ovality_polar"),
        "easting_m": here(truth, "easting"),
        "northing_m": here(truth, "northing"),
        "elevation_m": here(truth, "elevation"),
        "gradient_pct": 1e2 * here(truth, "gradient"),
    }


FURTHEST = {
    "chainage_m": 0.03,
    "offset_y_mm": 0.1,
    "offset_z_mm": 0.1,
    "pitch_deg": 0.25,
    "yaw_deg": 0.25,
    "roll_deg": 0.1,
    "ovality_polar_pct": 0.022,
    "easting_m": 0.03,
    "northing_m": 0.03,
    "elevation_m": 0.03,
    "gradient_pct": 0.25,
}
"""Largest rms error of each column."""


def test_every_column_is_the_truth_within_its_sigma(made, result):
    table, sigma = stations_table(result), stations_sigma_table(result)
    for name, value in true_columns(made.truth).items():
        error = table[name].to_numpy() - value
        assert np.sqrt(np.mean(error**2)) < FURTHEST[name], name
        # Slowly varying errors of one survey: at most two and a half sigma anywhere but at a few stations.
        assert np.mean(np.abs(error) < 2.5 * sigma[name].to_numpy() + 1e-9) > 0.9, name
    diameters = table[["diameter_x_mm", "diameter_y_mm"]].to_numpy() - [308.0, 292.0]
    assert np.sqrt(np.mean(diameters**2)) < 0.1


def test_the_bend_stands_in_the_layout_and_in_its_column(result):
    layout = result.layout
    assert layout.attrs["frame"] == "ties"
    assert np.degrees(layout["bend_angle"].values) == pytest.approx([22.5], abs=0.5)
    assert layout["bend_arc_radius"].values == pytest.approx([1.5], rel=0.05)
    assert layout["bend_start"].values == pytest.approx([3.75], abs=0.05)
    bent = stations_table(result)["bend_radius_m"].notna().to_numpy()
    where = stations_table(result)["chainage_m"].to_numpy()[bent]
    assert where.min() == pytest.approx(3.75, abs=0.06)
    assert where.max() == pytest.approx(3.75 + 1.5 * np.radians(22.5), abs=0.06)


def test_tilt_and_roll_are_out_of_the_section(made, result):
    alone = sl.inspect(made, make_config({"estimate": {"method": "rings"}}))
    truth = true_columns(made.truth)["ovality_polar_pct"]
    wrong = [np.sqrt(np.mean((stations_table(r)["ovality_polar_pct"] - truth) ** 2)) for r in (result, alone)]
    assert wrong[0] < 0.2 * wrong[1]
    assert not alone.has("layout")
    assert np.isnan(stations_table(alone)["yaw_deg"]).all()


def test_without_inertial_log_what_it_tells_is_missing_with_its_reason(made):
    survey = sl.Survey({"rings": made.rings}, made.attrs)
    assert np.isnan(stations_table(sl.inspect(survey))["pitch_deg"]).all()
    found = sl.inspect(survey, make_config({"estimate": {"method": "joint"}}))
    assert set(json.loads(found.pose.attrs["why_missing"])) == {"roll"}
    assert np.isfinite(found.pose["yaw"]).all()
    assert not found.has("layout")


def test_without_ties_the_layout_is_local_and_says_so(made):
    found = sl.inspect(sl.Survey({name: made.group(name) for name in ("rings", "inertial")}, made.attrs))
    assert found.layout.attrs["frame"] == "local"
    assert any("no ties" in sentence for sentence in found.assumptions)
    steps = np.diff(np.stack([found.layout[n].values for n in ("easting", "northing", "elevation")], axis=1), axis=0)
    assert np.linalg.norm(steps, axis=1).sum() == pytest.approx(found.layout["chainage"].values[-1] - 0.11, abs=0.05)
    assert (np.diff(found.layout["northing_sigma"].values) > -1e-6).all()


def test_a_log_that_does_not_cover_the_rings_is_said(made):
    log = made.inertial.isel(sample=slice(0, 8000))
    survey = sl.Survey({"rings": made.rings, "inertial": log}, made.attrs)
    assert any("one by one" in sentence and "does not cover" in sentence for sentence in sl.inspect(survey).warnings)
    with pytest.raises(InputError, match="does not cover"):
        sl.inspect(survey, make_config({"estimate": {"method": "joint"}}))


def changed(made, **groups):
    kept = {name: made.group(name) for name in ("rings", "inertial", "ties")}
    return sl.Survey({**kept, **groups}, made.attrs)


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda log, ties: {"inertial": log.assign(accel=-log["accel"])}, "the robot lies on its back"),
        (lambda log, ties: {"inertial": log.assign(accel=log["accel"] / 9.81)}, "the accelerometer reads 0.998 m/s2"),
        (lambda log, ties: {"inertial": log.assign(accel=0.0 * log["accel"])}, "the accelerometer reads 0 m/s2"),
        (
            lambda log, ties: {"ties": ties.assign(distance=ties["distance"] + 100.0)},
            "a tie stands at 100 m of the counter",
        ),
        (lambda log, ties: {"ties": ties.assign(easting=1000.0 * ties["easting"])}, "m apart, the counter ran"),
        (
            lambda log, ties: {"ties": ties.assign({n: 1e-5 * ties[n] for n in ("easting", "northing")})},
            "m apart, the counter ran",
        ),
    ],
)
def test_mistakes_of_axes_units_and_columns_are_said_and_not_swallowed(made, spoil, said):
    survey = changed(made, **spoil(made.inertial, made.ties))
    with pytest.raises(InputError, match=said):
        sl.inspect(survey, make_config({"estimate": {"method": "joint"}}))


def test_a_tie_in_the_manhole_before_the_first_ring_is_no_mistake(made):
    ties = made.ties.assign(distance=made.ties["distance"] - np.array([1.0, 0.0]))
    check_ties(
        Ties(
            ties["distance"].values,
            np.stack([ties[n].values for n in ("easting", "northing", "elevation")], 1),
            ties["sigma"].values,
        ),
        made.rings["distance"].values,
    )
