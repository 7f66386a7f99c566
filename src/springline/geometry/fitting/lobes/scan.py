"""Where a lobe may be: what lobes of every bearing and width would explain of a ring's distances to its host.

The distances are gathered into bins of bearing; what a shift of the centre, or another host, would explain is taken out
of templates and distances alike. What is left is the likelihood gained, in squared sigmas.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from .wall import ANGLES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..shapes.solve import Solver

    Array = NDArray[np.float64]

_BINS = 180
_WIDTHS = 9
_STEP = 0.7
"""Between the bearings of neighbouring templates, in half angles."""

_CLIP = 2.5
"""Clipped distances count up to this many sigmas."""

_LEAST_SHARE = 0.02
"""A template of which a shift and another host explain all but this share says nothing."""


@lru_cache(maxsize=4)
def templates(host_known: bool) -> tuple[Array, Array, Array, Array]:
    """Return the templates' bearing and half angle (G,), themselves (bins, G), and what is taken out (bins, 5 or 2)."""
    theta = (np.arange(_BINS) + 0.5) * 2 * np.pi / _BINS
    widths = np.geomspace(1.2 * ANGLES[0], 0.9 * ANGLES[1], _WIDTHS)
    counts = np.ceil(2 * np.pi / (_STEP * widths)).astype(int)
    half = np.repeat(widths, counts)
    bearing = np.concatenate([np.arange(n) * 2 * np.pi / n for n in counts])
    offset = (theta[:, None] - bearing + np.pi) % (2 * np.pi) - np.pi
    x = np.minimum(np.abs(offset) / half, 1.0)
    shift = [np.cos(theta), np.sin(theta)]
    other = [] if host_known else [np.ones_like(theta), np.cos(2 * theta), np.sin(2 * theta)]
    return bearing, half, np.cos(np.pi / 2 * x) ** 2, np.stack([*shift, *other], axis=-1)


def likely_lobes(solver: Solver, rows: NDArray[np.int64], *, host_known: bool, wanted: int, clip: bool = True) -> Array:
    """Return bearing, half angle and depth (wanted, R, 3) of the lobes that explain most, the best first.

    Args:
        solver: At rest on hosts without lobes.
        rows: (R,) the rings.
        host_known: Whether the hosts were given.
        wanted: How many lobes, at bearings of their own.
        clip: Whether a distance counts up to some sigmas only, which outliers ask for and deep lobes do not.
    """
    bearing, half, shape, loose = templates(host_known)
    weight, clipped, plain = (np.zeros((rows.size, _BINS)) for _ in range(3))
    readings, unknowns = solver.readings, solver.unknowns
    _bin(
        rows, readings.z, readings.y, readings.prior, readings.counts, unknowns, solver.residuals(), solver.sigma,
        weight, clipped, plain,
    )  # fmt: skip
    gram = np.einsum("rb,bk,bl->rkl", weight, loose, loose)
    gram += 1e-9 * np.einsum("rkk->r", gram)[:, None, None] * np.eye(loose.shape[1])
    # (R, G, k): what each template has in common with what is taken out
    common = np.moveaxis((weight[:, None] * loose.T) @ shape, 1, -1)
    taken = common @ np.linalg.inv(gram)
    full = weight @ shape**2
    left = full - np.sum(common * taken, axis=-1)
    said = left > _LEAST_SHARE * full
    left = np.where(said, left, np.inf)

    def depth(distances: Array) -> Array:
        return (np.einsum("rgk,rk->rg", taken, distances @ loose) - distances @ shape) / left

    depths, found = depth(plain), []
    gain = np.maximum(depth(clipped) if clip else depths, 0.0) ** 2 * np.where(said, left, 0.0)
    place = np.arange(rows.size)
    for _ in range(wanted):
        best = np.argmax(gain, axis=1)
        found.append(np.stack([bearing[best], half[best], depths[place, best]], axis=-1))
        apart = np.abs((bearing - bearing[best][:, None] + np.pi) % (2 * np.pi) - np.pi)
        gain = np.where(apart < np.maximum(0.7 * half[best], 0.2)[:, None], -1.0, gain)
    return np.stack(found)


@kernel
def _bin(rows, z, y, prior, counts, unknowns, residual, sigma, weight, clipped, plain):
    """Add up weights and weighted distances by bearing about the centre."""
    bins = weight.shape[1]
    for place in range(rows.size):
        ring = rows[place]
        most = _CLIP * sigma[ring]
        for i in range(counts[ring]):
            angle = np.arctan2(y[ring, i] - unknowns[ring, 1], z[ring, i] - unknowns[ring, 0]) % (2.0 * np.pi)
            b = min(int(angle * bins / (2.0 * np.pi)), bins - 1)
            e, w = residual[ring, i], prior[ring, i]
            weight[place, b] += w
            clipped[place, b] += w * min(max(e, -most), most)
            plain[place, b] += w * e


@kernel
def widest_gaps(rows, z, y, omega, counts, unknowns, gaps):
    """Fill (R,) the widest arc without a used reading inside each lobe, over the lobe's width.

    The last three unknowns of a ring are the lobe's bearing, half angle and depth.
    """
    size = unknowns.shape[1]
    inside = np.empty(z.shape[1] + 2)
    for place in range(rows.size):
        ring = rows[place]
        bearing, half = unknowns[ring, size - 3], unknowns[ring, size - 2]
        inside[0], inside[1], n = -half, half, 2
        for i in range(counts[ring]):
            angle = np.arctan2(y[ring, i] - unknowns[ring, 1], z[ring, i] - unknowns[ring, 0])
            offset = (angle - bearing + np.pi) % (2.0 * np.pi) - np.pi
            if omega[ring, i] > 0.0 and abs(offset) < half:
                inside[n] = offset
                n += 1
        ordered = np.sort(inside[:n])
        gaps[place] = np.max(ordered[1:] - ordered[:-1]) / (2.0 * half)
