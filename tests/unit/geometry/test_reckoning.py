"""Dead reckoning against the simulator's own centreline, and what is missing or refused."""

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.reckoning import along_path, reckon
from springline.simulate import parse
from springline.simulate.building import build_pipe

PIPE = """
name = "bends"
[pipe]
diameter = "300mm"
heading_deg = 200.0
gradient = 0.03
start = [0.0, 0.0, 0.0]
run = [
    { kind = "straight", length = 2.0 },
    { kind = "bend", radius = 0.9, angle_deg = 90.0, towards = "right" },
    { kind = "straight", length = 1.5 },
    { kind = "bend", radius = 1.4, angle_deg = 40.0, towards = "up" },
    { kind = "straight", length = 1.0 },
]
[rings]
spacing = "0.5m"
"""


def test_a_simulated_pipe_is_reckoned_exactly_from_the_joins_of_its_straights_and_bends():
    line = build_pipe(parse(PIPE).pipe).centreline
    joins = np.cumsum([0.0, 2.0, 0.9 * np.pi / 2, 1.5, 1.4 * np.radians(40.0), 1.0])
    _, frames = line.at(joins)
    east, north, up = frames[:, 0].T
    heading, inclination = np.arctan2(east, north), np.arcsin(up)
    chainage = np.linspace(0.0, joins[-1], 200)
    axis, _ = line.at(chainage)
    np.testing.assert_allclose(along_path(chainage, joins, heading, inclination), axis, atol=1e-9)
    np.testing.assert_allclose(reckon(joins, heading, inclination).radius[[1, 3]], [0.9, 1.4], rtol=1e-9)


def test_many_paths_are_reckoned_at_once_and_a_missing_direction_ends_one():
    heading = np.radians([[0.0, 10.0, 20.0], [0.0, np.nan, 20.0]])
    found = reckon([0.0, 1.0, 2.0], heading, 0.0).position
    assert found.shape == (2, 3, 3)
    assert np.isfinite(found[0]).all() and np.isnan(found[1, 1:]).all() and (found[1, 0] == 0).all()
    np.testing.assert_array_equal(found[0], reckon([0.0, 1.0, 2.0], heading[0], 0.0).position)


def test_a_long_arc_of_tiny_turns_closes_on_its_circle():
    n = 100_000
    found = reckon(np.linspace(0, 2 * np.pi, n), np.linspace(0, 2 * np.pi, n), 0.0)
    assert np.linalg.norm(found.position[-1]) < 1e-9
    np.testing.assert_allclose(found.radius, 1.0, rtol=1e-6)


def test_outside_the_stations_nothing_is_known():
    found = along_path([-0.1, 0.0, 2.0, 2.1], [0.0, 1.0, 2.0], [0.0, 0.1, 0.1], 0.0)
    assert np.isnan(found[[0, 3]]).all() and np.isfinite(found[1:3]).all()


def test_what_is_no_path_is_refused():
    with pytest.raises(ParameterError, match="distance between stations"):
        reckon([0.0, 2.0, 1.0], [0.0, 0.0, 0.0], 0.0)
    with pytest.raises(ParameterError, match="turn within a stretch"):
        reckon([0.0, 1.0], [0.0, np.pi], 0.0)
    with pytest.raises(ParameterError, match="one number"):
        reckon(1.0, 0.0, 0.0)
