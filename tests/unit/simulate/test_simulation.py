"""Whole surveys: sensors' errors have their stated size, seeds repeat, streams equal what is made at once."""

from __future__ import annotations

import json
import tracemalloc

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.data import builtin_survey
from springline.errors import ParameterError
from springline.simulate import parse, scenarios, simulate, simulate_to
from springline.simulate.builtin import SEED
from springline.simulate.wall import HIT_KINDS, WATER
from springline.survey import open_survey, validate

BASE = """
name = "test"
[pipe]
diameter = 0.3
run = [{{kind = "straight", length = {length}}}]
{pipe}
[robot]
offset_z = 0.02
speed = 0.8
[rings]
spacing = {spacing}
{rings}
{more}
"""


def make(rings="", pipe="", more="", length=3.0, spacing=0.01):
    return parse(BASE.format(rings=rings, pipe=pipe, more=more, length=length, spacing=spacing))


def same(a: xr.Dataset, b: xr.Dataset) -> None:
    assert set(a.variables) == set(b.variables)
    for name in a.variables:
        assert a[name].dims == b[name].dims
        assert np.array_equal(a[name].values, b[name].values, equal_nan=a[name].dtype.kind == "f"), name


def test_the_promised_name_works_after_the_package_is_imported():
    assert sl.simulate("reference-ring").attrs["name"] == "Reference ring"


def test_one_seed_one_survey_and_another_another():
    scenario = make("noise = 0.001\noutliers = 0.02", more="[inertial]\n[ties]\nchainages = [0.5, 2.5]")
    first, again, other = simulate(scenario, 5), simulate(scenario, 5), simulate(scenario, 6)
    for group in first.groups:
        same(first.group(group), again.group(group))
    assert not np.array_equal(first.rings["range"], other.rings["range"], equal_nan=True)
    same(first.truth.drop_vars(["tie_easting"]), other.truth.drop_vars(["tie_easting"]))


@pytest.mark.parametrize("seed", [-1, 1.5, "a", None])
def test_a_seed_that_is_none_is_refused(seed):
    with pytest.raises(ParameterError, match=f"seed: {seed!r} is no seed"):
        simulate("reference-ring", seed=seed)


def test_a_seed_of_numpy_is_as_good():
    assert simulate("reference-ring", seed=np.int64(3)).rings.identical(simulate("reference-ring", seed=3).rings)


def test_a_sensor_more_leaves_the_others_noise_alone():
    alone = simulate(make("noise = 0.001"), 5)
    beside = simulate(make("noise = 0.001", more="[inertial]\naccel_noise = 0.01\n[ties]\nchainages = [0.5]"), 5)
    same(alone.rings, beside.rings)


def test_the_same_pipe_is_surveyed_twice():
    pipe = "seed = 9\nroughness = {rms = 0.0005}\njoints = {spacing = 0.7, spacing_sigma = 0.01, gap_sigma = 0.002}"
    one, two = simulate(make("noise = 0.001", pipe), 1), simulate(make("noise = 0.001", pipe), 2)
    assert np.array_equal(one.truth["wall_radius"], two.truth["wall_radius"])
    assert np.array_equal(one.truth["feature_chainage"], two.truth["feature_chainage"])
    other = simulate(make("noise = 0.001", pipe.replace("seed = 9", "seed = 10")), 1)
    assert not np.array_equal(one.truth["feature_chainage"], other.truth["feature_chainage"])


def test_range_errors_have_their_stated_size():
    clean = simulate(make("noise = 0.0")).rings["range"].values.astype(float)
    noisy = simulate(make("noise = 0.001\nnoise_relative = 0.01\nscale_error = 0.005"), 1).rings["range"].values
    error = noisy - 1.005 * clean
    assert error.std() == pytest.approx(np.sqrt(0.001**2 + np.mean((0.01 * clean) ** 2)), rel=0.01)
    assert abs(error.mean()) < 4 * error.std() / np.sqrt(error.size)
    stray = simulate(make("noise = 0.0\noutliers = 0.05\ndropout = 0.1"), 1).rings["range"].values
    assert np.isnan(stray).mean() == pytest.approx(0.1, rel=0.05)
    seen = np.isfinite(stray)
    assert (np.abs(stray - clean) > 1e-6)[seen].mean() == pytest.approx(0.05, rel=0.05)
    coarse = simulate(make("noise = 0.0\nresolution = 0.002")).rings["range"].values.astype(float)
    assert np.abs(coarse / 0.002 - np.round(coarse / 0.002)).max() < 1e-4


