"""Metrics: what an engineer reads off each station's section, with one-sigma, against the reference diameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..geometry.axis import mean_over_stations
from ..geometry.fitting.boundary import amplitude_interval
from ..geometry.measures import ellipse_measures
from ..survey import add_assumption

if TYPE_CHECKING:
    from ..config import Config
    from ..geometry.measures import Measure
    from ..survey import Survey

# Power of length with which a measure grows; the scale's relative sigma counts that many times.
_POWER_OF_LENGTH = {"area": 2.0, "conveyance": 8 / 3, "axis_bearing": 0.0, "diameter_max_bearing": 0.0}


def metrics(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/metrics`: diameters, ovalities, deflection, area and capacity per station.

    Every `_sigma` joins the fit's part and the sensor scale's (`range_scale_sigma` of `/section`), except where the
    scale cancels (ovalities, bearings). Deflection and losses are missing when no reference diameter is known.

    Args:
        survey: With `/section`.
        config: `metrics.reference` chooses Dref.

    Source: DESIGN section 4 for the definitions; errata A2 for why the four means stand side by side.
    """
    section = survey.section
    scale = float(section.attrs["range_scale_sigma"])
    found = ellipse_measures(section["parameters"].values, section["covariance"].values)
    columns: dict[str, np.ndarray] = {}
    for name, measure in found.items():
        if name != "conveyance":
            columns[name] = measure.value
            columns[f"{name}_sigma"] = _total(name, measure, scale)
    columns["diameter_area_sigma_fit"] = found["diameter_area"].sigma
    columns |= _ovality_interval(section["parameters"].values, section["covariance"].values)
    reference, kind = reference_diameter(survey, config)
    if reference is not None:
        columns |= _against(reference, found, scale)
        survey = add_assumption(survey, f"Deflection and losses refer to the {kind} diameter, {reference * 1e3:g} mm.")
    data = xr.Dataset(
        {"chainage": section["chainage"], **{name: ("station", values) for name, values in columns.items()}},
        attrs={
            "reference_diameter": np.nan if reference is None else reference,
            "reference_kind": kind,
            **_mean_diameter(section, found["diameter_area"], scale),
        },
    )
    return survey.with_group("metrics", data)


def reference_diameter(survey: Survey, config: Config) -> tuple[float | None, str]:
    """Return Dref [m] and what it is: base, nominal or none.

    Args:
        survey: With `base_diameter` and `nominal_diameter` among its attributes, where known.
        config: `metrics.reference` is auto (base before nominal), base or nominal.
    """
    wanted = ("base", "nominal") if config.metrics.reference == "auto" else (config.metrics.reference,)
    for kind in wanted:
        value = survey.attrs.get(f"{kind}_diameter")
        if value is not None:
            return float(value), kind
    return None, "none"


def _ovality_interval(parameters: np.ndarray, covariance: np.ndarray) -> dict[str, np.ndarray]:
    """Return the 95 % interval of the polar ovality, which rises with the amplitude of (oval_cos, oval_sin)."""
    ends = amplitude_interval(parameters[:, 1:], covariance[:, 1:, 1:])
    ellipse = np.zeros_like(parameters)
    ellipse[:, 0] = parameters[:, 0]
    columns = {}
    for name, amplitude in zip(("ovality_polar_low", "ovality_polar_high"), ends, strict=True):
        ellipse[:, 1] = np.minimum(amplitude, 0.999 * parameters[:, 0])
        columns[name] = ellipse_measures(ellipse, covariance)["ovality_polar"].value
    return columns


def _mean_diameter(section: xr.Dataset, diameter: Measure, scale: float) -> dict[str, float]:
    """Return the mean diameter and its one-sigma in two parts: the fit's and the sensor's scale."""
    if "mean_diameter" in section.attrs:
        mean, fit = float(section.attrs["mean_diameter"]), float(section.attrs["mean_diameter_sigma"])
    else:
        mean, fit = mean_over_stations(diameter.value, diameter.sigma)
    parts = {"diameter_sigma_fit": fit, "diameter_sigma_scale": scale * mean}
    return {"diameter_mean": mean, "diameter_sigma": float(np.hypot(*parts.values())), **parts}


def _total(name: str, measure: Measure, scale: float) -> np.ndarray:
    power = 0.0 if name.startswith("ovality") else _POWER_OF_LENGTH.get(name, 1.0)
    return np.hypot(measure.sigma, power * scale * measure.value)


def _against(reference: float, found: dict[str, Measure], scale: float) -> dict[str, np.ndarray]:
    circle = ellipse_measures([reference / 2, 0.0, 0.0], np.zeros((3, 3)))
    columns = {}
    for name, measure, sign in (
        ("deflection", "diameter_min", -1),
        ("deflection_x", "diameter_x", 1),
        ("deflection_y", "diameter_y", 1),
    ):
        columns[name] = sign * (found[measure].value / reference - 1)
        columns[f"{name}_sigma"] = _total(measure, found[measure], scale) / reference
    for name, measure in (("area_loss", "area"), ("capacity_loss", "conveyance")):
        whole = float(circle[measure].value)
        columns[name] = 1 - found[measure].value / whole
        columns[f"{name}_sigma"] = _total(measure, found[measure], scale) / whole
    return columns
