"""A liner for an inspected pipe: thickness at every station, which check governs, and the station that governs all."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from springline.conventions import NOT_SPEAKING, flagged
from springline.design.liner import WARNINGS, LinerDesign, next_standard
from springline.design.stations import design_stations
from springline.errors import InputError
from springline.survey import Survey, add_warning

if TYPE_CHECKING:
    from collections.abc import Sequence

    from springline.design.liner import LinerResult

Z_ONE_SIDED = 1.6448536269514722
"""Sigmas above an estimate that the truth exceeds in 5 % of all cases."""

METHOD_NAMES = {"f1216": "ASTM F1216 appendix X1", "glock": "Glock in place of ASTM F1216 X1.1"}


def design_survey(
    survey: Survey,
    design: LinerDesign,
    *,
    mean: str = "polar",
    step: float = 0.0015,
    sizes: Sequence[float] | None = None,
) -> Survey:
    """Return the survey with `/design`: the liner's thickness at every station; an earlier design is replaced.

    Args:
        survey: With `/metrics`, as an inspection leaves it.
        design: What the liner is made of, what loads it, and by which rule it is sized.
        mean: By which mean diameter and ovality are taken: `axes`, `polar`, `area` or `caliper`.
        step: Liners are made in multiples of this thickness [m].
        sizes: Or the thicknesses that are made [m].

    Raises:
        MissingGroupError: The survey has not been inspected.
        ParameterError: A number is out of range.
        InputError: No station has a diameter and an ovality.

    Source: see `design_liner`. Stations that do not speak for the pipe (`conventions.NOT_SPEAKING`) have a thickness
    but do not govern.
    """
    found = design_stations(design, survey.metrics, mean=mean)
    if np.isnan(found.thickness).all():
        raise InputError(
            "no station has a thickness",
            where=survey.attrs.get("name", "survey"),
            expected="a diameter and an ovality at one station or more",
            mend="look at the status of the stations in stations.csv",
        )
    data = _dataset(survey.metrics, found, mean, next_standard(found.thickness, step=step, sizes=sizes))
    speaking = ~flagged(survey.section["flags"].values, *NOT_SPEAKING) & ~np.isnan(found.thickness)
    if not speaking.any():
        speaking = ~np.isnan(found.thickness)
    governing = int(np.argmax(np.where(speaking, found.thickness, -np.inf)))
    upper = np.nan_to_num(found.sigma[governing]) * Z_ONE_SIDED + found.thickness[governing]
    data.attrs = {
        **stated(design, found),
        "mean": mean,
        "governing_station": governing,
        "required_upper": float(upper),
        "standard": float(next_standard(found.thickness[governing], step=step, sizes=sizes)),
        "standard_upper": float(next_standard(upper, step=step, sizes=sizes)),
    }
    groups = {name: survey.group(name) for name in survey.groups if name != "design"}
    return _explain(Survey({**groups, "design": data}, survey.attrs), found)


def stated(design: LinerDesign, found: LinerResult) -> dict[str, str]:
    """Return the attributes of `/design` that say by what it was designed; lists and tables as JSON."""
    numbers = {
        key: None if isinstance(value, float) and not np.isfinite(value) else value
        for key, value in asdict(design).items()
    }
    return {
        "rule": METHOD_NAMES[design.method],
        "edition": design.edition,
        "condition": design.condition,
        "checks": json.dumps(list(found.checks)),
        "inputs": json.dumps(numbers),
    }


def _dataset(metrics: xr.Dataset, found: LinerResult, mean: str, standard: np.ndarray) -> xr.Dataset:
    remarks = [np.where(where, name, "") for name, where in found.warnings.items()]
    columns = {
        "chainage": metrics["chainage"].values,
        "diameter": metrics[f"diameter_{mean}"].values,
        "ovality": metrics[f"ovality_{mean}"].values,
        "liner_thickness": found.thickness,
        "liner_thickness_sigma": found.sigma,
        "liner_governing": found.governing,
        "liner_standard": standard,
        "dimension_ratio": found.dimension_ratio,
        "liner_remarks": np.array([" ".join(filter(None, words)) for words in zip(*remarks, strict=True)])
        if remarks
        else np.full(found.thickness.shape, ""),
        **{
            thickness_variable(check): np.broadcast_to(values, found.thickness.shape)
            for check, values in found.checks.items()
        },
    }
    return xr.Dataset({name: ("station", values) for name, values in columns.items()})


def thickness_variable(check: str) -> str:
    """Return the variable of `/design` that holds the thickness by one check.

    >>> thickness_variable("X1.1"), thickness_variable("DR limit")
    ('thickness_x1_1', 'thickness_dr_limit')
    """
    return "thickness_" + check.lower().replace(".", "_").replace(" ", "_")


def _explain(survey: Survey, found: LinerResult) -> Survey:
    without = int(np.isnan(found.thickness).sum())
    if without:
        survey = add_warning(survey, f"{without} of {found.thickness.size} stations have no liner thickness.")
    for name, where in found.warnings.items():
        survey = add_warning(survey, f"Liner design: at {int(np.sum(where))} stations {WARNINGS[name]}.")
    return survey
