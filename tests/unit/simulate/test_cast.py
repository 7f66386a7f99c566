"""Rays on walls whose ranges follow from school geometry, written out here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from springline.simulate.centreline import Cell, Centreline
from springline.simulate.sections import ellipse, mode
from springline.simulate.wall import (
    BED,
    DENT,
    DEPOSIT,
    JOINT,
    LATERAL,
    NOTHING,
    WALL,
    WATER,
    Bump,
    Floor,
    Knots,
    Lateral,
    Lobe,
    Pipe,
    Roughness,
    build,
)  # fmt: skip

from .helpers import BEARING, one_ray, ring, round_pipe, stack, straight

R = 0.15


def tilted(pitch: float, yaw: float, roll: float) -> np.ndarray:
    """Sensor axes as rows: forward by the two tangents, right made level in the sensor's own plane, then rolled."""
    x = np.array([1.0, np.tan(pitch), np.tan(yaw)])
    x /= np.linalg.norm(x)
    z = np.cross(x, [0.0, 1.0, 0.0])
    z /= np.linalg.norm(z)
    y = np.cross(z, x)
    c, s = np.cos(roll), np.sin(roll)
    return np.stack([x, c * y - s * z, c * z + s * y])


def test_a_centred_ring_in_a_round_pipe_reads_the_radius():
    r, kind, at = ring(round_pipe(), 5.0)
    assert np.abs(r - R).max() < 1e-14
    assert (kind == WALL).all()
    assert np.allclose(at, 5.0)


def test_an_offset_ring_follows_the_chord_through_the_origin():
    y0, z0 = 0.03, -0.05
    r, _, _ = ring(round_pipe(), 5.0, offset=(y0, z0))
    along = z0 * np.cos(BEARING) + y0 * np.sin(BEARING)
    assert np.allclose(r, -along + np.sqrt(along**2 + R**2 - y0**2 - z0**2), atol=1e-14)


@pytest.mark.parametrize("pose", [(0.2, 0.0, 0.0), (0.1, -0.3, 0.2), (-0.5, 0.4, -0.7)])
def test_an_oblique_ring_in_an_elliptical_pipe(pose):
    """By the 2x2 form: the ray (v, w) in the cross-section meets z2/a2 + y2/b2 = 1."""
    a, b = 0.16, 0.14
    axes = tilted(*pose)
    r, _, _ = ring(straight(ellipse(a, b)), 5.0, axes)
    ray = np.cos(BEARING)[:, None] * axes[2] + np.sin(BEARING)[:, None] * axes[1]
    assert np.allclose(r, ((ray[:, 2] / a) ** 2 + (ray[:, 1] / b) ** 2) ** -0.5, rtol=1e-13)


def test_ranges_do_not_depend_on_where_the_pipe_lies():
    axes = tilted(0.1, 0.2, 0.3)
    section = mode(5, R, 0.85, 0.97, 0.92)
    level, _, _ = ring(straight(section), 5.0, axes, (0.01, 0.02))
    elsewhere, _, _ = ring(straight(section, heading=2.0, gradient=-0.2), 3.0, axes, (0.01, 0.02))
    assert np.allclose(level, elsewhere, atol=1e-13)


def test_a_forward_ray_meets_the_wall_of_a_long_pipe():
    r, _, at = one_ray(round_pipe(length=200.0), 10.0, (1.0, 0.0, 0.001), limit=500.0)
    assert r == pytest.approx(0.15 * np.hypot(1.0, 0.001) / 0.001, rel=1e-12)
    assert at == pytest.approx(160.0)
    assert np.isnan(one_ray(round_pipe(), 5.0, (1.0, 0.0, 0.001))[0])


def test_the_range_limit_is_no_return():
    r, kind, _ = one_ray(round_pipe(), 5.0, (1.0, 0.0, 0.1), limit=1.0)
    assert np.isnan(r)
    assert kind == NOTHING


def bend(radius: float, towards: float, section=None, angle: float = np.pi / 2) -> Pipe:
    """A straight metre, a bend, and a straight metre."""
    one = Cell(0.0, 1.0, 0.0, 0.0, np.zeros(3), np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]))
    two = replace(one, chainage=1.0, length=radius * angle, curvature=1.0 / radius, towards=towards,
                  origin=np.array([0.0, 1.0, 0.0]))  # fmt: skip
    centreline = Centreline([one, two])
    point, frame = centreline.at(1.0 + radius * angle)
    three = Cell(1.0 + radius * angle, 1.0, 0.0, 0.0, point, frame)
    section = ellipse(R, R) if section is None else section
    return Pipe(Centreline([one, two, three]), [Knots(stack(section))] * 3, R)


