"""The robot's motion, its clock and its counter, against geometry written out here."""

from __future__ import annotations

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.simulate.attitude import from_axes, in_pipe, on_earth
from springline.simulate.motion import Clock
from springline.simulate.path import quaternions, rotations
from springline.simulate.reading import parse
from springline.simulate.simulation import simulate
from springline.simulate.world import World, set_up

PIPE = """
name = "test"
[pipe]
diameter = 0.3
heading_deg = 30.0
{pipe}
[robot]
length = 0.4
wheelbase = 0.3
{robot}
[rings]
noise = 0.0
spacing = 0.05
bearings = 16
{more}
"""


def scenario(pipe='run = [{kind = "straight", length = 6.0}]', robot="", more=""):
    return parse(PIPE.format(pipe=pipe, robot=robot, more=more))


def world(**parts) -> World:
    return set_up(scenario(**parts), 0)


def test_the_worked_example_of_the_conventions():
    a = np.radians(10.0)
    axes = in_pipe(a, a, 0.0)
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    # A robot that first pitches about its z and then yaws about its y ends rolled by -0.86 degrees against this frame.
    c, s = np.cos(a), np.sin(a)
    pitched = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    turn = np.arctan(np.tan(a) * np.cos(a))
    x = np.cos(turn) * pitched[0] + np.sin(turn) * pitched[2]
    z = -np.sin(turn) * pitched[0] + np.cos(turn) * pitched[2]
    pitch, yaw, roll = from_axes(np.stack([x, pitched[1], z]))
    assert np.degrees([pitch, yaw]) == pytest.approx([10.0, 10.0])
    assert np.degrees(roll) == pytest.approx(-0.86, abs=0.005)


def test_roll_goes_from_z_towards_y():
    right = in_pipe(0.0, 0.0, 0.1)[2]
    assert right == pytest.approx([0.0, np.sin(0.1), np.cos(0.1)])


def test_attitude_on_earth_has_its_signs():
    north, up, east = np.array([0.0, 1, 0]), np.array([0.0, 0, 1]), np.array([1.0, 0, 0])
    level = np.stack([north, up, east])
    assert on_earth(level) == pytest.approx((0.0, 0.0, 0.0))
    assert on_earth(np.stack([east, up, -north]))[0] == pytest.approx(np.pi / 2)
    nose_up = np.stack([north * np.cos(0.1) + up * np.sin(0.1), up * np.cos(0.1) - north * np.sin(0.1), east])
    assert on_earth(nose_up)[1] == pytest.approx(0.1)
    # Right side down: the right-hand axis dips, which is a negative roll.
    assert on_earth(in_pipe(0.0, 0.0, -0.2) @ level)[2] == pytest.approx(0.2)


def test_quaternions_hold_their_axes():
    rng = np.random.default_rng(1)
    axes = np.stack([np.linalg.qr(rng.standard_normal((3, 3)))[0] for _ in range(50)])
    axes *= np.sign(np.linalg.det(axes))[:, None, None]
    assert np.allclose(rotations(quaternions(axes)), axes, atol=1e-14)


def test_the_clock_covers_its_way_and_stands_where_told():
    clock = Clock(0.2, 5.0, 0.1, [(2.0, 30.0), (0.2, 60.0)])
    time = np.linspace(0.0, clock.duration, 20001)
    u, speed = clock.at(time)
    assert u[0] == 0.2
    assert u[-1] == pytest.approx(5.0)
    assert (np.diff(u) >= 0.0).all()
    assert np.allclose(np.gradient(u, time)[2:-2], speed[2:-2], atol=2e-4)
    assert (speed[time < 60.0] == 0.0).all()
    standing = time[(u > 1.999) & (speed == 0.0) & (u < 2.001)]
    assert np.ptp(standing) == pytest.approx(30.0, abs=0.1)
    assert np.allclose(clock.at(clock.when(np.array([0.7, 3.3])))[0], [0.7, 3.3], atol=1e-12)


def test_a_prescribed_offset_is_kept_in_straight_pipe():
    at = world(robot="offset_y = 0.01\noffset_z = -0.02\nroll_deg = 5.0")
    u = np.linspace(1.0, 5.0, 7)
    point, frame = at.route.at(u)
    off = np.einsum("nij,nj->ni", frame, at.motion.middle(u) - point)
    assert np.allclose(off, [0.0, 0.01, -0.02], atol=1e-12)
    pitch, yaw, roll = from_axes(at.motion.axes(u) @ np.swapaxes(frame, 1, 2))
    assert np.allclose([pitch, yaw], 0.0, atol=1e-9)
    assert np.allclose(roll, np.radians(5.0), atol=1e-9)


