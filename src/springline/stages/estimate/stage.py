"""Estimate: where the sensor was in the pipe, and the pipe's section at every station."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from ..conventions import FIT_STATUS, POSE_TERMS, SECTION_PARAMETERS
from ..errors import InputError
from ..geometry.axis import pool_sections, sections_about_axis
from ..geometry.cleaning import unlike_both_sides
from ..geometry.deviation import correlation_inflation, largest_gap, radial_deviation, smoothed_extremes
from ..geometry.fitting import fit_ellipses_to_ranges
from ..geometry.fitting.modes import CLASSES, select_modes
from ..survey import add_assumption, add_warning

if TYPE_CHECKING:
    from ..config import Config, EstimateConfig
    from ..geometry.axis import PooledSection
    from ..geometry.fitting import EllipseFits
    from ..survey import Survey

_BLOCK = 4096
_TOO_FEW, _ARC_TOO_SHORT = 1, 3
_ALIKE = 9
_SCATTERED = 3.0
_INDEPENDENT = 2.0
_PER_STATION = ("residual_rms", "noise", "centre_y", "centre_z")
_SEVERITIES = ("s1", "s2", "s02", "s01")
_DEVIATIONS = ("deviation_in", "deviation_in_bearing", "deviation_out", "deviation_out_bearing")


def estimate(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/pose` and `/section`: one robust geometric ellipse per ring, and its mode.

    The section's centre gives the sensor's offset; its shape is taken as perpendicular to the pipe, so that the
    sensor's own tilt stays in it (an assumption that is stated). Sigmas are widened where neighbouring readings err
    together. Stations without enough coverage, or whose readings
    do not determine an ellipse, have no section and say why in `status`. Rings that were cut from a cloud share its
    axis and lend one another what a part of the wall leaves open; their mean section gives the mean diameter. The mode
    of deformation is named only where its posterior is clear, `undecided` otherwise.

    Args:
        survey: With `/rings` and `/mask`.
        config: `estimate.minimum_coverage`, `estimate.largest_gap`, `sensor.scale_sigma`.

    Raises:
        InputError: No station at all could be fitted.

    Source: dissertation 2.9.1 (geometric fit) and 4.1 (origin offset).
    """
    rings, mask = survey.rings, survey.mask
    found = _fit(rings, mask, config.estimate)
    if not (found["status"] == 0).any():
        reasons = ", ".join(sorted({FIT_STATUS[code] for code in np.unique(found["status"])}))
        raise InputError(
            f"no ring has a section: {reasons}",
            where=survey.attrs.get("name", "survey"),
            expected="readings of the wall over a quarter of the circumference or more",
            mend="check unit, --nominal and the clean settings",
        )
    found["unlike"], found["scattered"] = _unlike(rings, found), _scattered(rings, found)
    scale, source = _scale(survey, config)
    section = _section(rings, mask, found)
    section.attrs = {"model": "ellipse", "range_scale_sigma": scale, "range_scale_source": source}
    if "mean_diameter" in found:
        section.attrs |= {name: found[name] for name in ("mean_diameter", "mean_diameter_sigma")}
    survey = _explain(survey, found)
    return survey.with_group("pose", _pose(rings, found)).with_group("section", section)


class _Fitted(NamedTuple):
    """Sections of some rings: the readings they stand on, and how many readings err alike, so count as one."""

    ranges: np.ndarray
    fits: EllipseFits
    covariance: np.ndarray
    status: np.ndarray
    alike: np.ndarray


def _fit(rings: xr.Dataset, mask: xr.Dataset, settings: EstimateConfig) -> dict[str, np.ndarray]:
    count, bearings = rings.sizes["ring"], rings["bearing"].values
    found = {name: np.full(count, np.nan) for name in (*_PER_STATION, *_DEVIATIONS)}
    found["parameters"] = np.full((count, 5), np.nan)
    found["covariance"] = np.full((count, 5, 5), np.nan)
    found["status"] = np.empty(count, np.uint8)
    found["severities"] = np.full((count, 4), np.nan)
    found["severities_sigma"] = np.full((count, 4), np.nan)
    found["mode"] = np.full(count, -1, np.int8)
    found["mode_probability"] = np.full(count, np.nan)
    found["inverted"] = np.zeros(count, bool)
    common = _common(rings, mask)
    if common is not None:
        _fit_rows(found, slice(0, count), _about_axis(rings, mask, common), bearings)
        found["mean_diameter"] = common.diameter
        doubt = float(rings.attrs.get("diameter_doubt", 0.0))
        found["mean_diameter_sigma"] = float(np.hypot(common.diameter_sigma, doubt * common.diameter))
        return found
    for start in range(0, count, _BLOCK):
        rows = slice(start, start + _BLOCK)
        _fit_rows(found, rows, _one_by_one(rings, mask, rows, settings), bearings)
    return found


