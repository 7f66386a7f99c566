"""The likelihood ratio of two reliefs, against the densities of two Gaussians written out."""

from __future__ import annotations

import numpy as np
from scipy.stats import multivariate_normal

from springline.compare.texture import Relief, Shared, log_ratio, prepare, sample, shared

RNG = np.random.default_rng(5)


def smooth_field(n, m, rng, reach=3):
    from scipy.ndimage import gaussian_filter

    field = gaussian_filter(rng.normal(size=(n, m)), reach, mode=("nearest", "wrap"))
    return field / field.std()


def relief_of(field):
    return Relief(field.astype(np.float32), np.ones(field.shape, bool))


def test_white_reliefs_give_the_ratio_of_two_gaussians():
    """With all waves alike a cell's terms are those of a pair of normals with correlation rho."""
    rho, n, m = 0.6, 64, 16
    flat = Shared(np.full((64, m // 2 + 1), rho), np.full((64, m // 2 + 1), 4.0), np.full((64, m // 2 + 1), 9.0))
    a = RNG.normal(0, 2.0, (n, m))
    b = 3.0 * (rho * a / 2.0 + np.sqrt(1 - rho**2) * RNG.normal(size=(n, m)))
    pairs = np.column_stack((a.ravel(), b.ravel()))
    joint = multivariate_normal([0, 0], [[4.0, rho * 6.0], [rho * 6.0, 9.0]]).logpdf(pairs)
    own = multivariate_normal(0, 4.0).logpdf(pairs[:, 0]) + multivariate_normal(0, 9.0).logpdf(pairs[:, 1])
    one = prepare(relief_of(a), relief_of(b), flat)
    found = log_ratio(one, slice(0, n), 0, 0, 1, np.zeros(m))
    np.testing.assert_allclose(found[0, 0], (joint - own).sum(), rtol=2e-3)
    assert found[0].argmax() == 0


def test_white_noise_shares_nothing():
    a, b = (relief_of(RNG.normal(size=(1500, 64))) for _ in range(2))
    assert shared(a, b).expected < 1e-3


def test_a_common_relief_is_shared_and_placed():
    wall = smooth_field(1500, 64, RNG)
    a, b = (relief_of(wall + 0.5 * RNG.normal(size=wall.shape)) for _ in range(2))
    both = shared(a, b)
    assert both.expected > 0.05
    moved = Relief(np.roll(np.roll(b.field, 7, axis=0), 5, axis=1), b.seen)
    one = prepare(a, moved, both)
    found = log_ratio(one, slice(600, 660), -20, 20, 1, np.zeros(64))
    assert np.unravel_index(found.argmax(), found.shape) == (27, 5)
    assert found.max() > 100.0


def test_where_b_was_not_seen_nothing_is_said():
    wall = smooth_field(600, 64, RNG)
    a = relief_of(wall + 0.5 * RNG.normal(size=wall.shape))
    wall = wall + 0.5 * RNG.normal(size=wall.shape)
    b = Relief(
        np.where(np.arange(600)[:, None] < 300, wall, 0.0).astype(np.float32),
        np.repeat(np.arange(600)[:, None] < 300, 64, 1),
    )
    one = prepare(a, b, shared(a, relief_of(wall)))
    found = log_ratio(one, slice(400, 440), 0, 0, 1, np.zeros(64))
    assert np.abs(found).max() < 30.0 < log_ratio(one, slice(100, 140), 0, 0, 1, np.zeros(64)).max()


def test_rows_between_rows_and_beyond_gaps():
    at = np.array([0.0, 1.0, 2.0, 3.0, 10.0, 11.0])
    rows = np.sin(0.5 * at)[:, None].astype(np.float32) * np.ones((1, 3), np.float32)
    rows[1, 2] = np.nan
    values, known = sample(at, rows, np.array([1.5, 5.0, 10.5, 11.5]), 2.0)
    np.testing.assert_allclose(values[0, 0], np.sin(0.75), atol=0.01)
    assert known[:, 0].tolist() == [True, False, True, False]
    assert not known[0, 2]
