"""One ellipse per ring, and what its readings show beyond it."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np

from ...estimation import Harmonics, pooled_harmonics
from ...geometry.axis import pool_sections, sections_about_axis
from ...geometry.deviation import correlation_inflation, largest_gap, radial_deviation, smoothed_extremes
from ...geometry.fitting import fit_ellipses_to_ranges
from ...geometry.fitting.modes import select_modes
from ...geometry.measures import polar_radius

if TYPE_CHECKING:
    import xarray as xr

    from ...config import EstimateConfig

BLOCK = 4000
"""Rings that are held in memory as floats at once; whole pools of harmonics."""
_TOO_FEW, _ARC_TOO_SHORT = 1, 3
_ALIKE = 9
_INDEPENDENT = 2.0
DEVIATIONS = ("deviation_in", "deviation_in_bearing", "deviation_out", "deviation_out_bearing")


@dataclass
class Fitted:
    """The ellipse of every ring; arrays run over rings.

    Attributes:
        parameters: centre_z, centre_y, mean_radius, oval_cos, oval_sin [m] (n, 5); NaN = none.
        covariance: (n, 5, 5) [m2], widened where neighbouring readings err together.
        residual_rms: Of the used readings about it [m] (n,).
        noise: Robust one-sigma of a reading [m] (n,).
        status: Flag of `conventions.FIT_STATUS` (n,).
        alike: How many readings err alike, so count as one (n,).
        mean_diameter: Of rings that share an axis: diameter of their mean section and its one-sigma [m]; else None.
        harmonics: What rings have in common beyond their ellipses; None when nobody asked.
    """

    parameters: np.ndarray
    covariance: np.ndarray
    residual_rms: np.ndarray
    noise: np.ndarray
    status: np.ndarray
    alike: np.ndarray
    mean_diameter: tuple[float, float] | None = None
    harmonics: Harmonics | None = None

    @classmethod
    def empty(cls, count: int) -> Fitted:
        """Return room for so many rings."""
        none = np.full(count, np.nan)
        return cls(
            np.full((count, 5), np.nan),
            np.full((count, 5, 5), np.nan),
            none,
            none.copy(),
            np.zeros(count, np.uint8),
            np.ones(count),
        )


@dataclass(frozen=True)
class Seen:
    """What the readings are looked at against; arrays run over rings.

    Attributes:
        ellipse: Ellipse in the ring's own plane and frame [m] (n, 5).
        section: Section in the pipe's frame [m] (n, 3), and the ring's roll in it [rad] (n,); None when the ring's
            own frame stands for the pipe's.
    """

    ellipse: np.ndarray
    section: tuple[np.ndarray, np.ndarray] | None = None


def fit_rings(rings: xr.Dataset, mask: xr.Dataset, settings: EstimateConfig, *, pool: bool) -> Fitted:
    """Return the ellipse of every ring; rings that were cut from a cloud share its axis.

    Args:
        rings: `/rings`.
        mask: `/mask`.
        settings: `minimum_coverage` and `largest_gap`.
        pool: Whether harmonics that rings have in common are looked for.
    """
    if rings.attrs.get("distance_source") == "axis":
        return _about_axis(rings, mask)
    count, bearings = rings.sizes["ring"], rings["bearing"].values
    out, pools = Fitted.empty(count), []
    for start in range(0, count, BLOCK):
        rows = slice(start, start + BLOCK)
        used = mask["reason"][rows].values == 0
        thin = mask["coverage"][rows].values < settings.minimum_coverage
        gap = largest_gap(used) > settings.largest_gap
        used[thin | gap] = False
        ranges = np.where(used, rings["range"][rows].values, np.float32(np.nan))
        fits = fit_ellipses_to_ranges(ranges, bearings)
        deviation = radial_deviation(ranges, bearings, fits.parameters)
        alike = correlation_inflation(deviation, fits.noise_sigma, window=_ALIKE)
        out.parameters[rows], out.covariance[rows] = fits.parameters, fits.covariance * alike[:, None, None]
        out.residual_rms[rows], out.noise[rows] = fits.residual_rms, fits.noise_sigma
        out.status[rows] = np.where(thin, _TOO_FEW, np.where(gap, _ARC_TOO_SHORT, fits.status))
        out.alike[rows] = alike
        if pool:
            pools.append(pooled_harmonics(ranges, bearings, fits.parameters))
    out.harmonics = Harmonics.joined(pools) if pool else None
    return out


def _about_axis(rings: xr.Dataset, mask: xr.Dataset) -> Fitted:
    """Return the section of each ring about the axis that they share."""
    ranges = np.where(mask["reason"].values == 0, rings["range"].values, np.nan)
    bearings, along = rings["bearing"].values, rings["distance"].values
    common = pool_sections(ranges, bearings, along)
    fits = sections_about_axis(ranges, bearings, along, common)
    doubt = float(rings.attrs.get("diameter_doubt", 0.0))
    # Where it is in doubt which readings are of the wall, no station knows its section better than the whole does.
    unsure = (doubt * common.diameter / 2.0) ** 2 * np.diag([0.0, 0.0, 1.0, 1.0, 1.0])
    return Fitted(
        fits.parameters,
        fits.covariance + unsure,
        fits.residual_rms,
        fits.noise_sigma,
        fits.status,
        np.full(len(ranges), common.alike),
        (common.diameter, float(np.hypot(common.diameter_sigma, doubt * common.diameter))),
    )


def describe(rings: xr.Dataset, mask: xr.Dataset, fitted: Fitted, seen: Seen) -> dict[str, np.ndarray]:
    """Return how far the wall leaves its section, and the mode of deformation where it is clear.

    Args:
        rings: `/rings`.
        mask: `/mask`.
        fitted: Ellipses of the rings.
        seen: What the readings are looked at against.

    Returns:
        `DEVIATIONS` [m, rad]; `mode` as an index of `CLASSES`, -1 undecided; `mode_probability`, `inverted`;
        `severities` and `severities_sigma` (n, 4).
    """
    count, bearings = rings.sizes["ring"], rings["bearing"].values
    out = {name: np.full(count, np.nan) for name in (*DEVIATIONS, "mode_probability")}
    out |= {name: np.full((count, 4), np.nan) for name in ("severities", "severities_sigma")}
    out |= {"mode": np.full(count, -1, np.int8), "inverted": np.zeros(count, bool)}
    for start in range(0, count, BLOCK):
        rows = slice(start, start + BLOCK)
        used = (mask["reason"][rows].values == 0) & (fitted.status[rows] == 0)[:, None]
        ranges = np.where(used, rings["range"][rows].values, np.float32(np.nan))
        ellipse = seen.ellipse[rows]
        deviation = radial_deviation(ranges, bearings, ellipse)
        if seen.section is not None:
            section, roll = seen.section[0][rows], np.nan_to_num(seen.section[1][rows])
            deviation = _upright(deviation, roll)
            ranges = polar_radius(section[:, None, :], np.broadcast_to(bearings, deviation.shape)) + deviation
            ellipse = np.concatenate([np.zeros((len(section), 2)), section], axis=1)
        for name, values in zip(DEVIATIONS, smoothed_extremes(deviation, bearings), strict=True):
            out[name][rows] = values
        modes = select_modes(ranges, bearings, ellipses=SimpleNamespace(parameters=ellipse))
        # The posterior takes readings as independent; where they are not, it would be too sure.
        clear = fitted.alike[rows] < _INDEPENDENT
        named = (modes.mode > 0) & clear
        out["mode"][rows] = np.where(clear, modes.mode, -1)
        out["mode_probability"][rows] = np.where(clear, modes.probability.max(axis=1), np.nan)
        out["inverted"][rows] = modes.inverted & named
        out["severities"][rows] = np.where(named[:, None], modes.severities, np.nan)
        out["severities_sigma"][rows] = np.where(named[:, None], modes.sigma, np.nan)
    return out


def _upright(deviation: np.ndarray, roll: np.ndarray) -> np.ndarray:
    """Return deviations by bearing in the pipe: each ring turned by its roll, to the nearest reading."""
    count = deviation.shape[1]
    turn = np.rint(roll * count / (2.0 * np.pi)).astype(np.int64)
    return np.take_along_axis(deviation, (np.arange(count) - turn[:, None]) % count, axis=1)
