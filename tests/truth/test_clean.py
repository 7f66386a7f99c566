"""What the mask says of each reading, against what the simulated ray hit."""

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.config import Config, make_config
from springline.conventions import MASK_REASONS
from springline.stages.clean import clean
from springline.survey import open_survey

CODE = {name: code for code, name in MASK_REASONS.items()}
HIT = {"wall": 0, "water": 1, "dent": 4, "joint": 5, "lateral": 6}


@pytest.fixture(scope="module")
def cleaned():
    survey = open_survey(sl.builtin_survey())
    return survey, clean(survey, Config()).mask["reason"].values


def share(reason, where, *names):
    return np.isin(reason[where], [CODE[name] for name in names]).mean()


def test_water_is_found_and_the_wall_is_kept(cleaned):
    survey, reason = cleaned
    hit = survey.truth["hit"].values
    seen = np.isfinite(survey.rings["range"].values)
    assert share(reason, seen & (hit == HIT["water"]), "water") > 0.95
    assert share(reason, seen & (hit == HIT["wall"]), "used") > 0.985
    assert share(reason, seen & (hit == HIT["wall"]), "water") < 0.001


def test_deformed_wall_is_wall(cleaned):
    survey, reason = cleaned
    dent = (survey.truth["hit"].values == HIT["dent"]) & np.isfinite(survey.rings["range"].values)
    assert dent.sum() > 1000
    assert share(reason, dent, "used") > 0.95


def test_lateral_opening_is_not_wall(cleaned):
    survey, reason = cleaned
    opening = survey.truth["hit"].values == HIT["lateral"]
    assert share(reason, opening, "lateral", "no_return", "out_of_range", "outlier") > 0.7


def test_every_missing_return_says_so(cleaned):
    survey, reason = cleaned
    missing = ~np.isfinite(survey.rings["range"].values)
    assert (reason[missing] == CODE["no_return"]).all()
    assert (reason[~missing] != CODE["no_return"]).all()


def rings(ranges):
    bearings = np.arange(ranges.shape[1]) * 2 * np.pi / ranges.shape[1]
    data = xr.Dataset(
        {
            "range": (("ring", "bearing"), ranges.astype("float32")),
            "distance": ("ring", 0.01 * np.arange(len(ranges))),
        },
        coords={"bearing": bearings},
        attrs={"referred_to": "sensor"},
    )
    return sl.Survey({"rings": data})


def test_spikes_go_and_a_ridge_stays():
    rng = np.random.default_rng(2)
    ranges = 0.15 + 0.0005 * rng.standard_normal((80, 180))
    spikes = rng.random(ranges.shape) < 0.02
    ranges[spikes] += rng.choice([-1, 1], spikes.sum()) * rng.uniform(0.01, 0.04, spikes.sum())
    ridge = np.zeros_like(spikes)
    ridge[:, 60:66] = True
    ranges[ridge & ~spikes] -= 0.008
    reason = clean(rings(ranges), Config()).mask["reason"].values
    assert share(reason, spikes & ~ridge, "outlier", "out_of_range", "lateral", "occluded") > 0.97
    assert share(reason, ridge & ~spikes, "used") > 0.97
    assert share(reason, ~spikes & ~ridge, "used") > 0.99


def test_something_between_sensor_and_wall_is_occlusion():
    ranges = np.full((30, 120), 0.15) + 0.0005 * np.random.default_rng(0).standard_normal((30, 120))
    ranges[:, 40:52] = 0.10
    reason = clean(rings(ranges), Config()).mask["reason"].values
    assert (reason[:, 41:51] == CODE["occluded"]).mean() > 0.95


def test_a_dry_pipe_has_no_water_and_water_can_be_switched_off():
    ranges = np.full((40, 120), 0.15) + 0.0005 * np.random.default_rng(1).standard_normal((40, 120))
    assert (clean(rings(ranges), Config()).mask["reason"].values != CODE["water"]).all()
    bearings = np.arange(120) * 2 * np.pi / 120
    flat = np.where(np.sin(bearings) < -0.8, -0.12 / np.minimum(np.sin(bearings), -1e-9), 0.15)
    under = flat < 0.149
    wet = np.where(under, flat, ranges)
    found = clean(rings(wet), Config()).mask["reason"].values
    assert (found[:, under] == CODE["water"]).mean() > 0.9
    off = clean(rings(wet), make_config({"clean": {"water": "none"}})).mask["reason"].values
    assert (off != CODE["water"]).all()


def test_blocks_do_not_show():
    rng = np.random.default_rng(3)
    ranges = 0.15 + 0.0005 * rng.standard_normal((9000, 48))
    ranges[rng.random(ranges.shape) < 0.01] = 0.2
    whole = clean(rings(ranges), Config()).mask["reason"].values
    part = clean(rings(ranges[4000:4300]), Config()).mask["reason"].values
    assert np.mean(whole[4050:4250] == part[50:250]) > 0.999
