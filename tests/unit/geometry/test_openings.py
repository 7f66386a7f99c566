"""Laterals and joints lie on the surfaces that make them; sizes and distances by direct geometry."""

from __future__ import annotations

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry import camera, openings
from springline.geometry.lenses import MODELS, Lens

TURN = np.linspace(0.0, 2 * np.pi, 90, endpoint=False)


def bore(bearing, inclination):
    """Axis of the bore, out of its bearing and inclination."""
    return np.array([np.sin(inclination), np.cos(inclination) * np.sin(bearing), np.cos(inclination) * np.cos(bearing)])


def test_every_point_lies_on_the_pipe_and_on_the_bore():
    rng = np.random.default_rng(4)
    count = 60
    r1, r2 = rng.uniform(5, 12, (2, count))
    radius = rng.uniform(0.1, 0.95, count) * np.minimum(r1, r2)
    bearing, inclination = rng.uniform(-np.pi, np.pi, count), rng.uniform(-1.2, 1.2, count)
    x = rng.uniform(-3, 3, count)
    edges = openings.lateral_contour(TURN, r1, r2, radius, bearing=bearing, inclination=inclination, x=x)
    assert edges.shape == (count, 90, 3)
    wall = (edges[..., 2] / r1[:, None]) ** 2 + (edges[..., 1] / r2[:, None]) ** 2
    np.testing.assert_allclose(wall, 1.0, atol=1e-12)
    for edge, axis, size, start in zip(edges, map(bore, bearing, inclination), radius, x, strict=True):
        relative = edge - [start, 0, 0]
        along = relative @ axis
        np.testing.assert_allclose(np.linalg.norm(relative - along[:, None] * axis, axis=1), size, rtol=1e-10)
        # out of the near wall, not the one behind the axis
        assert np.all(edge[:, 1:] @ axis[1:] > 0)


def test_turns_begin_ahead_and_go_to_the_right_of_the_crown():
    edge = openings.lateral_contour([0.0, np.pi / 2], 10.0, 10.0, 2.0, x=1.0)
    np.testing.assert_allclose(edge, [[3, 10, 0], [1, np.sqrt(96), 2]], atol=1e-12)


def test_a_tee_as_wide_as_the_pipe_closes_and_a_wider_one_does_not():
    tee = openings.lateral_contour(TURN, 10.0, 10.0, 10.0)
    assert np.isfinite(tee).all()
    np.testing.assert_allclose(tee[:, 1], np.abs(tee[:, 0]), atol=1e-6)
    wide = openings.lateral_contour(TURN, 10.0, 10.0, 10.1)
    assert 0 < np.isnan(wide).all(axis=1).sum() < len(TURN)


def test_joints_lie_on_the_wall_at_their_place():
    ring = openings.joint_contour(TURN, 11.0, 9.0, x=[1.0, 2.0])
    assert ring.shape == (2, 90, 3)
    np.testing.assert_allclose((ring[..., 2] / 11) ** 2 + (ring[..., 1] / 9) ** 2, 1.0)
    assert np.all(ring[..., 0] == [[1.0], [2.0]])


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("distance", "bore_radius"), [(30.0, 0.5), (15.0, 5.0), (5.5, 3.0)])
def test_sizes_are_those_of_projected_edges(model, distance, bore_radius):
    """(6.1) and 6.4.1 against the lateral itself, projected from the axis."""
    lens = Lens(model, 384.0)
    edge = openings.lateral_contour([np.pi, 0.0], 10.0, 10.0, bore_radius)
    seen = camera.project(camera.camera_matrix([-distance, 0, 0], [0, 0, 0]), edge, lens)
    near = np.arctan2(10.0, distance - bore_radius)
    assert openings.zenith_far(near, 10.0, bore_radius) == pytest.approx(np.arctan2(10.0, distance + bore_radius))
    assert openings.lateral_size(near, 10.0, bore_radius, lens) == pytest.approx(seen[0, 1] - seen[1, 1], rel=1e-9)


def test_far_edge_of_a_lateral_that_the_camera_has_half_passed():
    assert openings.zenith_far(np.radians(100), 10.0, 8.0) == pytest.approx(
        np.arctan2(10, 10 / np.tan(np.radians(100)) + 16)
    )
    assert np.isnan(openings.lateral_size(np.radians(100), 10.0, 8.0, Lens("sine", 1.0)))


def test_sine_size_peaks_where_the_limit_says():
    """A small lateral is largest at atan(sqrt 2) through a sine lens (erratum 42)."""
    near = np.radians(np.linspace(5, 89, 8401))
    size = openings.lateral_size(near, 10.0, 1e-4, Lens("sine", 1.0))
    assert np.degrees(near[np.argmax(size)]) == pytest.approx(np.degrees(np.arctan(np.sqrt(2))), abs=0.02)


def test_bias_is_where_the_wall_enters_the_views():
    """The rays of both view edges meet the wall that far apart (erratum 34)."""
    front, rear = np.radians(60.0), np.radians(75.0)
    ahead = 10.0 / np.tan(front) + 10.0 / np.tan(rear)
    assert openings.distance_bias(20.0, 10.0, half_front=front, half_rear=rear) == pytest.approx(20.0 + ahead)
    printed = 20.0 + 10.0 * (np.cos(front) + np.cos(rear))
    assert abs(openings.distance_bias(20.0, 10.0, half_front=front, half_rear=rear) - printed) > 0.5


def test_what_is_out_of_range_is_refused():
    for wrong in (
        lambda: openings.lateral_contour(TURN, 10.0, 10.0, 0.0),
        lambda: openings.lateral_contour(TURN, 10.0, 10.0, 1.0, inclination=np.pi / 2),
        lambda: openings.joint_contour(TURN, -1.0, 10.0),
        lambda: openings.zenith_far(-0.1, 10.0, 1.0),
        lambda: openings.zenith_far(0.1, 10.0, -1.0),
        lambda: openings.distance_bias(1.0, 10.0, half_front=0.0, half_rear=1.0),
    ):
        with pytest.raises(ParameterError):
            wrong()
    assert np.isnan(openings.lateral_contour(TURN, np.nan, 10.0, 1.0)).all()
