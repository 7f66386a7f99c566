"""Round trips and invariances of the simulator that hold for every pose and section."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from springline.simulate.attitude import from_axes, in_pipe
from springline.simulate.cast import cast_rays
from springline.simulate.centreline import Cell, Centreline, direction, level_frame
from springline.simulate.motion import Clock
from springline.simulate.path import quaternions, rotations
from springline.simulate.sections import Section, ellipse, mode
from springline.simulate.shapes import upside_down
from springline.simulate.wall import Knots, Pipe, build

angle = st.floats(-1.2, 1.2)
BEARING = np.arange(24) * (2.0 * np.pi / 24)
few = settings(max_examples=60, deadline=None)


def cast(section: Section, axes: np.ndarray, offset, heading: float = 0.0, gradient: float = 0.0) -> np.ndarray:
    frame = level_frame(direction(heading, gradient))
    cell = Cell(0.0, 400.0, 0.0, 0.0, np.array([1e3, 2e3, 10.0]), frame)
    pipe = Pipe(Centreline([cell]), [Knots(Section(section.pieces[None]))], 0.15)
    origin = (cell.origin + 200.0 * frame[0] + offset[0] * frame[1] + offset[1] * frame[2])[None]
    sensor = axes @ frame
    rays = np.cos(BEARING)[:, None] * sensor[2] + np.sin(BEARING)[:, None] * sensor[1]
    return cast_rays(build(pipe), origin, np.array([0]), rays[None], 100.0)[0][0]


@few
@given(angle, angle, st.floats(-3.1, 3.1))
def test_attitude_round_trip(pitch, yaw, roll):
    axes = in_pipe(pitch, yaw, roll)
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    assert np.allclose(from_axes(axes), (pitch, yaw, roll), atol=1e-12)
    assert np.allclose(rotations(quaternions(axes[None])), axes, atol=1e-14)


@few
@given(angle, angle, angle, st.floats(-0.08, 0.08), st.floats(-0.08, 0.08), st.floats(0.12, 0.2))
def test_every_ring_reading_ends_on_the_wall(pitch, yaw, roll, y, z, a):
    axes = in_pipe(pitch, yaw, roll)
    r = cast(ellipse(a, 0.15), axes, (y, z))
    hits = np.array([0.0, y, z]) + r[:, None] * (
        np.cos(BEARING)[:, None] * axes[2] + np.sin(BEARING)[:, None] * axes[1]
    )
    assert np.allclose((hits[:, 2] / a) ** 2 + (hits[:, 1] / 0.15) ** 2, 1.0, atol=1e-10)


@few
@given(angle, angle, st.floats(0.0, 6.2), st.floats(-0.5, 0.5), st.floats(0.75, 0.95))
def test_where_the_pipe_lies_does_not_matter(pitch, yaw, heading, gradient, s1):
    section = mode(3, 0.15, s1)
    axes = in_pipe(pitch, yaw, 0.0)
    assert np.allclose(cast(section, axes, (0.0, 0.0)), cast(section, axes, (0.0, 0.0), heading, gradient), atol=1e-10)


@few
@given(angle, angle, angle, st.floats(0.7, 0.99))
def test_mirror_images_give_mirrored_rings(pitch, yaw, roll, s1):
    section = mode(2, 0.15, s1)
    here = cast(section, in_pipe(pitch, yaw, roll), (0.02, 0.03))
    there = cast(section, in_pipe(pitch, -yaw, -roll), (0.02, -0.03))
    assert np.allclose(here, there[(12 - np.arange(24)) % 24], atol=1e-11)
    turned = cast(upside_down(section), in_pipe(-pitch, yaw, -roll), (-0.02, 0.03))
    assert np.allclose(here, turned[-np.arange(24) % 24], atol=1e-11)


@few
@given(st.lists(st.tuples(st.floats(0.5, 9.5), st.floats(0.1, 60.0)), max_size=5), st.floats(0.02, 1.0))
def test_the_clock_never_goes_back_and_arrives(stops, speed):
    clock = Clock(0.3, 10.0, speed, stops)
    u, v = clock.at(np.linspace(-1.0, clock.duration + 1.0, 2001))
    assert (np.diff(u) >= -1e-12).all()
    assert (v >= 0.0).all()
    assert (v <= speed + 1e-12).all()
    assert abs(u[0] - 0.3) < 1e-12
    assert abs(u[-1] - 10.0) < 1e-9
