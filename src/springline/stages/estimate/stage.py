"""The stage itself: ring by ring, and jointly where an inertial log lets it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...conventions import FIT_STATUS, MASK_REASONS
from ...errors import InputError
from ...geometry.cleaning import unlike_both_sides
from ...survey import add_assumption, add_warning
from . import groups
from .jointly import estimate_survey, why_never, why_not
from .layout import layout
from .misfit import doubted, off_the_ellipse
from .rear import rear_rings, why_no_rear
from .rings import Seen, describe, fit_rings

if TYPE_CHECKING:
    import xarray as xr

    from ...config import Config
    from ...estimation import JointEstimate
    from ...survey import Survey
    from .rings import Fitted

_SCATTERED = 3.0
_LATERAL = next(code for code, name in MASK_REASONS.items() if name == "lateral")


def estimate(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/pose` and `/section`, and `/layout` where it can be known.

    Every ring gets one robust geometric ellipse, its sigma widened where neighbouring readings err together. With
    `estimate.method` joint, or auto and an inertial log or a second scanner, the robot's path, the true section and
    the layout are then estimated together (`docs/estimator.md`). Otherwise the section's centre gives the sensor's
    offset and its shape is taken as perpendicular to the pipe, so that the sensor's own tilt stays in it (an
    assumption that is stated). Stations without enough coverage, or whose readings do not determine an ellipse, have
    no section and say why in `status`. Where the wall leaves its ellipse at the same bearings all along, that is said
    and sigma are as wide; a liner whose lobes are asked for is left to `liner`. Rings that were cut from a cloud
    share its axis and lend one another what a part of the wall leaves open; their mean section gives the mean
    diameter. The mode of deformation is named only where its posterior is clear, `undecided` otherwise.

    Args:
        survey: With `/rings` and `/mask`; `/candidates`, `/inertial` and `/ties` are used when they are there.
        config: `estimate.method`, `estimate.minimum_coverage`, `estimate.largest_gap`, `sensor.scale_sigma`.

    Raises:
        InputError: No station at all could be fitted, or `estimate.method` is joint and the survey does not allow it.

    Source: dissertation 2.9.1 (geometric fit) and 4.1 (origin offset); chapters 4 and 5 jointly.
    """
    rings, mask, settings = survey.rings, _without_openings(survey), config.estimate
    wanted = settings.method == "joint" or (settings.method == "auto" and _pays(survey))
    fitted = fit_rings(rings, mask, settings, pool=wanted)
    _refuse_nothing(survey, fitted)
    joint = None
    if wanted:
        try:
            told, rear = rear_rings(survey, config)
            joint = _at_rest(estimate_survey(survey, fitted, rear))
            survey = told
        except InputError as error:
            if settings.method == "joint":
                raise
            survey = add_warning(survey, f"Rings were taken one by one, as a joint estimate was not possible: {error}")
    if joint is None and survey.has("rings_rear"):
        reason = why_no_rear(survey) or "rings were taken one by one"
        survey = add_warning(survey, f"The rear scanner was left aside: {reason}.")
    counter = config.sensor.counter_scale_sigma
    found = _alone(rings, fitted, counter) if joint is None else _together(rings, fitted, joint)
    seen = found.pop("seen")
    if not config.liner.fit:
        survey, found = doubted(survey, found, off_the_ellipse(rings, mask, seen.ellipse, fitted.noise))
    found |= describe(rings, mask, fitted, seen)
    scattered = _scattered(rings, fitted)
    found["flags"] = {"inverted": found["inverted"], "unlike_neighbours": found["unlike"], "scattered": scattered}
    section = groups.section(rings, mask, found)
    scale, source = _scale(survey, config)
    section.attrs = {"model": "ellipse", "range_scale_sigma": scale, "range_scale_source": source}
    if found["mean_diameter"] is not None:
        mean, sigma = found["mean_diameter"]
        section.attrs |= {"mean_diameter": mean, "mean_diameter_sigma": sigma}
    survey = _explain(survey, fitted.status, found["unlike"], scattered)
    if joint is None:
        pose = groups.pose_of_rings(rings, found)
        return _explain_alone(survey, counter).with_group("pose", pose).with_group("section", section)
    survey = _explain_joint(survey, joint)
    survey = survey.with_group("pose", groups.pose_of_joint(joint)).with_group("section", section)
    return (
        survey
        if "axis" in joint.why_missing
        else survey.with_group("layout", layout(survey, joint, float(_counted(rings)[0])))
    )


