"""Springline: quantitative pipe inspection.

    import springline as sl

    survey = sl.read("scan.ply", nominal_diameter=0.4)
    result = sl.inspect(survey)
    result.metrics, result.features
    sl.write(result, "result.zarr.zip")

Frame, signs, units and names: `springline.conventions`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .lazy import lazy_names

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


__getattr__ = lazy_names(__name__, _HOMES)


def __dir__() -> list[str]:
    return sorted(__all__)
