"""The verdicts of acceptance rules on an inspected survey."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from springline.conventions import NOT_SPEAKING, flagged
from springline.design.acceptance import evaluate
from springline.design.rule import Rule, load_rule
from springline.errors import ContractError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from springline.survey import Survey

_RIGID = ("concrete", "clay", "vitrified", "brick", "masonry", "cast iron", "fibre cement", "asbestos")
_FLEXIBLE = ("pvc", "pe", "polyethylene", "pp", "polypropylene", "grp", "steel", "ductile", "corrugated", "plastic")


def judge(survey: Survey, rules: Iterable[Rule | str]) -> Survey:
    """Return the survey with the verdicts of rules in its attribute `rules`.

    Args:
        survey: With `/section` and `/metrics`; stations flagged by one of `conventions.NOT_SPEAKING` are not assessed.
        rules: Rules, names of rules that come with the program, or paths of TOML files.

    Raises:
        ParameterError: A rule is unknown; the message names the nearest.
        ContractError: A rule judges a quantity that is not in `/metrics`.
    """
    metrics = survey.metrics
    reference = metrics.attrs["reference_kind"]
    silent = flagged(survey.section["flags"].values, *NOT_SPEAKING)
    verdicts = []
    for given in rules:
        rule = given if isinstance(given, Rule) else load_rule(given)
        if rule.quantity not in metrics:
            if rule.quantity.startswith(("deflection", "area_loss", "capacity_loss")) and reference == "none":
                verdicts.append(_unjudged(rule.name, rule.edition, "no reference diameter: give --nominal or --base"))
                continue
            raise ContractError(f"'{rule.quantity}' is not among the metrics", where=f"rule {rule.name}")
        found = evaluate(
            rule,
            np.where(silent, np.nan, metrics[rule.quantity].values),
            metrics[f"{rule.quantity}_sigma"].values,
            chainage=metrics["chainage"].values,
            reference=None if reference == "none" else reference,
            material=material_class(survey.attrs.get("material")),
        )
        verdicts.append(
            {
                "rule": found.rule,
                "edition": found.edition,
                "verdict": found.verdict,
                "where": None if found.where != found.where else round(float(found.where), 4),
                "why": found.why,
                "remarks": list(found.remarks),
            }
        )
    return survey.with_attrs(rules=json.dumps(verdicts))


def material_class(material: str | None) -> str | None:
    """Return whether a material is rigid or flexible, or None when its name does not tell.

    >>> material_class("PVC-U"), material_class("vitrified clay"), material_class(None)
    ('flexible', 'rigid', None)
    """
    text = (material or "").lower()
    if any(word in text for word in _RIGID):
        return "rigid"
    words = text.replace("-", " ").split()
    return "flexible" if any(word.startswith(_FLEXIBLE) for word in words) else None


def _unjudged(rule: str, edition: str, why: str) -> dict[str, object]:
    return {
        "rule": rule,
        "edition": edition,
        "verdict": "not_assessed",
        "where": None,
        "why": why,
        "remarks": [],
    }
