"""Sections and centres that marks leave alone, and the unrolled wall."""

import numpy as np
import pytest

from springline.geometry.deviation import radial_deviation
from springline.geometry.marks import (
    add_rings,
    at_readings,
    centre_rings,
    empty_map,
    lasting_shape,
    steady_shape,
    tracked_centres,
    wall_deviation,
)
from springline.geometry.marks.regions import regions, runs
from springline.geometry.marks.steps import jumps, peaks
from springline.geometry.marks.wallmap import confirmed

BEARINGS = np.radians(np.arange(0.0, 360.0, 1.0))


def ellipse_ring(centre_z, centre_y, a, b, phi):
    """Return ranges of an ellipse from an origin inside it, by marching along each ray."""
    cos, sin = np.cos(BEARINGS), np.sin(BEARINGS)
    low, high = np.zeros(BEARINGS.size), np.full(BEARINGS.size, 3.0 * a)
    for _ in range(60):
        r = 0.5 * (low + high)
        z, y = r * cos - centre_z, r * sin - centre_y
        u, v = z * np.cos(phi) + y * np.sin(phi), -z * np.sin(phi) + y * np.cos(phi)
        outside = (u / a) ** 2 + (v / b) ** 2 > 1.0
        low, high = np.where(outside, low, r), np.where(outside, r, high)
    return r


def section(a, b, phi):
    return [0.5 * (a + b), 0.5 * (a - b) * np.cos(2 * phi), 0.5 * (a - b) * np.sin(2 * phi)]


def test_deviation_is_zero_on_the_ellipse_and_agrees_with_the_slow_way():
    ring = ellipse_ring(0.01, -0.02, 0.16, 0.14, 0.7)[None]
    parameters = [[0.01, -0.02, *section(0.16, 0.14, 0.7)]]
    assert np.abs(wall_deviation(ring, BEARINGS, parameters)).max() < 1e-7
    out = ring * 1.05
    assert wall_deviation(out, BEARINGS, parameters) == pytest.approx(
        radial_deviation(out, BEARINGS, parameters), abs=1e-7
    )


def test_the_centre_is_found_beside_a_dent_a_hole_and_noise():
    rng = np.random.default_rng(0)
    ring = ellipse_ring(0.012, -0.006, 0.155, 0.145, 0.3) + 5e-4 * rng.standard_normal(360)
    ring[20:90] -= 0.02
    ring[200:240] = np.nan
    found = centre_rings([ring], BEARINGS, [section(0.155, 0.145, 0.3)], [[0.010, -0.008]], [5e-4])[0]
    assert found[:2] == pytest.approx([0.012, -0.006], abs=2e-4)
    assert found[2] == pytest.approx(0.0, abs=2e-4)
    assert found[4] == pytest.approx(1.0 - 70 / 320, abs=0.03)


def test_a_ring_in_a_groove_stands_out_all_round():
    ring = ellipse_ring(0.0, 0.0, 0.16, 0.16, 0.0)
    found = centre_rings([ring], BEARINGS, [[0.15, 0.0, 0.0]], [[0.0, 0.0]], [5e-4])[0]
    assert found[2] == pytest.approx(0.01, abs=1e-5)
    assert np.isnan(centre_rings([np.full(360, np.nan)], BEARINGS, [[0.15, 0, 0]], [[0, 0]], [5e-4])).all()


def test_centres_are_carried_across_short_stretches_only():
    distance = 0.01 * np.arange(100)
    placed = np.column_stack([0.1 * distance, np.zeros(100), np.zeros(100), np.full(100, 1e-4), np.ones(100)])
    placed[40:44, [0, 2]] = 0.5, 0.01
    centre, good = tracked_centres(distance, placed, most_offset=0.002, longest=0.2)
    assert centre[:, 0] == pytest.approx(0.1 * distance)
    assert good.sum() == 96
    placed[20:80, 2] = 0.01
    assert tracked_centres(distance, placed, most_offset=0.002, longest=0.2)[1].all()


