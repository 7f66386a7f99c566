"""Frames laid out on the wall, against a picture painted ray by ray."""

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.camera import camera_at, from_pixels, project, rays, to_pixels
from springline.geometry.lenses import Lens
from springline.geometry.robot import frame
from springline.imaging.unwrapping import wall_grid

LENS = Lens("equidistant", 300.0)
CENTRE = (319.5, 239.5)


def _painted(eye, axes, r1, r2):
    """A chequered wall as the camera sees it: 25 mm along by 15 degrees round."""
    column, row = np.meshgrid(np.arange(640.0), np.arange(480.0))
    matrix = camera_at(eye, axes)
    ways = rays(matrix, from_pixels(np.stack([column, row], axis=-1).reshape(-1, 2), CENTRE), LENS)
    a = ways[:, 1] ** 2 / r2**2 + ways[:, 2] ** 2 / r1**2
    b = ways[:, 1] * eye[1] / r2**2 + ways[:, 2] * eye[2] / r1**2
    c = eye[1] ** 2 / r2**2 + eye[2] ** 2 / r1**2 - 1.0
    t = (-b + np.sqrt(b * b - a * c)) / a
    hit = np.asarray(eye) + t[:, None] * ways
    bearing = np.degrees(np.arctan2(hit[:, 1], hit[:, 2]))
    light = 100.0 + 50.0 * np.sin(2 * np.pi * hit[:, 0] / 0.05) * np.cos(np.radians(12 * bearing))
    return matrix, np.where(hit[:, 0] > eye[0] + 0.02, light, 0.0).reshape(480, 640).astype(np.float32)


@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0, 0.0, 0.0), (0.02, -0.015, 0.05, -0.04, 0.1)])
@pytest.mark.parametrize("radii", [(0.15, 0.15), (0.16, 0.14)])
def test_the_wall_comes_out_as_it_was_painted(pose, radii):
    up, right, *turn = pose
    matrix, picture = _painted([1.0, up, right], frame(*turn), *radii)
    grid = wall_grid(matrix, LENS, CENTRE, *radii, 1.0 + np.arange(0.12, 0.3, 0.002), columns=360)
    wall, seen = grid.unwrap(picture), grid.seen(picture.shape)
    x, bearing = np.meshgrid(grid.x, grid.bearing, indexing="ij")
    truth = 100.0 + 50.0 * np.sin(2 * np.pi * x / 0.05) * np.cos(12 * bearing)
    inner = seen & np.roll(seen, 3, axis=1) & np.roll(seen, -3, axis=1)
    assert inner.mean() > 0.5
    assert np.abs(wall - truth)[inner].mean() < 1.5


def test_what_the_lens_does_not_see_is_missing():
    grid = wall_grid(camera_at([0.0, 0.0, 0.0], np.eye(3)), Lens("sine", 300.0), CENTRE, 0.15, 0.15, [-0.1, 0.1])
    assert np.isnan(grid.columns[0]).all() and np.isfinite(grid.columns[1]).all()
    assert not grid.seen((480, 640))[0].any()


def test_too_few_columns_are_refused():
    with pytest.raises(ParameterError, match="columns"):
        wall_grid(camera_at([0.0, 0.0, 0.0], np.eye(3)), LENS, CENTRE, 0.15, 0.15, [0.1], columns=2)


@pytest.mark.parametrize(
    "lens",
    [
        Lens("equidistant", 500.0),
        Lens("sine", 620.0),
        Lens("equisolid", 560.0),
        Lens("perspective", 700.0),
        Lens("stereographic", 480.0),
        Lens("polynomial", 540.0, coefficients=(0.02, -0.01, 0.003, -0.0005)),
        Lens("equidistant", 500.0, view_angle=np.radians(130.0)),
    ],
    ids=lambda lens: lens.model,
)
def test_places_are_those_of_the_projection(lens):
    matrix = camera_at([0.01, 0.02, -0.03], frame(0.2, -0.3, 0.4))
    x = np.linspace(-0.2, 1.5, 120)
    grid = wall_grid(matrix, lens, (959.5, 539.5), 0.16, 0.14, x, columns=180, first_bearing=-1.0)
    turn = -1.0 + np.arange(180) * np.radians(2.0)
    radius = 1.0 / np.hypot(np.cos(turn) / 0.16, np.sin(turn) / 0.14)
    wall = np.stack(np.broadcast_arrays(x[:, None], radius * np.sin(turn), radius * np.cos(turn)), axis=-1)
    truth = to_pixels(project(matrix, wall.reshape(-1, 3), lens), (959.5, 539.5)).reshape(120, 180, 2)
    assert np.array_equal(np.isnan(truth[..., 0]), np.isnan(grid.columns))
    inside = (np.abs(truth - [959.5, 539.5]) < 3000.0).all(axis=-1)
    assert inside.mean() > 0.3
    assert np.abs(grid.columns - truth[..., 0])[inside].max() < 0.05
    assert np.abs(grid.rows - truth[..., 1])[inside].max() < 0.05


def test_a_place_of_another_shape_is_refused():
    with pytest.raises(ParameterError, match="matrix"):
        wall_grid(np.eye(3), LENS, CENTRE, 0.15, 0.15, [0.1])
