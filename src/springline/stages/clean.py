"""Clean: why each reading is used or not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..conventions import MASK_REASONS
from ..errors import InputError
from ..geometry.axis import pool_sections, sections_about_axis
from ..geometry.cleaning import flat_at_invert, patches, unlike_neighbours
from ..geometry.deviation import radial_deviation
from ..geometry.fitting import fit_ellipses_to_ranges
from ..survey import add_warning

if TYPE_CHECKING:
    from ..config import CleanConfig, Config
    from ..geometry.fitting import EllipseFits
    from ..survey import Survey

_BLOCK = 4096
_CODE = {name: code for code, name in MASK_REASONS.items()}
_SAMPLE = 200
_OPENING = 0.06
_OBSTACLE = 0.15


def clean(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/mask`: one reason per reading, and the coverage of each ring; `/mask_rear` is alike.

    Judged in this order: no return; out of range of the typical radius; water or sediment lying flat at the invert;
    a lateral (an outward patch that goes on along the pipe); occluded (a patch of returns from something that stands
    between sensor and wall); outlier (a reading that neither the rings nor the bearings about it confirm). Deformed
    wall is wall and stays. Rings that were cut from a cloud share one axis and are judged against sections that share
    it, as an arc of one ring may say little of its section.

    Args:
        survey: With `/rings`, and `/rings_rear` of a second scanner where there is one.
        config: `clean.outlier_sigma`, `clean.range_limits`, `clean.water`.
    """
    mask = _mask(survey.rings, config.clean)
    survey = _explain(survey.with_group("mask", mask), mask["reason"].values, mask["coverage"].values)
    if survey.has("rings_rear"):
        survey = survey.with_group("mask_rear", _mask(survey.rings_rear, config.clean))
    return survey


def _mask(rings: xr.Dataset, settings: CleanConfig) -> xr.Dataset:
    count, bearings = rings.sizes["ring"], rings["bearing"].values
    along = rings["distance"].values if rings.attrs.get("distance_source") == "axis" else None
    radius = _typical_radius(rings, along)
    spacing = np.median(np.diff(rings["distance"].values)) if count > 1 else 2.0 * radius
    window = int(np.clip(round(2.0 * radius / spacing), 1, 201))
    reason = np.empty((count, len(bearings)), np.uint8)
    margin = window
    for start in range(0, count, _BLOCK):
        low, high = max(start - margin, 0), min(start + _BLOCK + margin, count)
        ranges = _returns(rings["range"][low:high].values.astype(float))
        place = None if along is None else along[low:high]
        block = _reasons(ranges, bearings, place, radius, window, settings)
        stop = min(start + _BLOCK, count)
        reason[start:stop] = block[start - low : stop - low]
    coverage = (reason == _CODE["used"]).mean(axis=1)
    return xr.Dataset(
        {"reason": (("ring", "bearing"), reason), "coverage": ("ring", coverage)}, coords={"bearing": bearings}
    )


def _typical_radius(rings: xr.Dataset, along: np.ndarray | None) -> float:
    """Return the median radius [m] over rings spread along the survey; of the readings when no ring can be fitted."""
    if along is not None:
        return float(np.nanmedian(rings["range"].values))
    rows = np.unique(np.linspace(0, rings.sizes["ring"] - 1, _SAMPLE).astype(int))
    ranges = _returns(rings["range"].isel(ring=rows).values)
    fits = fit_ellipses_to_ranges(ranges, rings["bearing"].values)
    if fits.fitted.any():
        return float(np.median(fits.mean_radius[fits.fitted]))
    return float(np.nanmedian(_returns(rings["range"].values)))


def _returns(ranges: np.ndarray) -> np.ndarray:
    """Return ranges with NaN for every reading that is none: some devices tell no return by infinity."""
    return np.where(np.isfinite(ranges), ranges, np.nan)


def _reasons(
    ranges: np.ndarray,
    bearings: np.ndarray,
    along: np.ndarray | None,
    radius: float,
    window: int,
    settings: CleanConfig,
) -> np.ndarray:
    reason = np.zeros(ranges.shape, np.uint8)
    reason[~np.isfinite(ranges)] = _CODE["no_return"]
    low, high = settings.range_limits
    with np.errstate(invalid="ignore"):
        reason[(ranges < low * radius) | (ranges > high * radius)] = _CODE["out_of_range"]
    seen = np.where(reason == 0, ranges, np.nan)
    if settings.water == "auto":
        z, y, deviation, noise = _about_section(seen, bearings, along)
        wet = flat_at_invert(z, y, deviation, noise, radius, window=window)
        reason[wet] = _CODE["water"]
        seen[wet] = np.nan
    _, _, deviation, noise = _about_section(seen, bearings, along)
    across = max(3, round(len(bearings) * 0.02))
    with np.errstate(invalid="ignore"):
        outward = (deviation > _OPENING * radius) | (ranges > high * radius)
        inward = deviation < -_OBSTACLE * radius
    lateral = patches(outward, across=across, along=min(3, window))
    occluded = patches(inward, across=across, along=1)
    reason[lateral] = _CODE["lateral"]
    reason[occluded & ~lateral] = _CODE["occluded"]
    spikes = unlike_neighbours(deviation, noise, settings.outlier_sigma) & (reason == 0)
    reason[spikes] = _CODE["outlier"]
    return reason


def _about_section(ranges: np.ndarray, bearings: np.ndarray, along: np.ndarray | None) -> tuple[np.ndarray, ...]:
    """Return the readings about their ring's section: z, y, radial deviation [m], and the noise of each ring."""
    fits = _shared(ranges, bearings, along) if along is not None else None
    fits = fits or fit_ellipses_to_ranges(ranges, bearings)
    z = ranges * np.cos(bearings) - fits.centre_z[:, None]
    y = ranges * np.sin(bearings) - fits.centre_y[:, None]
    return z, y, radial_deviation(ranges, bearings, fits.parameters), fits.noise_sigma


def _shared(ranges: np.ndarray, bearings: np.ndarray, along: np.ndarray) -> EllipseFits | None:
    """Return sections that share the rings' axis; None when too little was seen for it."""
    try:
        return sections_about_axis(ranges, bearings, along, pool_sections(ranges, bearings, along))
    except InputError:
        return None


def _explain(survey: Survey, reason: np.ndarray, coverage: np.ndarray) -> Survey:
    if (low := int((coverage < 0.5).sum())) > 0:
        survey = add_warning(survey, f"{low} of {len(coverage)} stations were seen over less than half of their wall.")
    wet = (reason == _CODE["water"]).any(axis=1).mean()
    if wet > 0.01:
        survey = add_warning(
            survey,
            f"Water or sediment lies at the invert of {100 * wet:.0f} % of the stations; the wall below it is unseen.",
        )
    return survey
