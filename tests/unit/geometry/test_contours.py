"""Transforms by their own sums, descriptors against published figures, distances against plain searches."""

from __future__ import annotations

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry import camera, contours, openings, robot
from springline.geometry.lenses import Lens

TURN = np.linspace(0.0, 2 * np.pi, 200, endpoint=False)
CIRCLE = np.stack([np.cos(TURN), np.sin(TURN)], axis=-1)
EGG = np.stack([2 * np.cos(TURN) + 0.4 * np.cos(2 * TURN), np.sin(TURN) + 0.1 * np.sin(3 * TURN)], axis=-1)
LENS = Lens.of_view_angle("sine", np.radians(120), 768.0)


def seen(points, distance):
    matrix = camera.camera_matrix([-distance, 0, 0], [0, 0, 0])
    return camera.project(matrix, points, Lens(LENS.model, LENS.k))


def lateral(radius, distance=30.0):
    return seen(openings.lateral_contour(TURN, 10.0, 10.0, radius), distance)


def oval_joint(distance):
    return seen(openings.joint_contour(TURN, robot.deformed_r1(0.9, r=10.0), 9.0), distance)


def test_transform_is_its_sum():
    curve = contours.to_complex(EGG[:15])
    n = np.arange(15)
    plain = np.array([np.sum(curve * np.exp(-2j * np.pi * k * n / 15)) for k in n])
    np.testing.assert_allclose(contours.dft(curve), plain, atol=1e-12)
    np.testing.assert_allclose(contours.inverse_dft(plain), curve, atol=1e-13)
    backwards = contours.dft(np.roll(curve[::-1], 1))
    np.testing.assert_allclose(contours.reversed_dft(plain), backwards, atol=1e-12)
    later = contours.dft(np.roll(curve, -4))
    np.testing.assert_allclose(contours.shifted_dft(plain, 4), later, atol=1e-12)


def test_the_sense_does_not_leave_magnitudes_alone():
    """Why contours are oriented first (erratum 30)."""
    forwards = np.abs(contours.dft(contours.to_complex(EGG)))
    backwards = np.abs(contours.dft(contours.to_complex(EGG[::-1])))
    assert abs(forwards[1] - backwards[1]) > 50
    assert contours.signed_area(EGG) > 0 > contours.signed_area(EGG[::-1])
    np.testing.assert_allclose(contours.orient(EGG[::-1])[0], EGG[-1])
    assert contours.signed_area(contours.orient(EGG[::-1])) == pytest.approx(contours.signed_area(EGG))


def test_published_norms():
    """Noise-free norms of 6.6 with the eye on the axis, as the errata state them."""
    sizes = np.linspace(0.5, 6.0, 12)
    far, near = (contours.descriptor_norm([lateral(size, d) for size in sizes]) for d in (30.0, 8.0))
    assert np.round([far.min(), far.max()], 3).tolist() == [1.136, 1.165]
    assert np.round([near.min(), near.max()], 3).tolist() == [1.058, 1.102]
    for distance, norm in ((30.0, 1.004), (8.0, 1.003)):
        ring = seen(openings.joint_contour(TURN, 10.0, 10.0), distance)
        assert contours.descriptor_norm(ring) == pytest.approx(1.0, abs=1e-12)
        assert round(float(contours.descriptor_norm(oval_joint(distance))), 3) == norm


@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (1.1, 0.9), (3.0, 1.0), (1.0, 3.0), (5.0, 0.1)])
def test_norm_of_an_ellipse(a, b):
    ellipse = CIRCLE * [a, b]
    expected = np.sqrt(1 + ((a - b) / (a + b)) ** 2)
    assert contours.descriptor_norm(ellipse) == pytest.approx(expected, rel=1e-12)
    assert contours.norm_difference(ellipse, CIRCLE) == pytest.approx(expected - 1, abs=1e-12)


def test_without_a_leading_frequency_there_is_no_norm():
    trefoil = np.stack([np.cos(2 * TURN), np.sin(2 * TURN)], axis=-1)
    assert np.isnan(contours.descriptor_norm(trefoil))
    assert np.isnan(contours.descriptor_norm(0 * CIRCLE))


