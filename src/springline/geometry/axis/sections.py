"""The section of each ring of a stretch that shares one axis, told apart from the mean section by its own readings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.axis.pooled import (
    COMMON_PRIOR,
    OVALITY_PRIOR,
    SECTORS,
    TUKEY,
    UNSEEN,
    PooledSection,
    sector_of,
)
from springline.geometry.fitting.results import EllipseFits

if TYPE_CHECKING:
    from numpy.typing import NDArray

CENTRE_PRIOR = 0.003
"""One-sigma of a ring's centre about the common axis, in radii, while a third of the ring or more is unseen."""
_BLOCK = 512
_STEPS = 12
_LEAST = 12
_GATE = 0.3
_TOO_FEW, _SCATTERED = 1, 6


def sections_about_axis(
    ranges: NDArray[np.floating],
    bearings: NDArray[np.floating],
    distance: NDArray[np.floating],
    pooled: PooledSection,
) -> EllipseFits:
    """Return the section of each ring, to first order in its ovality and its offset.

    A ring of which a third or more is unseen in one piece does not determine an ellipse alone: the mean section then
    lends it its ovality and the axis its centre, each with a stated sigma. A ring that is seen all round stands for
    itself. The radius of every ring is its own.

    Args:
        ranges: (ring, bearing) from the axis to the wall [m]; NaN = no return or not of the wall.
        bearings: (bearing,) at equal steps, from +z counter-clockwise [rad].
        distance: (ring,) position along the axis [m].
        pooled: The mean section of the same rings.

    Returns:
        Fits in the order of the rings; their covariance holds what neighbouring readings err alike.

    Source: as `pool_sections`.

    >>> from springline.geometry.axis.pooled import pool_sections
    >>> bearings, distance = np.radians(np.arange(360.0)), 0.015 * np.arange(30)
    >>> ranges = np.full((30, 360), 0.15)
    >>> fits = sections_about_axis(ranges, bearings, distance, pool_sections(ranges, bearings, distance))
    >>> fits.parameters[0].round(6) + 0.0
    array([0.  , 0.  , 0.15, 0.  , 0.  ])
    """
    parts = [
        _solve(
            np.asarray(ranges[i : i + _BLOCK], dtype=np.float64) / pooled.mean_radius,
            np.asarray(bearings),
            np.asarray(distance[i : i + _BLOCK]),
            pooled.scatter[i : i + _BLOCK] / pooled.mean_radius,
            pooled,
        )
        for i in range(0, len(ranges), _BLOCK)
    ]
    return EllipseFits(*(np.concatenate(part) for part in zip(*parts, strict=True)), method="about axis")


def _solve(
    radius: NDArray, bearings: NDArray, distance: NDArray, scatter: NDArray, pooled: PooledSection
) -> tuple[NDArray, ...]:
    cos, sin = np.cos(bearings), np.sin(bearings)
    sectors = (sector_of(bearings) == np.arange(SECTORS)[:, None]).astype(float)
    shape = np.vstack([cos, sin, np.ones_like(cos), cos * cos - sin * sin, 2.0 * sin * cos, sectors])
    guess = np.zeros((len(radius), len(shape)))
    centre = (pooled.centre + (distance - pooled.middle)[:, None] * pooled.slope) / pooled.mean_radius
    guess[:, 0], guess[:, 1], guess[:, 2] = centre[:, 1], centre[:, 0], 1.0
    guess[:, 3:5] = np.array([pooled.oval_cos, pooled.oval_sin]) / pooled.mean_radius
    # The noise at hand is that of rings about this one; a ring that is worse by itself is told by its own misfit.
    unknown, target = guess, guess.copy()
    covariance = np.empty(0)
    for step in range(_STEPS):
        misfit = np.abs(radius - unknown @ shape)
        gate = TUKEY * scatter[:, None] if step else np.full((len(radius), 1), _GATE)
        weight = np.nan_to_num(np.clip(1.0 - (misfit / gate) ** 2, 0.0, None)) ** 2
        weight /= scatter[:, None] ** 2 * pooled.alike
        fade = np.maximum(1.0, UNSEEN / _gaps(weight @ sectors.T)) ** 4
        prior = np.zeros_like(guess)
        prior[:, :2] = ((CENTRE_PRIOR * fade) ** -2)[:, None]
        prior[:, 3:5] = ((OVALITY_PRIOR * fade) ** -2)[:, None]
        prior[:, 5:] = COMMON_PRIOR**-2
        # A ring without readings keeps its guess and is refused below.
        prior[:, 2] = 1e-6
        normal = np.einsum("nb,ib,jb->nij", weight, shape, shape, optimize=True)
        normal[:, np.arange(len(shape)), np.arange(len(shape))] += prior
        covariance = np.linalg.inv(normal)
        right = (weight * np.nan_to_num(radius)) @ shape.T + prior * target
        unknown = np.einsum("nij,nj->ni", covariance, right)
    return _judged(radius, unknown, covariance, weight, unknown @ shape, scatter, pooled.mean_radius)


def _judged(radius, unknown, covariance, weight, model, scatter, unit: float) -> tuple[NDArray, ...]:
    used = weight > 0
    count = used.sum(axis=1)
    misfit = np.where(used, radius - model, 0.0)
    rms = np.sqrt((misfit**2).sum(axis=1) / np.maximum(count, 1))
    parameters, covariance = unknown[:, :5] * unit, covariance[:, :5, :5] * unit**2
    sigma = np.sqrt(covariance[:, 2, 2])
    status = np.where(count < _LEAST, _TOO_FEW, np.where(sigma > 0.1 * unit, _SCATTERED, 0)).astype(np.uint8)
    parameters[status != 0], covariance[status != 0] = np.nan, np.nan
    return parameters, covariance, rms * unit, scatter * unit, count, status


def _gaps(told: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the longest run of sectors that hardly tell anything, of each ring [rad], at least one sector."""
    seen = told > 0.1 * told.mean(axis=1, keepdims=True)
    twice = np.concatenate([seen, seen], axis=1)
    place = np.arange(twice.shape[1])
    last = np.maximum.accumulate(np.where(twice, place, -1), axis=1)
    run = np.where(last >= 0, place - last + 1, 0)[:, SECTORS:].max(axis=1)
    return np.where(seen.any(axis=1), np.maximum(run, 1), SECTORS) * (2.0 * np.pi / SECTORS)
