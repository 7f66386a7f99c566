"""The summary of an inspection: the few numbers that stand at the top of everything."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import __version__
from .plain import plain_number
from .results import Results, feature_count, worst_station

if TYPE_CHECKING:
    from ..survey import Survey


def summary(survey: Survey) -> dict[str, Any]:
    """Return the content of `summary.json`; None where a value is not available.

    Largest values leave out stations flagged by `conventions.NOT_SPEAKING`. `unseen_m` is the length of stations
    under 50 % coverage and of gaps of more than three spacings between stations. `features` is how many were found,
    None when nobody looked for any. Deviations from a design line stand in it where one was given.

    Args:
        survey: A finished survey.

    Raises:
        ContractError: The survey is not finished.
    """
    results = Results(survey)
    ovality, deflection, loss = (results.judged(name) for name in ("ovality_polar", "deflection", "area_loss"))
    most_oval, most_deflected, most_lost = (worst_station(values) for values in (ovality, deflection, loss))

    def sigma(name: str, station: int | None) -> float | None:
        return _at(results.metric(f"{name}_sigma"), station, 1e2)

    coverage = results.coverage
    return {
        "name": survey.attrs.get("name"),
        "length_m": plain_number(results.length),
        "stations": results.stations,
        "nominal_diameter_mm": plain_number(survey.attrs.get("nominal_diameter"), 1e3, 3),
        "coverage_pct": plain_number(np.mean(np.nan_to_num(coverage)) if np.isfinite(coverage).any() else None, 1e2, 2),
        "unseen_m": plain_number(results.unseen),
        "diameter_mean_mm": plain_number(results.metrics_attr("diameter_mean"), 1e3),
        "diameter_sigma_mm": plain_number(results.metrics_attr("diameter_sigma"), 1e3),
        "diameter_sigma_fit_mm": plain_number(results.metrics_attr("diameter_sigma_fit"), 1e3),
        "diameter_sigma_scale_mm": plain_number(results.metrics_attr("diameter_sigma_scale"), 1e3),
        "ovality_polar_max_pct": _at(ovality, most_oval, 1e2),
        "ovality_polar_max_sigma_pct": sigma("ovality_polar", most_oval),
        "ovality_polar_max_chainage_m": _at(results.chainage, most_oval, 1.0),
        "deflection_max_pct": _at(deflection, most_deflected, 1e2),
        "deflection_max_sigma_pct": sigma("deflection", most_deflected),
        "deflection_max_chainage_m": _at(results.chainage, most_deflected, 1.0),
        "area_loss_max_pct": _at(loss, most_lost, 1e2),
        "area_loss_max_sigma_pct": sigma("area_loss", most_lost),
        **(_deviations(results) if survey.has("design_line") else {}),
        "features": feature_count(survey),
        "rules": json.loads(survey.attrs.get("rules", "[]")),
        "warnings": survey.warnings,
        "assumptions": survey.assumptions,
        "version": results.provenance.get("version", __version__),
    }


def _deviations(results: Results) -> dict[str, float | None]:
    """Return the deviations from the design line that are largest in size, with their sign, and where they stand."""
    found: dict[str, float | None] = {}
    for name, unit, factor in (("up", "mm", 1e3), ("right", "mm", 1e3), ("gradient", "pct", 1e2)):
        values = results.judged(f"deviation_{name}", "layout")
        at = worst_station(np.abs(values))
        found[f"deviation_{name}_max_{unit}"] = _at(values, at, factor)
        found[f"deviation_{name}_max_chainage_m"] = _at(results.chainage, at, 1.0)
    return found


def _at(values: np.ndarray, station: int | None, factor: float) -> float | None:
    return None if station is None else plain_number(values[station], factor)
