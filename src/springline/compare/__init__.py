"""Two inspections of one pipe, or many: which place is which, what changed, and what cannot be said.

The model is in docs/compare.md. Once imported, the package is callable: `springline.compare(result_a, result_b)`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..lazy import call_as, lazy_names
from .features import KINDS, FeatureList, feature_list
from .match import match, match_any
from .options import MatchOptions
from .readers import column_features, pacp_features
from .refine import refine
from .result import Drift, Match, Pairs, Span

if TYPE_CHECKING:
    from .epochs import Epoch
    from .pair import Comparison, compare, compare_epochs
    from .registration import Registration
    from .series import Series, compare_series
    from .wall import Wall, wall_of

_HOMES = {
    "Comparison": "pair",
    "Epoch": "epochs",
    "Registration": "registration",
    "Series": "series",
    "Wall": "wall",
    "compare": "pair",
    "compare_epochs": "pair",
    "compare_series": "series",
    "wall_of": "wall",
}

__all__ = [
    "KINDS",
    "Comparison",
    "Drift",
    "Epoch",
    "FeatureList",
    "Match",
    "MatchOptions",
    "Pairs",
    "Registration",
    "Series",
    "Span",
    "Wall",
    "column_features",
    "compare",
    "compare_epochs",
    "compare_series",
    "feature_list",
    "match",
    "match_any",
    "pacp_features",
    "refine",
    "wall_of",
]


__getattr__ = lazy_names(__name__, _HOMES)
call_as(__name__, "compare")
