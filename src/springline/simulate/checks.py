"""What makes a scenario impossible, beyond single values out of range."""

from __future__ import annotations

from itertools import pairwise
from math import atan, degrees, hypot, radians, sqrt

import numpy as np

from ..conventions import bearing_from_clock
from ..errors import ParameterError
from . import equipment, pipes, strewn
from .checks_camera import check_camera
from .checks_size import check_size
from .laying import joints, total_length
from .problem import Path, Problem, require
from .profiles import extremes
from .scenario import Scenario
from .sections import Section
from .stretches import NEEDS, sections_at, stretches

_TOUCH = 1e-9
_STEEPEST = 75.0


def check(scenario: Scenario) -> None:
    """Raise the first `Problem` of a scenario; return when there is none."""
    if not (scenario.rings or scenario.rings_rear or scenario.depth_camera or scenario.camera):
        raise Problem(("rings",), "nothing", "at least one of rings, rings_rear, depth_camera, camera")
    pipe = scenario.pipe
    check_size(scenario)
    _bends(pipe)
    _sags(pipe)
    length = total_length(pipe)
    _sections(pipe, length)
    _patches(pipe, length)
    _harmonics(pipe)
    _levels(pipe, length)
    _lobes(pipe, length)
    _joints(pipe, length)
    _robot(scenario)
    _drive(scenario, length)
    _sensors(scenario, length)


def _bends(pipe: pipes.Pipe) -> None:
    reach = _reach(pipe)
    climb = degrees(atan(pipe.gradient))
    for k, run in enumerate(pipe.run):
        if not isinstance(run, pipes.Bend):
            continue
        path: Path = ("pipe", "run", k)
        tight = " is a bend tighter than the pipe radius"
        require(run.radius > reach, (*path, "radius"), run.radius, f"above {reach:g} m", tight)
        climb += {"up": run.angle_deg, "down": -run.angle_deg}.get(str(run.towards), 0.0)
        why = f" leaves the pipe inclined by {climb:.0f} degrees"
        upright = f"a pipe inclined by at most {_STEEPEST:g} degrees: in an upright one no wall is the crown"
        require(abs(climb) <= _STEEPEST, (*path, "angle_deg"), run.angle_deg, upright, why)


def _reach(pipe: pipes.Pipe) -> float:
    """Return the farthest that the wall lies from the axis [m]."""
    reach = [0.5 * pipe.diameter]
    for one in pipe.section:
        if one.diameter is not None:
            reach.append(0.5 * extremes(one.diameter)[1])
        if one.semi_major is not None:
            reach.append(extremes(one.semi_major)[1])
        reach.append(0.5 * (one.width or 0.0))
        reach.append((one.height or 0.0) - 0.5 * (one.width or 0.0))
    return max(reach)


def _sags(pipe: pipes.Pipe) -> None:
    straights, end = [], 0.0
    for run in pipe.run:
        start, end = end, end + (run.length if isinstance(run, pipes.Straight) else run.radius * radians(run.angle_deg))
        if isinstance(run, pipes.Straight):
            straights.append((start, end))
    where = "a sag within one straight run: " + ", ".join(f"{a:g} to {b:g} m" for a, b in straights)
    for k, sag in enumerate(pipe.sag):
        first, last = sag.chainage - 0.5 * sag.length, sag.chainage + 0.5 * sag.length
        held = any(a - _TOUCH <= first and last <= b + _TOUCH for a, b in straights)
        require(held, ("pipe", "sag", k, "chainage"), sag.chainage, where)
        most = 0.125 * sag.length
        expected = f"at most an eighth of its length, {most:g} m"
        require(abs(sag.depth) <= most, ("pipe", "sag", k, "depth"), sag.depth, expected)
    ordered = sorted(enumerate(pipe.sag), key=lambda item: item[1].chainage)
    for (k, sag), (_, following) in pairwise(ordered):
        apart = sag.chainage + 0.5 * sag.length <= following.chainage - 0.5 * following.length + _TOUCH
        require(apart, ("pipe", "sag", k, "length"), sag.length, "sags that do not overlap")


