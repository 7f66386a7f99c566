"""The estimator's optimum and covariance against GTSAM's: another solver, another elimination, no block structure.

The measurements are the estimator's own at its final weights; states, order of elimination, steps and marginals are
GTSAM's. Ties are written anew, as the long rows that they are.
"""

import numpy as np
import pytest
from bench._joint import given

from springline.estimation import JointOptions
from springline.estimation.iterate import iterate
from springline.estimation.joint import _set_up
from springline.estimation.solver import Normal
from springline.estimation.spill import Spill
from springline.estimation.states import AXIS, BLOCK, CLOCK, ORIGIN, SCALARS, State, place
from springline.estimation.torus import bend_terms
from springline.simulate import parse, simulate

gtsam = pytest.importorskip("gtsam", reason="needs GTSAM, of requirements-dev.lock")

SCENARIO = """
name = "two metres"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.008
run = [{ kind = "straight", length = 2.5 }]
[robot]
length = 0.5
offset_z = { amplitude = 0.02, period = 1.5 }
roll_deg = { amplitude = 3.0, period = 1.1 }
side_slip_deg = 0.3
standstill = [{ chainage = 0.25, duration = 20.0 }]
[rings]
spacing = "20mm"
noise = "1mm"
[inertial]
rate = 50.0
gyro_bias_deg_h = [10.0, -10.0, 10.0]
gyro_noise_deg_sqrt_h = 0.3
accel_noise = 0.0005
[odometer]
scale_error = 0.005
[ties]
chainages = [0.3, 2.1]
sigma = "10mm"
"""
SCALAR_KEY = 10_000


@pytest.fixture(scope="module")
def solved():
    """Return problem and solution of a short survey."""
    made = simulate(parse(SCENARIO), seed=2)
    options = JointOptions(knot_step=0.1, tolerance=1e-4, iterations=40)
    problem, state = _set_up(*given(made), options)
    solution = iterate(problem, state, lambda now: bend_terms(problem, now), Spill(on_disk=False))
    assert solution.converged
    return problem, solution


