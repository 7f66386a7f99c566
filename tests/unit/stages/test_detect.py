"""Candidates: what rings show, in the contract's columns, and what stays out of the section."""

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.config import Config, make_config
from springline.stages.clean import clean
from springline.stages.detect import detect
from springline.stages.estimate import estimate
from springline.survey import Survey, validate

BEARINGS = np.radians(np.arange(0.0, 360.0, 1.0))
SETTINGS = Config()


def plain(count=300, spacing=0.01, noise=5e-4, seed=0):
    rng = np.random.default_rng(seed)
    return 0.15 + noise * rng.standard_normal((count, 360)), spacing * np.arange(1, count + 1)


def surveyed(ranges, distance):
    rings = xr.Dataset(
        {"range": (("ring", "bearing"), ranges.astype(np.float32)), "distance": ("ring", distance)},
        coords={"bearing": BEARINGS},
        attrs={"referred_to": "sensor", "distance_source": "odometer"},
    )
    return clean(Survey({"rings": rings}, {"name": "test"}), SETTINGS)


def kinds(survey):
    return survey.candidates["kind"].values.tolist()


@pytest.fixture(scope="module")
def builtin():
    return detect(clean(sl.read(sl.builtin_survey()), SETTINGS), SETTINGS)


def test_the_built_in_survey_shows_its_lateral_its_dent_and_its_open_joint(builtin):
    found = validate(builtin).candidates
    place = {kind: found["distance"].values[found["kind"].values == kind] for kind in ("lateral", "inward", "joint")}
    assert place["lateral"] == pytest.approx([10.335], abs=0.03)
    assert place["inward"] == pytest.approx([20.26], abs=0.05)
    assert np.abs(place["joint"] - 14.85).min() < 0.02
    assert set(found["source"].values) == {"rings"}


def test_every_joint_that_is_named_is_one(builtin):
    found, truth = builtin.candidates, builtin.truth
    at = np.interp(truth["feature_chainage"].values, truth["ring_chainage"].values, builtin.rings["distance"].values)
    for place in found["distance"].values[found["kind"].values == "joint"]:
        assert np.abs(at[truth["feature_kind"].values == 5] - place).min() < 0.02


def test_nothing_is_seen_in_a_plain_pipe():
    found = detect(surveyed(*plain()), SETTINGS)
    assert kinds(found) == []
    assert found.candidates["opening"].sum() == 0


def test_missing_readings_with_wall_all_about_them_may_be_an_opening():
    ranges, distance = plain()
    ranges[100:112, 30:60] = np.nan
    found = detect(surveyed(ranges, distance), SETTINGS)
    assert kinds(found) == ["lateral"]
    assert found.candidates["probability"].values[0] <= 0.5
    assert found.candidates["opening"].values[100:112, 30:60].all()


def test_a_blind_sector_is_no_opening():
    ranges, distance = plain()
    ranges[:, 30:60] = np.nan
    assert kinds(detect(surveyed(ranges, distance), SETTINGS)) == []


def test_a_step_between_two_rings_is_a_joint_and_a_slow_drift_is_none():
    ranges, distance = plain()
    stepped = ranges + np.where(distance[:, None] > 1.505, 0.004 * np.sin(BEARINGS), 0.0)
    found = detect(surveyed(stepped, distance), SETTINGS).candidates
    assert found["kind"].values.tolist() == ["joint"]
    assert found["distance"].values[0] == pytest.approx(1.505, abs=0.02)
    drifting = ranges + 0.02 * np.sin(distance / 0.6)[:, None] * np.sin(BEARINGS)
    assert kinds(detect(surveyed(drifting, distance), SETTINGS)) == []


def test_one_stray_ring_is_no_bump_and_shallow_bumps_can_be_left_out():
    ranges, distance = plain()
    ranges[150, 40:60] -= 0.02
    assert kinds(detect(surveyed(ranges, distance), SETTINGS)) == []
    ranges[200:215, 100:130] -= 0.004
    assert kinds(detect(surveyed(ranges, distance), SETTINGS)) == ["inward"]
    deeper = make_config({"detect": {"least_depth": 0.03}})
    assert kinds(detect(surveyed(ranges, distance), deeper)) == []


def test_an_opening_does_not_bend_the_section():
    ranges, distance = plain()
    ranges[100:115, 20:50] += 0.006
    ranges[100:115, 26:44] += 0.2
    seen = surveyed(ranges, distance)
    bent, kept = (
        estimate(s, SETTINGS).section["parameters"].values[104:111, 0].mean() for s in (seen, detect(seen, SETTINGS))
    )
    assert abs(kept - 0.15) < 1e-4
    assert abs(kept - 0.15) < abs(bent - 0.15)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_short_surveys_have_no_candidates(count):
    ranges, distance = plain(count)
    assert kinds(detect(surveyed(ranges, distance), SETTINGS)) == []
