import numpy as np
import pytest

from springline.geometry.robot import oblique_ellipse, ring_covariance, ring_cylinder, section_from_ring
from springline.geometry.robot.section import ring_parameters

TILTS = [(0, 0), (15, 7.5), (-15, 7.5), (15, -20), (25.67, 7.5), (28.58, 15), (38.07, 30), (60, 60)]


@pytest.mark.parametrize("order", ["direct", "pitch_yaw", "yaw_pitch"])
@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize("roll", [-30, 0, 7.5])
@pytest.mark.parametrize("axes", [(11.0, 10.0), (10.0, 11.0), (10.0, 10.0)])
def test_the_section_comes_back_also_where_the_printed_system_is_singular(tilt, roll, axes, order):
    pose = np.radians([*tilt, roll])
    found = section_from_ring(*oblique_ellipse(*axes, *pose, order=order), *pose, order=order)
    np.testing.assert_allclose([found.r1, found.r2], axes, atol=1e-10)
    assert found.inconsistency < 1e-12


def test_a_round_pipe_at_equal_tilts_is_not_singular():
    pose = np.radians([20, 20])
    found = section_from_ring(*oblique_ellipse(10.0, 10.0, *pose), *pose)
    np.testing.assert_allclose([found.r1, found.r2], 10.0, atol=1e-12)


def fit_rings(rho, phi):
    """Least-squares ellipse about a known centre: 1/rho^2 is linear in the ring form."""
    design = np.stack([np.cos(phi) ** 2, 2 * np.sin(phi) * np.cos(phi), np.sin(phi) ** 2], axis=-1)
    form = np.linalg.lstsq(design, rho.T**-2.0, rcond=None)[0]
    values, vectors = np.linalg.eigh(np.stack([form[[0, 1]], form[[1, 2]]]).transpose(2, 0, 1))
    beta = np.arctan2(vectors[:, 1, 0], vectors[:, 0, 0])
    return values[:, 0] ** -0.5, values[:, 1] ** -0.5, beta


@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (10.0, -5.0, 8.0)])
def test_the_covariance_is_that_of_noisy_rings_and_attitudes(pose):
    rng = np.random.default_rng(4)
    truth, noise, count, trials = np.radians(pose), 5e-4, 240, 3000
    phi = np.linspace(0, 2 * np.pi, count, endpoint=False)
    attitude_covariance = np.diag(np.radians([0.4, 0.6, 1.0]) ** 2)
    rho = ring_cylinder(phi, 0.155, 0.145, *truth) + noise * rng.normal(size=(trials, count))
    attitude = truth + rng.multivariate_normal(np.zeros(3), attitude_covariance, size=trials)
    found = section_from_ring(
        *fit_rings(rho, phi),
        *attitude.T,
        covariance=ring_covariance(noise, count),
        attitude_covariance=attitude_covariance,
    )
    measured = np.cov(np.stack([found.r1, found.r2]))
    assert np.sqrt(np.diag(found.covariance.mean(axis=0))) == pytest.approx(np.sqrt(np.diag(measured)), rel=0.08)


def test_a_wrong_attitude_shows_as_inconsistency():
    ring = oblique_ellipse(11.0, 10.0, *np.radians([20, 20]))
    right = section_from_ring(*ring, *np.radians([20, 20]))
    wrong = section_from_ring(*ring, *np.radians([20, -20]))
    assert right.inconsistency < 1e-14
    assert wrong.inconsistency > 0.05


def test_an_impossible_ring_is_missing_not_guessed():
    found = section_from_ring(40.0, 3.0, 0.0, *np.radians([60, 60]))
    assert np.isnan([found.r1, found.r2]).all()
    assert found.inconsistency > 0.4
    missing = section_from_ring([11.0, np.nan], [10.0, 9.0], 0.0, 0.1, 0.1, covariance=ring_covariance(1e-3, 360))
    assert np.isfinite(missing.r1).tolist() == [True, False]
    assert np.isnan(missing.covariance[1]).all()


def test_without_covariance_there_is_none():
    assert np.isnan(section_from_ring(11.0, 10.0, 0.0, 0.1, 0.1).covariance).all()


def test_ring_covariance_is_that_of_a_least_squares_ring():
    phi = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    design = np.stack([np.ones(120), np.cos(2 * phi), np.sin(2 * phi)], axis=-1)
    np.testing.assert_allclose(ring_covariance(0.2, 120), 0.04 * np.linalg.inv(design.T @ design), atol=1e-15)


def test_ring_parameters_hold_no_direction_for_a_circle():
    np.testing.assert_allclose(ring_parameters(2.0, 2.0, np.nan), [2.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: section_from_ring(10.0, 11.0, 0.0, 0.0, 0.0), "minor = 11 .* Exchange"),
        (lambda: section_from_ring(11.0, 0.0, 0.0, 0.0, 0.0), "minor = 0"),
        (lambda: section_from_ring(11.0, 10.0, 0.0, 2.0, 0.0), "pitch = 2"),
        (lambda: section_from_ring(11.0, 10.0, 0.0, 0.0, 0.0, covariance=np.eye(2)), r"\(\.\.\., 3, 3\)"),
        (lambda: section_from_ring(11.0, 10.0, 0.0, 0.0, 0.0, covariance=np.zeros((3, 3))), "not positive definite"),
        (lambda: ring_covariance(-1.0, 100), "noise = -1"),
        (lambda: ring_covariance(1.0, 4), "readings = 4"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
