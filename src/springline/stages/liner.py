"""Liner: where a liner has left its host in a lobe, and the shape of the lobe at every such station."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..conventions import clock_from_bearing
from ..geometry.deviation import correlation_inflation
from ..geometry.fitting.lobes import fit_lobe
from ..survey import Survey, add_assumption, add_warning

if TYPE_CHECKING:
    import xarray as xr

    from ..config import Config, LinerConfig

_BLOCK = 4096
_ALIKE = 9

# Power of length with which a quantity grows; the scale's relative sigma counts that many times.
_QUANTITIES = {
    "liner_lobe_bearing": 0.0,
    "liner_lobe_half_angle": 0.0,
    "liner_lobe_depth": 1.0,
    "liner_lobe_power": 0.0,
    "liner_remaining_radius": 1.0,
    "liner_gap_area": 2.0,
}


def liner(survey: Survey, config: Config) -> Survey:
    """Return the survey with the liner's lobes in `/section`; unchanged unless `liner.fit` is set.

    The host is fitted with the lobe, from the same readings: it is the liner's own shape where it lies on the pipe.
    Readings that err together count less, as in `estimate`. Every `_sigma` joins the fit's part and the sensor
    scale's.

    Args:
        survey: With `/rings`, `/mask` and `/section`.
        config: `liner.fit`, `liner.kind`, `liner.power`, `liner.free_power`, `liner.false_alarm`.

    Source: dissertation 7.3 with errata A11 to A13, A19 and A21.
    """
    settings = config.liner
    if not settings.fit:
        return survey
    section = survey.section
    found = _search(survey.rings, survey.mask, section["status"].values == 0, settings)
    scale = float(section.attrs["range_scale_sigma"])
    for name, power in _QUANTITIES.items():
        found[f"{name}_sigma"] = np.hypot(found[f"{name}_sigma"], power * scale * np.nan_to_num(found[name]))
    section = section.assign({name: ("station", values) for name, values in found.items()})
    section.attrs |= {"liner_kind": settings.kind, "liner_false_alarm_rate": settings.false_alarm}
    groups = {name: survey.group(name) for name in survey.groups}
    return _explain(Survey({**groups, "section": section}, survey.attrs), found, settings)


def _search(rings: xr.Dataset, mask: xr.Dataset, fitted: np.ndarray, settings: LinerConfig) -> dict[str, np.ndarray]:
    count, bearings = rings.sizes["ring"], rings["bearing"].values
    names = [n for name in _QUANTITIES for n in (name, f"{name}_sigma")]
    found = {name: np.full(count, np.nan) for name in ("liner_lobe_false_alarm", *names, "liner_protrusion")}
    found["liner_lobe"] = np.zeros(count, np.uint8)
    for start in range(0, count, _BLOCK):
        rows = slice(start, start + _BLOCK)
        used = (mask["reason"][rows].values == 0) & fitted[rows, None]
        ranges = np.where(used, rings["range"][rows].values, np.float32(np.nan))
        fits = fit_lobe(
            ranges,
            bearings,
            kind=settings.kind,
            power=settings.power,
            free_power=settings.free_power,
            false_alarm=settings.false_alarm,
            keep_residuals=True,
        )
        fits = fits.counted_less(correlation_inflation(fits.residuals, fits.noise_sigma, window=_ALIKE))
        found["liner_lobe"][rows] = fits.lobed
        found["liner_lobe_false_alarm"][rows] = fits.false_alarm
        found["liner_protrusion"][rows] = fits.protrusion
        for name in ("bearing", "half_angle", "depth", "power"):
            found[f"liner_lobe_{name}"][rows] = fits[name]
            found[f"liner_lobe_{name}_sigma"][rows] = fits.sigma_of(name)
        for name, (value, sigma) in (("remaining_radius", fits.remaining), ("gap_area", fits.gap_area)):
            found[f"liner_{name}"][rows], found[f"liner_{name}_sigma"][rows] = value, sigma
    return found


def _explain(survey: Survey, found: dict[str, np.ndarray], settings: LinerConfig) -> Survey:
    lobed = found["liner_lobe"] == 1
    survey = add_assumption(
        survey,
        "Lobes of a liner are looked for on the user's word that there is one. A station without a lobe is said to "
        f"show one in at most {100 * settings.false_alarm:g} % of all cases; a hinge or a deposit may look like one.",
    )
    if not lobed.any():
        return survey
    deepest = int(np.nanargmax(found["liner_lobe_depth"]))
    # what rounds to 0 o'clock is 12 o'clock
    clock = round(float(clock_from_bearing(found["liner_lobe_bearing"][deepest])), 1) or 12.0
    sentence = (
        f"The liner has left its host in a lobe at {lobed.sum()} of {len(lobed)} stations, at most by "
        f"{1e3 * found['liner_lobe_depth'][deepest]:.1f} mm at {survey.section['chainage'].values[deepest]:.2f} m, "
        f"{clock:g} o'clock. Diameters, ovality, deflection, losses and verdicts are of the section without the lobe: "
        "where there is one, less is free by its depth."
    )
    outside = lobed & (found["liner_protrusion"] > found["liner_lobe_depth_sigma"])
    if outside.any():
        sentence += (
            f" At {outside.sum()} of them the fitted lobe would leave its host, which no liner can: the smooth lobe "
            "(liner.kind) may describe it better."
        )
    return add_warning(survey, sentence)