def _sections(pipe: pipes.Pipe, length: float) -> None:
    for k, one in enumerate(pipe.section):
        path: Path = ("pipe", "section", k)
        needs = f"a value: shape '{one.shape}' needs {', '.join(NEEDS[one.shape])}"
        for key in NEEDS[one.shape]:
            require(getattr(one, key) is not None, (*path, key), "nothing", needs)
        start, end = one.start or 0.0, length if one.end is None else one.end
        inside = 0.0 <= start < end <= length + _TOUCH
        require(inside, (*path, "start"), start, f"start and end between 0 and the pipe's length, {length:g} m")
        for key in ("diameter", "semi_major", "semi_minor"):
            value = getattr(one, key)
            least = np.inf if value is None else extremes(value)[0]
            require(least > 0.0, (*path, key), least, "above 0 all along")
        try:
            sections_at(pipe, one, np.linspace(start, end, 201))
        except ParameterError as error:
            key = "s1" if one.shape == "mode" else "shape"
            expected = error.expected or "a possible section"
            raise Problem((*path, key), getattr(one, key), expected, f" ({error.what})") from None
        if one.shape == "ellipse":
            flat = extremes(one.semi_minor)[1] <= extremes(one.semi_major)[1]
            require(flat, (*path, "semi_minor"), one.semi_minor, "at most semi_major")
    for a, b in pairwise(stretches(pipe, length)):
        if a.end > b.start + _TOUCH:
            k = next(k for k, one in enumerate(pipe.section) if (one.start or 0.0) == b.start)
            raise Problem(("pipe", "section", k, "start"), b.start, f"at least {a.end:g} m, where the last one ends")


def _patches(pipe: pipes.Pipe, length: float) -> None:
    radius = 0.5 * pipe.diameter
    if pipe.laterals is not None:
        for k, diameter in enumerate(pipe.laterals.diameters):
            path: Path = ("pipe", "laterals", "diameters", k)
            expected, why = f"below the pipe's diameter, {pipe.diameter:g} m", " is a lateral larger than the pipe"
            require(diameter < pipe.diameter, path, diameter, expected, why)
        for one in strewn.laterals(pipe):
            there = 0.0 <= one.chainage <= length
            expected = "laterals within the pipe: a smaller spacing_sigma, or another first"
            require(there, ("pipe", "laterals", "spacing"), pipe.laterals.spacing, expected)
    inward = f"below the pipe's radius, {radius:g} m"
    for name in ("lateral", "dent", "deposit", "crack", "stain"):
        for k, one in enumerate(getattr(pipe, name)):
            path = ("pipe", name, k)
            _inside((*path, "chainage"), one.chainage, length)
            if name in ("crack", "stain"):
                continue
            if name != "lateral":
                require(one.depth < radius, (*path, "depth"), one.depth, inward)
                continue
            expected, why = f"below the pipe's diameter, {pipe.diameter:g} m", " is a lateral larger than the pipe"
            require(one.diameter < pipe.diameter, (*path, "diameter"), one.diameter, expected, why)
            require(one.protrusion < radius, (*path, "protrusion"), one.protrusion, inward)


def _inside(path: Path, chainage: float, length: float) -> None:
    require(0.0 <= chainage <= length, path, chainage, f"between 0 and the pipe's length, {length:g} m")


def _harmonics(pipe: pipes.Pipe) -> None:
    """Check that harmonics together leave the wall outside the axis."""
    left = 0.5 * pipe.diameter
    for k, one in enumerate(pipe.harmonic):
        low, high = extremes(one.amplitude)
        swing = max(-low, high)
        expected = f"below {left:g} m, what other harmonics leave of the pipe's radius"
        require(swing < left, ("pipe", "harmonic", k, "amplitude"), swing, expected)
        left -= swing


