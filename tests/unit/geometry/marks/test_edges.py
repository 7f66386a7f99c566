"""Pipe ends told from rings: what a spacing allows, and no more."""

import numpy as np
import pytest

from springline.geometry.marks.edges import crossings, edge_between

BEARINGS = np.radians(np.arange(0.0, 360.0, 2.0))
SPACING = 1e-3


def between(places, spacing=SPACING):
    below = np.floor(places / spacing) * spacing
    return edge_between(below, below + spacing, BEARINGS)


def test_a_square_ring_knows_no_more_than_its_spacing():
    edge = between(np.full(BEARINGS.size, 0.01037))
    assert edge.plane[0] == pytest.approx(0.0105, abs=1e-5)
    # uniform over a spacing: its one-sigma is the spacing over the root of twelve, and a little for raggedness
    assert 1.0 <= np.sqrt(edge.covariance[0, 0]) / (SPACING / np.sqrt(12.0)) < 1.3


def test_a_tilted_ring_knows_the_middle_far_better_than_its_spacing():
    edge = between(0.0103 + 0.006 * np.cos(BEARINGS - 1.0))
    assert edge.plane == pytest.approx([0.0103, 0.006 * np.cos(1.0), 0.006 * np.sin(1.0)], abs=5e-5)
    assert np.sqrt(edge.covariance[0, 0]) < 0.2 * SPACING


@pytest.mark.parametrize("tilt", [0.0, 0.0003, 0.001, 0.01])
def test_intervals_hold_the_edge(tilt):
    rng = np.random.default_rng(3)
    held = []
    for _ in range(60):
        middle, turn = rng.uniform(0.0, 0.01), rng.uniform(0.0, 2.0 * np.pi)
        edge = between(middle + tilt * np.cos(BEARINGS - turn))
        held.append(abs(edge.plane[0] - middle) < 1.96 * np.sqrt(edge.covariance[0, 0]))
    assert np.mean(held) >= 0.9


def test_a_few_stray_bearings_do_not_move_the_edge():
    places = 0.0103 + 0.004 * np.sin(BEARINGS)
    places[::30] += 0.02
    assert between(places).plane[0] == pytest.approx(0.0103, abs=1e-4)


def test_too_few_bearings_give_no_edge():
    before = np.full(BEARINGS.size, np.nan)
    before[:7] = 0.0
    assert edge_between(before, before + SPACING, BEARINGS) is None


def test_missing_readings_widen_what_is_known():
    inside = np.array([[False], [False], [True], [True]])
    known = np.array([[True], [False], [False], [True]])
    before, after = crossings(inside, known, np.arange(4.0))
    assert (before[0], after[0]) == (0.0, 3.0)
    before, after = crossings(~inside, known, np.arange(4.0))
    assert np.isnan(before[0]) and np.isnan(after[0])