class Graph:
    """GTSAM's graph of a solved survey; its values are steps from the estimate, each in a unit of its own size."""

    def __init__(self, problem, solution, widen=1.0):
        self.problem, self.like = problem, solution.state
        normal = Normal.zeros(len(self.like.knots), BLOCK, SCALARS)
        for factor in problem.factors(
            problem.windows[0], float(self.like.scalars[CLOCK]), bend_terms(problem, self.like)
        ).values():
            factor.linearise(self.like).add(normal)
        self.sigma = 1.0 / np.sqrt(np.einsum("kii->ki", normal.diagonal))
        self.edge = 1.0 / np.sqrt(np.diag(normal.corner))
        self.keys = [*range(len(self.sigma)), SCALAR_KEY]
        self.graph = gtsam.NonlinearFactorGraph()
        clock, bent = float(self.like.scalars[CLOCK]), bend_terms(problem, self.like)
        for name, factor in problem.factors(problem.windows[0], clock, bent).items():
            factor.scale = widen * solution.scales.get(name, factor.scale)
            self.graph.add(self.measurement(factor.linearise, factor.linearise(self.like).weight))
        for row in range(len(problem.ties.sigma)):
            self.graph.add(self.tie(row))

    def values(self, rng, size):
        out = gtsam.Values()
        for k in self.keys:
            out.insert(k, size * rng.standard_normal(SCALARS if k == SCALAR_KEY else BLOCK))
        return out

    def state(self, values):
        knots = np.stack([values.atVector(k) for k in self.keys[:-1]])
        scalars = self.like.scalars + self.edge * values.atVector(SCALAR_KEY)
        return State(self.like.distance, self.like.knots + self.sigma * knots, scalars)

    def hand_over(self, slopes, jacobians):
        """Give GTSAM its blocks of slopes (rows, all states)."""
        slopes = slopes * np.concatenate([self.sigma.ravel(), self.edge])
        cuts = np.cumsum([BLOCK] * len(self.sigma))
        for k, part in enumerate(np.split(slopes, cuts, axis=1)):
            jacobians[k] = np.asfortranarray(part)

    def sigmas(self, values):
        """Return one-sigma of every state by QR of the Jacobian that GTSAM makes: (knot, BLOCK) and (SCALARS,)."""
        jacobian, _ = self.graph.linearize(values).jacobian()
        root = np.linalg.inv(np.linalg.qr(jacobian, mode="r"))
        all_of_them = np.linalg.norm(root, axis=1)
        knots = all_of_them[: self.sigma.size].reshape(self.sigma.shape)
        return knots * self.sigma, all_of_them[self.sigma.size :] * self.edge

    def measurement(self, linearise, weight):
        """Return the factor of all residuals of one kind, their weights as they came to rest."""
        root, shift = np.sqrt(weight), (len(self.sigma) - 2) * BLOCK

        def error(_, values, jacobians):
            one = linearise(self.state(values))
            if jacobians is not None:
                slopes = np.zeros((*one.residual.shape, self.sigma.size + SCALARS))
                for row, knot in enumerate(one.factor.interval):
                    columns = one.factor.columns
                    at = np.where(columns < 2 * BLOCK, knot * BLOCK + columns, shift + columns)
                    slopes[row][:, at] = one.slopes[row]
                self.hand_over((root[..., None] * slopes).reshape(root.size, -1), jacobians)
            return (root * one.residual).ravel()

        return gtsam.CustomFactor(gtsam.noiseModel.Unit.Create(root.size), self.keys, error)

    def tie(self, row):
        """Return the factor of one tie: the origin and all ways before it add up to the known point."""
        ties = self.problem.ties
        interval, share = place(np.asarray(ties.distance[row : row + 1], float), self.problem.knots)
        weights = np.where(np.arange(len(self.sigma)) < interval[0], 1.0, 0.0)
        weights[interval[0]] = share[0]

        def error(_, values, jacobians):
            now = self.state(values)
            if jacobians is not None:
                slopes = np.zeros((3, self.sigma.size + SCALARS))
                for axis in range(3):
                    slopes[axis, AXIS.start + axis : self.sigma.size : BLOCK] = weights
                    slopes[axis, self.sigma.size + ORIGIN.start + axis] = 1.0
                self.hand_over(slopes, jacobians)
            return now.scalars[ORIGIN] + weights @ now.knots[:, AXIS] - ties.position[row]

        return gtsam.CustomFactor(gtsam.noiseModel.Isotropic.Sigma(3, ties.sigma[row]), self.keys, error)


def sigmas_of_knots(found):
    """Return one-sigma of every state of every knot."""
    return np.sqrt(np.einsum("kii->ki", found.rows(0, found.windows[-1].last)[0]))


def test_the_optimum_and_its_covariance_are_those_of_gtsam(solved):
    graph, (_, solution) = Graph(*solved), solved
    settings = gtsam.GaussNewtonParams()
    settings.setLinearSolverType("MULTIFRONTAL_QR")
    start = graph.values(np.random.default_rng(1), 3.0)
    best = gtsam.GaussNewtonOptimizer(graph.graph, start, settings).optimize()
    found = solution.covariance
    own = [*sigmas_of_knots(found), np.sqrt(np.diag(found.corner))]
    for k, unit, sigma in zip(graph.keys, [*graph.sigma, graph.edge], own, strict=True):
        assert np.max(np.abs(best.atVector(k) * unit / sigma)) < 0.02
    knots, scalars = graph.sigmas(best)
    np.testing.assert_allclose(np.stack(own[:-1]), knots, rtol=2e-3)
    np.testing.assert_allclose(own[-1], scalars, rtol=2e-3)


def test_the_check_would_see_scales_that_are_wrong(solved):
    graph, (_, solution) = Graph(*solved, widen=2.0), solved
    knots, _ = graph.sigmas(graph.values(np.random.default_rng(1), 0.0))
    own = sigmas_of_knots(solution.covariance)
    assert np.max(np.abs(own / knots - 1.0)) > 0.1