def _pays(survey: Survey) -> bool:
    """Return whether a joint estimate tells more by itself: with an inertial log, or two scanners and an odometer."""
    if not why_not(survey):
        return True
    odometer = survey.rings.attrs.get("distance_source", "odometer") == "odometer"
    return survey.has("rings_rear") and odometer and not (why_never(survey) or why_no_rear(survey))


def _at_rest(joint: JointEstimate) -> JointEstimate:
    """Return an estimate that came to rest; refuse one that did not, whose sigma would say too little."""
    if joint.converged:
        return joint
    raise InputError(
        f"the estimate had not come to rest after {joint.iterations} steps",
        where="estimate.method",
        expected="a robot that drives where it points, within a few degrees, and clocks and readings that agree",
        mend="check the sensor's position on the robot, the clocks and the inertial log's axes",
    )


def _without_openings(survey: Survey) -> xr.Dataset:
    """Return `/mask` without the readings that candidates say fall on openings: no section is bent into a hole."""
    mask = survey.mask
    if not (survey.has("candidates") and "opening" in survey.candidates):
        return mask
    reason = np.where(
        (mask["reason"].values == 0) & (survey.candidates["opening"].values == 1), _LATERAL, mask["reason"]
    )
    return mask.assign(reason=(mask["reason"].dims, reason), coverage=("ring", (reason == 0).mean(axis=1)))


def _refuse_nothing(survey: Survey, fitted: Fitted) -> None:
    if (fitted.status == 0).any():
        return
    reasons = ", ".join(sorted({FIT_STATUS[code] for code in np.unique(fitted.status)}))
    raise InputError(
        f"no ring has a section: {reasons}",
        where=survey.attrs.get("name", "survey"),
        expected="readings of the wall over a quarter of the circumference or more",
        mend="check unit, --nominal and the clean settings",
    )


def _counted(rings: xr.Dataset) -> np.ndarray:
    """Return the chainage of each ring [m] as the counter has it: from where it read zero, the sensor ahead of it."""
    return rings["distance"].values + float(rings.attrs.get("position_x", 0.0))


def _alone(rings: xr.Dataset, fitted: Fitted, counter: float) -> dict:
    """Return what the rings say one by one; their chainage is as good as the counter's scale."""
    shape, covariance = fitted.parameters[:, 2:], fitted.covariance[:, 2:, 2:]
    counted = {}
    if rings.attrs.get("distance_source", "odometer") == "odometer":
        counted = {"chainage": _counted(rings), "chainage_sigma": counter * np.abs(rings["distance"].values)}
    return {
        **counted,
        "parameters": shape,
        "covariance": covariance,
        "centre_covariance": fitted.covariance[:, :2, :2],
        "unlike": _unlike(rings, shape, covariance),
        "seen": Seen(fitted.parameters),
        "mean_diameter": fitted.mean_diameter,
        **_columns(fitted, fitted.parameters),
    }


