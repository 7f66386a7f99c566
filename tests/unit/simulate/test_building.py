"""Pipes as built: lengths, joints, sags and sections end up where the scenario puts them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from springline.simulate.building import build_pipe
from springline.simulate.laying import joints
from springline.simulate.reading import parse

TEXT = 'name = "x"\n[pipe]\ndiameter = 0.3\n{}\n[rings]\n'
TEN = 'run = [{kind = "straight", length = 10.0}]\n'


def pipe(text: str):
    return parse(TEXT.format(text)).pipe


def test_cells_follow_one_another_without_a_hole():
    built = build_pipe(
        pipe(
            'run = [{kind = "straight", length = 4.0}, {kind = "bend", radius = 1.0, angle_deg = 45.0, towards = 2}, '
            '{kind = "straight", length = 6.0}]\nsag = [{chainage = 2.0, length = 3.0, depth = 0.02}]\n'
            "joints = {spacing = 0.9, gap = 0.01}\n"
            "section = [{start = 1.0, end = 3.3, shape = 'mode', mode = 1, s1 = 0.9}]"
        )
    )
    cells = built.centreline.cells
    assert cells[0].chainage == 0.0
    assert cells[-1].end == pytest.approx(10.0 + np.radians(45.0))
    for a, b in pairwise(cells):
        assert b.chainage == pytest.approx(a.end)
        assert np.allclose(b.origin, built.centreline.at(a.end - 1e-12)[0], atol=1e-9)
        assert b.frame[0] @ built.centreline.at(a.end - 1e-12)[1][0] == pytest.approx(1.0)
    assert sum(c.joint for c in cells) == 11


def test_a_bend_ends_where_its_clock_says():
    # Heading north, towards 3 o'clock: to the east. Towards 2 o'clock: east and up, 60 degrees from the vertical.
    for clock, side in ((3.0, [1.0, 0.0]), (9.0, [-1.0, 0.0]), (2.0, [np.sin(np.pi / 3), np.cos(np.pi / 3)])):
        built = build_pipe(pipe(f'run = [{{kind = "bend", radius = 2.0, angle_deg = 60.0, towards = {clock}}}]'))
        point, _ = built.centreline.at(built.centreline.end)
        away = 2.0 * (1.0 - np.cos(np.pi / 3))
        assert np.allclose(point, [away * side[0], 2.0 * np.sin(np.pi / 3), away * side[1]])


def test_a_sag_dips_by_its_depth_and_comes_back():
    built = build_pipe(pipe(TEN + "gradient = 0.0\nsag = [{chainage = 5.0, length = 6.0, depth = 0.3}]"))
    point, frame = built.centreline.at(np.array([2.0, 5.0, 8.0, 10.0]))
    assert point[:, 2] == pytest.approx([0.0, -0.3, 0.0, 0.0], abs=1e-12)
    assert np.allclose(frame[:, 0, 2], 0.0, atol=1e-12)
    hump = build_pipe(pipe(TEN + "sag = [{chainage = 5.0, length = 6.0, depth = -0.3}]"))
    assert hump.centreline.at(5.0)[0][2] == pytest.approx(0.3)


def test_a_joint_steps_and_turns_the_next_pipe():
    built = build_pipe(
        pipe(TEN + "joint = [{chainage = 4.0, gap = 0.02, offset_y = -0.01, offset_z = 0.02, kink_up_deg = 3.0}]")
    )
    before, _ = built.centreline.at(4.01 - 1e-12)
    after, frame = built.centreline.at(4.01)
    assert np.allclose(after - before, [0.02, 0.0, -0.01], atol=1e-9)
    assert np.degrees(np.arctan2(frame[0, 2], frame[0, 1])) == pytest.approx(3.0)


def test_a_joint_at_the_seam_of_two_sections_is_kept():
    seam = "section = [{end = 4.01, shape = 'mode', mode = 1, s1 = 0.9}, {start = 4.01, shape = 'circle'}]\n"
    built = build_pipe(pipe(TEN + seam + "joint = [{chainage = 4.0, gap = 0.02, offset_y = -0.01}]"))
    assert built.centreline.at(9.0)[0][2] == pytest.approx(-0.01)
    plain = build_pipe(pipe(TEN + "joint = [{chainage = 4.0, gap = 0.0, offset_y = -0.01}]"))
    assert plain.centreline.at(9.0)[0][2] == pytest.approx(-0.01)
    assert not any(cell.joint for cell in plain.centreline.cells)


def test_regular_joints_keep_their_spacing_and_their_spread():
    drawn = joints(
        pipe(
            'run = [{kind = "straight", length = 2500.0}]\n'
            "joints = {spacing = 2.5, spacing_sigma = 0.008, gap = 0.01, gap_sigma = 0.002, kink_sigma_deg = 0.1}\n"
            "joint = [{chainage = 5.1, gap = 0.05}]"
        )
    )
    at = np.array([j.chainage for j in drawn])
    assert len(drawn) == 999
    assert at[1] == 5.1
    assert np.std(at - np.round(at / 2.5) * 2.5) == pytest.approx(np.hypot(0.008, 0.1 / np.sqrt(999)), rel=0.08)
    assert np.std([j.kink_up_deg for j in drawn]) == pytest.approx(0.1, rel=0.08)
    assert np.std([j.gap for j in drawn if j.gap < 0.04]) == pytest.approx(0.002, rel=0.08)


def test_a_harmonic_is_added_to_the_radius():
    built = build_pipe(pipe(TEN + "harmonic = [{order = 3, amplitude = 0.002, phase_deg = 30.0}]"))
    from .helpers import BEARING, ring

    r, _, _ = ring(built, 5.0)
    assert np.allclose(r, 0.15 + 0.002 * np.cos(3.0 * (BEARING - np.radians(30.0))), atol=1e-12)