def test_blind_bearings_and_limits_return_nothing():
    hidden = simulate(make("noise = 0.0\nblind_deg = [[350.0, 10.0], [90.0, 91.0]]")).rings["range"].values
    lost = np.flatnonzero(np.isnan(hidden).all(axis=0))
    assert lost.tolist() == [*range(11), 90, 91, *range(350, 360)]
    near = simulate(make("noise = 0.0\nrange_min = 0.15")).rings["range"].values
    assert np.isnan(near[:, 0]).all()
    assert np.isfinite(near[:, 180]).all()


def test_water_swallows_its_share():
    survey = simulate(make("noise = 0.0\nwater_returns = 0.25", pipe="water = [{depth = 0.03}]"), 2)
    wet = survey.truth["hit"].values == WATER
    assert np.isnan(survey.rings["range"].values[wet]).mean() == pytest.approx(0.75, abs=0.02)
    assert np.isfinite(survey.rings["range"].values[~wet]).all()


def test_a_boresight_error_tilts_the_ring_and_not_the_truth():
    survey = simulate(make("noise = 0.0\nboresight_pitch_deg = 20.0").model_copy(), 0)
    top = survey.rings["range"].values[:, 90]
    side = np.hypot(0.15, 0.0)
    assert np.allclose(top, np.sqrt(side**2 - 0.02**2) / np.cos(np.radians(20.0)), atol=1e-6)
    assert np.allclose(survey.truth["pitch"], 0.0, atol=1e-12)


def test_ties_lie_on_the_axis_within_their_sigma():
    chainages = np.linspace(0.1, 2.9, 200)
    survey = simulate(make(more=f"[ties]\nchainages = {chainages.tolist()}\nsigma = 0.02"), 3)
    error = np.concatenate([survey.ties[n] - survey.truth[f"tie_{n}"] for n in ("easting", "northing", "elevation")])
    assert error.std() == pytest.approx(0.02, rel=0.1)
    assert np.allclose(survey.truth["tie_northing"], chainages)
    assert np.allclose(survey.ties["distance"], chainages - 0.2, atol=1e-9)


def test_the_truth_of_sections_is_that_of_the_scenario():
    pipe = "section = [{shape = 'mode', mode = 4, s02 = 0.97, s1 = [[0, 0.96], [3, 0.9]]}]"
    truth = simulate(make(pipe=pipe)).truth
    assert np.allclose(truth["s1"], np.interp(truth["chainage"], [0, 3], [0.96, 0.9]))
    # The vertical chord through O is s1 + s2 times the radius.
    assert np.allclose(truth["diameter_y"], 0.15 * (truth["s1"] + truth["s2"]), atol=1e-7)
    assert np.allclose(truth["wall_radius"][:, 270], 0.15 * truth["s1"], atol=1e-6)
    assert np.allclose(truth["s02"], 0.97)
    assert np.isnan(truth["s01"]).all()


