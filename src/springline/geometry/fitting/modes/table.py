"""The family of half sections on a grid, as coefficients of a few shapes found by singular values."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from springline.geometry.sections import chord, hinged
from springline.geometry.sections.ellipses import partner_axis

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SHAPES = 8
"""Shapes kept: the family departs from their span by less than 1e-5 of the radius."""

_NODES = 257
_FRACTIONS = 32
_STEP = 1e-3


class HalfTable(NamedTuple):
    """Half sections of unit r over springline half width OA and frozen severity s0.

    At each OA the severities run from s*, the ellipse of that half width, to 1, the circular arc, at the middles of
    equal cells. A half section is 1 plus its coefficients times the shapes.
    """

    shapes: Array
    """(shape, node) over folded bearings from the springline to the crown, equally spaced."""
    first: float
    """Smallest OA; the others follow in steps of `step`."""
    step: float
    swung: Array
    """(OA, fraction, shape) coefficients."""
    elliptic: Array
    """(OA, shape) coefficients of the ellipse, s0 = s*."""
    circular: Array
    """(OA, shape) coefficients of the circular arc, s0 = 1."""
    severity: Array
    """(OA, fraction) s0."""
    chord2: Array
    """(OA, fraction) square of the chord of s0, that of s* first: (OA, fraction + 1)."""
    ellipse_severity: Array
    """(OA,) s*."""


@lru_cache(maxsize=2)
def half_table(lowest: float) -> HalfTable:
    """Return the table for severities s1 down to `lowest`."""
    widest = float(partner_axis(lowest, "exact"))
    axis = 1.0 + 1e-6 + np.arange(int((widest - 1.0) / _STEP)) * _STEP
    least = np.asarray(partner_axis(axis, "exact"))
    fraction = (np.arange(_FRACTIONS) + 0.5) / _FRACTIONS
    severity = least[:, None] + (1.0 - least[:, None]) * fraction
    folded = np.linspace(0.0, np.pi / 2, _NODES)
    everything = np.concatenate([least[:, None], severity, np.ones((len(axis), 1))], axis=1)
    chord2 = chord(everything) ** 2
    crown = np.sqrt(chord2 - axis[:, None] ** 2)
    radius = hinged(5, np.minimum(crown, everything), everything, everything).polar_radius(folded) - 1.0
    _, _, rows = np.linalg.svd(radius[::3, ::4].reshape(-1, _NODES), full_matrices=False)
    shapes = np.ascontiguousarray(rows[:SHAPES])
    coefficients = radius @ shapes.T
    return HalfTable(
        shapes,
        float(axis[0]),
        _STEP,
        np.ascontiguousarray(coefficients[:, 1:-1]),
        np.ascontiguousarray(coefficients[:, 0]),
        np.ascontiguousarray(coefficients[:, -1]),
        severity,
        np.ascontiguousarray(chord2[:, :-1]),
        least,
    )
