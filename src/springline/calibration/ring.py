"""The group `/calibration` from scans of a reference ring or pipe."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..conventions import CALIBRATION_TERMS
from ..errors import InputError, ParameterError, nearest
from .noise import fit_noise_law
from .reference import ALIGNMENT_SIGMA, TILT_SIGMA, fit_reference
from .scans import scan_shape

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..survey import Survey
    from .noise import NoiseLaw
    from .reference import ReferenceFit
    from .scans import ScanShape

_MOST_SCALE = 0.2
_NO_TILTS = "no scan was taken at a known tilt, and boresight shows to second order without one"
_ABOUT_AXIS = "the rings stand about the reference's axis already, so no tilt is left in them"
_FEW_TILTS = "the tilts do not show it: take scans at tilts of either sign about both axes"
_FEW_READINGS = "there are too few single readings, or the rings were cut from a cloud and average them"
_EXACT = "The reference's diameter is taken as exact: neither its sigma nor repeated measures of it are given."
_ANGLES = ("boresight_pitch", "boresight_yaw", "boresight_roll")


def calibrate_ring(
    scans: Mapping[str, Survey],
    diameter: float | Sequence[float],
    *,
    diameter_sigma: float | None = None,
    tilts: Mapping[str, Sequence[float]] | None = None,
    tilt_sigma: float = TILT_SIGMA,
    common_tilt_sigma: float = 0.0,
) -> xr.Dataset:
    """Return the calibration that scans of one reference of known diameter give.

    Args:
        scans: Surveys with `/rings` by name, each of the reference with the scanner's attitude kept; or rings that were
            cut from a cloud about the reference's axis, which show the scale alone.
        diameter: Inside diameter of the reference [m]; or the diameters that were measured on it, whose mean counts.
        diameter_sigma: One-sigma of the diameter [m]; when not given, that of the mean of the measured diameters, or
            none (and said so) when there is one diameter alone.
        tilts: Robot's pitch, yaw and, when known, roll against the reference's axis [rad], for every scan by name.
        tilt_sigma: One-sigma of each tilt by itself [rad].
        common_tilt_sigma: One-sigma of what all tilts have wrong in common [rad]: how well robot and reference were set
            parallel. It cannot be told from boresight and stands in its sigma.

    Returns:
        The group `/calibration` as `conventions` lists it: range scale, boresight, noise law, their covariance, and in
        its attributes what it was made from and why something is missing.

    Raises:
        InputError: A scan cannot be fitted or has no tilt; scale far from one (wrong diameter or unit).
        ParameterError: A diameter or a sigma out of range.

    >>> import springline as sl
    >>> t = np.radians(np.arange(0, 360, 3))
    >>> rings = xr.Dataset({"range": (("ring", "bearing"), np.full((4, 120), 0.15075))}, {"bearing": t})
    >>> found = calibrate_ring({"a": sl.Survey({"rings": rings})}, 0.3)
    >>> round(float(found["range_scale"]), 6), "boresight_pitch" in found.attrs["why_missing"]
    (1.005, True)
    """
    if not scans:
        raise InputError("there is no scan", expected="scans of a reference of known diameter")
    mean, sigma, notes = _reference(diameter, diameter_sigma)
    shapes = {name: _shape(name, survey) for name, survey in scans.items()}
    about_axis = _about_axis(scans)
    if about_axis and tilts is not None:
        raise InputError(_ABOUT_AXIS, where="tilts", mend="leave the tilts out")
    angles = _angles(tilts, scans)
    found = fit_reference(
        [one.shape for one in shapes.values()],
        [one.covariance for one in shapes.values()],
        0.5 * mean,
        angles,
        radius_sigma=0.5 * sigma,
        tilt_sigma=tilt_sigma,
        alignment_sigma=0.0 if about_axis else ALIGNMENT_SIGMA,
    )
    scale = found.values[0]
    _refuse_far_scale(scale, mean)
    # What is left of a cloud's scatter in its rings is not that of the sensor's readings.
    law = _noise_law([] if about_axis else list(shapes.values()), scale)
    notes += _notes(found, list(scans))
    return _dataset(found, law, common_tilt_sigma).assign_attrs(
        reference_diameter=mean,
        reference_sigma=sigma,
        tilt_sigma=float(tilt_sigma) if angles is not None else np.nan,
        common_tilt_sigma=float(common_tilt_sigma),
        misfit=found.misfit,
        readings=law.readings,
        scans=json.dumps(_listed(scans, shapes, angles)),
        why_missing=json.dumps(_why(found, law, _ABOUT_AXIS if about_axis else _no_tilts(angles))),
        notes=json.dumps(notes),
    )


def _reference(diameter: float | Sequence[float], sigma: float | None) -> tuple[float, float, list[str]]:
    measured = np.atleast_1d(np.asarray(diameter, float))
    if measured.ndim != 1 or not measured.size or not (np.isfinite(measured) & (measured > 0)).all():
        raise ParameterError(f"diameter = {diameter}", expected="one or more lengths above zero [m]")
    if sigma is not None and not (np.isfinite(sigma) and sigma >= 0):
        raise ParameterError(f"diameter_sigma = {sigma}", expected="a one-sigma of zero or more [m]")
    mean = float(measured.mean())
    if sigma is not None:
        return mean, float(sigma), []
    if measured.size == 1:
        return mean, 0.0, [_EXACT]
    return mean, float(measured.std(ddof=1) / np.sqrt(measured.size)), []


def _refuse_far_scale(scale: float, diameter: float) -> None:
    if abs(scale - 1.0) > _MOST_SCALE:
        seen, true = 1e3 * scale * diameter, 1e3 * diameter
        raise InputError(
            f"the scans show a diameter of about {seen:.4g} mm, the reference has {true:.4g} mm",
            expected=f"a range scale within {100 * _MOST_SCALE:.0f} % of one",
            mend="check --diameter and the unit of the ranges",
        )


def _about_axis(scans: Mapping[str, Survey]) -> bool:
    """Return whether the rings stand about the reference's axis; refuse scans of both kinds together."""
    kinds = {survey.rings.attrs.get("referred_to") == "axis" for survey in scans.values()}
    if len(kinds) > 1:
        raise InputError("some scans are of rings and some of clouds", expected="one kind of scan at a time")
    return kinds.pop()