def test_the_truth_of_the_axis_is_that_of_the_scenario():
    scenario = parse(
        'name = "x"\n[pipe]\ndiameter = 0.3\nstart = [10.0, 20.0, 5.0]\nheading_deg = 90.0\n'
        'run = [{kind = "straight", length = 4.0}, {kind = "bend", radius = 2.0, angle_deg = 90.0, towards = "left"}, '
        '{kind = "straight", length = 8.0}]\nsag = [{chainage = 11.0, length = 4.0, depth = 0.05}]\n'
        "[rings]\nspacing = 1.0"
    )
    truth = simulate(scenario).truth
    whole = 4.0 + np.pi + 8.0
    assert float(truth["chainage"][-1]) == pytest.approx(whole, abs=0.05)
    at = {name: truth[name].values for name in ("chainage", "easting", "northing", "elevation", "heading", "gradient")}
    assert np.interp(4.0, at["chainage"], at["easting"]) == pytest.approx(14.0)
    # East first, then a left bend to the north: the bend ends 2 m on and 2 m over, heading north.
    after = np.argmin(np.abs(at["chainage"] - (4.0 + np.pi + 0.5)))
    assert at["easting"][after] == pytest.approx(16.0)
    assert at["northing"][after] == pytest.approx(22.0 + at["chainage"][after] - 4.0 - np.pi)
    assert np.cos(at["heading"][after]) == pytest.approx(1.0)
    assert at["elevation"].min() == pytest.approx(5.0 - 0.05, abs=2e-5)
    assert at["elevation"][-1] == pytest.approx(5.0)
    assert np.allclose(np.gradient(at["elevation"], at["chainage"]), at["gradient"], atol=3e-3)


def test_streaming_equals_making_at_once(tmp_path):
    scenario = make(
        "noise = 0.001\ndropout = 0.05\nbearings = 180",
        pipe="joint = [{chainage = 1.0, gap = 0.02}]\nlateral = [{chainage = 2.0, clock_h = 2, diameter = 0.1}]",
        more="[rings_rear]\nspacing = 0.02\nbearings = 90\nposition = [-0.2, 0.0, 0.0]\n"
        "[inertial]\nrate = 2000\ngyro_walk_deg_h_sqrt_h = 5.0\n[ties]\nchainages = [0.5]",
        length=30.0,
    )
    shares = []
    path = simulate_to(tmp_path / "test.zarr.zip", scenario, 4, progress=shares.append)
    streamed, made = open_survey(path), simulate(scenario, 4)
    validate(streamed)
    assert shares == sorted(shares)
    assert made.rings.sizes["ring"] > 2048  # more than one block
    assert made.inertial.sizes["sample"] > 65536
    assert {k: v for k, v in streamed.attrs.items() if k != "chunks"} == made.attrs
    for group in made.groups:
        one, two = streamed.group(group), made.group(group)
        if group.startswith("rings"):
            assert np.allclose(one["range"], two["range"], atol=6e-5, equal_nan=True)  # a tick is a tenth of the noise
            one, two = one.drop_vars("range"), two.drop_vars("range")
        same(one, two)


def test_memory_of_a_stream_does_not_grow_with_the_pipe(tmp_path):
    def peak(length: float) -> float:
        tracemalloc.start()
        text = BASE.format(rings="bearings = 90", pipe="", more="", length=length, spacing=0.002)
        simulate_to(tmp_path / f"{length}.zarr", parse("truth_spacing = 0.004\n" + text))
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return most

    # A few blocks of rings and of stations fill it; from there on it is flat.
    short, long = peak(16.0), peak(32.0)
    assert long < 1.05 * short


def test_the_built_in_survey_is_what_its_generator_makes():
    assert builtin_survey().stat().st_size < 2_000_000
    shipped, made = open_survey(builtin_survey()), simulate("builtin", SEED)
    # Where a reading lies between two steps of the scanner's resolution, rounding may differ between machines.
    assert np.allclose(shipped.rings["range"], made.rings["range"], atol=6e-5, equal_nan=True)
    assert np.mean(shipped.truth["hit"].values == made.truth["hit"].values) > 0.9999
    assert shipped.attrs["nominal_diameter"] == 0.3
    met = {HIT_KINDS[k] for k in np.unique(shipped.truth["hit"])}
    assert {"wall", "water", "dent", "joint", "lateral"} <= met
    assert 0.05 < np.isnan(shipped.rings["range"]).mean() < 0.15


@pytest.mark.parametrize(
    "name", [n for n in scenarios() if n not in ("builtin", "weaving", "joints", "bends", "egg", "sewer")]
)
def test_ready_scenarios_make_sound_surveys(name):
    survey = validate(simulate(name, 1))
    assert survey.has("truth")
    assert json.loads(survey.truth.attrs["scenario"])["name"] == survey.attrs["name"]
