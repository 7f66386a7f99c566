"""The scan of difference maps: its threshold holds the stated rate, its dents are found as drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from springline.compare.difference import Difference
from springline.compare.scan import detectable, scan
from springline.compare.sharpen import dent_fit, depth_at
from springline.compare.templates import DISTINCT, bank, false_alarms, thresholds

STEP, ROWS, NOISE = 0.02, 120, 1e-3


def noise_map(seed, length=100.0):
    rng = np.random.default_rng(seed)
    x = np.arange(0.0, length, STEP)
    change = rng.normal(0.0, NOISE, (x.size, ROWS)).astype(np.float32)
    return Difference(
        chainage=x, chainage_b=x, bearing=np.arange(ROWS) * (2 * np.pi / ROWS), wall_a=change, wall_b=change,
        change=change, sigma=np.full_like(change, NOISE), why=np.zeros(change.shape, np.uint8), scale=0.0,
        scale_sigma=1e-5, pattern=np.zeros(ROWS), fine=np.ones(x.size, bool),
        radius=0.0, place_sigma=np.zeros(x.size), side_sigma=0.0,
    )  # fmt: skip


def add_dent(found, chainage, bearing, length, width, depth):
    """Draw a dent of a shape that is not the templates' own: a Gaussian with these half-depth sizes."""
    turn = np.mod(found.bearing - bearing + np.pi, 2 * np.pi) - np.pi
    along = np.exp(-4 * np.log(2) * ((found.chainage - chainage) / length) ** 2)
    around = np.exp(-4 * np.log(2) * (turn / width) ** 2)
    draw(found, depth * along[:, None] * around[None, :])


def draw(found, shape):
    """Add a shape without the first order of its rings: a dent moves the middle of its section."""
    first = (2.0 / ROWS) * (shape @ np.exp(1j * found.bearing))
    found.change[:] += (shape - (first[:, None] * np.exp(-1j * found.bearing)[None, :]).real).astype(np.float32)


def test_every_size_has_its_share_of_the_alarms():
    templates = bank(STEP, ROWS)
    limits = thresholds(templates, ROWS, STEP, 1.0)
    shares = [false_alarms(u, t, ROWS, STEP) for u, t in zip(limits, templates, strict=True)]
    assert np.allclose(shares, 1.0 / (DISTINCT * len(templates)))
    # Small dents have more places to appear in by chance.
    assert limits[0] == limits.max()
    assert limits[-1] == limits.min()


def test_noise_gives_about_one_alarm_in_100_m():
    told = sum(len(scan(noise_map(seed)).patches) for seed in range(5))
    assert told <= 13  # Poisson of mean 5: more in one case of a thousand


def test_the_rate_is_what_is_asked_for():
    told = sum(len(scan(noise_map(seed), rate=20.0).patches) for seed in range(3))
    # Mean 60 at most: alarms of neighbouring sizes fall together at so high a rate.
    assert 10 <= told <= 85


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_dent_is_found_and_measured(sign):
    found = noise_map(1, 20.0)
    add_dent(found, 7.31, 1.2, 0.25, 0.7, sign * 4e-3)
    patch = scan(found).patches[0]
    assert all(abs(p.chainage - 7.31) > 0.8 for p in scan(found).patches[1:]), "one dent is one patch"
    assert abs(patch.chainage - 7.31) < 0.03
    assert abs(patch.bearing - 1.2) < 0.1
    assert patch.change == pytest.approx(sign * 4e-3, rel=0.15)
    assert patch.length == pytest.approx(0.25, rel=0.3)
    assert patch.width == pytest.approx(0.7, rel=0.3)