def _shape(name: str, survey: Survey) -> ScanShape:
    rings = survey.rings
    if rings.attrs.get("range_scale_applied", 1.0) != 1.0:
        raise InputError("its ranges are corrected by a calibration already", where=name, mend="give the scan as taken")
    found = scan_shape(rings["range"].values, rings["bearing"].values)
    if not found.rings:
        raise InputError(
            "no ring of it can be fitted", where=name, expected="readings of the reference over most of its circle"
        )
    return found


def _angles(tilts: Mapping[str, Sequence[float]] | None, scans: Mapping[str, Survey]) -> np.ndarray | None:
    """Return pitch, yaw, roll of each scan (n, 3), or None when none is known."""
    if tilts is None:
        return None
    for name in tilts:
        if name not in scans:
            raise InputError(f"a tilt is given for '{name}', which is no scan{nearest(name, scans)}", where="tilts")
    rows = []
    for name in scans:
        if name not in tilts:
            raise InputError("there is no tilt for it", where=name, mend="state 0, 0 where it was not tilted")
        row = [*tilts[name], 0.0][:3]
        if not np.isfinite(row).all() or np.max(np.abs(row)) > np.radians(80.0):
            raise InputError(
                f"its tilt {np.degrees(row).round(3).tolist()} cannot be used", where=name, expected="angles below 80"
            )
        rows.append(row)
    return np.array(rows, float)


def _noise_law(scans: list[ScanShape], scale: float) -> NoiseLaw:
    return fit_noise_law(
        np.concatenate([[], *(one.ranges for one in scans)]) / scale,
        np.concatenate([[], *(one.deviation for one in scans)]) / scale,
    )


def _dataset(found: ReferenceFit, law: NoiseLaw, common: float) -> xr.Dataset:
    covariance = np.full((len(CALIBRATION_TERMS),) * 2, np.nan)
    covariance[:4, :4], covariance[4:, 4:] = found.covariance[:4, :4], law.covariance
    covariance[[1, 2], [1, 2]] += common**2
    # Scatter and mean of readings are independent.
    known = np.isfinite(np.diagonal(covariance))
    covariance = np.where(np.isnan(covariance) & known[:, None] & known, 0.0, covariance)
    values = [*found.values[:4], law.constant, law.relative]
    columns = {}
    for k, (name, value) in enumerate(zip(CALIBRATION_TERMS, values, strict=True)):
        columns[name], columns[f"{name}_sigma"] = float(value), float(np.sqrt(covariance[k, k]))
    return xr.Dataset(
        {
            **columns,
            "covariance": (("calibration_term", "calibration_term_2"), covariance),
            "range_low": law.range_low,
            "range_high": law.range_high,
        },
        coords={"calibration_term": list(CALIBRATION_TERMS), "calibration_term_2": list(CALIBRATION_TERMS)},
    )


def _no_tilts(angles: np.ndarray | None) -> str:
    return _NO_TILTS if angles is None or not angles.any() else _FEW_TILTS


def _why(found: ReferenceFit, law: NoiseLaw, unseen: str) -> dict[str, str]:
    why = {name: unseen for k, name in enumerate(_ANGLES) if np.isnan(found.values[1 + k])}
    if np.isnan(law.constant):
        why |= dict.fromkeys(("noise_constant", "noise_relative"), _FEW_READINGS)
    elif np.isnan(law.relative):
        why["noise_relative"] = (
            f"the ranges spread from {1e3 * law.range_low:.4g} to {1e3 * law.range_high:.4g} mm only: put the scanner "
            "off the reference's axis"
        )
    return why


def _notes(found: ReferenceFit, names: list[str]) -> list[str]:
    if found.consistent:
        return []
    worst = names[int(np.argmax(found.scan_misfit))]
    return [
        f"The scans disagree by {np.sqrt(found.misfit):.1f} times what their readings and tilts explain, most of all "
        f"'{worst}'; every sigma is widened by that."
    ]


def _listed(
    scans: Mapping[str, Survey], shapes: Mapping[str, ScanShape], angles: np.ndarray | None
) -> list[dict[str, object]]:
    """Return what each scan was, for the record."""
    listed = []
    for k, (name, survey) in enumerate(scans.items()):
        one: dict[str, object] = {"name": name, "rings": shapes[name].rings}
        if angles is not None:
            one["tilt_deg"] = np.degrees(angles[k]).round(9).tolist()
        one["inputs"] = json.loads(survey.attrs.get("provenance", "{}")).get("inputs", [])
        listed.append(one)
    return listed
