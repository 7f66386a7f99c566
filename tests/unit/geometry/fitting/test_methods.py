"""Each fit against its own definition, solved by general routines in plain coordinates."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eig
from scipy.optimize import least_squares

from springline.geometry.fitting import conic_to_ellipse, fit_circle, fit_ellipse


def readings(seed, *, count=60, arc=2.0 * np.pi, noise=0.03, oval=0.08, centre=(0.3, -0.2)):
    rng = np.random.default_rng(seed)
    psi = 0.4 + arc * np.arange(count) / count
    point = np.exp(0.7j) * ((1 + oval) * np.cos(psi) + 1j * (1 - oval) * np.sin(psi))
    point += noise * (rng.standard_normal(count) + 1j * rng.standard_normal(count))
    return np.stack([point.real + centre[0], point.imag + centre[1]], axis=-1)


CASES = [
    readings(0),
    readings(1, count=12, noise=0.05),
    readings(2, arc=2.5, noise=0.01),
    readings(3, count=200, arc=4.0, centre=(20.0, 5.0)),
]


def circle_by_constraint(points, constraint):
    """Minimise |D a|^2 under a' C a = 1, as a generalised eigenproblem."""
    z, y = points.T
    scatter = np.stack([z * z + y * y, z, y, np.ones_like(z)], axis=-1)
    scatter = scatter.T @ scatter
    values, vectors = eig(scatter, constraint(scatter))
    values = values.real
    usable = np.isfinite(values) & (values > -1e-9)
    a, b, c, d = vectors[:, np.flatnonzero(usable)[values[usable].argmin()]].real
    return -b / (2 * a), -c / (2 * a), np.sqrt((b * b + c * c) / (4 * a * a) - d / a)


def pratt(_):
    constraint = np.zeros((4, 4))
    constraint[0, 3] = constraint[3, 0] = -2.0
    constraint[1, 1] = constraint[2, 2] = 1.0
    return constraint


def taubin(scatter):
    """Return the sum of the squared gradients as a form in a, b, c, d."""
    square, z, y, n = scatter[:, 3]
    constraint = np.zeros((4, 4))
    constraint[0, 0], constraint[1, 1], constraint[2, 2] = 4 * square, n, n
    constraint[0, 1] = constraint[1, 0] = 2 * z
    constraint[0, 2] = constraint[2, 0] = 2 * y
    return constraint


@pytest.mark.parametrize("points", CASES)
@pytest.mark.parametrize(("method", "constraint"), [("pratt", pratt), ("taubin", taubin)])
def test_pratt_and_taubin_solve_their_eigenproblems(points, method, constraint):
    # in a centred frame, where the reference routine is at its best; both fits move with the points
    shift = points.mean(axis=0)
    expected = circle_by_constraint(points - shift, constraint)
    fit = fit_circle(points, method=method)
    assert fit.parameters == pytest.approx([expected[0] + shift[0], expected[1] + shift[1], expected[2]], abs=1e-9)


@pytest.mark.parametrize("points", CASES)
def test_kasa_is_linear_least_squares(points):
    z, y = points.T
    b, c, d = np.linalg.lstsq(np.stack([z, y, np.ones_like(z)], axis=-1), -(z * z + y * y))[0]
    expected = [-b / 2, -c / 2, np.sqrt((b * b + c * c) / 4 - d)]
    assert fit_circle(points, method="kasa").parameters == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("points", CASES)
def test_unit_norm_circle_is_the_smallest_singular_vector(points):
    z, y = points.T
    a, b, c, d = np.linalg.svd(np.stack([z * z + y * y, z, y, np.ones_like(z)], axis=-1))[2][-1]
    expected = [-b / (2 * a), -c / (2 * a), np.sqrt((b * b + c * c) / (4 * a * a) - d / a)]
    assert fit_circle(points, method="svd").parameters == pytest.approx(expected, abs=1e-7)


def ellipse_by_constraint(points, method):
    shift = points.mean(axis=0)
    z, y = (points - shift).T
    design = np.stack([z * z, z * y, y * y, z, y, np.ones_like(z)], axis=-1)
    if method == "gander":
        rest = np.linalg.lstsq(np.delete(design, 2, axis=1) - design[:, [2]] * [1, 0, 0, 0, 0], -design[:, 2])[0]
        conic = np.insert(rest, 2, 1.0 - rest[0])
    else:
        constraint = np.zeros((6, 6))
        if method == "bookstein":
            constraint[0, 0], constraint[1, 1], constraint[2, 2] = 1.0, 0.5, 1.0
        else:
            constraint[0, 2] = constraint[2, 0] = 2.0
            constraint[1, 1] = -1.0
        values, vectors = eig(constraint, design.T @ design)
        conic = vectors[:, values.real.argmax()].real
    shape = conic_to_ellipse(*conic)
    return [float(x) for x in (shape[0] + shift[0], shape[1] + shift[1], *shape[2:])]


