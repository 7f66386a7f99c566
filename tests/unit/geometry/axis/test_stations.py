"""Cells of stations and bearings, and which stations can be trusted."""

import numpy as np
import pytest

from springline.geometry.axis._rows import row_median
from springline.geometry.axis.centreline import Placed
from springline.geometry.axis.stations import cut_stations, longest_stretch, trusted


def placed(along, theta, rho):
    return Placed(np.asarray(along), rho * np.sin(theta), rho * np.cos(theta))


def test_every_point_falls_into_the_cell_about_its_bearing():
    theta = np.radians([0.0, 89.0, 181.0, -4.0])
    cut = cut_stations(placed([0.05, 0.15, 0.15, 0.25], theta, np.array([0.1, 0.2, 0.3, 0.4])), 0.0, 0.1, 3, 36, 1.0)
    assert cut.distance == pytest.approx([0.05, 0.15, 0.25])
    rows, columns = np.nonzero(np.isfinite(cut.ranges))
    assert list(zip(rows.tolist(), columns.tolist(), strict=True)) == [(0, 0), (1, 9), (1, 18), (2, 0)]
    assert cut.ranges[rows, columns] == pytest.approx([0.1, 0.2, 0.3, 0.4])
    assert cut.count.sum() == 4


def test_a_cell_without_points_is_nan_and_far_points_are_left_out():
    cut = cut_stations(placed([0.05, 0.05], np.zeros(2), np.array([0.1, 5.0])), 0.0, 0.1, 1, 8, 1.0)
    assert np.isfinite(cut.ranges).sum() == 1
    assert cut.count.sum() == 1


def test_a_cells_range_is_robust_and_finer_than_the_quantum_of_its_points():
    rng = np.random.default_rng(0)
    rho = np.round(0.1503 + 0.001 * rng.standard_normal(40_000), 3)
    rho[::20] = 0.25
    cut = cut_stations(
        placed(rng.uniform(0.0, 0.1, 40_000), rng.uniform(-np.pi, np.pi, 40_000), rho), 0.0, 0.1, 1, 36, 1.0
    )
    assert cut.ranges.mean() == pytest.approx(0.1503, abs=5e-5)
    assert cut.ranges.std() < 1e-4


def test_only_stations_that_show_wall_are_trusted():
    rng = np.random.default_rng(0)
    ranges = 0.15 + 0.001 * rng.standard_normal((5, 72))
    ranges[1] = np.nan
    ranges[2] = rng.uniform(0.02, 0.29, 72)
    ranges[3, 4:] = np.nan
    ranges[4, :30] = 0.07
    stations = cut_stations(placed([0.0], np.zeros(1), np.ones(1)), 0.0, 1.0, 5, 72, 2.0)
    stations = type(stations)(stations.distance, ranges, stations.bearings, stations.count)
    assert trusted(stations, 0.15, 0.5).tolist() == [True, False, False, True, True]
    assert trusted(stations, 0.15, 0.7).tolist() == [True, False, False, True, False]


def test_an_oval_station_is_trusted_when_its_pipe_is_oval():
    bearings = np.arange(72) * np.pi / 36
    ranges = 0.15 * (1.0 + 0.1 * np.cos(2.0 * bearings))[None]
    stations = cut_stations(placed([0.0], np.zeros(1), np.ones(1)), 0.0, 1.0, 1, 72, 2.0)
    stations = type(stations)(stations.distance, ranges, stations.bearings, stations.count)
    assert not trusted(stations, 0.15, 0.5)[0]
    assert trusted(stations, 0.15, 0.5, (0.1, 0.0))[0]


def test_longest_stretch_bridges_short_gaps_only():
    good = np.array([1, 1, 0, 1, 1, 0, 0, 0, 0, 0, 1, 1, 1], bool)
    assert longest_stretch(good, np.ones(13), 0.5) == slice(0, 5)
    assert longest_stretch(good, np.ones(13), 0.1) == slice(0, 13)
    assert longest_stretch(np.zeros(4, bool), np.ones(4), 1.0) == slice(0, 0)


def test_row_median_is_numpys():
    values = np.random.default_rng(0).normal(size=(20, 9))
    values[values > 1.0] = np.nan
    assert row_median(values) == pytest.approx(np.nanmedian(values, axis=1))
