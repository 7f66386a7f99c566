"""Joints in drawn views whose rings are known."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

from scenes import view

from springline.imaging.detections import detect_frame
from springline.imaging.edges import edge_field
from springline.imaging.joints import JointRules
from springline.imaging.vanishing import vanishing_point


@pytest.mark.parametrize(("height", "width"), [(90.0, 1.5), (-45.0, 1.5), (60.0, 2.5)])
def test_a_ring_is_found_where_it_was_drawn(height, width):
    found = detect_frame(view([(160.0, 112.0, 70.0, width, height)]))
    assert [one.kind for one in found] == ["joint"]
    ring = found[0]
    assert math.hypot(ring.column - 160.0, ring.row - 112.0) < 1.5
    assert abs(ring.semi_major - 70.0) < 3.5 and abs(ring.semi_minor - 70.0) < 3.5
    assert 0.9 < ring.confidence <= 1.0 and ring.coverage > 0.8


@pytest.mark.parametrize("seed", range(8))
def test_a_pipe_without_joints_shows_none(seed):
    assert detect_frame(view([], seed=seed, noise=4.0)) == []


def test_two_joints_that_do_not_fit_one_camera_are_not_both_believed():
    far, near, wrong = (165.0, 118.0, 45.0), (165.0, 118.0, 110.0), (95.0, 118.0, 110.0)
    assert len(detect_frame(view([(*far, 1.5, 80.0), (*near, 1.5, 80.0)]))) == 2
    assert len(detect_frame(view([(*far, 1.5, 80.0), (*wrong, 1.5, 80.0)]))) == 1


def test_a_ring_half_under_water_is_still_found():
    frame = view([(165.0, 118.0, 70.0, 1.5, 90.0)])
    frame[140:] = view([])[140:]
    found = detect_frame(frame)
    assert len(found) == 1 and abs(found[0].semi_major - 70.0) < 4.0
    assert 0.3 < found[0].coverage < 0.9


def test_large_frames_are_worked_on_small_and_answered_large():
    frame = view([(660.0, 472.0, 280.0, 6.0, 90.0)], size=(960, 1280), centre=(660.0, 472.0), reach=360.0)
    found = detect_frame(frame)
    assert len(found) == 1
    assert math.hypot(found[0].column - 660.0, found[0].row - 472.0) < 4.0
    assert abs(found[0].semi_major - 280.0) < 14.0


def test_analogue_video_has_pixels_that_are_not_square():
    square = view([(160.0, 118.0, 70.0, 1.5, 90.0)], centre=(160.0, 118.0))
    columns = np.clip(np.round((np.arange(352) + 0.5) * 320 / 352 - 0.5).astype(int), 0, 319)
    found = detect_frame(square[:, columns])
    assert len(found) == 1
    assert abs(found[0].semi_major / found[0].semi_minor - 1.1) < 0.02
    assert abs(math.degrees(found[0].angle)) < 5.0


@pytest.mark.parametrize("centre", [(165.0, 118.0), (100.0, 90.0), (250.0, 150.0)])
def test_the_vanishing_point_is_where_the_light_falls_off(centre):
    field = edge_field(view([], centre=centre))
    point = vanishing_point(field)
    assert math.hypot(point.column - centre[0], point.row - centre[1]) < 4.0
    assert point.reliable and point.doubt == 0.0


def test_black_frames_and_flat_frames_show_nothing():
    assert detect_frame(np.zeros((240, 320, 3), np.uint8)) == []
    assert detect_frame(np.full((240, 320, 3), 128, np.uint8)) == []
    assert edge_field(np.zeros((240, 320, 3), np.uint8)) is None


def test_a_stricter_rule_finds_less():
    frame = view([(165.0, 118.0, 70.0, 1.5, 90.0)])
    assert detect_frame(frame) and not detect_frame(frame, JointRules(evidence=5000.0))
