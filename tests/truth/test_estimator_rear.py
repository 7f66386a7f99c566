"""A second scanner against simulated truth: better tilt and side-slip, nothing worse, intervals that hold."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from bench.pose_rear import FRONT, REAR, given, made, off, off_blind, pooled

import springline as sl
from springline.errors import InputError
from springline.estimation import Rear, Rings, estimate_joint
from springline.io import write

SEEDS = range(900, 905)


@pytest.fixture(scope="module")
def runs():
    """Errors and sigma of some surveys, with one scanner and with both."""
    single, double = [], []
    for seed in SEEDS:
        survey, scalars = made(seed)
        rings, log, ties, rear, shape = given(survey)
        single.append(off(estimate_joint(rings, log, ties, **shape), survey.truth, scalars))
        double.append(off(estimate_joint(rings, log, ties, rear=rear, **shape), survey.truth, scalars))
    return single, double


@pytest.mark.parametrize("name", ["r1", "r2", "offset_y", "offset_z", "roll"])
def test_nothing_gets_worse(runs, name):
    (one, _), (two, _) = (pooled(parts, name) for parts in runs)
    assert two < 1.05 * one


@pytest.mark.parametrize("name", ["pitch", "yaw", "slip up", "slip right"])
def test_tilt_and_slip_get_clearly_better(runs, name):
    (one, _), (two, _) = (pooled(parts, name) for parts in runs)
    assert two < 0.75 * one
    assert two < np.radians(0.05 if name == "yaw" else 0.03)


def test_intervals_hold(runs):
    z = np.concatenate([
        error / sigma for part in runs[1] for name, (error, sigma) in part.items() if not name.endswith("ing")
    ])  # fmt: skip
    assert 0.9 <= np.mean(np.abs(z) < 1.96) <= 0.99


def test_without_a_log_two_scanners_show_the_tilt():
    survey, _ = made(910, straight=True)
    rings, _, _, rear, _ = given(survey)
    (one, _), (two, held) = (
        pooled([off_blind(estimate_joint(rings, rear=r), survey.truth)], "tilt") for r in (None, rear)
    )
    assert two < np.radians(0.03) < 0.2 * one
    assert held > 0.85


def test_a_bend_between_the_scanners_puts_tilt_in_doubt_where_no_log_tells_it():
    survey, _ = made(911)
    rings, _, _, rear, _ = given(survey)
    found = estimate_joint(rings, rear=rear)
    assert any("The pipe bends between the two scanners" in one for one in found.warnings)
    at = survey.truth["ring_chainage"].values
    error = np.hypot(*(found.pose[:, 2:4] - np.stack([survey.truth[n] for n in ("pitch", "yaw")], axis=1)).T)
    within = (at > 4.1) & (at < 4.5)
    assert np.rad2deg(error[within].max()) > 2.0
    assert np.mean((error / np.linalg.norm(found.pose_sigma[:, 2:4], axis=1))[within] < 3.0) > 0.9


def test_a_mount_that_is_not_as_stated_is_said():
    survey, _ = made(912)
    rings, log, ties, rear, _ = given(survey)
    rolled = np.radians(8.0)
    c, s = np.cos(rolled), np.sin(rolled)
    wrong = replace(rear, mounting=np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]))
    assert not estimate_joint(rings, log, ties, rear=rear).warnings
    assert any("Front and rear rings differ" in one for one in estimate_joint(rings, log, ties, rear=wrong).warnings)


def test_bad_rear_scanners_are_refused():
    rings = Rings(
        np.arange(20) * 0.01, np.tile([0.0, 0.0, 0.15, 0.0, 0.0], (20, 1)), np.tile(np.eye(5) * 1e-8, (20, 1, 1))
    )
    with pytest.raises(InputError, match="stands 0 mm from the front one"):
        estimate_joint(rings, rear=Rear(rings, 1e-3))
    with pytest.raises(InputError, match=r"rear\.sigma is 0"):
        Rear(rings, 0.0)
    with pytest.raises(InputError, match=r"rear\.scale is nan"):
        Rear(rings, 1e-3, float("nan"))


@pytest.fixture(scope="module")
def survey():
    return made(913)[0]


def test_the_survey_is_read_back_with_both_scanners(survey, tmp_path):
    for name in ("a.zarr", "a.zarr.zip", "folder"):
        write(survey, tmp_path / name)
        back = sl.read(tmp_path / name)
        assert (back.rings.attrs["position_x"], back.rings_rear.attrs["position_x"]) == (FRONT, REAR)
        np.testing.assert_allclose(back.rings_rear["range"], survey.rings_rear["range"], atol=1e-4)
        np.testing.assert_allclose(back.rings_rear["time"], survey.rings_rear["time"], atol=1e-6)


def test_the_chain_uses_it_and_says_so(survey):
    result = sl.inspect(survey)
    assert any("rings of a second scanner, 0.400 m behind the first" in one for one in result.assumptions)
    assert result.mask_rear.sizes == result.rings_rear.sizes
    # Without a log it is what makes the rings worth estimating jointly.
    blind = sl.inspect(sl.Survey({"rings": survey.rings, "rings_rear": survey.rings_rear}, survey.attrs))
    assert np.isfinite(blind.pose["pitch"]).all()
    assert set(json.loads(blind.pose.attrs["why_missing"])) == {"roll"}


@pytest.mark.parametrize(
    ("attrs", "said"),
    [
        ({"position_x": FRONT}, "it stands 0 mm from the front one"),
        ({"position_x": None}, r"where both scanners stand on the robot \(position_x\) is not stated"),
        ({"referred_to": "axis"}, "not as the sensor saw them"),
    ],
)
def test_one_that_cannot_be_used_is_left_aside_with_the_reason(survey, attrs, said):
    rear = survey.rings_rear.isel(ring=slice(0, 300))
    kept = {key: value for key, value in (rear.attrs | attrs).items() if value is not None}
    rings = survey.rings.isel(ring=slice(0, 300))
    groups = {"rings": rings, "rings_rear": rear.drop_attrs().assign_attrs(kept)}
    (warning,) = [one for one in sl.inspect(sl.Survey(groups, survey.attrs)).warnings if "rear scanner" in one]
    assert re.search(said, warning)
