"""What would take more memory or time than any machine has, refused before it is begun."""

from __future__ import annotations

from math import radians

from . import pipes
from .problem import Path, require
from .scenario import Scenario

_LONGEST = 1e6
_FARTHEST = 1e8
_THINGS = 1e5
_STATIONS = 1e7
_FRAMES = 1e6
_SAMPLES = 1e9


def check_size(scenario: Scenario) -> None:
    """Raise a `Problem` when a scenario describes more than can be simulated."""
    pipe, robot = scenario.pipe, scenario.robot
    far = max(map(abs, pipe.start))
    require(far <= _FARTHEST, ("pipe", "start"), list(pipe.start), f"coordinates within {_FARTHEST:g} m")
    length = 0.0
    for k, run in enumerate(pipe.run):
        bend = isinstance(run, pipes.Bend)
        length += run.radius * radians(run.angle_deg) if bend else run.length
        path: Path = ("pipe", "run", k, "radius" if bend else "length")
        expected, why = f"a pipe of at most {_LONGEST:g} m", f" makes the pipe {length:g} m long"
        require(length <= _LONGEST, path, run.radius if bend else run.length, expected, why)
    for name in ("joints", "laterals"):
        if (regular := getattr(pipe, name)) is not None:
            _least(("pipe", name, "spacing"), regular.spacing, length / _THINGS)
    for name in ("cracks", "stains", "deposits"):
        share, most = getattr(pipe.decoys, name), _THINGS / length
        require(share <= most, ("pipe", "decoys", name), share, f"at most {most:g} per metre in {length:g} m")
    _least(("truth_spacing",), scenario.truth_spacing, length / _STATIONS)
    for name, most in (("rings", _STATIONS), ("rings_rear", _STATIONS), ("camera", _FRAMES)):
        if (sensor := getattr(scenario, name)) is not None:
            _least((name, "spacing"), sensor.spacing, length / most)
    if scenario.inertial is not None:
        rate = scenario.inertial.rate
        lasts = length / robot.speed + sum(one.duration for one in robot.standstill)
        expected = f"at most {_SAMPLES:g} samples, here {_SAMPLES / lasts:g} Hz: or a faster robot, or shorter stops"
        require(rate * lasts <= _SAMPLES, ("inertial", "rate"), rate, expected)


def _least(path: Path, spacing: float, least: float) -> None:
    require(spacing >= least, path, spacing, f"at least {least:g} m in a pipe of this length")
