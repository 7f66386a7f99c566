"""First wall hit of rays that start inside a torus, as a numba kernel.

The quartic is negative inside the pipe, so the hit is its smallest positive root. It is isolated in the Bernstein
basis: a part of the ray whose coefficients are all negative holds no wall; the leftmost other part is halved until
its coefficients rise from negative to positive, where there is exactly one root. Newton on the section's level,
which does not lose digits in wide bends, then refines it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_DEPTH = 64
"""Halvings of one part of a ray, more than its floats have bits."""


@njit(cache=True)
def first_hits(origin: Array, direction: Array, bend_radius: Array, r1: Array, r2: Array) -> Array:
    """Return distances (n,) for origins and unit directions (n, 3) and radii (n,); NaN for NaN inputs."""
    hits = np.empty(origin.shape[0])
    stack = np.empty((_DEPTH + 2, 5))
    ends = np.empty((_DEPTH + 2, 2))
    for i in range(origin.shape[0]):
        p, d = origin[i], direction[i]
        total = p.sum() + d.sum() + bend_radius[i] + r1[i] + r2[i]
        if np.isnan(total):
            hits[i] = np.nan
            continue
        start = _isolate(p, d, bend_radius[i], r1[i], r2[i], stack, ends)
        hits[i] = _refine(start, p, d, bend_radius[i], r1[i], r2[i])
    return hits


@njit(cache=True)
def _isolate(p: Array, d: Array, big: float, r1: float, r2: float, stack: Array, ends: Array) -> float:
    """Return the smallest positive root of the quartic, to within a thousandth of the section."""
    longest = np.sqrt((p * p).sum()) + np.hypot(big + r2, r1)
    start, length = 0.0, 4.0 * (r1 + r2)
    # Parts that double in length from the section's own size: over the whole ray of a wide bend digits would be lost.
    while start < longest:
        _bernstein(p + start * d, d, big, r1, r2, length, stack[0])
        found = _leftmost(start, length, 1e-3 * min(r1, r2), stack, ends)
        if not np.isnan(found):
            return found
        start, length = start + length, 2.0 * length
    return np.nan


@njit(cache=True)
def _leftmost(start: float, length: float, width: float, stack: Array, ends: Array) -> float:
    """Return the first sign change of the coefficients in `stack[0]` over one part of the ray, NaN for none."""
    ends[0, 0], ends[0, 1] = start, start + length
    top = 0
    while top >= 0:
        lower, upper = ends[top]
        part = stack[top]
        if part.max() < 0.0:
            top -= 1
            continue
        rising = part[0] < 0.0 and part[4] > 0.0
        for k in range(4):
            rising = rising and part[k + 1] >= part[k]
        middle = 0.5 * (lower + upper)
        if top >= _DEPTH or upper - lower < 1e-14 * upper or (rising and upper - lower < width):
            return middle
        _halve(part, stack[top + 1])
        ends[top, 0], ends[top, 1] = middle, upper
        ends[top + 1, 0], ends[top + 1, 1] = lower, middle
        top += 1
    return np.nan


@njit(cache=True)
def _bernstein(p: Array, d: Array, big: float, r1: float, r2: float, length: float, out: Array) -> None:
    """Write the quartic's Bernstein coefficients over [0, length], scaled by r2^2 R^2."""
    squash = (r2 / r1) ** 2
    a2 = (d[0] * d[0] + d[1] * d[1] + squash * d[2] * d[2]) * length * length
    a1 = 2.0 * (p[0] * d[0] + p[1] * d[1] + squash * p[2] * d[2]) * length
    a0 = p[0] * p[0] + (p[1] - big) * (p[1] + big) + squash * p[2] * p[2] - r2 * r2
    pull = 4.0 * squash * big * big
    z, w = p[2], d[2] * length
    unit = 1.0 / (r2 * r2 * big * big)
    c4 = a2 * a2 * unit
    c3 = 2.0 * a2 * a1 * unit
    c2 = (a1 * a1 + 2.0 * a2 * a0 + pull * w * w) * unit
    c1 = (2.0 * a1 * a0 + 2.0 * pull * z * w) * unit
    c0 = (a0 * a0 - 4.0 * r2 * r2 * big * big + pull * z * z) * unit
    out[0] = c0
    out[1] = c0 + c1 / 4.0
    out[2] = c0 + c1 / 2.0 + c2 / 6.0
    out[3] = c0 + 3.0 * c1 / 4.0 + c2 / 2.0 + c3 / 4.0
    out[4] = c0 + c1 + c2 + c3 + c4


@njit(cache=True)
def _halve(part: Array, left: Array) -> None:
    """Split in the middle (de Casteljau): `part` becomes its right half, `left` receives the left half."""
    left[0] = part[0]
    for level in range(1, 5):
        for k in range(5 - level):
            part[k] = 0.5 * (part[k] + part[k + 1])
        left[level] = part[0]


@njit(cache=True)
def _refine(t: float, p: Array, d: Array, big: float, r1: float, r2: float) -> float:
    """Return the root of the section's level near `t`, by Newton."""
    for _ in range(8):
        x, y, z = p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]
        across = np.hypot(x, y)
        # hypot - R without cancellation: y is close to -R in a bend.
        radial = (x * x + (y - big) * (y + big)) / (across + big)
        level = (radial / r2) ** 2 + (z / r1) ** 2 - 1.0
        slope = 2.0 * (radial / r2**2 * (x * d[0] + y * d[1]) / across + z * d[2] / r1**2)
        if slope == 0.0:
            break
        step = level / slope
        # A grazing ray has no slope at its hit; what isolation found is then as good as it gets.
        if abs(step) > 0.01 * (r1 + r2):
            break
        t -= step
        if abs(step) < 1e-16 * t:
            break
    return t
