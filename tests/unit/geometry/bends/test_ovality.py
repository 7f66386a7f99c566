import numpy as np
import pytest
from scipy.special import ellipe

from springline.geometry.bends import bend_ovality, ring_ovality, tilt_ovality
from springline.geometry.robot import oblique_ellipse


@pytest.mark.parametrize("pose", [(0.0, 0.0), (10.0, 0.0), (12.0, -20.0), (35.0, 25.0)])
@pytest.mark.parametrize("pipe", [(0.1, 0.1), (0.11, 0.1), (0.1, 0.108)])
def test_a_tilt_fakes_the_ovality_of_its_ellipse(pipe, pose):
    a, b, _ = oblique_ellipse(*pipe, *np.radians(pose))
    shown = tilt_ovality(*pipe, *np.radians(pose))
    grid = np.linspace(0, 2 * np.pi, 4096, endpoint=False)
    means = [
        a + b,
        2 * np.mean(a * b / np.hypot(b * np.cos(grid), a * np.sin(grid))),
        2 * np.sqrt(a * b),
        4 * a * ellipe(1 - (b / a) ** 2) / np.pi,
    ]
    np.testing.assert_allclose(shown[:2], [2 * a, 2 * b], rtol=1e-9)
    np.testing.assert_allclose(shown[2:], 2 * a / np.array(means) - 1, atol=1e-9)


def test_an_untilted_ring_in_a_round_bend_is_round():
    np.testing.assert_allclose(bend_ovality(1.0, 0.15, 0.15)[2:], 0.0, atol=1e-12)


def test_the_offset_of_the_scanner_fakes_nothing():
    poses = np.radians([3.0, 12.0])
    centred = bend_ovality(0.8, 0.15, 0.15, poses, 0.1)
    moved = bend_ovality(0.8, 0.15, 0.15, poses, 0.1, offset=(0.0, 0.0))
    assert centred.axes.shape == (2,)
    np.testing.assert_array_equal(centred.axes, moved.axes)
    # Away from the axis the plane cuts another part of the bend, so rings differ, but only by the tilt's change.
    np.testing.assert_allclose(
        bend_ovality(1e4, 0.15, 0.15, poses, 0.1, offset=(0.02, 0.01)).axes,
        tilt_ovality(0.15, 0.15, poses, 0.1).axes,
        atol=1e-6,
    )


def test_a_wide_bend_fakes_what_the_tilt_alone_fakes():
    tilt = tilt_ovality(0.15, 0.15, np.radians(8), np.radians(3))
    bend = bend_ovality(1e6, 0.15, 0.15, np.radians(8), np.radians(3))
    np.testing.assert_allclose(bend, tilt, atol=1e-8)


def test_the_hull_of_a_hollow_ring_is_convex():
    phi = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    radius = 1 + 0.25 * np.cos(4 * phi)
    x, y = radius * np.cos(phi), radius * np.sin(phi)
    widths = [np.ptp(np.cos(t) * x + np.sin(t) * y) for t in np.linspace(0, np.pi, 2000, endpoint=False)]
    caliper = 2.5 / (1 + ring_ovality(radius).caliper)
    assert caliper == pytest.approx(np.mean(widths), rel=1e-5)


def test_missing_readings_make_a_missing_ovality():
    radius = np.ones((2, 64))
    radius[1, 5] = np.nan
    assert np.isnan(ring_ovality(radius).polar).tolist() == [False, True]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ring_ovality(np.ones(90)), "90 readings"),
        (lambda: ring_ovality(1.0), "0 readings"),
        (lambda: ring_ovality(-np.ones(64)), "radius = -1"),
        (lambda: bend_ovality(0.1, 0.15, 0.15), "bend_radius = 0.1"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
