"""The rings of a second scanner on the same robot, as the joint estimate takes them."""

from __future__ import annotations

from math import degrees, sqrt
from typing import TYPE_CHECKING

import numpy as np

from ...estimation import Rear, Rings
from ...geometry.robot import frame
from ...geometry.robot.boresight import on_scanner
from ...survey import add_assumption, add_warning
from .jointly import boresight, lever
from .rings import fit_rings

if TYPE_CHECKING:
    from ...config import Config
    from ...survey import Survey

_SHORTEST = 0.02
_FEWEST = 10


def why_no_rear(survey: Survey) -> str:
    """Return why the rear rings are left aside; empty when they are used or there are none."""
    if not survey.has("rings_rear"):
        return ""
    front, rear = survey.rings, survey.rings_rear
    if not all("position_x" in rings.attrs for rings in (front, rear)):
        return "where both scanners stand on the robot (position_x) is not stated"
    base = abs(lever(front.attrs)[0] - lever(rear.attrs)[0])
    if base < _SHORTEST:
        return f"it stands {1e3 * base:.0f} mm from the front one along the robot, and 20 mm is the least that tells"
    if rear.attrs.get("referred_to") == "axis" or rear.attrs.get("distance_source", "odometer") != "odometer":
        return "its rings are not as the sensor saw them, by the odometer"
    if rear.sizes["ring"] < _FEWEST:
        return f"it has {rear.sizes['ring']} rings, and {_FEWEST} are the least"
    both = (front["distance"].values, rear["distance"].values)
    if min(d[-1] for d in both) - max(d[0] for d in both) < base:
        return "the two scanners never saw the same place by the counter"
    return ""


def rear_rings(survey: Survey, config: Config) -> tuple[Survey, Rear | None]:
    """Return the survey, saying what was taken of its rear scanner, and the rear rings; None when they are left aside.

    The direction between the scanners is as their positions state it, to within the attribute `baseline_sigma` of
    `/rings_rear`, or `sensor.baseline_sigma`; how their ranges compare is taken from what both saw.

    Args:
        survey: With `/rings`, `/rings_rear` and `/mask_rear`.
        config: `sensor.baseline_sigma`, `sensor.scale_sigma`, `estimate`.
    """
    if not survey.has("rings_rear"):
        return survey, None
    if reason := why_no_rear(survey):
        return add_warning(survey, f"The rear scanner was left aside: {reason}."), None
    front, rings = survey.rings, survey.rings_rear
    fitted = fit_rings(rings, survey.mask_rear, config.estimate, pool=True)
    shapes = fitted.parameters if fitted.harmonics is None else fitted.harmonics.parameters
    forward = boresight(front)
    stated = rings.attrs.get("baseline_sigma")
    sigma = config.sensor.baseline_sigma if stated is None else float(stated)
    kinds = (one.attrs.get("sensor_kind", "unknown") for one in (front, rings))
    mounting = frame(*forward) @ frame(*boresight(rings)).T
    found = Rings(
        rings["distance"].values.astype(float),
        np.where((fitted.status == 0)[:, None], shapes, np.nan),
        fitted.covariance,
        lever=tuple(on_scanner(lever(rings.attrs), forward)),
    )
    base = lever(front.attrs)[0] - lever(rings.attrs)[0]
    survey = add_assumption(
        survey,
        f"{int((fitted.status == 0).sum())} rings of a second scanner, {abs(base):.3f} m "
        f"{'behind' if base > 0 else 'ahead of'} the first, were used; the direction between the two is taken as "
        f"stated to within {degrees(sigma):.2g} degrees (one-sigma{'' if stated is not None else ', assumed'}).",
    )
    scale = sqrt(sum(config.sensor.scale_sigma.of(kind) ** 2 for kind in kinds))
    return survey, Rear(found, sigma, max(scale, 1e-6), mounting)
