import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from springline.geometry.robot import _search as search
from springline.geometry.robot import frame, oblique_ellipse, pitch_yaw_roll, ring_covariance, solve_rings
from springline.geometry.robot.section import form_of, ring_parameters

PUBLISHED = np.radians([[0.0, 0.0, 0.0], [25.0, 12.5, 0.0]])


def rings_of(pitch, yaw, r1, r2, steps, roll=0.0):
    """Exact rings (n, 3) of a robot whose tan-defined angles grow by `steps`."""
    return np.stack([np.stack(oblique_ellipse(r1, r2, pitch + p, yaw + y, roll + r)) for p, y, r in steps])


def found_values(found):
    return [np.degrees(found.pitch), np.degrees(found.yaw), found.r1, found.r2]


@pytest.mark.parametrize("guess", [(25.0, 20.0), (20.0, 10.0)])
def test_the_published_case_is_found_from_both_published_guesses(guess):
    rings = rings_of(*np.radians([15, 7.5]), 11.0, 10.0, PUBLISHED)
    found = solve_rings(rings, PUBLISHED, guess=np.radians(guess))
    np.testing.assert_allclose(found_values(found), [15, 7.5, 11, 10], atol=1e-8)
    assert found.solved
    assert found.roots == 1


SIGNS = [(p, y) for p in (1, -1) for y in (1, -1)]


@pytest.mark.parametrize("truth", [(15.0, 7.5, 25.0, 12.5), (7.5, 15.0, 12.5, 25.0)])
@pytest.mark.parametrize("signs", SIGNS)
@pytest.mark.parametrize("step_signs", SIGNS)
def test_all_signs_of_the_published_case_have_one_root(truth, signs, step_signs):
    pitch, yaw = np.radians(truth[:2]) * signs
    steps = np.zeros((2, 3))
    steps[1, :2] = np.radians(truth[2:]) * step_signs
    found = solve_rings(rings_of(pitch, yaw, 11.0, 10.0, steps), steps)
    np.testing.assert_allclose(found_values(found), [*np.degrees([pitch, yaw]), 11, 10], atol=1e-7)
    assert found.reason() == "solved"


@pytest.mark.parametrize("signs", SIGNS)
def test_no_false_root_is_reached_from_250_random_starts(signs):
    truth = np.radians([15.0, 7.5]) * signs
    rings = rings_of(*truth, 11.0, 10.0, PUBLISHED)
    problem = search.Problem(
        forms=form_of(ring_parameters(*rings.T))[None],
        steps=PUBLISHED[None],
        weights=np.broadcast_to(100 * np.eye(3), (1, 2, 3, 3)),
        roll=np.zeros(1),
        unknown_roll=False,
        rotation=False,
    )
    starts = np.radians(np.random.default_rng(7).uniform(-58, 58, size=(1, 250, 2)))
    angles, cost = search._descend(problem, starts)
    exact = cost[0] < 1e-14
    assert exact.sum() > 60
    np.testing.assert_allclose(angles[0, exact], np.broadcast_to(truth, (exact.sum(), 2)), atol=1e-6)
    for guess in starts[0, :20]:
        found = solve_rings(rings, PUBLISHED, guess=guess)
        np.testing.assert_allclose([found.pitch, found.yaw], truth, atol=1e-9)


def random_cases(count, seed):
    rng = np.random.default_rng(seed)
    angles = np.radians(rng.uniform(-30, 30, size=(count, 3)))
    steps = np.zeros((count, 2, 3))
    steps[:, 1] = np.radians(rng.uniform(5, 25, size=(count, 3)) * rng.choice([-1, 1], size=(count, 3)))
    return angles, steps, rng.uniform(9, 12, size=(count, 2))


def test_two_rings_give_five_unknowns():
    angles, steps, radii = random_cases(60, 3)
    pose = angles[:, None] + steps
    rings = np.stack(oblique_ellipse(*radii.T[..., None], pose[..., 0], pose[..., 1], pose[..., 2]), axis=-1)
    found = solve_rings(rings, steps, unknown_roll=True)
    np.testing.assert_allclose(np.stack([found.pitch, found.yaw, found.roll], axis=-1), angles, atol=1e-7)
    np.testing.assert_allclose(np.stack([found.r1, found.r2], axis=-1), radii, atol=1e-6)


def test_inertial_steps_are_rotations_of_the_robot():
    rng = np.random.default_rng(5)
    base = frame(*np.radians([8.0, -12.0, 4.0]))
    steps = np.concatenate([np.zeros((1, 3)), rng.normal(0, 0.15, size=(2, 3))])
    frames = Rotation.from_rotvec(steps).as_matrix().swapaxes(-1, -2) @ base
    rings = np.stack(oblique_ellipse(0.155, 0.148, *pitch_yaw_roll(frames)), axis=-1)
    found = solve_rings(rings, steps, increments="rotation", unknown_roll=True)
    np.testing.assert_allclose(np.degrees([found.pitch, found.yaw, found.roll]), [8, -12, 4], atol=1e-6)
    np.testing.assert_allclose([found.r1, found.r2], [0.155, 0.148], atol=1e-9)


