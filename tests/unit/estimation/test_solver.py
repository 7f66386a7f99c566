"""The block solver against dense linear algebra."""

import numpy as np
import pytest

from springline.errors import InputError
from springline.estimation.solver import Normal, Stretch, Threads, solve
from springline.estimation.states import AXIS, ORIGIN

KNOTS, BLOCK, SCALARS = 6, 5, 18


def problem(rng):
    """Return normal equations of random factors between neighbouring knots and scalars, and the dense matrix."""
    size = KNOTS * BLOCK + SCALARS
    whole, right = np.zeros((size, size)), np.zeros(size)
    for k in range(KNOTS - 1):
        rows = np.zeros((12, size))
        rows[:, k * BLOCK : (k + 2) * BLOCK] = rng.normal(size=(12, 2 * BLOCK))
        rows[:, KNOTS * BLOCK :] = rng.normal(size=(12, SCALARS))
        whole += rows.T @ rows
        right += rows.T @ rng.normal(size=12)
    whole += np.eye(size)
    edge = KNOTS * BLOCK
    blocks = whole[:edge, :edge].reshape(KNOTS, BLOCK, KNOTS, BLOCK)
    normal = Normal(
        np.stack([blocks[k, :, k] for k in range(KNOTS)]),
        np.stack([blocks[k, :, k + 1] for k in range(KNOTS - 1)]),
        whole[:edge, edge:].reshape(KNOTS, BLOCK, SCALARS).copy(),
        whole[edge:, edge:].copy(),
        right[:edge].reshape(KNOTS, BLOCK).copy(),
        right[edge:].copy(),
    )
    return normal, whole, right


ALONG = np.random.default_rng(5).normal(size=(KNOTS - 1, 3))


def reach(knot):
    """Return the rows (4, size) that add up the origin and all ways before a knot, and their length."""
    length = np.zeros((1, KNOTS * BLOCK + SCALARS))
    for k in range(knot):
        length[0, k * BLOCK : k * BLOCK + 3] = ALONG[k]
    return np.concatenate([ways(knot), length])


def ways(knot):
    """Return the rows (3, size) that add up the origin and all ways before a knot."""
    rows = np.zeros((3, KNOTS * BLOCK + SCALARS))
    for axis in range(3):
        rows[axis, KNOTS * BLOCK + ORIGIN.start + axis] = 1.0
        rows[axis, AXIS.start + axis : knot * BLOCK : BLOCK] = 1.0
    return rows


def check(found, matrix, right):
    inverse = np.linalg.inv(matrix)
    whole, edge = inverse @ right, KNOTS * BLOCK
    np.testing.assert_allclose(found.knots.ravel(), whole[:edge], rtol=1e-9)
    np.testing.assert_allclose(found.scalars, whole[edge:], rtol=1e-9)
    blocks = inverse[:edge, :edge].reshape(KNOTS, BLOCK, KNOTS, BLOCK)
    np.testing.assert_allclose(found.diagonal, [blocks[k, :, k] for k in range(KNOTS)], atol=1e-10)
    np.testing.assert_allclose(found.beside, [blocks[k, :, k + 1] for k in range(KNOTS - 1)], atol=1e-10)
    np.testing.assert_allclose(found.border.reshape(edge, -1), inverse[:edge, edge:], atol=1e-10)
    np.testing.assert_allclose(found.corner, inverse[edge:, edge:], atol=1e-10)
    np.testing.assert_allclose(found.axis, [reach(k) @ inverse @ reach(k).T for k in range(KNOTS)], atol=1e-9)


def test_solution_and_covariance_are_those_of_the_dense_matrix():
    normal, matrix, right = problem(np.random.default_rng(1))
    check(solve(normal, along=ALONG), matrix, right)


def test_known_points_count_as_the_long_rows_that_they_are():
    rng = np.random.default_rng(2)
    normal, matrix, right = problem(rng)
    threads = Threads(np.array([0, 3, 4]), np.array([-0.2, 0.4, 1.1]), rng.normal(size=(3, 3)), np.array([0.1, 0.5, 2]))
    for interval, share, known, sigma in zip(
        threads.interval, threads.share, threads.residual, threads.sigma, strict=True
    ):
        rows = (1.0 - share) * ways(interval) + share * ways(interval + 1)
        matrix, right = matrix + rows.T @ rows / sigma**2, right + rows.T @ known / sigma**2
    check(solve(normal, threads, ALONG), matrix, right)


def test_the_solution_alone_is_the_same():
    normal, matrix, right = problem(np.random.default_rng(4))
    found = solve(normal, covariance=False)
    whole = np.linalg.solve(matrix, right)
    np.testing.assert_allclose(found.knots.ravel(), whole[: KNOTS * BLOCK], rtol=1e-9)
    np.testing.assert_allclose(found.scalars, whole[KNOTS * BLOCK :], rtol=1e-9)
    assert found.diagonal.size == 0


def test_a_stretch_of_knots_errs_together_as_the_dense_inverse_says():
    normal, matrix, _ = problem(np.random.default_rng(6))
    inverse = np.linalg.inv(matrix)
    stretch = Stretch.of(solve(normal), 1, 4)
    weights = np.random.default_rng(7).normal(size=(4, BLOCK))
    row = np.zeros(len(matrix))
    row[BLOCK : 5 * BLOCK] = weights.ravel()
    assert stretch.sigma(weights) == pytest.approx(np.sqrt(row @ inverse @ row), rel=1e-8)
    blocks = inverse[: KNOTS * BLOCK, : KNOTS * BLOCK].reshape(KNOTS, BLOCK, KNOTS, BLOCK)
    np.testing.assert_allclose(stretch.together(slice(1, 3)), blocks[1:5, 1:3, 1:5, 1:3], atol=1e-10)


def test_a_state_without_information_is_refused():
    normal, _, _ = problem(np.random.default_rng(3))
    normal.diagonal[2, 4] = normal.diagonal[2, :, 4] = 0.0
    normal.beside[1, :, 4] = normal.beside[2, 4] = 0.0
    with pytest.raises(InputError, match="no information"):
        solve(normal)