def _common(rings: xr.Dataset, mask: xr.Dataset) -> PooledSection | None:
    """Return the mean section of rings that were cut from a cloud about one axis; None for rings of their own."""
    if rings.attrs.get("distance_source") != "axis":
        return None
    ranges = np.where(mask["reason"].values == 0, rings["range"].values, np.nan)
    return pool_sections(ranges, rings["bearing"].values, rings["distance"].values)


def _about_axis(rings: xr.Dataset, mask: xr.Dataset, common: PooledSection) -> _Fitted:
    """Return the section of each ring about the axis that they share."""
    ranges = np.where(mask["reason"].values == 0, rings["range"].values, np.nan)
    fits = sections_about_axis(ranges, rings["bearing"].values, rings["distance"].values, common)
    alike = np.full(len(ranges), common.alike)
    return _Fitted(ranges, fits, fits.covariance, fits.status, alike)


def _one_by_one(rings: xr.Dataset, mask: xr.Dataset, rows: slice, settings: EstimateConfig) -> _Fitted:
    """Return the ellipse of each ring by itself, its sigma widened where neighbouring readings err together."""
    bearings = rings["bearing"].values
    used = mask["reason"][rows].values == 0
    thin = mask["coverage"][rows].values < settings.minimum_coverage
    gap = largest_gap(used) > settings.largest_gap
    used[thin | gap] = False
    ranges = np.where(used, rings["range"][rows].values, np.float32(np.nan))
    fits = fit_ellipses_to_ranges(ranges, bearings)
    deviation = radial_deviation(ranges, bearings, fits.parameters)
    alike = correlation_inflation(deviation, fits.noise_sigma, window=_ALIKE)
    status = np.where(thin, _TOO_FEW, np.where(gap, _ARC_TOO_SHORT, fits.status))
    return _Fitted(ranges, fits, fits.covariance * alike[:, None, None], status, alike)


def _fit_rows(found: dict[str, np.ndarray], rows: slice, fitted: _Fitted, bearings: np.ndarray) -> None:
    """Fill the rows with what was fitted: parameters, deviations of the wall, and the mode where it is clear."""
    fits = fitted.fits
    found["parameters"][rows], found["covariance"][rows] = fits.parameters, fitted.covariance
    found["residual_rms"][rows], found["noise"][rows] = fits.residual_rms, fits.noise_sigma
    found["centre_z"][rows], found["centre_y"][rows] = fits.centre_z, fits.centre_y
    found["status"][rows] = fitted.status
    deviation = radial_deviation(fitted.ranges, bearings, fits.parameters)
    for name, values in zip(_DEVIATIONS, smoothed_extremes(deviation, bearings), strict=True):
        found[name][rows] = values
    modes = select_modes(fitted.ranges, bearings, ellipses=fits)
    # The posterior takes readings as independent; where they are not, it would be too sure.
    clear = fitted.alike < _INDEPENDENT
    named = (modes.mode > 0) & clear
    found["mode"][rows] = np.where(clear, modes.mode, -1)
    found["mode_probability"][rows] = np.where(clear, modes.probability.max(axis=1), np.nan)
    found["inverted"][rows] = modes.inverted & named
    found["severities"][rows] = np.where(named[:, None], modes.severities, np.nan)
    found["severities_sigma"][rows] = np.where(named[:, None], modes.sigma, np.nan)


def _section(rings: xr.Dataset, mask: xr.Dataset, found: dict[str, np.ndarray]) -> xr.Dataset:
    distance = rings["distance"].values
    odometer = rings.attrs.get("distance_source", "odometer") == "odometer"
    columns = {
        "chainage": distance,
        "distance": distance if odometer else np.full(len(distance), np.nan),
        "coverage": mask["coverage"].values,
        "status": found["status"],
        **{name: found[name] for name in (*_PER_STATION, *_DEVIATIONS, "mode_probability")},
        "mode": np.where(found["status"] == 0, np.array([*CLASSES, "undecided"])[found["mode"]], ""),
        "flags": _flags(inverted=found["inverted"], unlike_neighbours=found["unlike"], scattered=found["scattered"]),
    }
    for column, name in enumerate(_SEVERITIES):
        columns[name] = found["severities"][:, column]
        columns[f"{name}_sigma"] = found["severities_sigma"][:, column]
    return xr.Dataset(
        {
            **{name: ("station", values) for name, values in columns.items()},
            "parameters": (("station", "parameter"), found["parameters"][:, 2:]),
            "covariance": (("station", "parameter", "parameter_2"), found["covariance"][:, 2:, 2:]),
        },
        coords={"parameter": list(SECTION_PARAMETERS), "parameter_2": list(SECTION_PARAMETERS)},
    )


