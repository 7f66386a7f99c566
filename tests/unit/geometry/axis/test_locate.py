"""Pipes are found where they are, whatever unit, bend or clutter; other things are refused."""

import numpy as np
import pytest

from springline.errors import InputError
from springline.geometry.axis import locate_pipe
from springline.geometry.axis.search import find_cylinder

from .clouds import NOT_PIPES, bent_tube, haze, tube


def away_from_axis(line, places):
    """Distance of a centreline's places from the straight axis through the origin along (1, 0.1, -0.05)."""
    x = np.array([1.0, 0.1, -0.05]) / np.linalg.norm([1.0, 0.1, -0.05])
    points = line.at(np.asarray(places))
    return np.linalg.norm(points - (points @ x)[:, None] * x, axis=1)


def test_straight_pipe_axis_radius_and_extent():
    located = locate_pipe(tube())
    assert located.centreline.straight
    assert located.pooled.diameter == pytest.approx(0.3, abs=4 * located.pooled.diameter_sigma)
    assert located.pooled.diameter_sigma < 2e-4
    assert away_from_axis(located.centreline, located.stations.distance).max() < 3e-4
    assert located.stations.distance[-1] - located.stations.distance[0] == pytest.approx(2.0, abs=0.05)
    assert located.trusted.all() and located.doubt == 0.0 and located.share > 0.95


@pytest.mark.parametrize("unit", [1000.0, 0.01])
def test_search_knows_no_unit(unit):
    found = find_cylinder(tube(20_000) * unit)
    assert found.cylinder.radius == pytest.approx(0.15 * unit, rel=0.01)
    assert found.share > 0.95


def test_axis_runs_along_the_clouds_forward():
    mirrored = tube() * np.array([-1.0, 1.0, -1.0])
    for points in (tube(), mirrored):
        assert locate_pipe(points).centreline.direction(np.zeros(1))[0, 0] > 0.9


def test_bend_is_followed_and_the_radius_stays_true_in_it():
    located = locate_pipe(bent_tube())
    line, distance = located.centreline, located.stations.distance
    assert not line.straight
    assert distance[-1] - distance[0] == pytest.approx(4.0 + np.pi / 2, abs=0.1)
    assert located.pooled.diameter == pytest.approx(0.4, abs=4e-4)
    ring_radius = np.nanmean(located.stations.ranges[3:-3], axis=1)
    assert ring_radius == pytest.approx(0.2, abs=1e-3)


def test_slight_sag_is_followed_too():
    points = tube(150_000, 12.0, forward=(1.0, 0.0, 0.0))
    points[:, 1] -= 0.04 * np.sin(np.pi * points[:, 0] / 12.0)
    located = locate_pipe(points)
    assert not located.centreline.straight
    middle = located.centreline.at(np.array([located.centreline.length / 2]))[0]
    assert middle[1] == pytest.approx(-0.04, abs=0.004)


@pytest.mark.parametrize("oval", [0.05, 0.10])
def test_deflected_pipe_is_a_pipe(oval):
    located = locate_pipe(tube(oval=oval, forward=(1.0, 0.0, 0.0)))
    assert located.pooled.oval_cos == pytest.approx(0.15 * oval, abs=2e-4)
    assert located.pooled.mean_radius == pytest.approx(0.15, abs=2e-4)


def test_speckle_and_scenery_do_not_move_the_axis():
    clutter = haze(30_000) * 0.5 + np.array([1.0, 0.0, 0.0])
    beyond = np.random.default_rng(8).uniform([4.0, -2.0, -2.0], [9.0, 2.0, 2.0], (5000, 3))
    located = locate_pipe(np.concatenate([tube(), clutter, beyond]))
    assert located.pooled.diameter == pytest.approx(0.3, abs=3e-4)
    assert located.stations.distance[-1] - located.stations.distance[0] == pytest.approx(2.0, abs=0.1)


def test_same_points_from_another_file_give_the_same_diameter():
    points = tube(arc=(0.6, 2.5), noise=0.002)
    points = np.round(points, 3)
    other = points + np.random.default_rng(1).uniform(-1e-6, 1e-6, points.shape)
    first, second = (locate_pipe(cloud).pooled for cloud in (points, other))
    assert abs(second.diameter - first.diameter) < 0.1 * first.diameter_sigma
    assert abs(first.diameter - 0.3) < 1.96 * first.diameter_sigma
    assert first.diameter_sigma > 1e-4


@pytest.mark.parametrize("name", sorted(NOT_PIPES))
def test_what_is_not_a_pipe_is_refused_with_what_was_found(name):
    with pytest.raises(InputError, match=r"not of a pipe: .*(no cylinder|explains \d+ %)"):
        locate_pipe(NOT_PIPES[name]())


def test_depth_image_of_a_duct_is_refused_for_its_side_walls():
    rng = np.random.default_rng(0)
    across = rng.uniform(-0.9, 0.9, (40_000, 2)) * np.array([0.7, 1.0])
    depth = np.minimum(0.1 / np.abs(across).max(axis=1), 1.0)
    points = np.round(depth, 3)[:, None] * np.column_stack([np.ones(len(across)), across])
    with pytest.raises(InputError, match="side walls"):
        locate_pipe(points, looking=True)


def test_few_points_are_refused():
    with pytest.raises(InputError, match="not of a pipe"):
        locate_pipe(haze(40))