def test_a_following_robot_points_where_it_goes():
    at = world(robot="offset_z = {amplitude = 0.02, period = 3.0}\nside_slip_deg = 0.3")
    u = np.linspace(1.0, 5.0, 401)
    ways = np.gradient(at.motion.middle(u), u, axis=0)
    _, frame = at.route.at(u)
    going = np.einsum("nij,nj->ni", frame, ways)
    yaw = from_axes(at.motion.axes(u) @ np.swapaxes(frame, 1, 2))[1]
    slip = np.degrees(yaw - np.arctan2(going[:, 2], going[:, 0]))[5:-5]
    assert np.abs(slip - 0.3).max() < 1e-3


def test_a_free_robot_holds_its_prescribed_attitude():
    at = world(robot="follow = false\noffset_z = {amplitude = 0.02, period = 3.0}\npitch_deg = 4.0\nyaw_deg = -7.0")
    u = np.linspace(1.0, 5.0, 11)
    _, frame = at.route.at(u)
    pitch, yaw, _ = from_axes(at.motion.axes(u) @ np.swapaxes(frame, 1, 2))
    assert np.degrees(pitch) == pytest.approx(np.full(11, 4.0), abs=1e-6)
    assert np.degrees(yaw) == pytest.approx(np.full(11, -7.0), abs=1e-6)


def test_wheels_in_a_deformed_pipe_lift_the_robot_as_chapter_4_says():
    """(4.2): the rise of the origin above the centre of an ellipse, for a robot that is centred in the circle."""
    r, half, s = 0.15, 0.06, 0.9
    a = r * (3.0 - 2.0 * s + np.sqrt(3.0 + 6.0 * s - 5.0 * s * s)) / 3.0
    rise = np.sqrt(r * r - half * half) - s * r / a * np.sqrt(a * a - half * half)
    at = world(
        pipe='run = [{kind = "straight", length = 6.0}]\nperimeter = "ramanujan"\n'
        'section = [{shape = "mode", mode = 1, s1 = 0.9}]',
        robot='path = "kinematic"\nhalf_span = 0.06\nwheel_radius = 0.03',
    )
    u = np.linspace(1.0, 5.0, 5)
    point, _ = at.route.at(u)
    assert np.allclose(at.motion.middle(u)[:, 2] - point[:, 2], rise, atol=1e-9)


def test_front_wheels_on_a_bump_pitch_the_robot_as_chapter_4_says():
    """4.1.2: the scanner L ahead of the rear axle rises by L sin p - H (1 - cos p), H its height over the axles."""
    at = world(
        pipe='run = [{kind = "straight", length = 6.0}]\nbed = [{start = 2.9, depth = 0.03, ramp = 0.01}]',
        robot='path = "kinematic"\nhalf_span = 0.02\nwheel_radius = 0.02',
    )
    u = np.array([3.0 - 0.05])  # front axle on the bed, rear axle before it
    point, frame = at.route.at(u)
    axes = at.motion.axes(u)
    pitch = from_axes(axes @ np.swapaxes(frame, 1, 2))[0][0]
    lift = at.motion.middle(u)[0, 2] - point[0, 2]
    height = np.sqrt(0.15**2 - 0.02**2) - 0.02
    front = 0.5 * 0.3  # the middle lies half a wheelbase ahead of the rear axle
    # On the bed's flat top both wheels stand 0.03 m over the invert, not 0.15 - sqrt(0.15^2 - 0.02^2).
    climb = 0.03 - (0.15 - np.sqrt(0.15**2 - 0.02**2))
    assert np.sin(pitch) == pytest.approx(climb / 0.3, rel=2e-3)
    assert lift == pytest.approx(front * np.sin(pitch) - height * (1.0 - np.cos(pitch)), abs=2e-5)


def test_a_climbing_robot_rolls_with_the_wall():
    at = world(robot='path = "kinematic"\nclimb_deg = 6.0')
    u = np.linspace(1.0, 5.0, 5)
    _, frame = at.route.at(u)
    point, _ = at.route.at(u)
    off = np.einsum("nij,nj->ni", frame, at.motion.middle(u) - point)
    roll = from_axes(at.motion.axes(u) @ np.swapaxes(frame, 1, 2))[2]
    # Climbing to the right lifts its right side: positive roll; its axis stays on the pipe's.
    assert np.degrees(roll) == pytest.approx(np.full(5, 6.0), abs=1e-6)
    assert np.allclose(off, 0.0, atol=1e-9)


def test_a_robot_on_its_wheels_cuts_the_corner_in_a_bend():
    at = world(
        pipe='run = [{kind = "bend", radius = 1.0, angle_deg = 90.0, towards = "right"}]',
        robot='path = "kinematic"\nwheel_radius = 0.02',
    )
    u = np.array([0.8])
    point, frame = at.route.at(u)
    off = frame[0] @ (at.motion.middle(u)[0] - point[0])
    # The middle of a chord over 0.3 m of arc lies inside it by 1 - cos(0.15).
    assert off[2] == pytest.approx(1.0 - np.cos(0.15), rel=0.02)
    assert np.abs(off[:2]).max() < 1e-9


