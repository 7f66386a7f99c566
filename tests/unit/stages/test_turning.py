"""A run that comes back, parted at its turn."""

import numpy as np
import pytest
import xarray as xr

from springline.stages.turning import out_and_back
from springline.survey import Survey
from springline.survey.turning import turn_of

BEARINGS = np.arange(24) * 2 * np.pi / 24


def run(distance, groups=None, **attrs):
    distance = np.asarray(distance, float)
    time = 3.0 + np.arange(len(distance))
    rings = xr.Dataset(
        {
            "range": (("ring", "bearing"), np.full((len(distance), 24), 0.15, "float32")),
            "bearing": ("bearing", BEARINGS),
            "distance": ("ring", distance),
            "time": ("ring", time),
        }
    )
    log = xr.Dataset({"time": ("sample", np.arange(0.0, 10.0 + len(distance), 0.5))})
    return Survey({"rings": rings, "inertial": log, **(groups or {})}, attrs)


@pytest.mark.parametrize(
    ("distance", "turn"),
    [
        ([*range(12), *range(10, -1, -1)], 11),
        ([*range(12), *range(11, 0, -1)], 11),
        ([*range(12), 11, 11, *range(10, 0, -1)], None),
        ([*range(12), *range(10, 3, -1)], None),
        ([*range(9), *range(7, -20, -1)], None),
        ([*range(30)], None),
        ([*range(30, 0, -1)], None),
        ([*range(12), *range(10, 0, -1), *range(12)], None),
        ([*range(12), np.nan, *range(10, -1, -1)], None),
        ([0.0], None),
        ([], None),
    ],
)
def test_one_turn_with_enough_rings_either_way_is_found(distance, turn):
    assert turn_of(np.array(distance, float)) == turn


def test_rings_and_log_are_parted_at_the_turn_and_ties_hold_for_both():
    ties = xr.Dataset({name: ("tie", [1.0]) for name in ("distance", "easting", "northing", "elevation", "sigma")})
    out, back = out_and_back(run([*range(12), *range(10, -1, -1)], {"ties": ties, "truth": xr.Dataset()}, name="a"))
    assert out.rings["distance"].values.tolist() == list(range(12))
    assert back.rings["distance"].values.tolist() == list(range(10, -1, -1))
    # The robot stood between ring 11, at 14 s, and ring 12, at 15 s.
    assert out.inertial["time"].values[-1] == 15.0
    assert back.inertial["time"].values[0] == 14.0
    assert back.has("ties") and not back.has("truth")
    assert back.attrs == {"name": "a", "facing": "backwards"}
    assert "comes back" in out.assumptions[-1]


def test_a_run_that_does_not_come_back_is_left_as_it_is():
    survey = run(range(30))
    assert out_and_back(survey) == (survey, None)
    assert out_and_back(Survey({}))[1] is None
