"""Liner design and acceptance rules: one file per published method, rules as data.

Pure functions in SI. `f1216` and `f1216_pressure` are ASTM F1216 appendix X1, `glock` close-fit buckling; `liner`
sizes a liner along a pipe; `acceptance` judges measured deformation by the rules in `rules/*.toml`.
"""

from __future__ import annotations

from springline.design.acceptance import Assessment, evaluate
from springline.design.along import design_survey
from springline.design.judge import judge
from springline.design.liner import LinerDesign, LinerResult, design_liner, next_standard
from springline.design.rule import Rule, load_rule, rule_names
from springline.design.stations import design_stations

__all__ = [
    "Assessment",
    "LinerDesign",
    "LinerResult",
    "Rule",
    "design_liner",
    "design_stations",
    "design_survey",
    "evaluate",
    "judge",
    "load_rule",
    "next_standard",
    "rule_names",
]