def _levels(pipe: pipes.Pipe, length: float) -> None:
    """Check that water and beds stay below O, and lobes within the radius."""
    below = 0.5 * pipe.diameter
    for one in stretches(pipe, length):
        ends = sections_at(pipe, one, np.linspace(one.start, one.end, 11)).pieces
        below = min(below, *(float(Section(pieces).radius(1.5 * np.pi)) for pieces in ends))
    for name, most in (("bed", below), ("water", below), ("lobe", 0.5 * pipe.diameter)):
        for k, one in enumerate(getattr(pipe, name)):
            path: Path = ("pipe", name, k)
            require(one.depth < most, (*path, "depth"), one.depth, f"below the way from wall to axis, {most:g} m")
            start, end = one.start or 0.0, length if one.end is None else one.end
            require(start < end, (*path, "start"), start, f"below its end, {end:g} m")
            require(start < length, (*path, "start"), start, f"below the pipe's length, {length:g} m")


def _lobes(pipe: pipes.Pipe, length: float) -> None:
    """A varying-amplitude lobe is even about its middle, so both its edges must find the same host."""
    for k, lobe in enumerate(pipe.lobe):
        if lobe.form != "varying":
            continue
        for one in stretches(pipe, length):
            at = np.array([max(one.start, lobe.start), min(one.end, lobe.end)])
            if at[0] >= at[1]:
                continue
            turn = 0.5 * radians(lobe.width_deg) * np.array([1.0, -1.0])
            for pieces in sections_at(pipe, one, at).pieces:
                left, right = Section(pieces).radius(bearing_from_clock(lobe.clock_h) + turn)
                even = abs(left - right) <= 1e-6 * pipe.diameter
                expected = "a clock about which the host is even, or form = 'smooth'"
                why = f" puts the varying lobe's edges at radii of {left:.6f} and {right:.6f} m"
                require(even, ("pipe", "lobe", k, "clock_h"), lobe.clock_h, expected, why)


def _joints(pipe: pipes.Pipe, length: float) -> None:
    radius = 0.5 * pipe.diameter
    for k, joint in enumerate(pipe.joint):
        path: Path = ("pipe", "joint", k)
        half = 0.5 * joint.gap
        require(half < joint.chainage < length - half, (*path, "chainage"), joint.chainage, f"inside 0 to {length:g} m")
        aside = hypot(joint.offset_y, joint.offset_z)
        require(aside < radius, (*path, "offset_y"), joint.offset_y, f"an offset below {radius:g} m")
    laid = joints(pipe)
    for joint in laid:
        where: Path = ("pipe", "joints")
        why = f" puts a joint at {joint.chainage:g} m"
        inside = 0.5 * joint.gap < joint.chainage < length - 0.5 * joint.gap
        spacing = pipe.joints.spacing if pipe.joints else 0.0
        expected = f"joints inside 0 to {length:g} m: a smaller spacing_sigma or gap, or another first"
        require(inside, (*where, "spacing"), spacing, expected, why)
        aside = hypot(joint.offset_y, joint.offset_z)
        sigma, why = (pipe.joints.offset_sigma if pipe.joints else 0.0), f" puts a joint {aside:g} m aside"
        require(aside < radius, (*where, "offset_sigma"), sigma, f"offsets below {radius:g} m", why)
    for a, b in pairwise(laid):
        end = a.chainage + 0.5 * a.gap
        listed = b in pipe.joint
        path = ("pipe", "joint", pipe.joint.index(b), "chainage") if listed else ("pipe", "joints", "spacing")
        value = b.chainage if listed or pipe.joints is None else pipe.joints.spacing
        apart = end < b.chainage - 0.5 * b.gap
        require(
            apart, path, value, f"joints apart: one at {b.chainage:g} m begins before {end:g} m, where another ends"
        )


def longest_robot(bend_radius: float, pipe_radius: float, half_span: float) -> float:
    """Return the length [m] of the longest box 2 half_span wide that fits a bend, measured in the bend's plane.

    Its inner side touches the inner wall in its middle and its outer corners touch the outer wall.

    >>> round(longest_robot(0.45, 0.15, 0.05), 3)
    0.894
    """
    inner = bend_radius - pipe_radius
    return 2.0 * sqrt(max((bend_radius + pipe_radius) ** 2 - (inner + 2.0 * half_span) ** 2, 0.0))


