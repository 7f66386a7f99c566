"""Simulated surveys with known truth; its own ray-casting geometry, so that no formula is tested with itself.

A scenario (one TOML file, see `scenario`) names a pipe, a robot and its sensors. `simulate` builds the pipe's true wall
as a surface in space, lays out the robot's motion, casts every ray on the wall and spoils the readings as the sensors
spoil them. What was true goes into `/truth`, which no stage reads.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

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


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


class _Callable(ModuleType):
    """This package, callable: once imported, it stands in `springline` under the promised function's own name."""

    def __call__(self, *args: Any, **options: Any) -> Any:
        return __getattr__("simulate")(*args, **options)


sys.modules[__name__].__class__ = _Callable