@pytest.mark.parametrize("towards", [0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi, 0.7])
def test_points_of_a_ring_in_a_bend_lie_on_the_torus(towards):
    radius = 0.6
    angle = 0.9  # an upward bend of 90 degrees would end upright
    pipe = bend(radius, towards, angle=angle)
    chainage = 1.0 + 0.5 * radius * angle
    axes, offset = tilted(0.1, -0.2, 0.3), (0.02, -0.03)
    r, _, _ = ring(pipe, chainage, axes, offset)
    point, frame = pipe.centreline.at(chainage)
    sensor = axes @ frame
    hits = point + offset[0] * frame[1] + offset[1] * frame[2]
    hits = hits + r[:, None] * (np.cos(BEARING)[:, None] * sensor[2] + np.sin(BEARING)[:, None] * sensor[1])
    start, first = pipe.centreline.at(1.0)
    inward = np.cos(towards) * first[2] + np.sin(towards) * first[1]
    centre, axis = start + radius * inward, np.cross(first[0], inward)
    away = hits - centre
    height = away @ axis
    from_axis = np.linalg.norm(away - height[:, None] * axis, axis=1)
    assert np.abs(np.hypot(from_axis - radius, height) - R).max() < 1e-12


def test_a_ring_at_the_end_of_a_bend_sees_straight_and_bend():
    pipe = bend(0.6, 0.0)
    chainage = 1.0 + 0.6 * np.pi / 2 + 0.02
    r, _, at = ring(pipe, chainage, tilted(0.0, 0.5, 0.0))
    assert at.min() < 1.0 + 0.6 * np.pi / 2 < at.max()
    assert np.isfinite(r).all()


def test_a_section_stays_level_through_a_bend_on_a_slope():
    """In a plan bend on a slope the wall's highest line stays in the vertical plane of the axis."""
    pipe = bend(1.0, 0.0, ellipse(0.16, 0.13))
    slope = np.arctan(0.3)
    turn = np.array([[1, 0, 0], [0, np.cos(slope), -np.sin(slope)], [0, np.sin(slope), np.cos(slope)]])
    cells = [
        replace(c, origin=turn @ c.origin, frame=c.frame @ turn.T) for c in pipe.centreline.cells[:2]
    ]  # the frame of a sloping straight is level; that of the arc's end is found by the centreline itself
    pipe = Pipe(Centreline(cells), pipe.knots[:2], R)
    s = 1.0 + 0.8
    _, frame = pipe.centreline.at(s)
    assert abs(frame[2, 2]) < 1e-15
    r, _, _ = ring(pipe, s)
    assert r[90] == pytest.approx(0.13, rel=1e-12)
    assert r[0] == pytest.approx(0.16, rel=1e-12)


def jointed(gap: float = 0.0, step: float = 0.0, kink: float = 0.0) -> Pipe:
    """Two pipes that meet at 5 m: apart by a gap, the second one lower by `step` and turned right by `kink`."""
    frame = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    cells = [Cell(0.0, 5.0 - 0.5 * gap, 0.0, 0.0, np.zeros(3), frame)]
    if gap:
        cells.append(Cell(5.0 - 0.5 * gap, gap, 0.0, 0.0, np.array([0.0, 5.0 - 0.5 * gap, 0.0]), frame, 0.01, True))
    start = np.array([0.0, 5.0 + 0.5 * gap, -step])
    turned = np.array([[np.sin(kink), np.cos(kink), 0.0], [0, 0, 1.0], [np.cos(kink), -np.sin(kink), 0.0]])
    cells.append(Cell(5.0 + 0.5 * gap, 5.0, 0.0, 0.0, start, turned))
    return Pipe(Centreline(cells), [Knots(stack(ellipse(R, R)))] * len(cells), R)


def test_an_open_joint_is_seen_as_a_groove():
    pipe = jointed(gap=0.04)
    r, kind, _ = ring(pipe, 5.0)
    assert np.allclose(r, R + 0.01, atol=1e-13)
    assert (kind == JOINT).all()
    assert np.allclose(ring(pipe, 5.021)[0], R)


def test_a_steep_ray_meets_the_side_of_a_groove():
    """From the axis, a ray that enters the gap and rises 1 in 10 meets its far side before its floor."""
    pipe = jointed(gap=0.04)
    slope = 0.1
    start = 5.0 + 0.02 - 0.005 - R / slope
    r, kind, at = one_ray(pipe, start, (1.0, slope, 0.0))
    assert kind == JOINT
    assert r == pytest.approx((5.02 - start) * np.hypot(1.0, slope), rel=1e-12)
    assert at == pytest.approx(5.02)


