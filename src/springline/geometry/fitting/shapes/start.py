"""Where a fit starts: every listed start of the family, brought to the ring's ellipse, the nearest ones first."""

from __future__ import annotations

from functools import lru_cache
from math import log
from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel
from ..ellipses import fit_ellipses_to_ranges
from .chains import chain_radius
from .kernels import LEAST_SQUARE
from .models import model_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .models import Model
    from .solve import Readings

    Array = NDArray[np.float64]

_NODES = 361
_JUDGED = 4
"""Every so many readings judge the starts."""


@lru_cache(maxsize=32)
def start_table(name: str) -> tuple[Array, Array, Array]:
    """Return what is known of a family's starts at unit mean radius of their ellipse.

    Returns:
        Coordinates (S, K); their ellipse's centre (S, 2); radius (S, nodes) about O at equal bearings over one turn.
    """
    model = model_of(name)
    bearing = np.linspace(0.0, 2 * np.pi, _NODES)
    radius = contour(model, model.coordinates_of(model.starts), bearing)
    ellipses = fit_ellipses_to_ranges(radius[:, :-1], bearing[:-1], method="fitzgibbon")
    size = ellipses.mean_radius[:, None]
    parameters = np.where(model.lengths, model.starts / size, model.starts)
    return model.coordinates_of(parameters), ellipses.parameters[:, :2] / size, radius / size


def contour(model: Model, coordinates: Array, bearing: Array) -> Array:
    """Return the radius (N, M) of a family's sections at common bearings (M,) [rad]."""
    rings, points = len(coordinates), len(bearing)
    chain = model.chain_at(coordinates)
    radius, slope, by = np.empty((rings, points)), np.empty((rings, points)), np.empty((rings, 0, points))
    bearings = np.ascontiguousarray(np.broadcast_to(bearing, (rings, points)))
    none = np.empty((rings, 0, *chain.shape[1:]))
    counts = np.full(rings, points)
    chain_radius(
        np.arange(rings), bearings, counts, model.straight, np.ascontiguousarray(chain), none, radius, slope, by
    )
    return radius


def ranked_starts(model: Model, readings: Readings, places: Array, turn: Array, wanted: int) -> Array:
    """Return the unknowns (wanted, N, 2 + K) of the starts nearest to each ring, best first.

    Args:
        model: The family.
        readings: In units in which the rings' radius is about 1.
        places: (A, N, 3) where each ring may lie: centre z, centre y and mean radius of an ellipse.
        turn: (N,) turn of the section [rad].
        wanted: How many starts.
    """
    coordinates, centre, radius = start_table(model.name)
    cos, sin = np.cos(turn)[:, None], np.sin(turn)[:, None]
    away = np.stack([cos * centre[:, 0] - sin * centre[:, 1], sin * centre[:, 0] + cos * centre[:, 1]], axis=-1)
    size = np.repeat(places[..., 2:], len(centre), axis=-1)
    origin = places[:, :, None, :2] - size[..., None] * away
    misfit = np.empty(size.shape)
    for alternative in range(len(places)):
        _misfits(
            readings.z, readings.y, readings.counts, turn, origin[alternative], size[alternative], radius,
            misfit[alternative],
        )  # fmt: skip
    best = np.argsort(np.moveaxis(misfit, 1, 0).reshape(len(turn), -1), axis=1)[:, :wanted].T
    alternative, start = np.divmod(best, len(centre))
    rings = np.arange(len(turn))
    # parameters scale with the ring, and coordinates with them: limits are at zero in every unit
    grown = np.where(model.lengths, size[alternative, rings, start][..., None], 1.0) * coordinates[start]
    return np.concatenate([origin[alternative, rings, start], grown], axis=-1)


@kernel
def _misfits(z, y, counts, turn, origin, size, radius, misfit):
    """Fill the mean logarithm of the squared distance of every ring to every start."""
    nodes = radius.shape[1] - 1
    for ring in range(z.shape[0]):
        for s in range(radius.shape[0]):
            total, count = 0.0, 0
            for i in range(0, counts[ring], _JUDGED):
                dz, dy = z[ring, i] - origin[ring, s, 0], y[ring, i] - origin[ring, s, 1]
                angle = (np.arctan2(dy, dz) - turn[ring]) % (2.0 * np.pi)
                node = int(angle * nodes / (2.0 * np.pi))
                away = np.sqrt(dz * dz + dy * dy) - size[ring, s] * radius[s, min(node, nodes)]
                total += log(min(away * away, 1.0) + LEAST_SQUARE)
                count += 1
            misfit[ring, s] = total / max(count, 1)
