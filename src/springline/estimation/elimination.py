"""Compiled kernels of the block-tridiagonal solution, one window of blocks at a time; every one works in place."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def eliminate(diagonal, beside, right, ends):
    """Eliminate a window's blocks, and return right' T^-1 right of those eliminated and whether T is positive definite.

    Overwrites `diagonal` with the inverses of the pivots, `beside` with the steps that eliminate each block, and
    `right` with what `substitute` starts from. Unless the window `ends` the survey its last block is not eliminated,
    but left as the next window finds it. Pivots are factored by Cholesky and lose a square, never a product, so that
    they stay symmetric to the last bit.
    """
    knots, block = diagonal.shape[:2]
    tied = np.zeros((right.shape[2], right.shape[2]))
    pivot = diagonal[0].copy()
    lower = np.zeros((block, block))
    for k in range(knots if ends else knots - 1):
        for j in range(block):
            value = pivot[j, j]
            for i in range(j):
                value -= lower[j, i] * lower[j, i]
            if not value > 0.0:
                return tied, False
            lower[j, j] = np.sqrt(value)
            for m in range(j + 1, block):
                value = pivot[m, j]
                for i in range(j):
                    value -= lower[m, i] * lower[j, i]
                lower[m, j] = value / lower[j, j]
        root = _invert(lower)
        above = np.ascontiguousarray(root.T)
        diagonal[k] = above @ root
        own = root @ right[k]
        tied += np.ascontiguousarray(own.T) @ own
        if k < knots - 1:
            half = root @ beside[k]
            beside[k] = above @ half
            across = np.ascontiguousarray(half.T)
            pivot = diagonal[k + 1] - across @ half
            right[k + 1] -= across @ own
        right[k] = above @ own
    if not ends:
        diagonal[knots - 1] = pivot
    return tied, True


@njit(cache=True)
def _invert(lower):
    """Return the inverse of a lower triangular matrix."""
    size = len(lower)
    out = np.zeros((size, size))
    for j in range(size):
        out[j, j] = 1.0 / lower[j, j]
        for i in range(j + 1, size):
            value = 0.0
            for k in range(j, i):
                value -= lower[i, k] * out[k, j]
            out[i, j] = value / lower[i, i]
    return out


@njit(cache=True)
def substitute(beside, right):
    """Turn `right` into T^-1 right, the last block being that already."""
    for k in range(len(right) - 2, -1, -1):
        right[k] -= beside[k] @ right[k + 1]


@njit(cache=True)
def selected(inverse, step):
    """Turn what `eliminate` left into the diagonal blocks of the inverse of T and those beside them, the last known."""
    for k in range(len(inverse) - 2, -1, -1):
        beside = -step[k] @ inverse[k + 1]
        inverse[k] -= beside @ np.ascontiguousarray(step[k].T)
        step[k] = beside


@njit(cache=True)
def ways(blocks, beside, reach, before, shared):
    """Return the covariance (knot, 4, 4) of the sums of what all ways (the first three states) before each knot add.

    Knots are a Markov chain: what the sums share with the next knot they share through this one. `before` (4, 4) is the
    covariance at the first knot, and `shared` (4, block) what its sums share with it; that of the last knot takes its
    place.
    """
    knots = len(blocks)
    out = np.zeros((knots, 4, 4))
    out[0] = before
    for k in range(knots - 1):
        own = reach[k] @ np.ascontiguousarray(blocks[k, :3])
        with_sums = np.ascontiguousarray(shared[:, :3]) @ reach[k].T
        out[k + 1] = out[k] + with_sums + with_sums.T + np.ascontiguousarray(own[:, :3]) @ reach[k].T
        shared[:] = (shared + own) @ np.linalg.solve(blocks[k], beside[k])
    return out


@njit(cache=True)
def add_products(blocks, beside, left, right):
    """Add left[k] right[k]' to the blocks and left[k] right[k + 1]' to those beside them."""
    for k in range(len(blocks)):
        own = np.ascontiguousarray(left[k])
        blocks[k] += own @ np.ascontiguousarray(right[k].T)
        if k < len(beside):
            beside[k] += own @ np.ascontiguousarray(right[k + 1].T)


@njit(cache=True)
def chain_variance(blocks, beside, weights, shared):
    """Return the variance that weights[k] . states[k] add up to over a stretch of knots that are a Markov chain.

    `shared` (block,) is what the sum before shares with the first knot; what it shares with the knot after the last of
    `beside` takes its place.
    """
    total = 0.0
    for k in range(len(blocks)):
        own = blocks[k] @ weights[k]
        total += weights[k] @ own + 2.0 * (shared @ weights[k])
        if k < len(beside):
            shared[:] = (shared + own) @ np.linalg.solve(blocks[k], beside[k])
    return total
