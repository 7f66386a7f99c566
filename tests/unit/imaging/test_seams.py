"""Joints as lines all round the wall laid out."""

import math

import numpy as np
import pytest

pytest.importorskip("cv2", reason="needs the extra 'vision'")

from springline.geometry.camera import camera_at, rays
from springline.geometry.lenses import Lens
from springline.geometry.robot import frame
from springline.imaging.reprojection import PosePrior
from springline.imaging.seams import seam_odds, seams_of_frame

RADIUS, K, SIZE = 0.15, 333.0, (640, 480)
CENTRE = (319.5, 239.5)
LENS = Lens("equidistant", K)
PRIOR = PosePrior(0.003, math.radians(1.0))


def drawn(lines, *, tilt=(0.0, 0.0, 0.0), offset=(0.0, 0.0), patches=(), noise=4.0, seed=0):
    """A frame from x = 0 in a pipe lit from the camera, by casting every pixel's ray onto the wall.

    Args:
        lines: x of joints, 8 mm wide, darker than the wall.
        patches: (x, bearing, half length, half width in rad) of dark patches.
    """
    column, row = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    image = np.stack([column - CENTRE[0], CENTRE[1] - row], axis=-1).reshape(-1, 2)
    way = rays(camera_at([0.0, *offset], frame(*tilt)), image, LENS)
    across = way[:, 1:]
    middle = np.array(offset)
    a, b = (across**2).sum(axis=1), across @ middle
    reach = (-b + np.sqrt(b**2 - a * (middle @ middle - RADIUS**2))) / a
    x, (y, z) = reach * way[:, 0], (middle + reach[:, None] * across).T
    light = 230.0 * np.abs(np.cos(np.arctan2(np.abs(x), RADIUS))) / (1.0 + (np.hypot(x, RADIUS) / 0.3) ** 2) + 15.0
    bearing = np.arctan2(y, z)
    for at in lines:
        light = np.where(np.abs(x - at) < 0.004, 0.6 * light, light)
    for at, theta, long, wide in patches:
        turn = (bearing - theta + np.pi) % (2 * np.pi) - np.pi
        light = np.where((np.abs(x - at) < long) & (np.abs(turn) < wide), 0.5 * light, light)
    light = np.where(x > 0, light, 10.0) + noise * np.random.default_rng(seed).standard_normal(len(x))
    return np.repeat(np.clip(light, 0, 255).astype(np.uint8).reshape(SIZE[1], SIZE[0], 1), 3, axis=2)


def seams(picture, tilt=(0.0, 0.0, 0.0), offset=(0.0, 0.0), prior=PRIOR):
    return seams_of_frame(picture, camera_at([0.0, *offset], frame(*tilt)), LENS, CENTRE, RADIUS, RADIUS, prior=prior)


@pytest.mark.parametrize("tilt", [(0.0, 0.0, 0.0), (0.02, -0.015, 0.0)])
def test_joints_are_found_where_they_are_though_the_tilt_is_unknown(tilt):
    found = seams(drawn([0.25, 0.45], tilt=tilt)).peaks(8.0)
    places = sorted(x for _, x, _ in found)
    assert np.allclose(places, [0.25, 0.45], atol=0.008)
    for _, x, sigma in found:
        assert min(abs(x - 0.25), abs(x - 0.45)) < 3.0 * sigma


def test_a_patch_on_one_side_is_no_joint():
    patches = [(0.25, 1.0, 0.01, 1.2), (0.34, -1.0, 0.02, 0.6), (0.48, 2.5, 0.004, 1.3)]
    assert seams(drawn([], patches=patches)).peaks(6.0) == []


def test_a_place_may_be_asked_for():
    found = seams(drawn([0.35]))
    score, x, _ = found.at(0.37, 0.03)
    assert score > 8.0 and abs(x - 0.35) < 0.006
    assert found.at(0.5, 0.02)[0] < 4.0
    assert found.at(3.0, 0.02)[0] == -math.inf
    assert seam_odds(score, expected=True) > 3.0 > 0.0 > seam_odds(found.at(0.5, 0.02)[0], expected=True)
    assert seam_odds(6.0, expected=False) < seam_odds(6.0, expected=True)


def test_black_frames_show_nothing_and_narrow_lenses_say_so():
    assert seams(np.zeros((480, 640, 3), np.uint8)).peaks(3.0) == []
    tele = Lens("perspective", 20.0)
    assert (
        seams_of_frame(
            np.zeros((48, 64, 3), np.uint8), camera_at([0, 0, 0], np.eye(3)), tele, (31.5, 23.5), RADIUS, RADIUS,
            prior=PRIOR,
        )
        is None
    )  # fmt: skip
