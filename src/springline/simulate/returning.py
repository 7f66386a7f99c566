"""A robot that drives out and is pulled back: two drives of one world, by one counter and one clock."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..errors import ParameterError
from ..survey import Survey
from .scenario import Scenario
from .world import World, set_up


def ways(scenario: Scenario) -> tuple[Scenario, Scenario]:
    """Return the drives out and back of a scenario whose robot returns.

    Raises:
        ParameterError: It has a camera: what that sees on the way back is not made.
    """
    for name in ("camera", "depth_camera"):
        if getattr(scenario, name) is not None:
            raise ParameterError("robot.returns = true", where=name, expected="a robot without a camera")
    robot = scenario.robot
    back = {"returns": False, "from_end": not robot.from_end, "backwards": not robot.backwards}
    return (
        scenario.model_copy(update={"robot": robot.model_copy(update={"returns": False})}),
        scenario.model_copy(update={"robot": robot.model_copy(update=back)}),
    )


def returned(scenario: Scenario, seed: int, out: Survey, back: Survey) -> Survey:
    """Return both drives as one survey: the counter runs back from where the way out ended, and the clock runs on.

    Truth and ties are those of the way out; `/truth` of the way back is not kept.

    Args:
        scenario: The way out.
        seed: Of its noise.
        out: The survey of the way out.
        back: That of the way back, counted and timed from its own start.
    """
    world: World = set_up(scenario, seed)
    end, time = float(world.counter.reading(world.end)), world.clock.duration
    if scenario.inertial is not None:
        # Samples come at equal steps; the way back begins with the next one.
        time = (np.floor(time * scenario.inertial.rate) + 1.0) / scenario.inertial.rate
    groups = {name: out.group(name) for name in out.groups}
    for name, dim in (("rings", "ring"), ("rings_rear", "ring"), ("inertial", "sample")):
        if name not in groups:
            continue
        after = back.group(name)
        changed = {"time": (dim, after["time"].values + time)}
        if name != "inertial":
            changed["distance"] = (dim, end - after["distance"].values)
        groups[name] = xr.concat(
            [groups[name], after.assign(changed)],
            dim=dim,
            data_vars="minimal",
            coords="minimal",
            combine_attrs="override",
        )
    return Survey(groups, out.attrs)
