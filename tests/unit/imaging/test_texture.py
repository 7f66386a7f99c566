"""Frames laid on the wall, against a painted pipe whose pictures are made by casting rays at a cylinder."""

import numpy as np
import pytest

pytest.importorskip("cv2", reason="needs the extra 'vision'")

from springline.errors import InputError, ParameterError
from springline.geometry.camera import camera_at, from_pixels, rays
from springline.geometry.lenses import Lens
from springline.geometry.robot import frame
from springline.imaging.lens_table import MountedCamera
from springline.imaging.texture import Surface, View, lay_frames

RADIUS = 0.15
CAMERA = MountedCamera(Lens("equidistant", 160.0), (159.5, 119.5), (320, 240))
ROWS = np.arange(0.0, 1.5, 0.004)
BEARING = 2 * np.pi * np.arange(240) / 240


def painted(x, bearing):
    """Red along the pipe, green round it, blue in a chessboard of both."""
    red = 120 + 60 * np.sin(2 * np.pi * x / 0.2)
    green = 120 + 60 * np.cos(3 * bearing)
    blue = 120 + 60 * np.sin(2 * np.pi * x / 0.3) * np.cos(2 * bearing)
    return np.stack(np.broadcast_arrays(red, green, blue), axis=-1)


def taken(at, offset, tilt, fall=0.0):
    """A view from chainage `at` and its picture, blue, green and red; light falls by `fall` a metre ahead."""
    axes = frame(*tilt)
    matrix = camera_at([0.0, *offset], axes)
    columns, rows = np.meshgrid(np.arange(320.0), np.arange(240.0))
    ray = rays(matrix, from_pixels(np.stack([columns.ravel(), rows.ravel()], -1), CAMERA.centre), CAMERA.lens)
    # where p + t d meets y^2 + z^2 = R^2
    (y, z), (a, b, c) = offset, ray.T
    flat = b**2 + c**2
    middle = (y * b + z * c) / flat
    t = -middle + np.sqrt(middle**2 - (y**2 + z**2 - RADIUS**2) / flat)
    x, wy, wz = t * a, y + t * b, z + t * c
    colour = painted(at + x, np.arctan2(wy, wz)) * np.exp(-fall * np.maximum(x, 0.0))[:, None]
    colour = np.where(np.isfinite(colour) & (x < 3.0)[:, None], colour, 0.0)
    return View(at, matrix, CAMERA), np.rint(colour[:, ::-1]).astype(np.uint8).reshape(240, 320, 3)


def surface(**changes):
    straight = np.zeros_like(ROWS)
    section = np.broadcast_to([RADIUS, 0.0, 0.0], (len(ROWS), 3)).copy()
    return Surface(
        **{"x": ROWS, "parameters": section, "heading": straight, "climb": straight, "bearing": BEARING} | changes
    )


def drive(fall=0.0, step=0.08):
    rng = np.random.default_rng(3)
    places = np.arange(-0.4, 1.4, step)
    made = [taken(x, 0.02 * rng.uniform(-1, 1, 2), 0.03 * rng.uniform(-1, 1, 3), fall) for x in places]
    return [view for view, _ in made], [picture for _, picture in made]


def lay(views, pictures, wall=None, near=0.12, far=0.4):
    return lay_frames(
        wall or surface(), views, lambda chosen: ((k, pictures[n]) for k, n in enumerate(chosen)), near, far
    )


def test_the_paint_is_where_it_was():
    laid = lay(*drive())
    truth = painted(ROWS[:, None], BEARING)
    assert laid.seen.mean() > 0.97
    off = np.abs(laid.colour.astype(float) - truth)[laid.seen]
    assert np.median(off) < 0.6 and np.quantile(off, 0.99) < 2.0
    assert (laid.colour[~laid.seen] == 0).all()
    assert laid.refused == ()


def test_order_does_not_matter_and_not_every_frame_is_needed():
    views, pictures = drive()
    laid = lay(views, pictures)
    mixed = np.random.default_rng(1).permutation(len(views))
    other = lay([views[k] for k in mixed], [pictures[k] for k in mixed])
    np.testing.assert_array_equal(laid.colour, other.colour)
    dense = lay(*drive(step=0.02))
    assert len(dense.used) < 20


def test_the_lamps_fall_of_light_is_taken_away_and_dark_wall_stays_dark():
    truth = painted(ROWS[:, None], BEARING)
    laid = lay(*drive(fall=2.5))
    ratio = laid.colour.astype(float)[laid.seen] / truth[laid.seen]
    # brightness as a whole is not known, its evenness is
    assert np.std(ratio) / np.mean(ratio) < 0.01
    assert np.std(laid.colour[..., 0][laid.seen]) > 30.0


def test_nothing_is_laid_without_a_section_and_behind_a_bend():
    views, pictures = drive()
    wall = surface()
    wall.parameters[100:120] = np.nan
    laid = lay(views, pictures, wall)
    assert not laid.seen[100:120].any() and laid.seen[130:300].mean() > 0.95
    # a pipe that turns by 80 degrees a metre: its inner wall faces away from a camera that looks straight on
    bent = lay(views[4:5], pictures[4:5], surface(heading=1.4 * ROWS), near=0.1, far=0.6)
    inner, outer = bent.seen[:, np.abs(BEARING) < 0.3], bent.seen[:, np.abs(BEARING - np.pi) < 0.3]
    assert outer.sum() > 1.5 * inner.sum()


def test_unusable_frames_are_named():
    views, pictures = drive()
    first, second = lay(views, pictures).used[:2]
    pictures[first], pictures[second] = np.zeros((10, 10, 3), np.uint8), InputError("cut short")
    laid = lay(views, pictures)
    assert [number for number, _ in laid.refused] == [first, second]
    assert laid.refused[0][1] == "it is 10 by 10, its lens is for 320 by 240" and "cut short" in laid.refused[1][1]
    assert not np.isin([first, second], laid.used).any()
    nothing = lay([], [])
    assert not nothing.seen.any() and nothing.used.size == 0
    unknown = lay([View(np.nan, views[0].matrix, CAMERA)], pictures[:1])
    assert not unknown.seen.any()
    with pytest.raises(ParameterError, match="near"):
        lay(views, pictures, near=0.4, far=0.4)