def test_steady_sections_follow_the_pipe_and_not_its_marks():
    distance = 0.01 * np.arange(1000)
    shape = np.column_stack([0.15 + 0.001 * distance, np.zeros(1000), np.zeros(1000)])
    marked = shape.copy()
    marked[300:330, 0] += 0.01
    marked[::7] = np.nan
    assert np.abs(steady_shape(marked, distance, window=1.2) - shape)[100:900].max() < 3e-4
    assert np.isnan(steady_shape(np.full((5, 3), np.nan), np.arange(5.0), window=1.0)).all()


def test_cells_hold_what_was_put_into_them():
    distance, rng = 0.01 * np.arange(40), np.random.default_rng(2)
    deviation = rng.standard_normal((40, 360))
    deviation[3, :10] = np.nan
    missing, wet = np.isnan(deviation), np.zeros(deviation.shape, bool)
    cells = empty_map(distance, 360, length=0.02, columns=72)
    for first in (0, 16):
        part = slice(first, first + (16 if first == 0 else 24))
        add_rings(cells, first, deviation[part], missing[part], wet[part], far=2.0)
    kept = np.where(deviation > 2.0, np.nan, deviation)
    assert cells.mean[1, 5] == pytest.approx(np.nanmean(kept[2:4, 25:30]))
    assert cells.missing.sum() == 10 and cells.far.sum() == (deviation > 2.0).sum()
    assert cells.possible.sum() == deviation.size


def test_what_lasts_is_told_from_what_passes():
    shape = np.cos(np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False))
    mean = np.tile(shape, (200, 1))
    mean[90:100, 3:6] -= 5.0
    mean[50:60, 7] = np.nan
    assert lasting_shape(mean, window=120) == pytest.approx(np.tile(shape, (200, 1)))


def test_values_of_cells_run_smoothly_round_the_pipe():
    cells = empty_map([0.0, 0.01], 360, length=0.02, columns=36)
    values = np.cos(np.radians(np.arange(36) * 10.0 + 4.5))[None]
    assert at_readings([0], cells, values)[0] == pytest.approx(np.cos(BEARINGS), abs=0.005)


def test_one_row_alone_confirms_nothing():
    height = np.zeros((6, 12))
    height[2, 3:5] = -1.0
    assert (confirmed(height) == 0.0).all()
    height[3, 4] = -0.8
    assert confirmed(height)[2, 3:5].tolist() == [-0.8, -0.8]


def test_regions_close_round_the_pipe():
    flags = np.zeros((5, 10), bool)
    flags[1:3, [9, 0]] = True
    flags[4, 4:6] = True
    found = regions(flags)
    assert found.cells.tolist() == [4, 2]
    assert (found.first_column[0], found.columns[0], found.last_row[0]) == (9, 2, 2)
    assert len(regions(np.zeros((3, 4), bool)).cells) == 0
    assert runs([1, 0, 0, 1], bridge=2).tolist() == [[0, 3]]


def test_jumps_leave_slopes_alone_and_measure_steps_and_turns():
    x = np.cumsum(np.random.default_rng(1).uniform(0.008, 0.012, 60))
    at = 0.5 * (x[29] + x[30])
    y = 0.3 * x + np.where(x > at, 0.004 + 0.05 * (x - at), 0.0)
    found = jumps(x, y[:, None], [1e-4], window=8)
    assert found.step[30, 0] == pytest.approx(0.004, abs=1e-9)
    assert found.slope[30, 0] == pytest.approx(0.05, abs=1e-9)
    assert np.abs(found.step[10:20, 0]).max() < 1e-12
    assert np.isnan(found.step[1, 0])


def test_peaks_keep_their_distance():
    score = np.array([0.0, 3.0, 9.0, 3.0, 0.0, 5.0, 0.0, np.nan])
    assert peaks(score, np.arange(8.0), least=2.0, apart=2.0).tolist() == [2, 5]