@pytest.mark.parametrize(("length", "keep"), [(200, 32), (201, 32), (201, 31), (10, 10), (9, 30)])
def test_kept_frequencies_are_the_low_ones(length, keep):
    found = contours.kept_frequencies(length, keep)
    assert len(set(found)) == len(found) == min(length, keep)
    assert found[0] == 0
    assert set(found) == set(range(-(len(found) // 2), len(found) - len(found) // 2))
    every = np.fft.fftfreq(length, 1 / length).round().astype(int)
    assert all(every[f] == f for f in found)


def test_equal_steps_do_not_depend_on_the_sampling():
    crowded = TURN + 0.4 * np.sin(TURN)
    uneven = np.stack([np.cos(crowded), np.sin(crowded)], axis=-1)
    points = contours.resample(uneven, 50)
    assert points.shape == (50, 2)
    np.testing.assert_allclose(np.arctan2(points[:, 1], points[:, 0]) % (2 * np.pi), TURN[::4], atol=2e-3)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert np.ptp(steps) < 2e-3 * steps.mean()
    doubled = np.repeat(uneven, 2, axis=0)
    np.testing.assert_allclose(contours.resample(doubled, 50), points, atol=1e-12)


def test_procrustes_is_that_of_a_plain_search():
    from scipy.spatial import procrustes

    a, b = contours.resample(EGG, 64), contours.resample(contours.orient(lateral(6.0)), 64)
    least = min(procrustes(a, np.roll(b, shift, axis=0))[2] for shift in range(64))
    assert contours.procrustes_distance(EGG, lateral(6.0), 64) == pytest.approx(np.sqrt(least), rel=1e-9)


@pytest.mark.parametrize("rotation", [True, False])
def test_fourier_distance_is_that_of_a_plain_search(rotation):
    a, b = (contours.unit_descriptors(c, 10, 256) for c in (EGG, np.roll(lateral(6.0), 37, axis=0)))
    k = np.r_[-10:0, 1:11]
    shifts = np.exp(1j * np.outer(np.linspace(0, 2 * np.pi, 4001), k))
    if rotation:
        angles = np.exp(1j * np.linspace(0, 2 * np.pi, 721))
        least = min(np.linalg.norm(a - angles[:, None] * (s * b), axis=1).min() for s in shifts[::5])
    else:
        least = np.linalg.norm(a - shifts * b, axis=1).min()
    found = contours.fourier_distance(EGG, np.roll(lateral(6.0), 37, axis=0), rotation=rotation)
    assert found <= least + 1e-9
    assert found == pytest.approx(least, abs=2e-4)


def test_elliptic_descriptors_are_those_of_a_fine_transform():
    """The polygon's coefficients in closed form against the transform of 20,000 points along it."""
    raw = contours.dft(contours.to_complex(contours.resample(EGG, 20000))) / 20000
    begun = contours.elliptic_descriptors(EGG, 4)
    for n in range(1, 5):
        plus, minus = raw[n], raw[-n]
        size = [abs(plus) + abs(minus), abs(abs(plus) - abs(minus))]
        first = abs(raw[1]) + abs(raw[-1])
        np.testing.assert_allclose(np.linalg.svd(begun[n - 1])[1], np.divide(size, first), atol=1e-6)
    np.testing.assert_allclose(begun[0, [0, 0, 1], [0, 1, 0]], [1, 0, 0], atol=1e-12)


@pytest.mark.parametrize(
    "distance",
    [
        contours.fourier_distance,
        contours.procrustes_distance,
        contours.elliptic_distance,
        lambda a, b: np.abs(contours.norm_difference(a, b)),
    ],
    ids=["fourier", "procrustes", "elliptic", "norm"],
)
def test_batches_are_each_alone_and_missing_points_make_no_distance(distance):
    shapes = np.stack([lateral(0.5), lateral(6.0), oval_joint(8.0), CIRCLE])
    together = distance(shapes[:, None], shapes)
    assert together.shape == (4, 4)
    for i in range(4):
        for j in range(4):
            assert together[i, j] == pytest.approx(distance(shapes[i], shapes[j]), abs=1e-9)
    np.testing.assert_allclose(np.diag(together), 0.0, atol=1e-6)
    shapes[1, 7] = np.nan
    broken = distance(shapes, EGG)
    assert np.isnan(broken).tolist() == [False, True, False, False]


def test_a_joint_is_farther_from_a_lateral_than_another_lateral():
    for distance in (contours.fourier_distance, contours.procrustes_distance, contours.elliptic_distance):
        assert distance(lateral(6.0), lateral(3.0)) < 0.5 * distance(lateral(6.0), oval_joint(30.0))


def test_what_is_no_contour_is_refused():
    for wrong in (
        lambda: contours.to_complex(CIRCLE[:2]),
        lambda: contours.to_complex(CIRCLE.T),
        lambda: contours.to_complex(np.full((4, 2), np.inf)),
        lambda: contours.resample(CIRCLE, 2),
        lambda: contours.kept_frequencies(0, 3),
        lambda: contours.unit_descriptors(CIRCLE, 32, 64),
        lambda: contours.fourier_distance(CIRCLE, EGG, steps=0),
        lambda: contours.elliptic_descriptors(CIRCLE, 0),
    ):
        with pytest.raises(ParameterError):
            wrong()
    assert np.isnan(contours.resample(0 * CIRCLE, 10)).all()
