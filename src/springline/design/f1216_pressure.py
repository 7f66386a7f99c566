"""ASTM F1216 appendix X1: liners of pressure pipes, equations X1.5 to X1.7.

SI throughout; D is the mean inside diameter of the existing pipe, d that of a hole in its wall, DR = D/t.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import finite, positive, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


def thickness_hole_span(
    pressure: ArrayLike, diameter: ArrayLike, *, hole: ArrayLike, strength: ArrayLike, safety: ArrayLike = 2.0
) -> Array:
    """Return the liner thickness that spans a hole as a flat plate fixed at its edge, X1.6 solved for t.

    Args:
        pressure: Internal pressure [Pa].
        diameter: D [m].
        hole: Diameter d of the largest hole [m].
        strength: Long-term flexural strength [Pa].
        safety: N.

    Returns:
        Thickness [m] from P = 5.33/(DR - 1)^2 (D/d)^2 strength/N; 0 without pressure or hole.

    Raises:
        ParameterError: A value is out of range.

    Source: ASTM F1216 X1.6; only where `spans_as_plate` holds.

    >>> round(float(thickness_hole_span(1e6, 0.3, hole=0.05, strength=31e6)), 6)
    0.005402
    """
    pressure, diameter, hole = _load(pressure), positive("diameter", diameter), _hole(hole)
    with np.errstate(divide="ignore"):
        allowed = 5.33 * positive("strength", strength) / (pressure * positive("safety", safety))
        return diameter / (1.0 + diameter / hole * np.sqrt(allowed))


def spans_as_plate(thickness: ArrayLike, diameter: ArrayLike, *, hole: ArrayLike) -> Array:
    """Return whether a hole is small enough to be spanned as a flat plate, X1.5.

    Args:
        thickness: Of the liner [m].
        diameter: D [m].
        hole: Diameter d of the hole [m].

    Returns:
        Whether d/D <= 1.83 (t/D)^(1/2).

    Raises:
        ParameterError: A value is out of range.

    Source: ASTM F1216 X1.5; larger holes put the liner in ring tension, X1.7.

    >>> bool(spans_as_plate(0.006, 0.3, hole=0.05)), bool(spans_as_plate(0.006, 0.3, hole=0.1))
    (True, False)
    """
    diameter = positive("diameter", diameter)
    return _hole(hole) / diameter <= 1.83 * np.sqrt(positive("thickness", thickness) / diameter)


def thickness_ring_tension(
    pressure: ArrayLike, diameter: ArrayLike, *, tensile_strength: ArrayLike, safety: ArrayLike = 2.0
) -> Array:
    """Return the liner thickness that carries the whole internal pressure in ring tension, X1.7 solved for t.

    Args:
        pressure: Internal pressure [Pa].
        diameter: D [m].
        tensile_strength: Long-term tensile strength [Pa].
        safety: N.

    Returns:
        Thickness [m] from P = 2 strength/((DR - 2) N); 0 without pressure.

    Raises:
        ParameterError: A value is out of range.

    Source: ASTM F1216 X1.7; for holes beyond X1.5 and for fully deteriorated pressure pipes.

    >>> round(float(thickness_ring_tension(1e6, 0.3, tensile_strength=21e6)), 6)
    0.013043
    """
    pressure, diameter = _load(pressure), positive("diameter", diameter)
    with np.errstate(divide="ignore"):
        allowed = 2.0 * positive("tensile_strength", tensile_strength) / (pressure * positive("safety", safety))
    return diameter / (allowed + 2.0)


def _load(pressure: Array) -> Array:
    pressure = finite("pressure", pressure)
    require(~(pressure < 0), "pressure", pressure, "pressure >= 0", "give the internal pressure in pascals")
    return pressure


def _hole(hole: Array) -> Array:
    hole = finite("hole", hole)
    require(~(hole < 0), "hole", hole, "hole >= 0", "give the diameter of the largest hole in metres")
    return hole