def test_a_knock_comes_and_goes():
    at = world(robot="knock = [{chainage = 3.0, length = 0.2, roll_deg = 15.0}]")
    u = np.array([2.89, 3.0, 3.11])
    _, frame = at.route.at(u)
    roll = np.degrees(from_axes(at.motion.axes(u) @ np.swapaxes(frame, 1, 2))[2])
    assert roll == pytest.approx([0.0, 15.0, 0.0], abs=1e-3)


def test_the_counter_counts_the_robots_way_with_its_errors():
    at = world(
        robot="offset_z = {amplitude = 0.02, period = 3.0}",
        more="[odometer]\nscale_error = 0.01\nslip = [{chainage = 3.0, length = 0.1, extra = 0.25}]",
    )
    u = np.linspace(0.2, 5.8, 5601)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(at.motion.middle(u), axis=0), axis=1))])
    read = at.counter.reading(u)
    assert read[0] == pytest.approx(0.0, abs=1e-12)
    assert (np.diff(read) > 0.0).all()
    assert np.allclose(read, 1.01 * way + 0.25 * np.clip((u - 2.95) / 0.1, 0.0, 1.0), atol=2e-5)
    assert np.allclose(at.counter.where(at.counter.reading(u)), u, atol=1e-9)


def test_rings_are_taken_at_equal_counts_and_know_where_they_were():
    survey = simulate(scenario(more="[odometer]\nscale_error = 0.02"))
    assert np.allclose(np.diff(survey.rings["distance"]), 0.05)
    # The robot starts 0.2 m into the pipe; the counter shows 2 % too much.
    assert np.allclose(survey.truth["ring_chainage"], 0.2 + survey.rings["distance"] / 1.02, atol=1e-6)
    assert np.allclose(survey.rings["range"], 0.15, atol=1e-6)


@pytest.mark.parametrize(("towards", "offset"), [("right", (0.01, 0.0)), ("up", (0.0, 0.02))])
def test_driving_from_the_other_end_mirrors_what_is_seen(towards, offset):
    pipe = (
        'run = [{kind = "straight", length = 2.0}, {kind = "bend", radius = 2.0, angle_deg = 30.0, '
        f'towards = "{towards}"}}, {{kind = "straight", length = 2.0}}]\n'
        "lateral = [{chainage = 1.0, clock_h = 2.0, diameter = 0.1}]\n"
        "joint = [{chainage = 4.0, gap = 0.02, offset_y = 0.01, kink_right_deg = 1.0, kink_up_deg = 0.5}]"
    )
    text = PIPE.replace("bearings = 16", "bearings = 72").replace("spacing = 0.05", "spacing = 0.004")
    y, z = offset
    ahead = simulate(parse(text.format(pipe=pipe, robot=f"offset_y = {y}\noffset_z = {z}", more="")))
    turned = f"from_end = true\noffset_y = {y}\noffset_z = {-z}"
    back = simulate(parse(text.format(pipe=pipe, robot=turned, more="")))
    whole = 4.0 + 2.0 * np.radians(30.0)
    one, other = ahead.truth.ring_chainage.values, whole - back.truth.ring_chainage.values
    near = np.abs(one[:, None] - other[None]).argmin(axis=1)
    # Away from the joint, whose step each run takes on the side that it comes from.
    close = (np.abs(one - other[near]) < 2.5e-3) & (np.abs(one - 4.0) > 0.3)
    assert close.sum() > 900
    there, again = ahead.rings["range"].values[close], back.rings["range"].values[near[close]]
    mirrored = again[:, (36 - np.arange(72)) % 72]
    same = np.abs(there - mirrored) < 2e-4
    assert same.mean() > 0.995  # all but the edge of the lateral
    kinds = [s.truth["feature_kind"].values.tolist() for s in (ahead, back)]
    assert kinds[0] == kinds[1][::-1]
    assert back.truth["feature_chainage"].values == pytest.approx(whole - np.array([4.0, 1.0]))
    assert np.degrees(back.truth["feature_bearing"].values[1]) == pytest.approx(150.0)
    assert back.truth["feature_offset_y"].values[0] == pytest.approx(-0.01)
    assert np.degrees(back.truth["feature_kink_right"].values[0]) == pytest.approx(-1.0)
    assert np.degrees(back.truth["feature_kink_up"].values[0]) == pytest.approx(0.5)


def test_a_scanner_that_leaves_the_pipe_is_named():
    with pytest.raises(ParameterError, match="outside the pipe"):
        simulate(scenario(robot="yaw_deg = 50.0\nfollow = false", more="position = [0.5, 0.0, 0.0]"))


def test_wheels_wider_than_the_pipe_find_no_stand():
    with pytest.raises(ParameterError, match="half_span"):
        set_up(
            scenario(
                pipe='run = [{kind = "straight", length = 6.0}]\nsection = [{shape = "ellipse", semi_major = 0.15, '
                "semi_minor = 0.1}]",
                robot='path = "kinematic"\nhalf_span = 0.149\nclimb_deg = 60.0',
            ),
            0,
        )
