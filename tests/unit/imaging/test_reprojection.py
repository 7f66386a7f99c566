"""Contours of known laterals and joints, made forwards, fitted backwards."""

import math

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.camera import camera_matrix, project, turn_camera
from springline.geometry.lenses import Lens
from springline.geometry.openings import joint_contour, lateral_contour
from springline.imaging.decision import METHODS, decide, expected_contour
from springline.imaging.reprojection import Place, PosePrior, contour_noise, fit_joint, fit_lateral

LENS = Lens("equidistant", 333.0)
TURN = np.linspace(0, 2 * np.pi, 160, endpoint=False)
AHEAD = camera_matrix([2.0, 0.0, 0.0], [3.0, 0.0, 0.0])


def _lateral(rng, noise, *, bearing=0.7, inclination=0.3, radius=0.06, x=2.3, matrix=AHEAD):
    edge = lateral_contour(TURN, 0.15, 0.15, radius, bearing=bearing, inclination=inclination, x=x)
    return project(matrix, edge, LENS) + rng.normal(0, noise, (160, 2))


@pytest.mark.parametrize("bearing", [0.2, 1.5, 3.0, -2.9, -1.0])
@pytest.mark.parametrize("inclination", [-0.4, 0.0, 0.7])
def test_a_lateral_is_recovered_exactly_when_there_is_no_noise(bearing, inclination):
    contour = _lateral(np.random.default_rng(0), 0.0, bearing=bearing, inclination=inclination)
    fit = fit_lateral(contour, AHEAD, LENS, 0.15, 0.15, noise=0.3, inclination_sigma=10.0)
    assert fit
    assert abs(fit.value("x") - 2.3) < 2e-4 and abs(fit.value("radius") - 0.06) < 1e-4
    assert abs(math.remainder(fit.value("bearing") - bearing, 2 * math.pi)) < 1e-3
    assert abs(fit.value("inclination") - inclination) < 5e-3


def test_the_intervals_hold_the_truth():
    names, truth = ("x", "bearing", "radius"), (2.3, 0.7, 0.06)
    inside = np.zeros(3)
    for seed in range(120):
        rng = np.random.default_rng(seed)
        fit = fit_lateral(_lateral(rng, 1.5), AHEAD, LENS, 0.15, 0.15, noise=1.5, inclination_sigma=10.0)
        inside += [abs(fit.value(n) - t) < 1.96 * fit.sigma(n) for n, t in zip(names, truth, strict=True)]
    assert ((inside / 120 >= 0.90) & (inside / 120 <= 0.985)).all(), inside / 120


def test_a_joint_gives_its_place_and_the_pose_it_needs():
    tilted = turn_camera(AHEAD, pitch=0.05, yaw=-0.04)
    ring = project(tilted, joint_contour(TURN, 0.15, 0.15, x=2.4), LENS)
    fit = fit_joint(ring, AHEAD, LENS, 0.15, 0.15, prior=PosePrior(turn=0.06), noise=0.5)
    assert abs(fit.value("x") - 2.4) < 3e-3
    assert abs(fit.value("pitch") - 0.05) < 5e-3 and abs(fit.value("yaw") + 0.04) < 5e-3


def test_half_of_a_contour_suffices_and_a_prior_from_geometry_counts():
    contour = _lateral(np.random.default_rng(1), 1.0)
    contour[:80] = np.nan
    free = fit_lateral(contour, AHEAD, LENS, 0.15, 0.15)
    held = fit_lateral(contour, AHEAD, LENS, 0.15, 0.15, near=Place(x=2.3, x_sigma=0.002))
    assert abs(free.value("radius") - 0.06) < 4 * free.sigma("radius") + 0.004
    assert held.sigma("x") < 0.0021 and abs(held.value("x") - 2.3) < 0.006


def test_noise_is_told_from_roughness():
    rng = np.random.default_rng(4)
    clean = 90 * np.stack([np.cos(TURN), np.sin(TURN)], axis=-1)
    found = [contour_noise(clean + rng.normal(0, 2.0, clean.shape)) for _ in range(50)]
    assert abs(np.mean(found) - 2.0) < 0.15
    assert math.isnan(contour_noise(clean[:3]))


def test_too_little_is_a_stated_failure():
    fit = fit_lateral(np.full((20, 2), np.nan), AHEAD, LENS, 0.15, 0.15)
    assert not fit and "too few" in fit.reason and np.isnan(fit.parameters).all()
    with pytest.raises(ParameterError, match="contour"):
        fit_joint(np.zeros((4, 3)), AHEAD, LENS, 0.15, 0.15)


def test_decisions_by_every_method_have_a_score_and_reprojection_names_the_kind():
    rng = np.random.default_rng(2)
    lateral = _lateral(rng, 1.0)
    joint = project(AHEAD, joint_contour(TURN, 0.15, 0.15, x=2.5), LENS) + rng.normal(0, 1.0, (160, 2))
    template = expected_contour(AHEAD, LENS, 0.15, 0.15, lateral_radius=0.06, ahead=0.3)
    for method in METHODS:
        scores = [decide(c, AHEAD, LENS, 0.15, 0.15, method=method, template=template).score for c in (lateral, joint)]
        assert np.isfinite(scores).all() and (method != "reprojection" or scores[0] > 0 > scores[1])
    assert decide(lateral, AHEAD, LENS, 0.15, 0.15).kind == "lateral"
    assert decide(joint, AHEAD, LENS, 0.15, 0.15).kind == "joint"
    square = np.array([[60, 40], [120, 40], [120, 100], [60, 100]])
    rough = np.concatenate([np.linspace(a, b, 40) for a, b in zip(square, np.roll(square, -1, axis=0), strict=True)])
    assert decide(rough, AHEAD, LENS, 0.15, 0.15, noise=0.5).kind == "other"
    with pytest.raises(ParameterError, match="method"):
        decide(lateral, AHEAD, LENS, 0.15, 0.15, method="wavelet")
