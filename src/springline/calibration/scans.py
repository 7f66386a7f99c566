"""One scan of a reference: the ellipse that its rings have in common, and how its readings scatter about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..geometry.deviation import correlation_inflation, radial_deviation
from ..geometry.fitting import fit_ellipses_to_ranges
from ..geometry.robot.section import form_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

_ALIKE = 9


@dataclass(frozen=True, eq=False)
class ScanShape:
    """What one scan shows of the reference.

    Attributes:
        shape: mean_radius, oval_cos, oval_sin [m] (3,); NaN when no ring could be fitted.
        covariance: Of `shape` [m2] (3, 3); widened where readings err together or rings disagree.
        rings: How many rings it stands on.
        ranges: Readings that were used [m] (readings,).
        deviation: What each reads too much along its ray [m] (readings,).
    """

    shape: Array
    covariance: Array
    rings: int
    ranges: Array
    deviation: Array


def scan_shape(ranges: ArrayLike, bearings: ArrayLike) -> ScanShape:
    """Return what a scan shows, its sensor at rest or moved along the reference with its attitude kept.

    Args:
        ranges: (ring, bearing) [m]; NaN = no return.
        bearings: (bearing,) from +z counter-clockwise [rad].

    >>> t = np.radians(np.arange(0, 360, 3))
    >>> (scan_shape(np.full((4, 120), 0.15), t).shape.round(6) + 0.0).tolist()
    [0.15, 0.0, 0.0]
    """
    from scipy.stats import chi2

    ranges, bearings = np.asarray(ranges, float), np.asarray(bearings, float)
    fits = fit_ellipses_to_ranges(ranges, bearings, keep_weights=True)
    alike = correlation_inflation(radial_deviation(ranges, bearings, fits.parameters), fits.noise_sigma, window=_ALIKE)
    spread = fits.shape_covariance * alike[:, None, None]
    good = fits.fitted & np.isfinite(spread).all(axis=(1, 2))
    if not good.any():
        return ScanShape(np.full(3, np.nan), np.full((3, 3), np.nan), 0, np.empty(0), np.empty(0))
    shapes, floor = fits.shape[good], 1e-9 * float(np.median(fits.mean_radius[good]))
    weight = np.linalg.inv(spread[good] + floor**2 * np.eye(3))
    covariance = np.linalg.inv(weight.sum(axis=0))
    shape = covariance @ np.einsum("nij,nj->i", weight, shapes)
    left = shapes - shape
    square, freedom = float(np.einsum("ni,nij,nj->", left, weight, left)), 3 * (len(shapes) - 1)
    if freedom and chi2.sf(square, freedom) < 0.01:
        covariance = covariance * (square / freedom)
    used = fits.weights[good] > 0.0
    off = ranges[good] - ranges_to_ellipse(bearings, fits.parameters[good])
    # Five parameters of each ring take up a part of the scatter.
    share = np.sqrt(used.sum(axis=1, keepdims=True) / np.maximum(used.sum(axis=1, keepdims=True) - 5, 1))
    return ScanShape(shape, covariance, int(good.sum()), ranges[good][used], (off * share)[used])


def ranges_to_ellipse(bearings: ArrayLike, parameters: ArrayLike) -> Array:
    """Return the ranges (ring, bearing) [m] from the origin to each ring's ellipse; NaN where the ray misses it.

    Args:
        bearings: (bearing,) [rad].
        parameters: centre_z, centre_y, mean_radius, oval_cos, oval_sin of each ring [m] (ring, 5).

    >>> ranges_to_ellipse([0.0, np.pi], [[0.02, 0.0, 0.15, 0.0, 0.0]]).round(6)
    array([[0.17, 0.13]])
    """
    p = np.asarray(parameters, float)
    form = form_of(p[:, 2:])
    matrix = np.stack([form[:, [0, 1]], form[:, [1, 2]]], axis=1)
    ray = np.stack([np.cos(bearings), np.sin(bearings)])
    along = np.einsum("ib,nij,nj->nb", ray, matrix, p[:, :2])
    square = np.einsum("ib,nij,jb->nb", ray, matrix, ray)
    inside = np.einsum("ni,nij,nj->n", p[:, :2], matrix, p[:, :2])[:, None]
    with np.errstate(invalid="ignore"):
        return (along + np.sqrt(along**2 + square * (1.0 - inside))) / square