@pytest.mark.parametrize("points", CASES)
@pytest.mark.parametrize("method", ["bookstein", "fitzgibbon", "gander"])
def test_algebraic_ellipses_solve_their_eigenproblems(points, method):
    fit = fit_ellipse(points, method=method)
    got = [fit.centre_z, fit.centre_y, fit.semi_major, fit.semi_minor, fit.axis_bearing]
    assert got == pytest.approx(ellipse_by_constraint(points, method), abs=1e-8)


@pytest.mark.parametrize("points", CASES)
def test_geometric_circle_is_least_squares_of_distances(points):
    best = least_squares(
        lambda p: np.hypot(*(points - p[:2]).T) - p[2], [*points.mean(axis=0), 1.0], xtol=1e-14, ftol=1e-14
    )
    fit = fit_circle(points, robust=False)
    assert fit.parameters == pytest.approx(best.x, abs=1e-7)
    covariance = np.linalg.inv(best.jac.T @ best.jac) * 2 * best.cost / (len(points) - 3)
    assert fit.noise_sigma == pytest.approx(np.sqrt(2 * best.cost / (len(points) - 3)), rel=1e-9)
    # the normal matrix of the distances is also that of the parameters; Student's t widens it for few readings
    widening = fit.covariance / covariance
    assert widening == pytest.approx(np.full((3, 3), widening[0, 0]), rel=1e-4)
    assert 1.0 < widening[0, 0] < 1.4


@pytest.mark.parametrize("points", [CASES[0], CASES[2]])
def test_geometric_ellipse_is_least_squares_over_all_foot_angles(points):
    """Gander, Golub and Strebel's form: every foot angle is an unknown."""

    def residuals(x):
        zc, yc, a, b, axis = x[:5]
        wall = zc + 1j * yc + np.exp(1j * axis) * (a * np.cos(x[5:]) + 1j * b * np.sin(x[5:]))
        return np.concatenate([wall.real - points[:, 0], wall.imag - points[:, 1]])

    fit = fit_ellipse(points, robust=False)
    offset = (points[:, 0] - fit.centre_z) + 1j * (points[:, 1] - fit.centre_y)
    # started elsewhere than at the answer
    start = [fit.centre_z + 0.02, fit.centre_y - 0.02, 1.12, 0.9, 0.6, *(np.angle(offset) - 0.6)]
    best = least_squares(residuals, start, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    got = [fit.centre_z, fit.centre_y, fit.semi_major, fit.semi_minor, fit.axis_bearing]
    assert got == pytest.approx(best.x[:5], abs=1e-6)
    assert fit.residual_rms**2 * len(points) == pytest.approx(2 * best.cost, rel=1e-9)


@pytest.mark.parametrize("fit", [fit_circle, fit_ellipse])
def test_weights_count_as_repetitions(fit):
    points = readings(5, count=40)
    times = np.random.default_rng(0).integers(1, 4, 40)
    repeated = fit(np.repeat(points, times, axis=0), robust=False)
    weighted = fit(points, robust=False, weights=times)
    assert weighted.parameters == pytest.approx(repeated.parameters, abs=1e-9)


@pytest.mark.parametrize(
    ("fit", "methods"),
    [
        (fit_circle, ["kasa", "pratt", "taubin", "geometric"]),
        (fit_ellipse, ["bookstein", "fitzgibbon", "gander", "geometric"]),
    ],
)
def test_fits_move_turn_and_grow_with_the_readings(fit, methods):
    points = readings(6, arc=4.5)
    turn, grow, shift = np.exp(0.9j), 250.0, 1000.0 - 3000.0j
    moved = grow * turn * (points @ [1.0, 1.0j]) + shift
    for method in methods:
        before = fit(points, method=method, robust=False)
        after = fit(np.stack([moved.real, moved.imag], axis=-1), method=method, robust=False)
        centre = grow * turn * (before.centre_z + 1j * before.centre_y) + shift
        assert after.centre_z + 1j * after.centre_y == pytest.approx(centre, abs=1e-6)
        assert after.noise_sigma == pytest.approx(grow * before.noise_sigma, rel=1e-8)
        if fit is fit_ellipse:
            oval = grow * turn**2 * (before.oval_cos + 1j * before.oval_sin)
            assert after.oval_cos + 1j * after.oval_sin == pytest.approx(oval, abs=1e-6)


def test_robust_fit_does_not_depend_on_the_order_of_the_readings():
    points = readings(8, count=120)
    points[10:30] *= 1.2
    shuffled = np.random.default_rng(0).permutation(points)
    fit, again = fit_ellipse(points), fit_ellipse(shuffled)
    assert again.n_used == fit.n_used
    assert np.abs(again.parameters - fit.parameters).max() < 1e-3 * fit.sigma.min()
