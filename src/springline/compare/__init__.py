"""Match two inspections of one pipe; the model is in docs/compare.md."""

from .features import KINDS, FeatureList, feature_list
from .match import match, match_any
from .options import MatchOptions
from .readers import column_features, pacp_features
from .result import Drift, Match, Pairs, Span

__all__ = [
    "KINDS",
    "Drift",
    "FeatureList",
    "Match",
    "MatchOptions",
    "Pairs",
    "Span",
    "column_features",
    "feature_list",
    "match",
    "match_any",
    "pacp_features",
]
