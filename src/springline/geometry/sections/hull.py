"""Perimeter of a section's convex hull: the contour's own length where it lies on the hull, straight bridges else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .base import Section

    Array = NDArray[np.float64]

_STEPS = 512  # per piece between breaks; the bridge's foot is off by a step at most, the length by its cube
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)


def perimeter(section: Section) -> Array:
    """Return the hull's perimeter of every section of a batch.

    The contour is sampled, the samples on the hull found, and neighbours along the contour joined by the contour's
    exact length. The foot of a bridge is then known to one step, which moves the length by the step's cube only.

    >>> from springline.geometry.sections import hinged
    >>> round(float(perimeter(hinged(1, 0.8))), 10) == round(float(hinged(1, 0.8).perimeter), 10)
    True
    """
    breaks = section.breaks
    span = np.diff(breaks, axis=-1, append=breaks[..., :1] + 2 * np.pi)
    steps = breaks[..., None] + span[..., None] * (np.arange(_STEPS) / _STEPS)
    theta = steps.reshape(*breaks.shape[:-1], -1)
    z, y = section.contour(theta)
    length = _lengths(section, theta)
    points = np.stack([z, y], axis=-1).reshape(-1, *z.shape[-1:], 2)
    found = [_one(p, s) for p, s in zip(points, length.reshape(-1, theta.shape[-1]), strict=True)]
    return np.array(found).reshape(section.shape)


def _lengths(section: Section, theta: Array) -> Array:
    """Return the contour's length from each sample to the next."""
    span = np.diff(theta, axis=-1, append=theta[..., :1] + 2 * np.pi)
    inner = (theta[..., None] + span[..., None] * (0.5 + 0.5 * _NODES)).reshape(*theta.shape[:-1], -1)
    speed = np.hypot(section.polar_radius(inner), section.polar_slope(inner))
    return 0.5 * span * (speed.reshape(*theta.shape, -1) @ _WEIGHTS)


def _one(points: Array, length: Array) -> float:
    if not np.isfinite(points).all():
        return float("nan")
    apart = length > 1e-12 * np.max(length)  # breaks that coincide leave samples on top of one another
    points, length = points[apart], length[apart]
    on_hull = np.sort(ConvexHull(points).vertices)
    following = np.roll(on_hull, -1)
    neighbours = (following - on_hull) % len(points) == 1
    bridges = np.hypot(*(points[following] - points[on_hull]).T)
    return float(np.sum(np.where(neighbours, length[on_hull], bridges)))
