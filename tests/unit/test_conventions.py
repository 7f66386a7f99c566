"""The one table: names are consistent, frames are as stated, the docs page tells the same."""

import importlib.util
from math import cos, degrees, pi, radians, sqrt, tan
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from springline.conventions import (
    GROUPS,
    STATION_COLUMNS,
    SURVEY_FOLDER_KEYS,
    bearing_from_clock,
    clock_from_bearing,
)
from springline.imaging.lens_table import _KEYS

ROOT = Path(__file__).parents[2]


@given(st.floats(-20, 20))
def test_clock_and_bearing_undo_each_other(bearing):
    clock = clock_from_bearing(bearing)
    assert 0 < clock <= 12
    assert cos(bearing_from_clock(clock) - bearing) == pytest.approx(1, abs=1e-12)


def test_clock_runs_clockwise_looking_forward():
    assert list(clock_from_bearing(np.radians([90, 60, 0, -90, 180]))) == pytest.approx([12, 1, 3, 6, 9])


def test_worked_example_of_the_frame():
    a = 1 / sqrt(1 + 2 * tan(radians(10)) ** 2)
    assert (a, a * tan(radians(10))) == pytest.approx((0.97029, 0.17109), abs=5e-6)
    # Pitch first, then yaw about the pitched y axis: the robot's z axis against the direct frame's.
    forward = np.array([a, a * tan(radians(10)), a * tan(radians(10))])
    pitched_y = np.array([-np.sin(radians(10)), np.cos(radians(10)), 0])
    stepwise_z = np.cross(forward, pitched_y)
    turn = np.cross([1, 0, 0], forward)
    angle = np.arccos(forward[0])
    axis = turn / np.linalg.norm(turn)
    z = np.array([0, 0, 1.0])
    direct_z = z * cos(angle) + np.cross(axis, z) * np.sin(angle) + axis * (axis @ z) * (1 - cos(angle))
    direct_y = np.cross(direct_z, forward)
    roll = degrees(np.arctan2(stepwise_z @ direct_y, stepwise_z @ direct_z))
    assert roll == pytest.approx(-0.86, abs=5e-3)


def test_every_station_column_stands_in_the_contract():
    for column in STATION_COLUMNS:
        group = GROUPS[column.group]
        listed = {v.name for v in group.variables}
        assert column.variable in listed or group.open, column.name
    assert len({c.name for c in STATION_COLUMNS}) == len(STATION_COLUMNS) == 46


def test_units_at_the_edge_follow_the_column_names():
    factors = {"_mm": 1e3, "_pct": 1e2, "_deg": 180 / pi, "_m": 1.0, "_m2": 1.0}
    for column in STATION_COLUMNS:
        for ending, factor in factors.items():
            if column.name.endswith(ending):
                assert column.factor == factor, column.name


def test_docs_page_is_made_from_the_table():
    spec = importlib.util.spec_from_file_location("make_contract", ROOT / "docs" / "make_contract.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert (ROOT / "docs" / "contract.md").read_text(encoding="utf-8") == module.contract()


def test_every_key_of_a_lens_stands_in_the_contract():
    told = SURVEY_FOLDER_KEYS["lens"]
    assert [key for key in _KEYS if key not in told] == ["source", "sigma"]
