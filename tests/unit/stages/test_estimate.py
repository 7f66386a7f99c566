"""Pose and section from rings: offsets with their sign, reasons for what is missing, flags."""

import json

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.config import Config, make_config
from springline.conventions import FIT_STATUS, POSE_TERMS
from springline.errors import InputError
from springline.stages.estimate import estimate
from springline.stages.metrics import metrics

BEARINGS = np.arange(180) * 2 * np.pi / 180
RNG = np.random.default_rng(9)


def seen_from(y0, z0, a=0.151, b=0.149):
    """Ranges from a sensor at height y0 and z0 to the right of the axis of an ellipse wider than high."""
    c, s = np.cos(BEARINGS), np.sin(BEARINGS)
    two, one, zero = (c / a) ** 2 + (s / b) ** 2, z0 * c / a**2 + y0 * s / b**2, (z0 / a) ** 2 + (y0 / b) ** 2 - 1
    return (-one + np.sqrt(one**2 - two * zero)) / two


def masked(ranges, referred_to="sensor", **extra):
    ranges = np.asarray(ranges, "float32")
    rings = xr.Dataset(
        {
            "range": (("ring", "bearing"), ranges),
            "distance": ("ring", 0.02 * np.arange(len(ranges))),
            **extra,
        },
        coords={"bearing": BEARINGS},
        attrs={"referred_to": referred_to, "sensor_kind": "ring-laser"},
    )
    reason = np.where(np.isfinite(ranges), 0, 1).astype("uint8")
    mask = xr.Dataset(
        {"reason": (("ring", "bearing"), reason), "coverage": ("ring", (reason == 0).mean(axis=1))},
        coords={"bearing": BEARINGS},
    )
    return sl.Survey({"rings": rings, "mask": mask}, {"name": "test", "nominal_diameter": 0.3})


def noisy(ranges, count=20):
    return ranges + 0.0003 * RNG.standard_normal((count, len(BEARINGS)))


def test_offset_is_where_the_sensor_is():
    found = estimate(masked(noisy(seen_from(0.02, -0.03))), Config())
    assert found.pose["offset_y"].values == pytest.approx(0.02, abs=3e-4)
    assert found.pose["offset_z"].values == pytest.approx(-0.03, abs=3e-4)
    error = np.abs(found.pose["offset_y"].values - 0.02)
    assert np.mean(error < 2.5 * found.pose["offset_y_sigma"].values) > 0.9
    row = POSE_TERMS.index("offset_z")
    assert found.pose["covariance"].values[:, row, row] == pytest.approx(
        found.pose["offset_z_sigma"].values ** 2, rel=1e-5
    )


def test_attitude_is_missing_with_its_reason():
    pose = estimate(masked(noisy(seen_from(0, 0))), Config()).pose
    assert np.isnan(pose["pitch"]).all()
    assert np.isnan(pose["roll_sigma"]).all()
    assert set(json.loads(pose.attrs["why_missing"])) == {"pitch", "yaw", "roll"}


def test_rings_about_the_axis_keep_the_pose_they_came_with():
    sensor = {
        name: ("ring", np.full(20, value))
        for name, value in (
            ("sensor_y", 0.04),
            ("sensor_y_sigma", 1e-4),
            ("sensor_pitch", 0.2),
            ("sensor_pitch_sigma", 1e-3),
        )
    }
    pose = estimate(masked(noisy(seen_from(0.001, 0)), "axis", **sensor), Config()).pose
    assert (pose["offset_y"] == 0.04).all()
    assert pose["pitch_sigma"].values == pytest.approx(1e-3)
    assert np.isnan(pose["offset_z"]).all()


def test_a_ring_with_little_wall_has_no_section_and_says_why():
    ranges = noisy(seen_from(0, 0))
    ranges[4, 30:] = np.nan
    found = estimate(masked(ranges), Config())
    assert FIT_STATUS[int(found.section["status"][4])] == "too few readings"
    assert np.isnan(found.section["parameters"][4]).all()
    assert found.section["mode"].values[4] == ""
    assert any("1 of 20 stations have no section" in sentence for sentence in found.warnings)
    lenient = estimate(masked(ranges), make_config({"estimate": {"minimum_coverage": 0.1, "largest_gap": 6.2}}))
    assert lenient.section["status"].values[4] == 0


