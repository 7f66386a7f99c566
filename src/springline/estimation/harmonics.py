"""Third and fourth harmonics of the section, pooled over many rings: found, said, and taken out of the ellipses.

One ring does not show a shape of a few tenths of its noise, a hundred rings do. Where a part of the wall is not seen,
such a shape also bends every ellipse fitted to what is left, the same way ring after ring; the pooled profile tells by
how much.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ..geometry.deviation import radial_deviation

if TYPE_CHECKING:
    from collections.abc import Sequence

POOL = 200
"""Rings whose readings are pooled."""
ORDERS = (3, 4)
_CLIP = 3.0
_LEAK = 1.5
"""What is left of a shape in the radii, over its size times the share of the wall that is unseen or seen askew."""
_CERTAIN = 40.0
"""Chi-square of the four terms beyond which a shape is called: once in ten million pools by chance."""


@dataclass(frozen=True)
class Harmonics:
    """What the pools show.

    Attributes:
        terms: cos and sin of order 3 and 4 of each pool [m] (pool, 4), in the rings' own frame.
        sigma: One-sigma of one term [m] (pool, 4).
        significant: Whether each pool differs from ellipses (pool,).
        doubt: One-sigma by which the shape may still bend each ring's radii [m] (n,): by its size, the share of the
            wall that is not seen, and how far the sensor stands off the axis; 0 where there is no such shape.
        parameters: The rings' centre_z, centre_y, mean_radius, oval_cos, oval_sin, freed of the shape [m] (n, 5).
    """

    terms: np.ndarray
    sigma: np.ndarray
    significant: np.ndarray
    doubt: np.ndarray
    parameters: np.ndarray

    @property
    def amplitude(self) -> float:
        """Largest root of the summed squares of the terms among the significant pools [m]; 0 when there is none."""
        size = np.sqrt(np.sum(self.terms**2, axis=1))[self.significant]
        return float(size.max()) if size.size else 0.0

    @classmethod
    def joined(cls, parts: Sequence[Harmonics]) -> Harmonics:
        """Return the harmonics of consecutive stretches as one."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))


def pooled_harmonics(ranges: np.ndarray, bearings: np.ndarray, parameters: np.ndarray) -> Harmonics:
    """Return the harmonics that rings have in common beyond their ellipses.

    Args:
        ranges: From the sensor to the wall (n, m) [m]; NaN = none.
        bearings: From +z counter-clockwise (m,) [rad].
        parameters: Fitted centre_z, centre_y, mean_radius, oval_cos, oval_sin of each ring [m] (n, 5); NaN = none.

    >>> t = np.radians(np.arange(0, 360, 3))
    >>> found = pooled_harmonics(0.15 + 0.001 * np.tile(np.cos(3 * t), (9, 1)), t, np.tile([0, 0, 0.15, 0, 0], (9, 1)))
    >>> round(1e3 * found.amplitude, 3), found.significant.tolist()
    (1.0, [True])
    """
    pools = max(len(ranges) // POOL, 1)
    edges = np.linspace(0, len(ranges), pools + 1).astype(int)
    out = Harmonics(
        np.zeros((pools, 4)),
        np.full((pools, 4), np.inf),
        np.zeros(pools, bool),
        np.zeros(len(ranges)),
        np.array(parameters, float),
    )
    ellipse = [np.cos(bearings), np.sin(bearings), np.ones_like(bearings), np.cos(2 * bearings), np.sin(2 * bearings)]
    shape = [wave(order * bearings) for order in ORDERS for wave in (np.cos, np.sin)]
    design = np.stack([*ellipse, *shape], axis=1)
    # Pools are few, one for every couple of metres.
    for k, (first, last) in enumerate(pairwise(edges)):
        rows = slice(first, last)
        fitted = np.isfinite(parameters[rows]).all(axis=1)
        left = radial_deviation(ranges[rows][fitted], bearings, np.asarray(parameters[rows][fitted], float))
        noise = 1.4826 * float(np.nanmedian(np.abs(left))) if np.isfinite(left).any() else np.nan
        limit = _CLIP * max(noise, 1e-9) if np.isfinite(noise) else 0.0
        used = np.isfinite(left) & (np.abs(np.nan_to_num(left, nan=np.inf)) <= limit)
        count = used.sum(axis=0)
        seen = count > 0.2 * max(fitted.sum(), 1)
        if seen.sum() < 4 * design.shape[1]:
            continue
        mean = np.where(used, np.nan_to_num(left), 0.0).sum(axis=0)[seen] / count[seen]
        weighted = design[seen] * count[seen, None]
        inverse = np.linalg.inv(design[seen].T @ weighted)
        found = inverse @ (weighted.T @ mean)
        spread = inverse[5:, 5:] * max(noise, 1e-9) ** 2
        out.terms[k], out.sigma[k] = found[5:], np.sqrt(np.diag(spread))
        out.significant[k] = found[5:] @ np.linalg.solve(spread, found[5:]) > _CERTAIN
        if out.significant[k]:
            out.parameters[rows] += found[:5]
            # A robot that rolls turns the shape within the pool, and one off the axis sees its near side more densely,
            # so that what is taken out is not quite it.
            unseen = 1.0 - np.mean(seen)
            aside = (
                0.5 * np.sqrt(np.nanmean(np.sum(parameters[rows, :2] ** 2, axis=1))) / np.nanmedian(parameters[rows, 2])
            )
            out.doubt[rows] = _LEAK * np.linalg.norm(found[5:]) * np.hypot(unseen, aside)
    return out
