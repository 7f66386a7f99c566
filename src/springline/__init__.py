"""Springline: quantitative pipe inspection.

    import springline as sl

    survey = sl.read("scan.ply", nominal_diameter=0.4)
    result = sl.inspect(survey)
    result.metrics, result.features
    sl.write(result, "result.zarr.zip")

Frame, signs, units and names: `springline.conventions`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .compare import compare
    from .data import builtin_survey
    from .io import read
    from .outputs.exchange import write
    from .pipeline import inspect
    from .simulate import simulate
    from .survey import Survey

__version__ = "0.1.0"

# Heavy libraries load when a name is first used, so that `import springline` stays quick.
_HOMES = {
    "read": "io",
    "write": "outputs.exchange",
    "inspect": "pipeline",
    "simulate": "simulate",
    "compare": "compare",
    "Survey": "survey",
    "builtin_survey": "data",
}

__all__ = ["Survey", "__version__", "builtin_survey", "compare", "inspect", "read", "simulate", "write"]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(__all__)
