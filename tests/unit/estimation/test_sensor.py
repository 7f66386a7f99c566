"""The ring's ellipse against chapter 5's closed form, and what a bend adds against rays cast on a torus."""

import numpy as np

from springline.estimation.factors.sensor import ellipse, pose
from springline.estimation.torus import added_by_bend
from springline.geometry.bends import ring_bend
from springline.geometry.fitting import fit_ellipses_to_ranges
from springline.geometry.robot import frame, oblique_ellipse, ring_cylinder

BEARINGS = np.arange(360) * (2.0 * np.pi / 360)


def found(offset, angles, section):
    """Return what `locate` would tell of one place."""
    return np.concatenate([offset, frame(*angles).ravel(), section, np.zeros(5)])


def shown(offset, angles, section):
    out = np.empty(5)
    ellipse(found(offset, angles, section), out)
    return out


def test_shape_is_the_oblique_ellipse_of_chapter_5():
    angles = np.radians([12.0, -7.0, 20.0])
    _, _, mean, cos, sin = shown([0.0, 0.0], angles, [0.15, 0.01, 0.0])
    major, minor, beta = oblique_ellipse(0.16, 0.14, *angles)
    assert np.allclose([mean, np.hypot(cos, sin)], [(major + minor) / 2, (major - minor) / 2], rtol=1e-12)
    assert np.isclose(0.5 * np.arctan2(sin, cos), beta, rtol=1e-12)


def test_centre_and_shape_are_those_fitted_to_cast_rays():
    offset, angles = (0.012, -0.02), np.radians([6.0, 9.0, -30.0])
    ranges = ring_cylinder(BEARINGS, 0.155, 0.147, *angles, offset=offset)
    fit = fit_ellipses_to_ranges(ranges[None], BEARINGS)
    np.testing.assert_allclose(shown(offset, angles, [0.151, 0.004, 0.0]), fit.parameters[0], atol=1e-10)


def test_pose_is_read_back_from_the_frame():
    angles, out = np.radians([8.0, -5.0, 25.0]), np.empty(5)
    pose(found([0.01, 0.02], angles, [0.15, 0.0, 0.0]), out)
    np.testing.assert_allclose(out, [0.01, 0.02, *angles], atol=1e-14)


def test_what_a_bend_adds_is_what_rays_on_the_torus_add():
    # Upward bend of 2.5 D, tilts to 25 degrees, off centre.
    radius = 1.0
    for offset, degrees in (((0.0, 0.0), (25.0, 0.0, 0.0)), ((0.01, -0.02), (12.0, 15.0, 10.0))):
        angles = np.radians(degrees)
        bent = fit_ellipses_to_ranges(
            ring_bend(BEARINGS, radius, 0.203, 0.197, *angles, offset=offset)[None], BEARINGS, robust=False
        ).parameters[0]
        straight = shown(offset, angles, [0.2, 0.003, 0.0])
        added = added_by_bend(
            np.array([[*offset, *angles]]), np.array([[0.2, 0.003, 0.0]]), np.array([[1.0 / radius, 0.0]])
        )[0]
        whole = np.abs(bent - straight).max()
        assert whole > 0.9e-3
        assert np.abs(straight + added - bent).max() < 1e-4 * whole