def noisy_rings(pitch, yaw, steps, noise, trials, seed):
    exact = ring_parameters(*rings_of(pitch, yaw, 0.1575, 0.1425, steps).T)
    rng = np.random.default_rng(seed)
    values = exact + rng.multivariate_normal(np.zeros(3), ring_covariance(noise, 360), size=(trials, len(steps)))
    mean, cos, sin = np.moveaxis(values, -1, 0)
    half = np.hypot(cos, sin)
    return np.stack([mean + half, mean - half, 0.5 * np.arctan2(sin, cos)], axis=-1)


def steps_to(degrees, rings):
    part = np.linspace(0, 1, rings)[:, None]
    return np.radians(degrees) * part * [1.0, 0.5, 0.0]


@pytest.mark.parametrize(("degrees", "rings"), [(25.0, 2), (10.0, 3), (5.0, 2)])
def test_the_stated_covariance_covers_the_truth(degrees, rings):
    truth, steps = np.radians([5.0, 3.0]), steps_to(degrees, rings)
    covariance = ring_covariance(1e-3, 360)
    found = solve_rings(noisy_rings(*truth, steps, 1e-3, 400, 8), steps, covariance=covariance)
    sigma = np.sqrt(np.diagonal(found.covariance, axis1=-2, axis2=-1))
    assert found.solved.all()
    for value, true, one in (
        (found.pitch, truth[0], sigma[:, 0]),
        (found.yaw, truth[1], sigma[:, 1]),
        (found.r1, 0.1575, sigma[:, 3]),
        (found.r2, 0.1425, sigma[:, 4]),
    ):
        assert 0.92 <= np.mean(np.abs(value - true) < 1.96 * one) <= 0.98
    assert found.misfit.mean() == pytest.approx(3 * rings - 4, rel=0.2)


def test_neighbouring_rings_are_refused_under_a_millimetre_of_noise():
    steps = steps_to(1.0, 3)
    rings = noisy_rings(*np.radians([5.0, 3.0]), steps, 1e-3, 50, 9)
    found = solve_rings(rings, steps, covariance=ring_covariance(1e-3, 360))
    assert not found.solved.any()
    assert np.isnan([found.pitch, found.yaw, found.r1, found.r2]).all()


COVARIANCE = ring_covariance(1e-3, 360)


@pytest.mark.parametrize("covariance", [None, COVARIANCE])
@pytest.mark.parametrize("tilt", [(5.0, 3.0), (0.0, 0.0), (0.0, 5.0)])
def test_without_increments_nothing_is_known(covariance, tilt):
    steps = np.zeros((2, 3))
    found = solve_rings(rings_of(*np.radians(tilt), 0.15, 0.14, steps), steps, covariance=covariance)
    assert np.isnan([found.pitch, found.yaw, found.r1, found.r2]).all()
    assert found.observable.tolist() == [False, False, True, False, False]
    assert found.reason().endswith("(pitch, yaw, r1, r2)")


def test_a_round_pipe_tells_no_roll_from_two_noisy_rings_but_all_else():
    steps = np.radians([[0, 0, 0], [10, 5, 0]])
    rings = rings_of(*np.radians([5, 5]), 0.15, 0.15, steps, roll=0.05)
    found = solve_rings(rings, steps, unknown_roll=True, covariance=COVARIANCE)
    assert found.observable.tolist() == [True, True, False, True, True]
    np.testing.assert_allclose(found_values(found), [5, 5, 0.15, 0.15], atol=1e-5)
    assert np.isnan(found.roll)
    assert found.reason() == "not observable: the rings cannot tell this within the limit (roll)"
    assert np.isnan(found.covariance[2]).all()


def test_rings_of_another_section_contradict():
    steps = steps_to(20.0, 3)
    rings = rings_of(*np.radians([5, 3]), 0.15, 0.14, steps)
    rings[1, 0] += 0.002
    found = solve_rings(rings, steps, covariance=ring_covariance(1e-4, 360))
    assert found.status == 3
    assert found.misfit > 100


def test_missing_sets_stay_missing_in_a_batch():
    rings = np.stack([rings_of(*np.radians([15, 7.5]), 11.0, 10.0, PUBLISHED)] * 3).reshape(3, 1, 2, 3)
    rings[1, 0, 0, 1] = np.nan
    found = solve_rings(rings, PUBLISHED)
    assert found.status.tolist() == [[0], [4], [0]]
    assert np.isnan(found.pitch).tolist() == [[False], [True], [False]]
    assert found.reason((1, 0)).startswith("a ring is missing")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: solve_rings(np.ones((1, 3)), np.zeros((1, 3))), "n >= 2 rings .* section_from_ring"),
        (lambda: solve_rings(np.ones((2, 3)), np.zeros((3, 3))), r"steps has shape \(3, 3\)"),
        (lambda: solve_rings(np.ones((2, 3)), np.ones((2, 3))), "first step is not zero"),
        (lambda: solve_rings(np.ones((2, 3)), np.zeros((2, 3)), increments="gyro"), "increments = 'gyro'"),
        (lambda: solve_rings(np.ones((2, 3)), np.zeros((2, 3)), guess=(25.0, 20.0)), "guess = .* radians"),
        (lambda: solve_rings(np.ones((2, 3)), np.zeros((2, 3)), guess=(0.1, 0.2), unknown_roll=True), "3 angles"),
        (lambda: solve_rings(-np.ones((2, 3)), np.zeros((2, 3))), "major = -1"),
        (lambda: solve_rings(np.ones((2, 3)), np.zeros((2, 3)), covariance=-np.eye(3)), "not positive definite"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
