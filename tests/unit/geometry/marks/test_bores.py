"""A bore fitted to what readings say, against intersections of cylinders cast here."""

import numpy as np
import pytest

from springline.geometry.marks import fit_bore

RADIUS, HALF = 0.15, np.radians(85.0)


def opening(x0, bearing, bore, lean, *, spacing=0.005):
    """Return the grid of readings and which lie in a bore whose axis meets the wall at (x0, bearing)."""
    x = np.arange(0.0, 0.35, spacing)[:, None]
    theta = np.arange(bearing - HALF, bearing + HALF, np.radians(1.0))[None, :]
    x, theta = np.broadcast_arrays(x, theta)
    points = np.stack([x, RADIUS * np.sin(theta), RADIUS * np.cos(theta)], axis=-1)
    out = np.array([0.0, np.sin(bearing), np.cos(bearing)])
    axis = np.cos(lean) * out + np.sin(lean) * np.array([1.0, 0.0, 0.0])
    off = points - np.array([x0, 0.0, 0.0]) - RADIUS * out
    inside = np.linalg.norm(np.cross(off, axis), axis=-1) < bore
    return x, theta, inside & (off @ out > -RADIUS)


def fitted(*args, drop=0.0, seed=0, **options):
    x, theta, inside = opening(*args, **options)
    known = np.random.default_rng(seed).random(x.shape) >= drop
    return fit_bore(x, theta, np.full(x.shape, RADIUS), inside, known, wall=RADIUS, noise=1e-3)


@pytest.mark.parametrize("lean", [0.0, np.radians(45.0), np.radians(-30.0)])
@pytest.mark.parametrize("bore", [0.03, 0.05, 0.09])
def test_place_size_and_lean(bore, lean):
    found = fitted(0.171, 1.23, bore, lean, spacing=0.002)
    assert found.values[:3] == pytest.approx([0.171, 1.23, bore], abs=1.5e-3)
    assert found.values[3] == pytest.approx(lean, abs=np.radians(4.0))
    assert found.agreement > 0.95


def test_sizes_are_not_drawn_out_by_the_spacing():
    rng = np.random.default_rng(5)
    errors = []
    for k in range(40):
        bore = rng.uniform(0.04, 0.08)
        found = fitted(
            0.17 + rng.uniform(-0.01, 0.01), rng.uniform(0.0, 3.0), bore, 0.0, spacing=0.01, drop=0.1, seed=k
        )
        errors.append((found.values[2] - bore, np.sqrt(found.covariance[2, 2])))
    error, sigma = np.array(errors).T
    assert abs(error.mean()) < 0.8e-3
    assert np.mean(np.abs(error) < 1.96 * sigma) >= 0.85
    assert np.sqrt(np.mean(error**2)) < 2.5e-3


def test_nothing_open_is_no_bore():
    x, theta, inside = opening(0.17, 1.0, 0.05, 0.0)
    nothing = np.zeros_like(inside)
    assert fit_bore(x, theta, np.full(x.shape, RADIUS), nothing, ~nothing, wall=RADIUS, noise=1e-3) is None


def test_a_straight_edge_says_of_no_bore_how_large_it_is():
    x, theta, inside = opening(0.17, 1.0, 0.05, 0.0)
    inside = theta > 1.2
    found = fit_bore(x, theta, np.full(x.shape, RADIUS), inside, np.ones_like(inside), wall=RADIUS, noise=1e-3)
    assert found is None or found.agreement < 0.9 or found.covariance[2, 2] > 1e-4
