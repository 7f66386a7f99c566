"""The chain's passes against sums over all paths, done the slow way."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.stats import norm

from springline.compare import chain

LOW, STEP, CELLS = -0.4, 0.1, 9
WALK, SLIP_RATE, SLIP_SCALE = 0.08, 0.02, 0.3


@pytest.fixture
def case():
    rng = np.random.default_rng(4)
    u, y = np.array([0.0, 3.0, 5.0, 9.0]), np.array([0.1, 3.1, 9.2])
    ratio = rng.uniform(1.0, 3.0, (4, 3))
    shared = np.array([0.9, 0.7, 0.5, 0.8])
    start, end = rng.uniform(0.5, 1.0, (2, CELLS))
    return u, shared, y, ratio, np.array([0.0, 9.4]), np.full(4, 0.1), start / start.sum(), end


def _moves(gap):
    """Return the matrix of one transition, column by column."""
    out, jump, kernel = np.empty((3, CELLS))
    columns = []
    for k in range(CELLS):
        p = np.zeros(CELLS)
        p[k] = 1.0
        chain.transition(p, gap, WALK, SLIP_RATE, SLIP_SCALE, STEP, out, jump, kernel)
        columns.append(out.copy())
    return np.array(columns).T


def _seen(u, shared, y, ratio, extent, sigma):
    at = u + LOW + STEP * np.arange(CELLS)
    gap = y[None, :] - at[:, None]
    density = 0.9 * norm.pdf(gap, scale=sigma) + 0.1 * norm.pdf(gap, scale=4 * sigma)
    missed = np.where((at >= extent[0]) & (at <= extent[1]), 1 - shared, 1.0)
    return missed, ratio * density


def test_passes_equal_the_sum_over_all_paths(case):
    u, shared, y, ratio, extent, sigma, start, end = case
    motion = (WALK, SLIP_RATE, SLIP_SCALE)
    found, alpha, seen = chain.forward(u, shared, y, ratio, extent, sigma, *motion, LOW, STEP, start, end, True)
    chain.smooth(u, alpha, seen, *motion, STEP, end)
    shares = np.zeros(ratio.shape)
    chain.pair_shares(u, y, ratio, sigma, LOW, STEP, alpha, seen, shares)
    parts = [_seen(u[i], shared[i], y, ratio[i], extent, sigma[i]) for i in range(4)]
    emission = np.array([missed + hits.sum(axis=1) for missed, hits in parts])
    moves = [_moves(gap) for gap in np.diff(u)]
    posterior, total = np.zeros((4, CELLS)), 0.0
    for path in itertools.product(range(CELLS), repeat=4):
        weight = start[path[0]] * end[path[-1]] * np.prod([emission[i, k] for i, k in enumerate(path)])
        weight *= np.prod([moves[i][path[i + 1], path[i]] for i in range(3)])
        total += weight
        for i, k in enumerate(path):
            posterior[i, k] += weight
    posterior /= total
    assert found == pytest.approx(np.log(total), abs=1e-4)
    # walk and slip are applied in one order both ways, which differs at the very edge of the grid
    np.testing.assert_allclose(alpha, posterior, atol=5e-4)
    by_hand = [(posterior[i] / emission[i]) @ parts[i][1] for i in range(4)]
    np.testing.assert_allclose(shares, by_hand, atol=1e-3)


@pytest.mark.parametrize("sd", [0.02, 0.04, 0.3])
def test_the_walk_keeps_mass_and_variance(sd):
    cells, step = 401, 0.1
    p = np.zeros(cells)
    p[200] = 1.0
    out, jump, kernel = np.empty((3, cells))
    chain.transition(p, 1.0, sd, 0.0, 0.3, step, out, jump, kernel)
    x = step * (np.arange(cells) - 200)
    assert out.sum() == pytest.approx(1.0, abs=1e-9)
    assert (out @ x**2) == pytest.approx(sd**2, rel=2e-3)


def test_a_slip_is_a_laplace_jump():
    cells, step, scale = 2001, 0.02, 0.3
    p = np.zeros(cells)
    p[1000] = 1.0
    out, jump, kernel = np.empty((3, cells))
    chain.transition(p, 50.0, 1e-9, 0.01, scale, step, out, jump, kernel)
    x = step * (np.arange(cells) - 1000)
    slip = 1 - np.exp(-0.5)
    assert out.sum() == pytest.approx(1.0, abs=1e-9)
    assert (out @ x**2) == pytest.approx(slip * 2 * scale**2, rel=5e-3)
    far = np.abs(x) > 0.1
    np.testing.assert_allclose(out[far], slip * step * np.exp(-np.abs(x[far]) / scale) / (2 * scale), rtol=2e-3)
