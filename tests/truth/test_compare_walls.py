"""Walls of simulated repeat inspections against truth; the long tables are in bench/compare_maps.py."""

from __future__ import annotations

import numpy as np
import pytest
from bench._compare_walls import again, off, repeat

from springline.compare import compare, match, refine, wall_of

DENT = (7.3, 3.0, 3.0)  # chainage, clock, depth in mm


@pytest.fixture(scope="module")
def rough():
    """Rough walls: from the same end with features, from the other end by relief alone, a dent in the second."""
    dent = f'{{ chainage = {DENT[0]}, clock_h = {DENT[1]}, depth = "{DENT[2]}mm", length = 0.3, width_deg = 40.0 }}'
    return [repeat(seed, length=12.0, other_end=end, dents=dent) for seed, end in ((3, False), (4, True))]


@pytest.fixture(scope="module")
def compared(rough):
    return [compare(a.result, b.result) for a, b in rough]


def test_rings_are_placed_within_millimetres_from_either_end(rough):
    for (a, b), turned in zip(rough, (False, True), strict=True):
        placed = refine(None, wall_of(a.result), wall_of(b.result))
        assert placed.reversed == turned
        error, sigma, fine = off(placed, a, b)
        # Two slips in 12 m take more than their 15 %: the share in longer pipes stands in the bench.
        assert fine.mean() >= 0.8
        assert np.sqrt(np.mean(error[fine] ** 2)) < 0.005
        assert np.mean(np.abs(error[fine]) < 1.96 * sigma[fine]) > 0.9


def test_roll_is_that_of_the_robots(rough):
    a, b = rough[0]
    placed = refine(None, wall_of(a.result), wall_of(b.result))
    x = a.counter[50:-50:20]
    roll_a = np.interp(x, a.counter, a.result.truth["roll"].values)
    roll_b = np.interp(placed.at(x)[0], b.counter, b.result.truth["roll"].values)
    wrong = placed.roll_at(x) - (roll_b - roll_a)
    assert np.degrees(np.sqrt(np.mean(wrong**2))) < 1.0


def test_a_smooth_wall_leaves_the_features_as_they_are():
    a, b = repeat(11, length=15.0, rms=0.0, slips=False, lateral_every=3.0)
    found = match(a.features, b.features)
    assert found
    placed = refine(found, wall_of(a.result), wall_of(b.result), (a.features, b.features))
    x = np.linspace(2.0, 11.0, 50)
    alone = np.sqrt(np.mean((found.drift.at(x)[0] - b.at(a.place(x))) ** 2))
    both = np.sqrt(np.mean((placed.at(x)[0] - b.at(a.place(x))) ** 2))
    assert both <= 1.15 * alone
    assert not placed.refined.any()


def test_a_dent_is_told_where_and_as_deep_as_it_is(rough, compared):
    for (a, _), found in zip(rough, compared, strict=True):
        patches = [c for c in found.changes if c.quantity == "patch"]
        assert len(patches) == 1
        (dent,) = patches
        assert dent.verdict == "change"
        assert abs(dent.chainage - a.at(np.array(DENT[0]))) < 0.03
        assert abs(1e3 * dent.change + DENT[2]) < 4.0 * 1e3 * dent.sigma
        assert abs(dent.length - 0.15) < 0.05


def test_another_robot_odometer_and_roll_are_no_change(compared):
    for found in compared:
        assert {c.quantity for c in found.changes} <= {"patch", "found"}


def test_the_stated_detectable_dent_is_that_of_its_noise(compared):
    # 1 mm in both, 10 mm by 1 degree: a cos^2 dent of 190 mm x 35 degrees at half depth spans 1330 readings' weight,
    # and one false alarm in 100 m over all sizes takes a score of about five.
    for found in compared:
        cells = 0.375**2 * 38 * 70
        best = (4.8 + 1.645) * np.sqrt(2.0) / np.sqrt(cells)
        assert best < 1e3 * found.detectable["patch"] < 1.6 * best


def test_another_pipe_is_refused(rough):
    a, _ = rough[0]
    other, _ = repeat(31, length=12.0)
    found = compare(a.result, other.result)
    assert not found
    assert "same pipe" in found.reason


def test_joints_that_look_alike_do_not_draw_the_rings_to_the_next():
    # Joints stand out more than the wall's relief does: taken for relief, one laid four metres on the next but one.
    a, b = again("hinged", 13)
    wall_a, wall_b = wall_of(a), wall_of(b)
    placed = refine(None, wall_a, wall_b)
    x = np.linspace(1.0, 18.5, 200)
    true_a, true_b = (s.truth["ring_chainage"].values for s in (a, b))
    y = np.interp(np.interp(x, wall_a.chainage, true_a), true_b, wall_b.chainage)
    assert placed.refined_at(x).all()
    assert np.abs(placed.at(x)[0] - y).max() < 0.005
