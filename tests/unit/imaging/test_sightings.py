"""Marks of several frames put together."""

import math

from springline.imaging.sightings import put_together
from springline.imaging.wall import Mark

EYES = [0.0, 0.1, 0.2, 0.3, 0.4]


def _mark(kind, x, eye, *, bearing=1.0, radius=0.06, odds=2.0):
    lateral = kind == "lateral"
    size = (radius, 0.002) if lateral else (math.nan, math.nan)
    turn = (bearing, 0.02, *size, 0.0) if lateral else (math.nan,) * 5
    return Mark(kind, x, 0.004, *turn, odds, 0.9, x - eye)


def test_frames_that_show_one_thing_agree_on_it():
    marks = [(k, _mark("lateral", 0.5 + 0.002 * k, EYES[k], bearing=1.0 + 0.01 * k)) for k in (1, 2, 3)]
    (found,) = put_together(marks, EYES, 0.15)
    assert abs(found.x - 0.504) < 0.003 and abs(found.bearing - 1.02) < 0.012
    assert sorted(found.frames) == [1, 2, 3] and found.probability > 0.95
    assert found.x_sigma < 0.006


def test_bearings_meet_across_the_turn():
    marks = [(k, _mark("lateral", 0.5, EYES[k], bearing=b)) for k, b in ((1, math.pi - 0.02), (2, -math.pi + 0.02))]
    (found,) = put_together(marks, EYES, 0.15)
    assert abs(math.remainder(found.bearing - math.pi, 2 * math.pi)) < 0.01


def test_small_and_rare_marks_are_doubted():
    often = [(k, _mark("lateral", 0.5, EYES[k])) for k in (1, 2, 3)]
    small = [(k, _mark("lateral", 0.5, EYES[k], bearing=-1.0, radius=0.02, odds=0.24)) for k in (1, 2)]
    sure, doubtful = sorted(put_together(often + small, EYES, 0.15), key=lambda one: -one.probability)
    assert sure.probability > 0.95 and doubtful.probability < 0.2


def test_two_joints_are_never_closer_than_the_pipe_is_wide():
    marks = [(k, _mark("joint", 0.5, EYES[k])) for k in (0, 1, 2)] + [(3, _mark("joint", 0.7, EYES[3], odds=0.2))]
    found = put_together(marks, EYES, 0.15)
    assert len(found) == 1 and abs(found[0].x - 0.5) < 1e-3
    assert put_together([], [], 0.15) == []
