"""Bearings and clocks: angles of a cross-section seen looking forward."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import TypeVar

    Angle = TypeVar("Angle")

CROWN = pi / 2
"""Bearing of the crown [rad]."""

BEARING_ZEROS = {"right": 0.0, "crown": pi / 2, "left": pi, "invert": -pi / 2}
"""Bearing [rad] at which a device's own zero may lie, by name."""

BEARING_SENSES = {"ccw": 1, "cw": -1}
"""Sense in which a device counts its angles, seen looking forward."""


def clock_from_bearing(bearing: Angle) -> Angle:
    """Return the clock position [h], in (0, 12], of a bearing [rad]; scalars and arrays alike.

    >>> [clock_from_bearing(b) for b in (0.0, pi / 2, pi, -pi / 2)]
    [3.0, 12.0, 9.0, 6.0]
    """
    return 12.0 - ((bearing - CROWN) * (6.0 / pi)) % 12.0


def bearing_from_clock(clock: Angle) -> Angle:
    """Return the bearing [rad], in [0, 2 pi), of a clock position [h]; scalars and arrays alike.

    >>> [round(bearing_from_clock(h) / pi, 3) for h in (3, 12, 9, 6)]
    [0.0, 0.5, 1.0, 1.5]
    """
    return (CROWN - clock * (pi / 6.0)) % (2.0 * pi)
