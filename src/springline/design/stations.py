"""Liner thickness along an inspected pipe, from the metrics of its stations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.design.liner import LinerDesign, LinerResult, design_liner
from springline.errors import ParameterError
from springline.geometry.checks import choice

if TYPE_CHECKING:
    from collections.abc import Mapping

MEANS = ("axes", "polar", "area", "caliper")
"""Means by which an ovality and a mean diameter may be taken."""


def design_stations(design: LinerDesign, metrics: Mapping, *, mean: str = "polar") -> LinerResult:
    """Return the required liner thickness at every station.

    Args:
        design: LinerDesign.
        metrics: The `/metrics` group, or any mapping with `diameter_<mean>` [m], `ovality_<mean>` and, for the sigma,
            the same names with `_sigma`.
        mean: `axes`, `polar`, `area` or `caliper`, for ovality and diameter alike; the sign of the difference between
            them depends on the definition (errata A2), so it is stated with every result.

    Returns:
        LinerResult; its sigma is NaN where the metrics hold none.

    Raises:
        ParameterError: The mean is unknown or the metrics lack it.

    Source: see `design_liner`; errors of diameter and ovality are taken as independent.

    >>> metrics = {"diameter_area": [0.6, 0.598], "ovality_area": [0.01, 0.04],
    ...            "diameter_area_sigma": [1e-3, 1e-3], "ovality_area_sigma": [2e-3, 2e-3]}
    >>> found = design_stations(LinerDesign(modulus=1.7e9, strength=31e6, water_pressure=36e3), metrics, mean="area")
    >>> found.worst(), round(float(1e3 * found.thickness[1]), 2), round(float(1e3 * found.sigma[1]), 2)
    (1, 9.3, 0.06)
    """
    choice("mean", mean, MEANS)
    diameter, ovality = _read(metrics, f"diameter_{mean}"), _read(metrics, f"ovality_{mean}")
    sigmas = (
        _read(metrics, f"{name}_{mean}_sigma") if f"{name}_{mean}_sigma" in metrics else np.full(diameter.shape, np.nan)
        for name in ("diameter", "ovality")
    )
    diameter_sigma, ovality_sigma = sigmas
    return design_liner(design, diameter, ovality, diameter_sigma=diameter_sigma, ovality_sigma=ovality_sigma)


def _read(metrics: Mapping, name: str) -> np.ndarray:
    if name not in metrics:
        raise ParameterError(f"the metrics lack {name}", expected="diameter and ovality by the mean asked for")
    return np.asarray(metrics[name], dtype=float)