def test_a_step_shows_its_face_going_one_way_and_is_passed_going_the_other():
    pipe = jointed(step=0.01)
    # Low in the second pipe a ray looking back meets the end of the first pipe's wall; looking forward it passes.
    r, kind, _ = one_ray(pipe, 5.1, (-1.0, 0.0, 0.0), start=(-0.145, 0.0))
    assert kind == JOINT
    assert r == pytest.approx(0.1, rel=1e-12)
    r, kind, _ = one_ray(pipe, 4.9, (1.0, 0.0, 0.0), start=(0.145, 0.0))
    assert kind == JOINT
    assert r == pytest.approx(0.1, rel=1e-12)
    r, kind, _ = one_ray(pipe, 4.9, (1.0, 0.0, 0.0), start=(-0.145, 0.0), limit=3.0)
    assert np.isnan(r)


def test_a_kinked_joint_is_crossed_once_at_its_mitre_plane():
    kink = 0.05
    pipe = jointed(kink=kink)
    ranges, _, _ = ring(pipe, 5.0 + 1e-4, tilted(0.0, 0.5 * kink, 0.0))
    assert np.isfinite(ranges).all()
    # A ray along the first axis meets the left wall of the second pipe.
    r, _, _ = one_ray(pipe, 4.0, (1.0, 0.0, 0.0))
    assert r == pytest.approx(1.0 + R / np.sin(kink), rel=1e-12)


def test_water_and_bed_are_level():
    pipe = round_pipe(floors=[Floor(-5.0, 20.0, 0.04, 0.1, WATER), Floor(4.0, 6.0, 0.02, 0.5, BED)])
    r, kind, _ = ring(pipe, 5.0, tilted(0.0, 0.0, 0.3))
    wet = kind == WATER
    depth = r * np.sin(BEARING) * np.cos(0.3) + r * np.cos(BEARING) * np.sin(0.3)
    assert np.allclose(depth[wet], -R + 0.04, atol=1e-13)
    assert wet.sum() == pytest.approx(360 * np.arccos(0.11 / 0.15) / np.pi, abs=2)
    assert not (kind == BED).any()
    dry = round_pipe(floors=[Floor(4.0, 6.0, 0.02, 0.5, BED)])
    assert ring(dry, 5.0)[0][270] == pytest.approx(0.13, rel=1e-13)
    assert ring(dry, 3.9)[0][270] == pytest.approx(0.15, rel=1e-13)


def test_a_dent_is_deepest_in_its_middle_and_ends_at_its_edge():
    pipe = round_pipe(bumps=[Bump(5.0, 1.0, 0.02, 0.4, 0.8), Bump(7.0, 4.0, 0.01, 0.4, 0.8, DEPOSIT)])
    point = np.radians(np.arange(360))
    r, kind, _ = ring(pipe, 5.0)
    assert one_ray(pipe, 5.0, (0.0, np.sin(1.0), np.cos(1.0)))[0] == pytest.approx(0.13, rel=1e-13)
    assert (kind == DENT).sum() == np.sum(np.abs(point - 1.0) < 0.4)
    assert np.allclose(r[kind == WALL], R)
    assert (ring(pipe, 5.2001)[1] == WALL).all()
    assert (ring(pipe, 7.0)[1] == DEPOSIT).any()


def test_an_inward_feature_hides_what_lies_behind_it():
    """A grazing ray meets the near flank of a deposit, not the wall beyond it."""
    clear, hidden = round_pipe(), round_pipe(bumps=[Bump(5.0, np.pi / 2, 0.05, 0.3, 1.0, DEPOSIT)])
    towards = (1.0, 0.02, 0.0)
    far, _, _ = one_ray(clear, 4.0, towards, start=(0.11, 0.0))
    near, kind, at = one_ray(hidden, 4.0, towards, start=(0.11, 0.0))
    assert kind == DEPOSIT
    assert near < far
    assert 4.85 < at < 5.0


def test_a_lateral_opens_where_it_should_and_shows_its_own_wall():
    pipe = round_pipe(laterals=[Lateral(5.0, np.pi / 2, 0.05, length=1.0)])
    # Straight up its axis a ray meets nothing within its length.
    r, kind, _ = one_ray(pipe, 5.0, (0.0, 1.0, 0.0))
    assert np.isnan(r)
    assert kind == NOTHING
    # Tipped forward, it meets the lateral's wall: x = 0.05 at height 0.05 / slope.
    r, kind, _ = one_ray(pipe, 5.0, (0.2, 1.0, 0.0))
    assert kind == LATERAL
    assert r == pytest.approx(0.05 / 0.2 * np.hypot(0.2, 1.0), rel=1e-13)
    # The opening's edge across: the cylinder |z| < 0.05 meets the pipe at sin(angle) = 1/3.
    _, kind, _ = ring(pipe, 5.0)
    open_half = np.degrees(np.arcsin(0.05 / R))
    assert np.isin(kind, (LATERAL, NOTHING)).sum() == 2 * int(open_half) + 1


