"""Limits of the rules that were asked for, so that charts can draw them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...design import load_rule
from ...design.judge import material_class
from ...errors import SpringlineError
from ..summary import summary

if TYPE_CHECKING:
    from ...survey import Survey


def rule_limits(survey: Survey, quantity: str) -> tuple[tuple[str, float], ...]:
    """Return label and limit (a fraction) of each rule that was asked for and judges a quantity.

    A rule by classes stands with the lower bound of the mildest class that fails. A rule of the user's own, which is
    not at hand any more, or one whose figures are not known has no limit to draw.
    """
    found = []
    for verdict in summary(survey)["rules"]:
        try:
            rule = load_rule(str(verdict.get("rule")))
        except SpringlineError:
            continue
        bounds = rule.bounds(material_class(survey.attrs.get("material")))
        limit = rule.limit if bounds is None else dict(bounds)[rule.fail_at]
        if rule.quantity == quantity and limit is not None:
            found.append((f"limit of {rule.name}, {limit * 100:g} %", limit))
    return tuple(found)