def _together(rings: xr.Dataset, fitted: Fitted, joint: JointEstimate) -> dict:
    """Return what the joint estimate says; where a ring shows no section, neighbours do not speak for it."""
    without = fitted.status != 0
    shown = np.where(without[:, None], np.nan, joint.rings)
    shape = np.where(without[:, None], np.nan, joint.section)
    covariance = np.where(without[:, None, None], np.nan, joint.section_covariance)
    # What each ring shows by itself, freed of its tilt.
    own = shape + (fitted.parameters - shown)[:, 2:]
    mean, cos, sin = shape.T
    diameter = 2.0 * np.sqrt(mean**2 - cos**2 - sin**2)
    found = {
        "parameters": shape,
        "covariance": covariance,
        "unlike": _unlike(rings, own, fitted.covariance[:, 2:, 2:]),
        "seen": Seen(shown, (shape, joint.pose[:, 4])),
        # Neighbouring stations err together, so that the mean is hardly surer than one of them.
        "mean_diameter": (float(np.nanmean(diameter)), 2.0 * float(np.nanmean(np.sqrt(covariance[:, 0, 0])))),
        **_columns(fitted, shown),
    }
    if "chainage" not in joint.why_missing:
        found |= {"chainage": _counted(rings)[0] + joint.chainage, "chainage_sigma": joint.chainage_sigma}
    return found


def _columns(fitted: Fitted, shown: np.ndarray) -> dict[str, np.ndarray]:
    return {
        "status": fitted.status,
        "residual_rms": fitted.residual_rms,
        "noise": fitted.noise,
        "centre_z": shown[:, 0],
        "centre_y": shown[:, 1],
    }


def _unlike(rings: xr.Dataset, shape: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return which stations differ from the pipe within half a diameter on both sides."""
    if rings.sizes["ring"] < 3:
        return np.zeros(len(shape), bool)
    spacing = float(np.median(np.diff(rings["distance"].values)))
    window = int(np.clip(round(2.0 * np.nanmedian(shape[:, 0]) / spacing), 5, 201))
    return unlike_both_sides(shape, np.sqrt(np.einsum("kii->ki", covariance)), window=window)


def _scattered(rings: xr.Dataset, fitted: Fitted) -> np.ndarray:
    """Return which stations of a cloud scatter over three times as much as its best quarter.

    A depth camera errs with the square of the distance, and where it scatters it also bends what it sees.
    """
    noise = fitted.noise
    if rings.attrs.get("distance_source") != "axis" or not np.isfinite(noise).any():
        return np.zeros(len(noise), bool)
    return noise > _SCATTERED * np.nanquantile(noise, 0.25)


def _scale(survey: Survey, config: Config) -> tuple[float, str]:
    """Return the relative one-sigma of the sensor's scale, and where it comes from."""
    if survey.has("calibration") and "range_scale_sigma" in survey.calibration:
        return float(survey.calibration["range_scale_sigma"]), "calibration"
    kind = survey.rings.attrs.get("sensor_kind", "unknown")
    return config.sensor.scale_sigma.of(kind), f"default for a sensor of kind {kind}"


def _explain(survey: Survey, status: np.ndarray, unlike: np.ndarray, scattered: np.ndarray) -> Survey:
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
    return survey


def _explain_alone(survey: Survey, counter: float) -> Survey:
    if survey.rings.attrs.get("distance_source", "odometer") == "odometer":
        survey = add_assumption(
            survey,
            "Chainage is what the counter read, from where it read zero; its scale is taken to be good to "
            f"{100.0 * counter:.2g} % (one-sigma).",
        )
    if survey.rings.attrs.get("referred_to") == "axis":
        return survey
    return add_assumption(
        survey,
        "Rings are taken as perpendicular to the pipe: the sensor's tilt is not estimated, and 3 degrees of it "
        "read as 0.14 % of ovality.",
    )


def _explain_joint(survey: Survey, joint: JointEstimate) -> Survey:
    survey = add_warning(survey, *joint.warnings)
    if "north" in joint.why_missing:
        survey = add_assumption(survey, f"Layout: {joint.why_missing['north']}.")
    return add_assumption(
        survey,
        "Robot, section and layout were estimated together. How the ring is misaligned with the robot, and the scale "
        "of its ranges, cannot be told from one survey; they are taken as the sensor's sigma and calibration say.",
        "The robot is taken to go where it points, up to a side-slip that stays: a head that swings on a robot which "
        "drives straight is taken for bends of the pipe, and yaw, pitch and layout are off by as much.",
        "Chainage counts from where the counter read zero.",
    )
