"""Perimeter of a section's convex hull: the contour's own length where it lies on the hull, straight bridges else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .quadrature import flat

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .base import Section

    Array = NDArray[np.float64]

_STEPS = 512  # per panel; the bridge's foot is off by a step at most, the length by its cube
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)


def perimeter(section: Section) -> Array:
    """Return the hull's perimeter of every section of a batch.

    The contour is sampled, the samples on the hull found, and neighbours along the contour joined by the contour's
    exact length. The foot of a bridge is then known to one step, which moves the length by the step's cube only.

    >>> from springline.geometry.sections import hinged
    >>> round(float(perimeter(hinged(1, 0.8))), 10) == round(float(hinged(1, 0.8).perimeter), 10)
    True
    """
    from . import kernels

    breaks = section.panels
    span = np.diff(breaks, axis=-1, append=breaks[..., :1] + 2 * np.pi)
    theta = flat(breaks[..., None] + span[..., None] * (np.arange(_STEPS) / _STEPS))
    z, y, length = (x.reshape(-1, theta.shape[-1]) for x in (*section.contour(theta), _lengths(section, theta)))
    out = np.empty(z.shape[0])
    kernels.hull_length(z, y, length, out)
    return out.reshape(section.shape)


def _lengths(section: Section, theta: Array) -> Array:
    """Return the contour's length from each sample to the next."""
    span = np.diff(theta, axis=-1, append=theta[..., :1] + 2 * np.pi)
    inner = flat(theta[..., None] + span[..., None] * (0.5 + 0.5 * _NODES))
    speed = np.hypot(section.polar_radius(inner), section.polar_slope(inner))
    return 0.5 * span * (speed.reshape(*theta.shape, _NODES.size) @ _WEIGHTS)
