"""The published single-ended method: right where it is right, and wrong in the ways that are known."""

import numpy as np
import pytest

from springline.geometry.robot import section_from_ring
from springline.reproduce import published
from springline.reproduce.dogleg import solve
from springline.reproduce.figures import convergence, roots


def test_dogleg_finds_a_root_and_keeps_its_steps():
    start = np.array([-1.2, 1.0])
    found = solve(lambda x: np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]), start, tolerance=1e-10)
    np.testing.assert_allclose(found.x, [1.0, 1.0], atol=1e-9)
    assert found.converged
    assert len(found.optimality) == len(found.steps) + 1
    assert found.steps[0] <= 1.0  # the first trust region


def test_dogleg_says_when_there_is_no_root():
    found = solve(lambda x: np.array([x[0] ** 2 + 1.0]), [3.0], most=50)
    assert found.residual >= 1.0 - 1e-9


def test_known_orientation_is_recovered_for_one_sign_only():
    assert roots.recovered(1) == 1.0
    assert roots.recovered(-1) <= 0.01
    ring = published.ring(20.0, -15.0, 11.0, 10.0)
    right = section_from_ring(ring.major, ring.minor, np.radians(-ring.beta), *np.radians([20.0, -15.0]))
    np.testing.assert_allclose([right.r1, right.r2], [11.0, 10.0], rtol=1e-9)


# erratum 4
@pytest.mark.parametrize(("pitch", "yaw"), [(25.67, 7.5), (28.58, 15.0), (31.32, 20.0), (38.07, 30.0)])
def test_the_linear_system_is_singular_at_these_poses(pitch, yaw):
    assert round(roots.singular_pitch(yaw), 2) == pitch


def test_both_published_guesses_lead_to_the_pose():
    found = [convergence.four_unknowns(guess) for guess in (convergence.WILD, convergence.CLOSE)]
    for one in found:
        assert one.converged
        np.testing.assert_allclose(one.x, [15, 7.5, 11, 10], atol=1e-4)
    assert len(found[1].steps) == 6  # as printed


def test_the_published_system_has_a_false_exact_root():
    found = convergence.four_unknowns((5.6, 51.0, 6.9, 10.4), tolerance=1e-9)
    assert found.residual < 1e-7
    np.testing.assert_allclose(found.x, [5.622, 51.046, 6.912, 10.433], atol=1e-3)  # erratum 1
    rings = convergence.rings_of(*convergence.TRUTH, convergence.STEPS)
    again = convergence.rings_of(*found.x[:2], convergence.STEPS)
    assert abs(float(again[0].beta - rings[0].beta)) > 1.0  # what the left-out equation would have told


def test_opposite_signs_give_an_exact_wrong_answer():
    steps = ((0.0, 0.0, 0.0), (25.0, -12.5, 0.0))
    found = convergence.four_unknowns((20.0, -10.0, 12.0, 9.0), truth=(15.0, -7.5), steps=steps)
    assert found.residual < 1e-7
    np.testing.assert_allclose(found.x, [25.13, 19.67, 10.26, 9.71], atol=0.01)  # erratum 2
    right = convergence.full_solution((20.0, -10.0), truth=(15.0, -7.5), steps=steps)
    np.testing.assert_allclose(right, [15, -7.5, 11, 10], atol=1e-6)


def test_five_unknowns_are_singular_and_the_listing_inconsistent():
    assert convergence.claimed_residual() == pytest.approx(0.04, abs=0.005)  # erratum 8
    assert not convergence.five_unknowns(consistent=False).converged
    mended = convergence.five_unknowns(consistent=True)
    np.testing.assert_allclose(mended.x, convergence.FIVE_TRUTH, atol=2e-3)
    rate = mended.steps[-4:-1] / mended.steps[-5:-2]
    assert np.all((rate > 0.3) & (rate < 0.7))  # linear, where Newton would square the error
    assert convergence.singular_ratio() < 1e-9
