"""A liner's design in the edge units: the summary that stands in `design.json`, and the table along the pipe."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from ..design.along import stated, thickness_variable
from ..design.liner import WARNINGS
from .plain import plain_number
from .results import text

if TYPE_CHECKING:
    from ..design import LinerDesign, LinerResult
    from ..survey import Survey


def design_summary(survey: Survey) -> dict[str, Any]:
    """Return the content of `design.json`; None where a value is not available.

    Args:
        survey: With `/design`.

    Raises:
        MissingGroupError: Nothing has been designed.
    """
    data = survey.design
    attrs, at = data.attrs, int(data.attrs["governing_station"])
    thickness = data["liner_thickness"].values
    governing = np.array(text(data, "liner_governing", thickness.size))
    remarks = " ".join(text(data, "liner_remarks", thickness.size)).split()
    known = governing != ""
    checks = json.loads(attrs["checks"])
    return {
        "name": survey.attrs.get("name"),
        **{key: attrs[key] for key in ("rule", "edition", "condition", "mean")},
        "stations": int(thickness.size),
        "stations_without": int(np.sum(~known)),
        "governing_chainage_m": plain_number(data["chainage"].values[at]),
        "governing_check": str(governing[at]),
        "diameter_mm": plain_number(data["diameter"].values[at], 1e3),
        "ovality_pct": plain_number(data["ovality"].values[at], 1e2),
        "required_mm": plain_number(thickness[at], 1e3),
        "sigma_mm": plain_number(data["liner_thickness_sigma"].values[at], 1e3),
        "required_upper_mm": plain_number(attrs["required_upper"], 1e3),
        "standard_mm": plain_number(attrs["standard"], 1e3),
        "standard_upper_mm": plain_number(attrs["standard_upper"], 1e3),
        "dimension_ratio": plain_number(data["dimension_ratio"].values[at]),
        "thickness_min_mm": plain_number(np.nanmin(thickness), 1e3),
        "thickness_mean_mm": plain_number(np.nanmean(thickness), 1e3),
        "governs": {check: plain_number(np.mean(governing[known] == check)) for check in checks},
        "checks_mm": {check: plain_number(data[thickness_variable(check)].values[at], 1e3) for check in checks},
        "inputs": json.loads(attrs["inputs"]),
        "warnings": [f"at {remarks.count(key)} stations {WARNINGS[key]}" for key in WARNINGS if key in remarks],
    }


def numbers_summary(
    design: LinerDesign, found: LinerResult, diameter: float, ovality: float, *, upper: float, standards: np.ndarray
) -> dict[str, Any]:
    """Return the same of a design from numbers.

    Args:
        design: LinerDesign.
        found: Its result for the one diameter and ovality.
        diameter: Mean diameter [m].
        ovality: As a fraction.
        upper: One-sided 95 % bound of the thickness [m].
        standards: Next thickness up that is made, for the thickness and for its bound [m].
    """
    attrs = stated(design, found)
    return {
        "name": None,
        **{key: attrs[key] for key in ("rule", "edition", "condition")},
        "mean": None,
        "stations": 1,
        "stations_without": 0,
        "governing_chainage_m": None,
        "governing_check": str(found.governing),
        "diameter_mm": plain_number(diameter, 1e3),
        "ovality_pct": plain_number(ovality, 1e2),
        "required_mm": plain_number(found.thickness, 1e3),
        "sigma_mm": plain_number(found.sigma, 1e3),
        "required_upper_mm": plain_number(upper, 1e3),
        "standard_mm": plain_number(standards[0], 1e3),
        "standard_upper_mm": plain_number(standards[1], 1e3),
        "dimension_ratio": plain_number(found.dimension_ratio),
        "thickness_min_mm": plain_number(found.thickness, 1e3),
        "thickness_mean_mm": plain_number(found.thickness, 1e3),
        "governs": {check: float(check == found.governing) for check in found.checks},
        "checks_mm": {check: plain_number(values, 1e3) for check, values in found.checks.items()},
        "inputs": json.loads(attrs["inputs"]),
        "warnings": [WARNINGS[name] for name in found.warnings],
    }


def design_table(survey: Survey) -> tuple[pd.DataFrame, dict[str, int]]:
    """Return the rows of `design.csv`, one per station, and the decimals of its numbers.

    Args:
        survey: With `/design`.

    Raises:
        MissingGroupError: Nothing has been designed.
    """
    data = survey.design
    count = data.sizes["station"]
    columns = {
        "chainage_m": (data["chainage"].values, 4),
        "diameter_mm": (1e3 * data["diameter"].values, 3),
        "ovality_pct": (1e2 * data["ovality"].values, 4),
        "liner_thickness_mm": (1e3 * data["liner_thickness"].values, 3),
        "liner_thickness_sigma_mm": (1e3 * data["liner_thickness_sigma"].values, 3),
        "liner_standard_mm": (1e3 * data["liner_standard"].values, 3),
        "dimension_ratio": (data["dimension_ratio"].values, 2),
    }
    for check in json.loads(data.attrs["checks"]):
        name = thickness_variable(check)
        columns[f"{name}_mm"] = (1e3 * data[name].values, 3)
    table = pd.DataFrame({name: values for name, (values, _) in columns.items()})
    for name in ("liner_governing", "liner_remarks"):
        table[name] = text(data, name, count)
    return table, {name: decimals for name, (_, decimals) in columns.items()}
