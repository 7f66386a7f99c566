"""The block solver against dense linear algebra."""

from itertools import pairwise

import numpy as np
import pytest

from springline.errors import InputError
from springline.estimation.covariance import Stretch, sigma_of_sum
from springline.estimation.solver import Normal, Sweep, Threads
from springline.estimation.spill import Spill
from springline.estimation.states import AXIS, ORIGIN
from springline.estimation.windows import Window

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
        right[:edge].reshape(KNOTS, BLOCK).copy(),
        whole[edge:, edge:].copy(),
        right[edge:].copy(),
    )
    return normal, whole, right


CUTS = ((), (3,), (1, 2, 4))
"""Knots at which windows meet."""


def windows_of(normal, cuts):
    """Return windows, and a function that gives the equations of each; a border knot's own are the later window's."""
    edges = [0, *cuts, KNOTS - 1]
    windows = [Window(a, b, b == KNOTS - 1) for a, b in pairwise(edges)]

    def equations(number):
        one = windows[number]
        rows, ways_on = one.knots, slice(one.first, one.last)
        parts = [normal.diagonal[rows], normal.beside[ways_on], normal.border[rows], normal.right[rows]]
        part = Normal(*(values.copy() for values in parts), normal.corner.copy(), normal.right_corner.copy(), one.first)
        if not one.ends:
            for values in (part.diagonal, part.border, part.right):
                values[-1] = 0.0
        if number:
            part.corner[:], part.right_corner[:] = 0.0, 0.0
        return part

    return windows, equations


def solved(normal, aside, threads=None, cuts=()):
    """Return the solution of the knots and scalars, and the covariance."""
    windows, equations = windows_of(normal, cuts)
    scale = 1.0 / np.sqrt(np.einsum("kii->ki", normal.diagonal))
    edge = 1.0 / np.sqrt(np.diag(normal.corner))
    sweep = Sweep(windows, scale, edge, threads or Threads.none(), aside)
    sweep.forward(equations)
    knots = np.empty((KNOTS, BLOCK))
    for number, part in sweep.backward(covariance=False):
        assert part.diagonal.size == 0
        knots[windows[number].knots] = part.knots
    return knots, sweep.scalars, sweep.covariance(ALONG)


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


def check(knots, scalars, found, matrix, right):
    inverse = np.linalg.inv(matrix)
    whole, edge = inverse @ right, KNOTS * BLOCK
    np.testing.assert_allclose(knots.ravel(), whole[:edge], rtol=1e-9)
    np.testing.assert_allclose(scalars, whole[edge:], rtol=1e-9)
    blocks = inverse[:edge, :edge].reshape(KNOTS, BLOCK, KNOTS, BLOCK)
    diagonal, beside, border = found.rows(0, KNOTS - 1)
    np.testing.assert_allclose(diagonal, [blocks[k, :, k] for k in range(KNOTS)], atol=1e-10)
    np.testing.assert_allclose(beside, [blocks[k, :, k + 1] for k in range(KNOTS - 1)], atol=1e-10)
    np.testing.assert_allclose(border.reshape(edge, -1), inverse[:edge, edge:], atol=1e-10)
    np.testing.assert_allclose(found.corner, inverse[edge:, edge:], atol=1e-10)
    np.testing.assert_allclose(found.axis, [reach(k) @ inverse @ reach(k).T for k in range(KNOTS)], atol=1e-9)
    for first, last in ((0, 2), (1, 4), (2, 2), (3, 5)):
        some = found.rows(first, last)
        np.testing.assert_array_equal(some[0], diagonal[first : last + 1])
        np.testing.assert_array_equal(some[1], beside[first:last])
        np.testing.assert_array_equal(some[2], border[first : last + 1])


@pytest.fixture(params=[False, True], ids=["in memory", "on disk"])
def aside(request):
    with Spill(on_disk=request.param) as aside:
        yield aside


@pytest.mark.parametrize("cuts", CUTS)
def test_solution_and_covariance_are_those_of_the_dense_matrix(cuts, aside):
    normal, matrix, right = problem(np.random.default_rng(1))
    check(*solved(normal, aside, cuts=cuts), matrix, right)


@pytest.mark.parametrize("cuts", CUTS)
def test_known_points_count_as_the_long_rows_that_they_are(cuts, aside):
    rng = np.random.default_rng(2)
    normal, matrix, right = problem(rng)
    threads = Threads(np.array([0, 3, 4]), np.array([-0.2, 0.4, 1.1]), rng.normal(size=(3, 3)), np.array([0.1, 0.5, 2]))
    for interval, share, known, sigma in zip(
        threads.interval, threads.share, threads.residual, threads.sigma, strict=True
    ):
        rows = (1.0 - share) * ways(interval) + share * ways(interval + 1)
        matrix, right = matrix + rows.T @ rows / sigma**2, right + rows.T @ known / sigma**2
    check(*solved(normal, aside, threads, cuts), matrix, right)


def test_a_stretch_of_knots_errs_together_as_the_dense_inverse_says(monkeypatch, aside):
    normal, matrix, _ = problem(np.random.default_rng(6))
    inverse = np.linalg.inv(matrix)
    found = solved(normal, aside, cuts=(2,))[2]
    weights = np.random.default_rng(7).normal(size=(4, BLOCK))
    row = np.zeros(len(matrix))
    row[BLOCK : 5 * BLOCK] = weights.ravel()
    assert sigma_of_sum(found, 1, weights) == pytest.approx(np.sqrt(row @ inverse @ row), rel=1e-8)
    for held in (1, 2, 3):
        monkeypatch.setattr("springline.estimation.covariance.MOST_INTERVALS", held)
        assert sigma_of_sum(found, 1, weights) == pytest.approx(np.sqrt(row @ inverse @ row), rel=1e-8)
    blocks = inverse[: KNOTS * BLOCK, : KNOTS * BLOCK].reshape(KNOTS, BLOCK, KNOTS, BLOCK)
    together = Stretch.of(found, 1, 4).together(slice(1, 3))
    np.testing.assert_allclose(together, blocks[1:5, 1:3, 1:5, 1:3], atol=1e-10)


def test_a_state_without_information_is_refused():
    normal, _, _ = problem(np.random.default_rng(3))
    normal.diagonal[2, 4] = normal.diagonal[2, :, 4] = 0.0
    normal.beside[1, :, 4] = normal.beside[2, 4] = 0.0
    windows, equations = windows_of(normal, (3,))
    ones = np.ones((KNOTS, BLOCK)), np.ones(SCALARS)
    with pytest.raises(InputError, match="no information"):
        Sweep(windows, *ones, Threads.none(), Spill(on_disk=False)).forward(equations)
