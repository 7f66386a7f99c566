"""Simulated surveys with known truth; its own ray-casting geometry, so that no formula is tested with itself.

A scenario (one TOML file, see `scenario`) names a pipe, a robot and its sensors. `simulate` builds the pipe's true wall
as a surface in space, lays out the robot's motion, casts every ray on the wall and spoils the readings as the sensors
spoil them. What was true goes into `/truth`, which no stage reads.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..lazy import call_as, lazy_names

if TYPE_CHECKING:
    from .camera import Footage
    from .reading import load, parse, scenarios
    from .scenario import Scenario
    from .simulation import simulate, simulate_to

_HOMES = {
    "simulate": "simulation",
    "simulate_to": "simulation",
    "scenarios": "reading",
    "load": "reading",
    "parse": "reading",
    "Scenario": "scenario",
    "Footage": "camera",
}

__all__ = ["Footage", "Scenario", "load", "parse", "scenarios", "simulate", "simulate_to"]


__getattr__ = lazy_names(__name__, _HOMES)
call_as(__name__, "simulate")