def _unlike(rings: xr.Dataset, found: dict[str, np.ndarray]) -> np.ndarray:
    """Return which stations differ from the pipe within half a diameter on both sides."""
    shape = found["parameters"][:, 2:]
    if rings.sizes["ring"] < 3:
        return np.zeros(len(shape), bool)
    spacing = float(np.median(np.diff(rings["distance"].values)))
    window = int(np.clip(round(2.0 * np.nanmedian(shape[:, 0]) / spacing), 5, 201))
    sigma = np.sqrt(np.einsum("kii->ki", found["covariance"][:, 2:, 2:]))
    return unlike_both_sides(shape, sigma, window=window)


def _scattered(rings: xr.Dataset, found: dict[str, np.ndarray]) -> np.ndarray:
    """Return which stations of a cloud scatter over three times as much as its best quarter.

    A depth camera errs with the square of the distance, and where it scatters it also bends what it sees.
    """
    noise = found["noise"]
    if rings.attrs.get("distance_source") != "axis" or not np.isfinite(noise).any():
        return np.zeros(len(noise), bool)
    return noise > _SCATTERED * np.nanquantile(noise, 0.25)


def _flags(**named: np.ndarray) -> np.ndarray:
    """Return the names of the flags that each station carries, separated by spaces."""
    words = [np.where(flag, name, "") for name, flag in named.items()]
    joined = words[0]
    for word in words[1:]:
        gap = np.where((joined != "") & (word != ""), " ", "")
        joined = np.char.add(np.char.add(joined, gap), word)
    return joined


def _pose(rings: xr.Dataset, found: dict[str, np.ndarray]) -> xr.Dataset:
    """Return the sensor's pose: the offset from the section's centre, attitude where the rings carry it."""
    count = rings.sizes["ring"]
    terms = {name: np.full(count, np.nan) for name in POSE_TERMS}
    covariance = np.full((count, 5, 5), np.nan, np.float32)
    why = {"roll": "a ring alone does not show roll"}
    if rings.attrs.get("referred_to") == "axis":
        for term, source in (("offset_y", "y"), ("offset_z", "z"), ("pitch", "pitch"), ("yaw", "yaw")):
            if f"sensor_{source}" in rings:
                terms[term] = rings[f"sensor_{source}"].values
                diagonal = POSE_TERMS.index(term)
                covariance[:, diagonal, diagonal] = rings[f"sensor_{source}_sigma"].values ** 2
            else:
                why[term] = "the rings were given about the pipe's axis, without the sensor's pose"
    else:
        terms["offset_y"], terms["offset_z"] = -found["centre_y"], -found["centre_z"]
        covariance[:, :2, :2] = found["covariance"][:, [[1, 1], [0, 0]], [[1, 0], [1, 0]]]
        why["pitch"] = why["yaw"] = "one ring shows its tilt to second order only"
    sigma = {f"{name}_sigma": np.sqrt(covariance[:, i, i].astype(float)) for i, name in enumerate(POSE_TERMS)}
    return xr.Dataset(
        {
            **{name: ("ring", values) for name, values in (terms | sigma).items()},
            "covariance": (("ring", "pose", "pose_2"), covariance),
        },
        coords={"pose": list(POSE_TERMS), "pose_2": list(POSE_TERMS)},
        attrs={"why_missing": json.dumps(why)},
    )


def _scale(survey: Survey, config: Config) -> tuple[float, str]:
    """Return the relative one-sigma of the sensor's scale, and where it comes from."""
    if survey.has("calibration") and "range_scale_sigma" in survey.calibration:
        return float(survey.calibration["range_scale_sigma"]), "calibration"
    kind = survey.rings.attrs.get("sensor_kind", "unknown")
    return config.sensor.scale_sigma.of(kind), f"default for a sensor of kind {kind}"


def _explain(survey: Survey, found: dict[str, np.ndarray]) -> Survey:
    status, unlike, scattered = found["status"], found["unlike"], found["scattered"]
    if scattered.any():
        survey = add_warning(
            survey,
            f"{scattered.sum()} of {len(status)} stations scatter over three times as much as the best quarter of "
            "them; they are flagged scattered and left out of largest values and verdicts.",
        )
    if unlike.any():
        survey = add_warning(
            survey,
            f"{unlike.sum()} of {len(status)} stations differ from the pipe on both sides of them (joints, or misread "
            "rings); they are flagged unlike_neighbours and left out of largest values and verdicts.",
        )
    without = int((status != 0).sum())
    if without:
        codes, counts = np.unique(status[status != 0], return_counts=True)
        reasons = ", ".join(f"{FIT_STATUS[code]} ({n})" for code, n in zip(codes, counts, strict=True))
        survey = add_warning(survey, f"{without} of {len(status)} stations have no section: {reasons}.")
    if survey.rings.attrs.get("referred_to") != "axis":
        survey = add_assumption(
            survey,
            "Rings are taken as perpendicular to the pipe: the sensor's tilt is not estimated, and 3 degrees of it "
            "read as 0.14 % of ovality.",
        )
    return survey
