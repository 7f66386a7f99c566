import numpy as np
import pytest

from springline.geometry.robot import axis, conic_to_ellipse, frame, oblique_ellipse, ring_cylinder

POSES = [(15, 7.5, 0), (-15, 7.5, 5), (15, -7.5, -20), (28, 15, 3), (30, 30, 80), (0, 0, 30), (24.6, 0, 0)]


@pytest.mark.parametrize("order", ["direct", "pitch_yaw", "yaw_pitch"])
@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("offset", [(0.0, 0.0), (1.5, -2.0)])
def test_ring_points_lie_on_the_pipe_and_in_the_ring_plane(pose, order, offset):
    pose = np.radians(pose)
    phi = np.linspace(0, 2 * np.pi, 37)
    rho = ring_cylinder(phi, 11.0, 10.0, *pose, order=order, offset=offset)
    x, y, z = frame(*pose, order=order)
    points = rho[:, None] * (np.cos(phi)[:, None] * z + np.sin(phi)[:, None] * y) + [0.0, *offset]
    np.testing.assert_allclose((points[:, 2] / 11) ** 2 + (points[:, 1] / 10) ** 2, 1.0, atol=1e-13)
    np.testing.assert_allclose((points - [0.0, *offset]) @ x, 0.0, atol=1e-12)
    assert (rho > 0).all()


@pytest.mark.parametrize("pose", POSES)
def test_the_oblique_ellipse_is_the_longest_and_shortest_radius_of_the_ring(pose):
    pose = np.radians(pose)
    major, minor, beta = oblique_ellipse(11.0, 10.0, *pose)
    phi = np.linspace(0, np.pi, 200001)
    rho = ring_cylinder(phi, 11.0, 10.0, *pose)
    assert major == pytest.approx(rho.max(), rel=1e-9)
    assert minor == pytest.approx(rho.min(), rel=1e-9)
    assert ring_cylinder(beta, 11.0, 10.0, *pose) == pytest.approx(major, rel=1e-12)
    a, b, c = axis(*pose[:2])
    assert major * minor == pytest.approx(110 / a, rel=1e-13)
    assert 1 / major**2 + 1 / minor**2 == pytest.approx((1 - b * b) / 100 + (1 - c * c) / 121, rel=1e-13)


def test_beta_is_signed_and_mirrors_with_the_yaw():
    right = oblique_ellipse(11.0, 10.0, *np.radians([15, 7.5]))
    left = oblique_ellipse(11.0, 10.0, *np.radians([15, -7.5]))
    assert right.beta == pytest.approx(-left.beta)
    assert right.major == pytest.approx(left.major)


def test_the_major_axis_jumps_at_24_6_degrees_only_without_yaw():
    yawless = oblique_ellipse(11.0, 10.0, np.radians([24.61, 24.63]), 0.0)
    assert np.degrees(yawless.beta) == pytest.approx([0, 90])
    yawed = oblique_ellipse(11.0, 10.0, np.radians(25.67), np.radians(7.5))
    assert np.degrees(yawed.beta) == pytest.approx(45, abs=0.1)


def test_a_circle_has_no_major_axis():
    assert np.isnan(oblique_ellipse(10.0, 10.0, 0.0, 0.0, 0.5).beta)
    assert np.isfinite(oblique_ellipse(10.0, 10.0, 0.0, 0.01).beta)


def test_rings_batch():
    phi = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    pitch = np.radians([[0.0], [10.0], [np.nan]])
    rho = ring_cylinder(phi, 0.11, 0.1, pitch, 0.0, offset=(np.array([[0.0], [0.01], [0.0]]), 0.0))
    assert rho.shape == (3, 90)
    np.testing.assert_array_equal(rho[1], ring_cylinder(phi, 0.11, 0.1, pitch[1], 0.0, offset=(0.01, 0.0)))
    assert np.isnan(rho[2]).all()


@pytest.mark.parametrize("factor", [1.0, -3.0, 1e-6])
@pytest.mark.parametrize("beta", [-80.0, -33.0, 0.0, 45.0, 90.0])
def test_conics_come_back(factor, beta):
    turn, zc, yc, major, minor = np.radians(beta), 4.0, -3.0, 12.0, 7.0
    turned = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    (a, half), (_, c) = turned.T @ np.diag([major**-2, minor**-2]) @ turned
    d, e = -2 * (a * zc + half * yc), -2 * (half * zc + c * yc)
    f = a * zc**2 + 2 * half * zc * yc + c * yc**2 - 1
    found = conic_to_ellipse(*(factor * np.array([a, 2 * half, c, d, e, f])))
    np.testing.assert_allclose(found, [zc, yc, major, minor, turn], atol=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: conic_to_ellipse(1, 0, -1, 0, 0, -1), "parabola or a hyperbola"),
        (lambda: conic_to_ellipse(1, 0, 1, 0, 0, 1), "no real points"),
        (lambda: oblique_ellipse(0.0, 10.0, 0.0, 0.0), "r1 = 0"),
        (lambda: oblique_ellipse(11.0, -10.0, 0.0, 0.0), "r2 = -10"),
        (lambda: ring_cylinder(0.0, 11.0, 10.0, 0.0, 0.0, offset=(10.0, 0.0)), "inside the pipe"),
        (lambda: ring_cylinder(np.inf, 11.0, 10.0, 0.0, 0.0), "phi = inf"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
