"""Joints sized from rings: what is not known shows in the sigma."""

import numpy as np
import pytest

from springline.geometry.marks import size_gap, size_step
from springline.geometry.marks.cuts import cut_ends

BEARINGS = np.radians(np.arange(0.0, 360.0, 3.0))
NOISE = np.full(3, 4e-5)


def _way(rng, x, bend):
    """A robot's way whose direction wanders by `bend` [rad] over 0.1 m."""
    fine = np.arange(x[0], x[-1] + 1e-3, 1e-3)
    turn = np.cumsum(rng.normal(0.0, bend * np.sqrt(1e-3 / 0.1), (len(fine), 3)), axis=0)
    return np.stack([np.interp(x, fine, 1e-3 * np.cumsum(column)) for column in turn.T], axis=1)


@pytest.mark.parametrize(("spacing", "bend"), [(0.012, 0.0), (0.012, 0.01), (0.012, 0.04), (0.002, 0.01)])
def test_steps_hold_the_truth_however_the_robot_winds(spacing, bend):
    rng = np.random.default_rng(5)
    x = np.arange(-0.4, 0.4, spacing) + 0.3 * spacing
    step, turn, scores = np.array([0.006, -0.002, 0.001]), np.array([0.005, -0.004, 0.0]), []
    for _ in range(60):
        values = _way(rng, x, bend) + rng.normal(0.0, NOISE, (len(x), 3))
        values += np.where(x > 0.0, 1.0, 0.0)[:, None] * step + np.maximum(x, 0.0)[:, None] * turn
        found = size_step(x, values, 0.0, at_sigma=0.0, reach=0.004, noise=NOISE)
        scores.append((found.step - step) / found.step_sigma)
    held = np.mean(np.abs(scores) < 1.96)
    assert 0.9 <= held <= 1.0
    assert np.sqrt(np.mean(np.square(scores))) > 0.5  # no sigma so wide that it says nothing


def test_a_winding_way_makes_steps_doubtful():
    x = np.arange(-0.4, 0.4, 0.012)
    sigma = [
        size_step(x, _way(np.random.default_rng(k), x, bend), 0.001, at_sigma=0.0, reach=0.0, noise=NOISE).step_sigma[0]
        for bend, k in ((0.0, 1), (0.05, 1))
    ]
    assert sigma[1] > 2.0 * sigma[0]


def test_too_few_rings_on_a_side_tell_nothing():
    x = np.arange(8.0) * 0.01
    assert size_step(x, np.zeros((8, 3)), 0.015, at_sigma=0.0, reach=0.0, noise=NOISE) is None
    assert size_step(x, np.full((8, 3), np.nan), 0.04, at_sigma=0.0, reach=0.0, noise=NOISE) is None


def _cut(gap, tilt, place, spacing=0.012, strays=0.0, seed=0):
    rng = np.random.default_rng(seed)
    x = spacing * np.arange(-3.0, 5.0)
    off = x[:, None] - place - tilt * np.cos(BEARINGS - 1.0)
    inside = (np.abs(off) < 0.5 * gap) ^ (rng.random(off.shape) < strays)
    return x, inside


def test_gaps_of_cut_rings_hold_the_truth():
    rng = np.random.default_rng(7)
    scores = []
    for k in range(24):
        gap, tilt, place = rng.uniform(0.001, 0.006), rng.uniform(0.004, 0.009), rng.uniform(0.0, 0.012)
        x, inside = _cut(gap, tilt, place, strays=0.002, seed=k)
        if inside.any(axis=0).sum() < 8:
            continue
        mean, covariance = cut_ends(inside, np.ones(inside.shape, bool), x, BEARINGS, radius=0.15)
        sigma = np.sqrt(covariance[0, 0] + covariance[3, 3] - 2.0 * covariance[0, 3] + 2.0 * 0.0012**2)
        scores.append((mean[3] - mean[0] - gap) / sigma)
    assert len(scores) > 15
    assert 0.88 <= np.mean(np.abs(scores) < 1.96) <= 1.0


def test_one_ring_in_a_joint_leaves_it_narrow_or_wide():
    x = 0.012 * np.arange(-3.0, 4.0)
    deep = np.where(np.abs(x)[:, None] < 0.001, 0.01, 0.0) + np.zeros((1, len(BEARINGS)))
    found = size_gap(deep, deep, x, BEARINGS, noise=5e-4, radius=0.15)
    assert 0.5 * 0.012 < found.gap < 0.9 * 0.012
    assert found.gap - 1.96 * found.gap_sigma < 0.001 and found.gap + 1.96 * found.gap_sigma > 1.5 * 0.012


def test_nothing_that_stands_back_is_no_gap():
    x = 0.012 * np.arange(-3.0, 4.0)
    plain = np.zeros((len(x), len(BEARINGS)))
    assert size_gap(plain, plain, x, BEARINGS, noise=5e-4, radius=0.15) is None
    assert size_gap(plain[:1] + 0.01, plain[:1] + 0.01, x[:1], BEARINGS, noise=5e-4, radius=0.15) is None
    assert size_gap(np.full_like(plain, np.nan), plain, x, BEARINGS, noise=5e-4, radius=0.15) is None
