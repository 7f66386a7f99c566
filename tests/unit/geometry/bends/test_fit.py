import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from springline.geometry.bends import fit_bend, locate

TURNED = Rotation.random(random_state=3).as_matrix()
MOVED = np.array([5.0, -3.0, 2.0])


def survey(seed, *, bend_radius=1.0, angle=90.0, r1=0.2, r2=0.2, noise=0.002, before=1.0, after=1.0, rings=24):
    """Rings (n, 36, 3) of slightly oblique laser planes, by moving a section along straight, arc and straight."""
    rng = np.random.default_rng(seed)
    angle = np.radians(angle)
    where = np.linspace(-before, bend_radius * angle + after, rings)[:, None]
    phi = np.linspace(0, 2 * np.pi, 36, endpoint=False)
    where = where + 0.1 * r1 * np.sin(phi + rng.uniform(0, 6, size=(rings, 1)))
    turn = np.clip(where / bend_radius, 0, angle)
    rest = where - bend_radius * turn
    error = noise * rng.normal(size=where.shape)
    out = bend_radius + (r2 + error) * np.cos(phi)
    x = out * np.sin(turn) + rest * np.cos(turn)
    y = bend_radius - out * np.cos(turn) + rest * np.sin(turn)
    z = np.broadcast_to((r1 + error) * np.sin(phi), x.shape)
    return np.stack([x, y, z], axis=-1) @ TURNED + MOVED


def sigmas(found):
    return np.sqrt(np.diag(found.covariance))


@pytest.mark.parametrize(
    ("bend_radius", "angle", "r2"), [(1.0, 90.0, 0.2), (0.4, 45.0, 0.2), (3.0, 20.0, 0.19), (8.0, 8.0, 0.21)]
)
def test_exact_rings_give_the_bend_back(bend_radius, angle, r2):
    rings = survey(1, bend_radius=bend_radius, angle=angle, r2=r2, noise=0.0)
    found = fit_bend(rings, section="ellipse")
    assert found.reason == "fitted"
    assert found.bend_radius == pytest.approx(bend_radius, rel=1e-5)
    assert np.degrees(found.angle) == pytest.approx(angle, abs=1e-4)
    assert [found.r1, found.r2] == pytest.approx([0.2, r2], abs=1e-6)
    np.testing.assert_allclose(found.frame, TURNED, atol=1e-5)
    np.testing.assert_allclose(found.start, MOVED, atol=1e-4)
    np.testing.assert_allclose(found.centre, MOVED + bend_radius * TURNED[1], atol=1e-4)
    turn = np.radians(angle)
    np.testing.assert_allclose(found.exit, np.cos(turn) * TURNED[0] + np.sin(turn) * TURNED[1], atol=1e-5)


def test_stated_sigmas_cover_the_truth():
    pipe = {"bend_radius": 1.5, "angle": 30.0, "before": 0.8, "after": 0.8, "rings": 16}
    found = [fit_bend(survey(seed, **pipe)) for seed in range(40)]
    errors = np.array([[f.bend_radius - 1.5, f.angle - np.radians(30), f.r1 - 0.2] for f in found])
    scores = errors / np.array([sigmas(f)[[0, 1, 3]] for f in found])
    assert all(found)
    assert scores.std(axis=0).min() > 0.7
    assert scores.std(axis=0).max() < 1.35
    assert np.mean([f.noise for f in found]) == pytest.approx(0.002, rel=0.1)


def test_outliers_and_gaps_do_not_bend_the_fit():
    rng = np.random.default_rng(3)
    rings = survey(2)
    rings[rng.random(rings.shape[:2]) < 0.3] = np.nan
    wild = rng.random(rings.shape[:2]) < 0.05
    rings[wild] += rng.normal(0, 0.05, size=(wild.sum(), 3))
    found = fit_bend(rings)
    assert found
    assert abs(found.bend_radius - 1.0) < 4 * sigmas(found)[0] < 0.01
    assert abs(np.degrees(found.angle) - 90) < 0.3


def test_the_start_is_told_from_the_first_ring():
    found = fit_bend(survey(4, before=0.7))
    assert found.start_chainage == pytest.approx(0.7, abs=5 * sigmas(found)[2] + 0.003)


def test_the_bearing_says_which_way_the_pipe_turns():
    rings = (survey(5) - MOVED) @ TURNED.T
    assert np.degrees(fit_bend(rings).bearing()) == pytest.approx(90, abs=0.1)
    assert np.degrees(fit_bend(rings[..., [0, 2, 1]]).bearing()) == pytest.approx(0, abs=0.1)
    assert np.degrees(fit_bend(rings * [1, -1, -1]).bearing()) == pytest.approx(-90, abs=0.1)


def test_rings_within_the_bend_give_its_radius_alone():
    found = fit_bend(survey(6, before=-0.3, after=-0.3), straights=False)
    assert found
    assert abs(found.bend_radius - 1.0) < 4 * sigmas(found)[0] < 0.02
    assert np.isnan([found.angle, found.start_chainage]).all()


@pytest.mark.parametrize(
    ("survey_of", "status", "known"),
    [
        ({"angle": 0.001}, 2, []),
        ({"before": -0.3}, 4, ["bend_radius", "r1", "r2"]),
        ({"after": -0.3}, 5, ["bend_radius", "start_chainage", "r1", "r2"]),
        ({"angle": 1.0}, 6, ["angle", "r1", "r2"]),
    ],
)
def test_what_the_rings_cannot_tell_is_missing_with_its_reason(survey_of, status, known):
    found = fit_bend(survey(7, **survey_of))
    assert found.status == status
    assert not found
    names = ("bend_radius", "angle", "start_chainage", "r1", "r2")
    seen = [name for name in names if np.isfinite(getattr(found, name))]
    assert seen == (known or ["r1", "r2"])
    assert np.isfinite(sigmas(found)).tolist() == [name in known for name in names]


def test_a_straight_pipe_has_no_bend_radius_either_way():
    rings = survey(8, angle=0.001)
    assert fit_bend(rings, straights=False).status == 2


def test_too_few_rings_are_said_so():
    assert fit_bend(survey(9)[:3]).reason == "too few rings with readings"
    rings = survey(9)
    rings[3:, 4:] = np.nan
    assert fit_bend(rings).status == 1


def test_points_past_the_bend_are_located_on_the_straight():
    start, rows = np.array([1.0, 2.0, 3.0]), TURNED
    point = start + np.array([2.0 + 0.05, 2.0 + 0.4, -0.07]) @ rows
    place = locate(point, start, rows, 2.0, np.pi / 2)
    np.testing.assert_allclose(place, [np.pi + 0.4, 0.05, -0.07], atol=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fit_bend(np.zeros((5, 3))), r"rings has shape \(5, 3\)"),
        (lambda: fit_bend(np.full((5, 9, 3), np.inf)), "rings = inf"),
        (lambda: fit_bend(np.zeros((5, 9, 3)), section="egg"), "section = 'egg'"),
        (lambda: fit_bend(np.zeros((5, 9, 3)), noise=0.0), "noise = 0"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
