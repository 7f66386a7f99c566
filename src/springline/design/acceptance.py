"""The verdict that measured stations give under an acceptance rule.

A station passes or fails only when its 95 % interval lies wholly on one side of the limit; it is uncertain when the
interval straddles it, and not assessed when value, sigma or reference diameter are missing. Nothing is judged on a
figure that the rule does not hold.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.design.rule import Rule, load_rule
from springline.errors import ParameterError
from springline.geometry.checks import choice, finite, require

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]
    Bounds = tuple[tuple[int, float], ...]

VERDICTS = ("pass", "fail", "uncertain", "not_assessed")

REFERENCES = ("nominal", "base", "representative")
"""Diameters that a deflection may refer to."""

MATERIALS = ("rigid", "flexible")


@dataclass(frozen=True)
class Assessment:
    """What a rule makes of the stations.

    Attributes:
        rule: Name of the rule.
        edition: Its edition.
        verdict: One of VERDICTS, for the whole pipe.
        where: Chainage of the station that decides [m]; NaN when there is none.
        why: The reason in one sentence.
        stations: Verdict of each station.
        classes: Class of each station's value, NaN where there is none or the rule has no classes.
        remarks: What else must be known.
    """

    rule: str
    edition: str
    verdict: str
    where: float
    why: str
    stations: np.ndarray
    classes: np.ndarray
    remarks: tuple[str, ...] = ()


def evaluate(
    rule: Rule | str | Path,
    values: ArrayLike,
    sigmas: ArrayLike,
    *,
    chainage: ArrayLike | None = None,
    reference: str | None = None,
    material: str | None = None,
    confidence: float = 0.95,
    least_assessed: float = 0.9,
) -> Assessment:
    """Judge stations by a rule.

    Args:
        rule: Rule, its name, or the path of a TOML file.
        values: The rule's quantity at each station (n,), as a fraction; NaN where missing.
        sigmas: One sigma of each value.
        chainage: Of each station [m]; its number when not given.
        reference: Diameter that the values refer to: `nominal`, `base`, `representative`, or None when unknown.
        material: `rigid` or `flexible`, for rules whose classes depend on it.
        confidence: Of the two-sided interval.
        least_assessed: Share of stations that must be assessed for a pipe to pass.

    Returns:
        Assessment. The pipe fails when a station fails, is uncertain when a station is or when too few are assessed,
        and passes otherwise.

    Raises:
        ParameterError: Shapes differ, a value is infinite, or a word is not known.

    >>> found = evaluate("deflection-5", [0.02, 0.049, 0.06], [0.001, 0.001, 0.002], reference="base")
    >>> found.verdict, found.where, found.stations.tolist()
    ('fail', 2.0, ['pass', 'uncertain', 'fail'])
    >>> found.why
    'deflection 6.0 % +- 0.2 % at 2.00 m lies above 5 %; 1 of 3 stations fail, 1 uncertain, 0 not assessed'
    """
    rule = rule if isinstance(rule, Rule) else load_rule(rule)
    values, sigmas = np.atleast_1d(finite("values", values)), np.atleast_1d(finite("sigmas", sigmas))
    chainage = np.arange(float(values.size)) if chainage is None else np.atleast_1d(finite("chainage", chainage))
    if values.ndim != 1 or not values.shape == sigmas.shape == chainage.shape:
        raise ParameterError(
            f"values, sigmas and chainage have shapes {values.shape}, {sigmas.shape}, {chainage.shape}",
            expected="one value, one sigma and one chainage per station",
        )
    require(~(sigmas < 0), "sigmas", sigmas, "sigma >= 0", "give one-sigma values")
    require(np.asarray(0 < confidence < 1), "confidence", confidence, "0 < confidence < 1", "0.95 is usual")
    for name, word, known in (("reference", reference, REFERENCES), ("material", material, MATERIALS)):
        if word is not None:
            choice(name, word, known)
    bounds = rule.bounds(material)
    reason = _not_applicable(rule, reference, material, bounds)
    if reason:
        stations = np.full(values.shape, "not_assessed")
        return Assessment(rule.name, rule.edition, "not_assessed", np.nan, reason, stations, values * np.nan)
    # A class begins at its lower bound, a limit may be reached.
    limit = rule.limit if bounds is None else np.nextafter(dict(bounds)[rule.fail_at], 0.0)
    stations = _stations(values, sigmas, limit, confidence)
    verdict, decides = _overall(stations, values, least_assessed)
    where = np.nan if decides is None else float(chainage[decides])
    why = _why(rule, stations, values, sigmas, limit, verdict, decides, where)
    classes = np.full(values.shape, np.nan) if bounds is None else _classes(values, bounds)
    remarks = _remarks(rule, reference, values, sigmas)
    return Assessment(rule.name, rule.edition, verdict, where, why, stations, classes, remarks)


def _stations(values: Array, sigmas: Array, limit: float, confidence: float) -> Array:
    from scipy.special import ndtri

    reach = float(ndtri(0.5 + confidence / 2.0)) * sigmas
    verdicts = np.full(values.shape, "uncertain", dtype="<U12")
    verdicts[values + reach <= limit] = "pass"
    verdicts[values - reach > limit] = "fail"
    verdicts[np.isnan(values + sigmas)] = "not_assessed"
    return verdicts


def _overall(stations: Array, values: Array, least_assessed: float) -> tuple[str, int | None]:
    """Return the verdict on the pipe and the station that decides, None when there is none."""
    for verdict in ("fail", "uncertain"):
        these = stations == verdict
        if these.any():
            return verdict, int(np.argmax(np.where(these, values, -np.inf)))
    assessed = stations == "pass"
    if not assessed.any():
        return "not_assessed", None
    decides = int(np.argmax(np.where(assessed, values, -np.inf)))
    return ("pass" if assessed.mean() >= least_assessed else "uncertain"), decides


def _why(
    rule: Rule,
    stations: Array,
    values: Array,
    sigmas: Array,
    limit: float,
    verdict: str,
    decides: int | None,
    where: float,
) -> str:
    if decides is None:
        return f"no station has a {rule.quantity} with its sigma"
    count = {name: int(np.sum(stations == name)) for name in VERDICTS}
    sigma = 100 * sigmas[decides]
    shown = f"{sigma:.1g}" if sigma < 9.5 else f"{sigma:.0f}"
    text = f"{rule.quantity} {100 * values[decides]:.1f} % +- {shown} % at {where:.2f} m"
    relation = {"fail": "lies above", "uncertain": "cannot be told from", "pass": "is the largest, below"}
    own = stations[decides]
    text += f" {relation[str(own)]} {100 * limit:g} %"
    text += f"; {count['fail']} of {stations.size} stations fail, {count['uncertain']} uncertain, "
    text += f"{count['not_assessed']} not assessed"
    return text + (": too few to pass the pipe" if verdict == "uncertain" and own == "pass" else "")


def _not_applicable(rule: Rule, reference: str | None, material: str | None, bounds: Bounds | None) -> str | None:
    """Return why the rule cannot be applied, or None."""
    if rule.missing:
        return rule.missing
    if reference is None:
        return f"the reference diameter is not known; the rule refers to {' or '.join(rule.references)}"
    if reference not in rule.references:
        return f"the values refer to the {reference} diameter; the rule refers to {' or '.join(rule.references)}"
    if rule.limit is None and bounds is None:
        given = "not known" if material is None else material
        return f"the rule depends on the material, which is {given}; it holds for {' or '.join(rule.classes)}"
    return None


def _remarks(rule: Rule, reference: str, values: Array, sigmas: Array) -> tuple[str, ...]:
    remarks = [*rule.notes]
    if reference != rule.references[0]:
        remarks.append(f"values refer to the {reference} diameter; the rule prefers the {rule.references[0]} one")
    if rule.accuracy is not None:
        poor = np.sum(2.0 * sigmas > rule.accuracy)
        if poor:
            remarks.append(f"{poor} of {values.size} stations miss the accuracy of {100 * rule.accuracy:g} %")
    return tuple(remarks)


def _classes(values: Array, bounds: Bounds) -> Array:
    found = np.full(values.shape, np.nan)
    for number, lower in reversed(bounds):
        found[values >= lower] = number
    # A reading just below zero is a round pipe in noise: the mildest class.
    found[values < bounds[-1][1]] = bounds[-1][0]
    return found
