"""Scanner and robot: round trips, and what a boresight does to a joint estimate until it is taken out."""

import numpy as np

from springline.geometry.robot.boresight import on_scanner, robot_attitude
from springline.simulate.attitude import from_axes, in_pipe

BORESIGHT = np.radians([0.4, -1.2, 2.0])


def test_the_robots_attitude_is_found_again_behind_its_scanner():
    rng = np.random.default_rng(0)
    robot = rng.uniform(-0.4, 0.4, (50, 3))
    scanner = np.stack(from_axes(in_pipe(*BORESIGHT) @ in_pipe(*robot.T)), axis=1)
    found, covariance = robot_attitude(scanner, BORESIGHT)
    np.testing.assert_allclose(found, robot, atol=1e-12)
    assert np.isnan(covariance).all()


def test_vectors_keep_their_direction_in_space():
    rng = np.random.default_rng(1)
    robot, vector = in_pipe(0.2, -0.1, 0.3), rng.standard_normal((20, 3))
    seen = on_scanner(vector, BORESIGHT)
    np.testing.assert_allclose(seen @ (in_pipe(*BORESIGHT) @ robot), vector @ robot, atol=1e-12)


def test_covariance_is_that_of_drawn_attitudes():
    rng = np.random.default_rng(2)
    attitude, spread = np.array([0.2, -0.15, 0.1]), 1e-6 * np.array([[4, 1, 0], [1, 2, 0.5], [0, 0.5, 3]])
    sure = 1e-6 * np.diag([1.0, 2.0, 0.5])
    drawn = rng.multivariate_normal(attitude, spread, 40_000)
    mounts = rng.multivariate_normal(BORESIGHT, sure, 40_000)
    found, _ = robot_attitude(drawn, mounts)
    _, covariance = robot_attitude(attitude, BORESIGHT, spread, sure)
    np.testing.assert_allclose(np.cov(found.T), covariance, atol=1e-7)


def test_a_missing_roll_leaves_the_rest_missing():
    found, _ = robot_attitude([0.1, 0.1, np.nan], BORESIGHT)
    assert np.isnan(found).any()