def test_nothing_to_fit_is_an_error():
    ranges = np.full((5, 180), np.nan)
    ranges[:, :10] = 0.15
    with pytest.raises(InputError, match="no ring has a section: too few readings"):
        estimate(masked(ranges), Config())


def test_local_deviation_is_found_where_it_is():
    ranges = noisy(seen_from(0, 0))
    dent = np.abs(BEARINGS - np.pi / 3) < 0.2
    ranges[:, dent] -= 0.01
    section = estimate(masked(ranges), Config()).section
    assert section["deviation_in"].values == pytest.approx(-0.01, abs=1e-3)
    assert section["deviation_in_bearing"].values == pytest.approx(np.pi / 3, abs=0.15)


def test_a_ring_inside_a_joint_is_flagged():
    ranges = noisy(seen_from(0, 0), 60)
    ranges[30] += 0.008
    section = estimate(masked(ranges), Config()).section
    assert np.flatnonzero(section["flags"].values == "unlike_neighbours").tolist() == [30]


def test_a_lasting_change_of_diameter_is_not_flagged():
    ranges = noisy(seen_from(0, 0), 80)
    ranges[40:] += 0.003
    assert (estimate(masked(ranges), Config()).section["flags"].values == "").all()


def test_metrics_without_reference_have_no_deflection():
    survey = masked(noisy(seen_from(0, 0))).with_attrs(nominal_diameter=None)
    found = metrics(estimate(survey, Config()), Config()).metrics
    assert "deflection" not in found
    assert found.attrs["reference_kind"] == "none"


def test_base_diameter_comes_before_nominal_unless_stated():
    survey = estimate(masked(noisy(seen_from(0, 0))).with_attrs(base_diameter=0.31), Config())
    assert metrics(survey, Config()).metrics.attrs["reference_diameter"] == 0.31
    stated = make_config({"metrics": {"reference": "nominal"}})
    assert metrics(survey, stated).metrics.attrs["reference_diameter"] == 0.3


def test_scale_and_fit_make_the_total():
    found = metrics(estimate(masked(noisy(seen_from(0, 0))), Config()), Config()).metrics
    fit, diameter = found["diameter_area_sigma_fit"].values, found["diameter_area"].values
    assert found["diameter_area_sigma"].values == pytest.approx(np.hypot(fit, 0.0025 * diameter))
    assert found.attrs["diameter_sigma"] == pytest.approx(
        np.hypot(found.attrs["diameter_sigma_fit"], found.attrs["diameter_sigma_scale"])
    )
    assert (found["ovality_polar_sigma"].values < 1e-3).all()


def test_ovality_interval_holds_zero_for_round_pipes():
    ranges = 0.15 + 0.001 * RNG.standard_normal((1000, len(BEARINGS)))
    found = metrics(estimate(masked(ranges), Config()), Config()).metrics
    assert 0.90 <= np.mean(found["ovality_polar_low"].values == 0.0) <= 0.98


@pytest.fixture
def restless(monkeypatch):
    """A joint estimate that did not come to rest, in the place of the one that would be made."""
    from types import SimpleNamespace

    from springline.stages.estimate import stage

    monkeypatch.setattr(stage, "why_not", lambda survey: "")
    monkeypatch.setattr(
        stage, "estimate_survey", lambda survey, fitted, rear: SimpleNamespace(converged=False, iterations=40)
    )


def test_a_joint_estimate_that_is_not_at_rest_is_left_aside(restless):
    found = estimate(masked(noisy(seen_from(0.004, -0.006))), Config())
    assert "had not come to rest after 40 steps" in found.warnings[0]
    assert not found.has("layout")
    assert np.isnan(found.pose["pitch"]).all()
    assert found.pose["offset_y"].values == pytest.approx(0.004, abs=3e-4)


def test_asked_for_by_name_it_is_refused(restless):
    with pytest.raises(InputError, match="had not come to rest after 40 steps"):
        estimate(masked(noisy(seen_from(0.0, 0.0))), make_config({"estimate": {"method": "joint"}}))
