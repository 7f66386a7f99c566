"""A scenario set up: the pipe built, the robot's motion laid out, clock and counter running."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .building import build_pipe
from .motion import Clock, Counter
from .path import Motion, Route
from .scenario import Scenario
from .wall import Pipe, Wall, build

STREAMS = {"odometer": 1, "rings": 2, "rings_rear": 3, "inertial": 4, "ties": 5, "depth_camera": 6, "camera": 7}
"""Random streams: each sensor draws from its own, so that adding one leaves the others' noise alone."""


@dataclass(frozen=True)
class World:
    """Everything a sensor needs."""

    scenario: Scenario
    seed: int
    pipe: Pipe
    wall: Wall
    route: Route
    motion: Motion
    clock: Clock
    counter: Counter
    start: float
    end: float
    """Travelled chainage at which the robot's middle starts and ends [m]."""

    def rng(self, stream: str, block: int = 0) -> np.random.Generator:
        """Return the generator of one block of one sensor's noise."""
        return np.random.default_rng([self.seed, STREAMS[stream], block])


def set_up(scenario: Scenario, seed: int) -> World:
    """Return the world of a checked scenario."""
    robot = scenario.robot
    pipe = build_pipe(scenario.pipe)
    route = Route(pipe.centreline, robot.from_end)
    start = 0.5 * robot.length if robot.start is None else robot.start
    end = route.length - 0.5 * robot.length if robot.end is None else robot.end
    motion = Motion(scenario, pipe, route, start, end)
    clock = Clock(start, end, robot.speed, [(one.chainage, one.duration) for one in robot.standstill])
    rng = np.random.default_rng([seed, STREAMS["odometer"], 0])
    counter = Counter(scenario.odometer, motion.grid, motion.path, start, rng)
    return World(scenario, seed, pipe, build(pipe), route, motion, clock, counter, start, end)
