"""What a difference of two walls leaves out, and what of it is roll: on walls drawn by hand."""

from __future__ import annotations

import numpy as np

from springline.compare.edges import at_joints, joint_rows
from springline.compare.refine import _turns
from springline.compare.shape import roll_left

STEP, ROWS, NOISE = 0.01, 180, 1e-3
BEARING = np.arange(ROWS) * (2 * np.pi / ROWS)


def section(length, oval):
    """Return the radius of an oval pipe with a flat side (n, m) [m]."""
    shape = 0.15 + oval * np.cos(2 * BEARING) + 0.3 * oval * np.cos(3 * (BEARING - 0.4))
    return np.broadcast_to(shape, (round(length / STEP), ROWS)).copy()


def turned(radius, roll):
    return np.array([np.interp(BEARING - r, BEARING, row, period=2 * np.pi) for row, r in zip(radius, roll)])  # noqa: B905


def test_the_roll_left_over_is_taken_from_an_oval_wall():
    rng = np.random.default_rng(1)
    a = section(3.0, 5e-3)
    roll = np.radians(1.5) * np.sin(np.arange(len(a)) * STEP * 2.0)
    noise = 0.2 * NOISE
    change = (turned(a, roll) - a + rng.normal(0, noise, a.shape)).astype(np.float32)
    left = change - roll_left(change, a, np.zeros(a.shape), np.full(len(a), np.radians(1.0)), STEP)
    assert np.std(change) > 1.1 * noise
    assert abs(np.std(left) - noise) < 0.01 * noise


def test_a_round_wall_keeps_its_dent_whatever_the_roll():
    rng = np.random.default_rng(2)
    a = section(3.0, 0.0)
    x = np.arange(len(a)) * STEP
    bump = np.exp(-(((x - 1.5) / 0.1) ** 2))[:, None] * np.exp(-(((BEARING - 2.0) / 0.3) ** 2))[None, :]
    change = (-3e-3 * bump + rng.normal(0, NOISE, a.shape)).astype(np.float32)
    taken = roll_left(change, a, 0.5 * change.astype(float), np.full(len(a), np.radians(1.0)), STEP)
    kept = float(np.sum((change - taken) * bump) / np.sum(change * bump))
    assert abs(kept - 1.0) < 0.02


def test_a_joint_is_found_among_stray_readings():
    rng = np.random.default_rng(3)
    n = 1000
    wall = rng.normal(0, NOISE, (n, ROWS))
    stray = rng.random(wall.shape) < 0.04
    wall[stray] += rng.choice([-1, 1], stray.sum()) * rng.uniform(0.01, 0.1, stray.sum())
    wall[500:502, :60] += 0.01
    parameters = np.column_stack((np.full(n, 0.15), np.zeros((n, 2))))
    out = joint_rows(wall, np.ones(wall.shape, bool), parameters, STEP)
    assert out[499:503].all()
    assert out.mean() < 0.02


def test_a_joint_that_is_listed_is_left_out_with_its_gap():
    x = np.arange(0.0, 5.0, STEP)
    out = at_joints(x, np.array([[2.0, 0.1], [4.0, np.nan]]), STEP)
    assert out[np.abs(x - 2.0) < 0.06].all()
    assert out[np.abs(x - 4.0) < 0.02].all()
    assert not out[(np.abs(x - 2.0) > 0.09) & (np.abs(x - 4.0) > 0.05)].any()
    assert not at_joints(x, np.empty((0, 2)), STEP).any()
    assert not at_joints(np.array([np.nan]), np.array([[2.0, 0.1]]), STEP).any()


def test_a_roll_that_jumps_away_and_back_is_flagged_on_both_sides():
    roll = np.radians([0.0, 1.0, 172.0, 2.0, 5.0, 359.0, 354.0])
    spans = _turns(np.arange(7) * 0.5, roll)
    assert [(s.start, s.end) for s in spans] == [(0.5, 1.0), (1.0, 1.5)]
