"""The joint maximum-likelihood estimator: robot path, true section and buried layout at once; arrays in and out.

`estimate_joint` takes one fitted ellipse per ring, an inertial log and ties, whatever of them there is; states, model
and frames stand in `docs/estimator.md`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..lazy import lazy_names

if TYPE_CHECKING:
    from .bends import Bend
    from .data import Inertial, Rings, Ties
    from .harmonics import Harmonics, pooled_harmonics
    from .joint import estimate_joint
    from .options import JointOptions
    from .profile import Deflection, Sag
    from .rear import Rear
    from .results import JointEstimate

_HOMES = {
    "estimate_joint": "joint",
    "Rings": "data",
    "Inertial": "data",
    "Ties": "data",
    "JointOptions": "options",
    "JointEstimate": "results",
    "Bend": "bends",
    "Sag": "profile",
    "Deflection": "profile",
    "Rear": "rear",
    "Harmonics": "harmonics",
    "pooled_harmonics": "harmonics",
}

__all__ = [
    "Bend",
    "Deflection",
    "Harmonics",
    "Inertial",
    "JointEstimate",
    "JointOptions",
    "Rear",
    "Rings",
    "Sag",
    "Ties",
    "estimate_joint",
    "pooled_harmonics",
]


__getattr__ = lazy_names(__name__, _HOMES)
