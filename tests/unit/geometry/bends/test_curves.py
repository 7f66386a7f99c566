import numpy as np
import pytest

from springline.geometry.bends import bend_section, ring_bend
from springline.geometry.robot import frame


def level(points, bend_radius, r1, r2):
    """Level of the section at points about the torus axis: 1 on the wall."""
    return ((np.hypot(points[..., 0], points[..., 1]) - bend_radius) / r2) ** 2 + (points[..., 2] / r1) ** 2


@pytest.mark.parametrize("wall", [1, -1])
@pytest.mark.parametrize("tilt", [(0, 0), (15, 0), (0, 15), (15, 15), (25, -10), (-20, 30)])
@pytest.mark.parametrize("pipe", [(20.0, 10.0, 10.0), (30.0, 11.0, 9.0), (60.0, 9.0, 12.0)])
def test_the_closed_curve_lies_on_the_torus(pipe, tilt, wall):
    bend_radius, r1, _ = pipe
    z = np.linspace(-0.95, 0.95, 41) * r1
    y = bend_section(z, *pipe, *np.radians(tilt), wall=wall)
    _, y_axis, z_axis = frame(*np.radians(tilt), order="pitch_yaw")
    points = y[:, None] * y_axis + z[:, None] * z_axis - [0, bend_radius, 0]
    on = ~np.isnan(y)
    assert on.any()
    np.testing.assert_allclose(level(points[on], *pipe), 1.0, atol=1e-12)
    side = np.hypot(points[on, 0], points[on, 1]) - bend_radius
    assert (wall * side >= 0).all()


def test_the_closed_curve_and_the_cast_ring_are_one():
    pipe, tilt = (30.0, 11.0, 9.0), np.radians([15, -20])
    phi = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    rho = ring_bend(phi, *pipe, *tilt, order="pitch_yaw")
    y, z = rho * np.sin(phi), rho * np.cos(phi)
    walls = np.stack([bend_section(z, *pipe, *tilt, wall=wall) for wall in (1, -1)])
    assert np.nanmin(np.abs(walls - y), axis=0).max() < 1e-7


def test_the_printed_quartics_vanish_on_the_curve():
    r, big = 10.0, 20.0
    z = np.linspace(-9, 9, 19)
    pitch, yaw = np.radians([15.0, 20.0])
    y = bend_section(z, big, r, r, pitch) - big * np.cos(pitch)
    c = big * np.sin(pitch)
    left = (y**2 + z**2) ** 2 - 2 * (r**2 + big**2 - c**2) * y**2 - 2 * (r**2 - big**2 - c**2) * z**2
    np.testing.assert_allclose(left, -(r + big + c) * (r + big - c) * (r - big + c) * (r - big - c), rtol=1e-10)
    y = bend_section(z, big, r, r, 0.0, yaw) - big
    c = big * np.sin(yaw)
    left = (y**2 + z**2) ** 2 - 2 * (r**2 + big**2) * y**2 - 2 * (r**2 - big**2 + 2 * c**2) * z**2
    np.testing.assert_allclose(left, -((r**2 - big**2) ** 2), rtol=1e-10)


def test_a_steep_plane_misses_the_inner_wall():
    assert np.isnan(bend_section(0.0, 20.0, 10.0, 10.0, np.radians(35), wall=-1))
    assert np.isfinite(bend_section(0.0, 20.0, 10.0, 10.0, np.radians(35), wall=1))
    assert np.isnan(bend_section(10.01, 20.0, 10.0, 10.0))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: bend_section(0.0, 10.0, 10.0, 10.0), "bend_radius = 10 .* bend_radius > r2"),
        (lambda: bend_section(0.0, 20.0, 10.0, 10.0, wall=2), "wall = 2"),
        (lambda: bend_section(0.0, 20.0, 0.0, 10.0), "r1 = 0"),
        (lambda: bend_section(0.0, 20.0, 10.0, 10.0, 2.0), "pitch = 2"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