def _robot(scenario: Scenario) -> None:
    robot, pipe = scenario.robot, scenario.pipe
    radius = 0.5 * pipe.diameter
    slim = f"below the pipe's radius, {radius:g} m"
    for key in ("half_span", "wheel_radius"):
        require(getattr(robot, key) < radius, ("robot", key), getattr(robot, key), slim)
    expected = f"at most the robot's length, {robot.length:g} m"
    require(robot.wheelbase <= robot.length, ("robot", "wheelbase"), robot.wheelbase, expected)
    for run in pipe.run:
        if isinstance(run, pipes.Bend):
            most = longest_robot(run.radius, radius, robot.half_span)
            why = f" is longer than the bend of radius {run.radius:g} m allows"
            require(robot.length <= most, ("robot", "length"), robot.length, f"at most {most:.3f} m", why)
    for key in ("offset_y", "offset_z"):
        low, high = extremes(getattr(robot, key))
        require(max(-low, high) < radius, ("robot", key), max(-low, high), slim)
    for key in ("pitch_deg", "yaw_deg", "climb_deg"):
        low, high = extremes(getattr(robot, key))
        require(max(-low, high) <= 60.0, ("robot", key), max(-low, high), "within 60 degrees")


def _drives(scenario: Scenario, length: float) -> tuple[float, float]:
    """Return from where to where the robot's middle drives [m]."""
    robot = scenario.robot
    start = 0.5 * robot.length if robot.start is None else robot.start
    return start, length - 0.5 * robot.length if robot.end is None else robot.end


def _ahead(scenario: Scenario, name: str, drives: tuple[float, float], length: float) -> None:
    """Check that a sensor leaves the pipe's ends by a robot's length at most: as far the pipe is drawn out straight."""
    position, spare = getattr(scenario, name).position, scenario.robot.length
    low, high = -drives[0] - spare, length - drives[1] + spare
    expected, why = f"{low:g} to {high:g} m ahead of the robot's middle", " is far outside the pipe's ends"
    require(low <= position[0] <= high, (name, "position"), list(position), expected, why)


def _drive(scenario: Scenario, length: float) -> None:
    robot = scenario.robot
    start, end = _drives(scenario, length)
    key = "start" if robot.start is not None else "end" if robot.end is not None else "length"
    expected = f"0 <= start < end <= the pipe's length, {length:g} m"
    require(
        0.0 <= start < end <= length, ("robot", key), getattr(robot, key), expected, f" (from {start:g} to {end:g} m)"
    )
    for name in ("standstill", "knock"):
        for k, one in enumerate(getattr(robot, name)):
            there = f"where the robot drives, {start:g} to {end:g} m"
            require(start <= one.chainage <= end, ("robot", name, k, "chainage"), one.chainage, there)


def _sensors(scenario: Scenario, length: float) -> None:
    if scenario.camera is not None:
        check_camera(scenario, scenario.camera)
    for name in ("rings", "rings_rear"):
        scanner: equipment.RingScanner | None = getattr(scenario, name)
        if scanner is not None:
            expected = f"below range_max, {scanner.range_max:g} m"
            require(scanner.range_min < scanner.range_max, (name, "range_min"), scanner.range_min, expected)
            _ahead(scenario, name, _drives(scenario, length), length)
    for k, slip in enumerate(scenario.odometer.slip):
        expected = f"above -{slip.length:g} m: the counter never runs back"
        _inside(("odometer", "slip", k, "chainage"), slip.chainage, length)
        longest = f"at most the pipe's length, {length:g} m"
        require(slip.extra <= length, ("odometer", "slip", k, "extra"), slip.extra, longest)
        require(slip.extra > -slip.length, ("odometer", "slip", k, "extra"), slip.extra, expected)
    for at in scenario.ties.chainages if scenario.ties else ():
        _inside(("ties", "chainages"), at, length)
    for at in scenario.depth_camera.captures if scenario.depth_camera else ():
        _inside(("depth_camera", "captures"), at, length)
        _ahead(scenario, "depth_camera", (at, at), length)
    for k, (start, end) in enumerate(scenario.inertial.gap if scenario.inertial else ()):
        require(start < end, ("inertial", "gap", k), (start, end), "a start before its end")
