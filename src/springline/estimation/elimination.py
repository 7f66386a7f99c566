"""Compiled kernels of the block-tridiagonal solution; every one works in place, so that memory stays at one copy."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def eliminate(diagonal, beside, right, border):
    """Solve T X = right, and return right[..., :border]' X and whether T is positive definite.

    Overwrites `diagonal` with the inverses of the pivots, `beside` with the steps that eliminate each block, and
    `right` with X. Pivots are factored by Cholesky and lose a square, never a product, so that they stay symmetric to
    the last bit.
    """
    knots, block = diagonal.shape[:2]
    tied = np.zeros((border, right.shape[2]))
    pivot = diagonal[0].copy()
    lower = np.zeros((block, block))
    for k in range(knots):
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
        tied += np.ascontiguousarray(own[:, :border].T) @ own
        if k < knots - 1:
            half = root @ beside[k]
            beside[k] = above @ half
            across = np.ascontiguousarray(half.T)
            pivot = diagonal[k + 1] - across @ half
            right[k + 1] -= across @ own
        right[k] = above @ own
    for k in range(knots - 2, -1, -1):
        right[k] -= beside[k] @ right[k + 1]
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
def selected(inverse, step, scale):
    """Turn what `eliminate` left into the diagonal blocks of the inverse of T and those beside them, times scales."""
    knots, block = scale.shape
    for k in range(knots - 2, -1, -1):
        beside = -step[k] @ inverse[k + 1]
        inverse[k] -= beside @ np.ascontiguousarray(step[k].T)
        step[k] = beside
    for k in range(knots):
        for i in range(block):
            for j in range(block):
                inverse[k, i, j] *= scale[k, i] * scale[k, j]
                if k < knots - 1:
                    step[k, i, j] *= scale[k, i] * scale[k + 1, j]


@njit(cache=True)
def ways(blocks, beside, reach):
    """Return the covariance (knot, 4, 4) of the sums of what all ways (the first three states) before each knot add.

    Knots are a Markov chain: what the sums share with the next knot they share through this one.
    """
    knots, block = blocks.shape[:2]
    out = np.zeros((knots, 4, 4))
    shared = np.zeros((4, block))
    for k in range(knots - 1):
        own = reach[k] @ np.ascontiguousarray(blocks[k, :3])
        with_sums = np.ascontiguousarray(shared[:, :3]) @ reach[k].T
        out[k + 1] = out[k] + with_sums + with_sums.T + np.ascontiguousarray(own[:, :3]) @ reach[k].T
        through = np.linalg.solve(blocks[k], beside[k])
        shared = (shared + own) @ through
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
def chain_variance(blocks, beside, weights):
    """Return the variance of the sum of weights[k] . states[k] over a stretch of knots that are a Markov chain."""
    total, shared = 0.0, np.zeros(blocks.shape[1])
    for k in range(len(blocks)):
        own = blocks[k] @ weights[k]
        total += weights[k] @ own + 2.0 * (shared @ weights[k])
        if k < len(beside):
            shared = (shared + own) @ np.linalg.solve(blocks[k], beside[k])
    return max(total, 0.0)
