"""Sections that are no ellipse: where the wall leaves it at the same bearings all along, and what that costs."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...conventions import MASK_REASONS
from ...geometry.axis import mean_over_stations
from ...geometry.deviation import common_deviation
from ...survey import add_warning

if TYPE_CHECKING:
    import xarray as xr

    from ...survey import Survey

_LENGTH = 8.0
"""Length of a block in radii: longer than laterals, dents and joints are."""
_FEWEST = 5
_SHARE = 0.02
"""Share of the radius by which a wall leaves its ellipse, root mean square, that is no ellipse's; sections of modes 1
to 5 stay below 1 %, oblique rings of the tightest bends below 1.5 %, an egg is at 5 to 15 %."""
_CERTAIN = 4.0
_WALL = [code for code, name in MASK_REASONS.items() if name in ("used", "outlier", "lateral", "out_of_range")]


def off_the_ellipse(rings: xr.Dataset, mask: xr.Dataset, ellipse: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Return by how much the wall leaves its ellipse at the same bearings all along [m] (n,); 0 where it does not.

    Readings that were masked as outliers or as a lateral count: about a wrong section they are wall.

    Args:
        rings: `/rings`.
        mask: `/mask`.
        ellipse: Of each ring, in its own plane and frame [m] (n, 5); NaN = none.
        noise: One-sigma of a reading [m] (n,).
    """
    found, bearings = np.zeros(len(ellipse)), rings["bearing"].values
    radius = float(np.nanmedian(ellipse[:, 2]))
    distance = np.abs(rings["distance"].values - rings["distance"].values[0])
    most = max(int(distance[-1] / (_LENGTH * radius)), 1)
    blocks = int(np.clip(len(ellipse) // _FEWEST, 1, most))
    edges = np.searchsorted(distance, np.linspace(0.0, distance[-1], blocks + 1)[1:-1])
    for first, last in pairwise((0, *edges, len(ellipse))):
        rows = slice(int(first), int(last))
        if not np.isfinite(ellipse[rows, 2]).any():
            continue
        wall = np.isin(mask["reason"][rows].values, _WALL)
        ranges = np.where(wall, rings["range"][rows].values.astype(float), np.nan)
        typical, largest = common_deviation(ranges, bearings, ellipse[rows])
        chance = _CERTAIN * float(np.nanmedian(noise[rows])) / np.sqrt(last - first)
        if typical > max(_SHARE * radius, chance):
            found[rows] = largest
    return found


def doubted(survey: Survey, found: dict, off: np.ndarray) -> tuple[Survey, dict]:
    """Return what was found with sigma as wide as the wall stands off its ellipse, and the survey that says so."""
    if not off.any():
        return survey, found
    covariance = found["covariance"] + (off**2)[:, None, None] * np.eye(3)
    diameter = 2.0 * np.sqrt(found["parameters"][:, 0] ** 2 - (found["parameters"][:, 1:] ** 2).sum(axis=1))
    # What an ellipse gets wrong does not average out along the pipe.
    mean, sigma = found["mean_diameter"] or mean_over_stations(diameter, 2.0 * np.sqrt(covariance[:, 0, 0]))
    found = found | {"covariance": covariance, "mean_diameter": (mean, float(np.hypot(sigma, 2.0 * off.mean())))}
    return add_warning(
        survey,
        f"At {(off > 0).sum()} of {len(off)} stations the wall leaves its ellipse at the same bearings all along, by "
        f"up to {1e3 * off.max():.0f} mm: an egg, a box, a lobe of a liner or another shape. Diameters, ovality, area "
        "and losses there are those of the nearest ellipse, and their sigma are widened by as much.",
    ), found