def test_a_leaning_lateral_leans_the_way_it_says():
    pipe = round_pipe(laterals=[Lateral(5.0, np.pi / 2, 0.05, lean=np.radians(45.0), length=0.6)])
    # From the axis 0.15 m before the mouth, along its own axis, nothing is met.
    assert one_ray(pipe, 5.0 - 0.15, (1.0, 1.0, 0.0))[1] == NOTHING
    assert one_ray(pipe, 5.0 + 0.15, (-1.0, 1.0, 0.0))[1] == LATERAL


def test_a_protruding_lateral_stands_in_the_way():
    pipe = round_pipe(laterals=[Lateral(5.0, np.pi / 2, 0.05, protrusion=0.06, wall=0.005)])
    # Along the pipe, 0.11 m up, the stub's outer wall stands 0.055 m before its axis.
    r, kind, _ = one_ray(pipe, 4.0, (1.0, 0.0, 0.0), start=(0.11, 0.0))
    assert kind == LATERAL
    assert r == pytest.approx(1.0 - 0.055, rel=1e-12)
    # Below its end, at 0.09 m, nothing stands in the way.
    assert np.isnan(one_ray(pipe, 4.0, (1.0, 0.0, 0.0), start=(0.08, 0.0), limit=2.0)[0])
    # Looking up at its end face, between inner and outer wall.
    r, kind, _ = one_ray(pipe, 5.0, (0.0, 1.0, 0.0), start=(0.0, 0.052))
    assert kind == LATERAL
    assert r == pytest.approx(0.09, rel=1e-12)


def test_roughness_has_its_rms_and_is_the_same_seen_twice():
    pipe = round_pipe(roughness=Roughness(0.0005, 0.01, 0.01, seed=4))
    rings = np.stack([ring(pipe, s)[0] for s in np.linspace(1.0, 9.0, 60)])
    assert np.std(rings - R) == pytest.approx(0.0005, rel=0.06)
    assert np.array_equal(ring(pipe, 5.0)[0], ring(pipe, 5.0)[0])
    other = round_pipe(roughness=Roughness(0.0005, 0.01, 0.01, seed=5))
    assert not np.allclose(ring(pipe, 5.0)[0], ring(other, 5.0)[0])
    ahead, _, _ = ring(pipe, 5.0005)
    assert np.corrcoef(ahead, ring(pipe, 5.0)[0])[0, 1] > 0.95


def test_a_section_blends_along_its_cell():
    knots = np.stack([ellipse(0.15, 0.15).pieces, ellipse(0.17, 0.15).pieces])
    pipe = round_pipe()
    pipe.knots[0] = Knots(type(pipe.knots[0].sections)(knots))
    assert ring(pipe, 5.0)[0][0] == pytest.approx(0.16, rel=1e-13)


def test_a_smooth_lobe_draws_the_host_in():
    pipe = round_pipe(lobes=[Lobe(2.0, 8.0, np.pi / 2, 0.03, np.radians(60.0), 2.0, 0.5)])
    r, _, _ = ring(pipe, 5.0)
    assert r[90] == pytest.approx(0.12, rel=1e-13)
    assert r[105] == pytest.approx(R - 0.03 * 0.5, rel=1e-12)
    assert np.allclose(np.delete(r, np.arange(60, 121)), R)


def test_a_varying_lobe_meets_its_host_with_the_hosts_slope():
    a, b, half = 0.16, 0.14, np.radians(40.0)
    pipe = straight(ellipse(a, b), lobes=[Lobe(2.0, 8.0, np.pi / 2, 0.03, 2 * half, 2.0, 0.1, varying=True)])
    wall = build(pipe)
    axes = np.eye(3)
    r, _, _ = ring(pipe, 5.0, axes, wall=wall)
    assert r[90] == pytest.approx(b - 0.03, rel=1e-10)
    host = ((np.cos(BEARING) / a) ** 2 + (np.sin(BEARING) / b) ** 2) ** -0.5
    assert np.allclose(np.delete(r, np.arange(50, 131)), np.delete(host, np.arange(50, 131)), rtol=1e-13)
    step = 1e-4
    edge = np.pi / 2 + half

    def at(theta):
        return one_ray(pipe, 5.0, (0.0, np.sin(theta), np.cos(theta)))[0]

    inside, outside = (at(edge) - at(edge - step)) / step, (at(edge + step) - at(edge)) / step
    assert inside == pytest.approx(outside, abs=2e-4)