def test_the_detectable_depth_is_told_in_95_percent():
    size = 0.25, np.radians(40.0)
    clean = noise_map(2, 60.0)
    depth = float(np.median(detectable(clean, scan(clean), *size, at_half_depth=True)))
    told = there = 0
    for seed in range(3):
        found = noise_map(50 + seed, 60.0)
        rng = np.random.default_rng(seed)
        places = np.arange(2.0, 58.0, 3.0) + rng.uniform(0, 0.5, 19)
        for x in places:
            bearing = rng.uniform(0, 2 * np.pi)
            turn = np.mod(found.bearing - bearing + np.pi, 2 * np.pi) - np.pi
            u, v = np.abs(found.chainage - x) / size[0], np.abs(turn) / size[1]
            shape = np.outer(
                np.where(u < 1, np.cos(np.pi * u / 2) ** 2, 0), np.where(v < 1, np.cos(np.pi * v / 2) ** 2, 0)
            )
            draw(found, -depth * shape)
        patches = scan(found).patches
        told += sum(any(abs(p.chainage - x) < 0.3 for p in patches) for x in places)
        there += len(places)
    assert 0.88 <= told / there <= 1.0


def test_dents_do_not_widen_the_scatter_they_are_judged_by():
    clean, found = noise_map(4, 20.0), noise_map(4, 20.0)
    for x in (3.0, 9.0, 15.0):
        add_dent(found, x, 1.0 + x, 0.2, 0.6, -6e-3)
    assert np.all(scan(found).inflation < 1.05 * scan(clean).inflation + 0.02)


def test_cells_that_are_not_known_are_left_out():
    found = noise_map(3, 20.0)
    add_dent(found, 10.0, 1.0, 0.2, 0.6, -6e-3)
    found.change[np.abs(found.chainage - 10.0) < 0.5] = np.nan
    assert all(abs(p.chainage - 10.0) > 0.4 for p in scan(found).patches)
    assert np.isnan(depth_at(found, 10.0, 1.0, 0.2, 0.6)[0])


def test_the_fit_of_a_dent_has_an_honest_sigma():
    off = []
    for seed in range(12):
        found = noise_map(200 + seed, 6.0)
        turn = np.mod(found.bearing - 1.0 + np.pi, 2 * np.pi) - np.pi
        u, v = np.abs(found.chainage - 3.0) / 0.2, np.abs(turn) / 0.6
        shape = np.outer(np.where(u < 1, np.cos(np.pi * u / 2) ** 2, 0), np.where(v < 1, np.cos(np.pi * v / 2) ** 2, 0))
        draw(found, -4e-3 * shape)
        fitted = dent_fit(found, 3.05, 1.1, 0.25, 0.5, -3e-3)
        off.append((fitted[4] + 4e-3) / fitted[5])
    assert np.abs(np.mean(off)) < 1.0
    assert 0.4 < np.std(off) < 1.8


@pytest.mark.parametrize("wave", [2.0, 3.0, 4.0])
def test_what_moves_whole_rings_is_no_patch(wave):
    found = noise_map(5, length=20.0)
    rows = np.abs(found.chainage - 8.0) < 0.08
    assert not scan(found).patches
    found.change[rows] += (1.5e-3 * np.cos(wave * found.bearing)).astype(np.float32)
    assert not scan(found).patches
    add_dent(found, 14.0, 1.0, 0.16, 0.5, -1.5e-3)
    assert [round(p.chainage) for p in scan(found).patches] == [14]


def test_a_slope_of_the_wall_that_tilt_may_have_moved_is_no_patch():
    found = noise_map(6, length=20.0)
    dent = noise_map(7, length=20.0)
    dent.change[:] = 0.0
    add_dent(dent, 8.0, 1.0, 0.1, 0.5, -40e-3)
    # Both inspections see the dent; the second, tilted by another degree, sees it 8 mm further on.
    found = replace(found, wall_a=dent.change, wall_b=dent.change)
    found.change[:] += (0.008 * np.gradient(dent.change, STEP, axis=0)).astype(np.float32)
    assert scan(found).patches
    assert not scan(replace(found, side_sigma=0.008)).patches
