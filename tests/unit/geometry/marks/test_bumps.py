"""Depths of bumps of several forms, none of them the surface that is fitted."""

import numpy as np
import pytest

from springline.geometry.marks import size_bump

BEARING = np.radians(np.arange(-120.0, 120.0, 1.0))
RADIUS = 0.15

FORMS = {
    "cosine": lambda u, v: np.cos(0.5 * np.pi * np.clip(u, -1, 1)) ** 2 * np.cos(0.5 * np.pi * np.clip(v, -1, 1)) ** 2,
    "bell": lambda u, v: np.exp(-3.0 * (u**2 + v**2)),
    "cap": lambda u, v: np.clip(1.0 - u**2 - v**2, 0.0, None),
}


def wall(form, depth, *, spacing=0.002, noise=0.0, seed=0):
    x = np.arange(0.0, 0.5, spacing)
    u, v = np.meshgrid((x - 0.26) / 0.1, (BEARING - 0.1) / 0.4, indexing="ij")
    rng = np.random.default_rng(seed)
    return x, -depth * FORMS[form](u, v) + noise * rng.standard_normal(u.shape)


def sized(x, height, noise, **options):
    return size_bump(
        x, BEARING, height, (0.25, 0.05), radius=RADIUS, reach=(0.15, 0.6), noise=noise, alike=1.0, **options
    )


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("depth", [0.003, 0.02])
def test_depth_of_any_smooth_bump(form, depth):
    found = sized(*wall(form, depth), 1e-4)
    assert -found.depth[0] == pytest.approx(depth, rel=0.03)
    assert found.x[0] == pytest.approx(0.26, abs=0.005)
    assert found.bearing[0] == pytest.approx(0.1, abs=0.02)


def test_extents_are_where_a_tenth_of_the_depth_is_left():
    found = sized(*wall("cosine", 0.01), 1e-4)
    tenth = 2.0 / np.pi * np.arccos(np.sqrt(0.1))
    assert found.length[0] == pytest.approx(0.2 * tenth, rel=0.03)
    assert found.span[0] == pytest.approx(0.8 * tenth, rel=0.03)


def test_intervals_of_depth_hold():
    held, errors = [], []
    for seed in range(60):
        found = sized(*wall("cosine", 0.006, spacing=0.005, noise=1e-3, seed=seed), 1e-3)
        errors.append(found.depth[0] + 0.006)
        held.append(abs(errors[-1]) < 1.96 * found.depth[1])
    assert np.mean(held) >= 0.88
    assert np.sqrt(np.mean(np.square(errors))) < 0.4e-3


def test_a_hole_in_the_readings_is_bridged_and_no_readings_are_no_bump():
    x, height = wall("cosine", 0.01, noise=2e-4)
    height[np.random.default_rng(1).random(height.shape) < 0.4] = np.nan
    assert sized(x, height, 2e-4).depth[0] == pytest.approx(-0.01, abs=4e-4)
    assert sized(x, np.full(height.shape, np.nan), 2e-4) is None
