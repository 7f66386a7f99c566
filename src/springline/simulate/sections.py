"""True cross-sections, built as rigid arcs and lines and read off as polar radii.

Every section is a closed chain of conic pieces about its origin O, each covering a range of bearings; the wall's radius
at a bearing is the far root of one quadratic. Hinged sections (modes 1 to 5) are made as the pipe itself makes them:
a quarter of the undeformed or ovalised ring is frozen, taken as a rigid body and swung until its ends stand on the
springline and on the crown line. Nothing here is shared with `springline.geometry`.

Frame: z right, y up, O on the springline line; a bearing runs from +z counter-clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from scipy.optimize import brentq

from ..errors import ParameterError

PIECE = 7
"""Columns of a piece: first bearing, then A, B, C, D, E, F of A z2 + B z y + C y2 + D z + E y + F = 0."""

_PERIMETER_NODES = 4096


@dataclass(frozen=True)
class Section:
    """A closed section: pieces (n, 7) in order of bearing, the first one starting at bearing 0."""

    pieces: np.ndarray

    def radius(self, bearing: np.ndarray | float) -> np.ndarray:
        """Return the polar radius [m] about O at each bearing [rad].

        >>> float(hinged(0.15, (1.0, 0.9), (1.0, 0.9)).radius(np.pi / 2))
        0.135
        """
        theta = np.mod(np.asarray(bearing, float), 2.0 * pi)
        rows = self.pieces[np.searchsorted(self.pieces[:, 0], theta, side="right") - 1]
        c, s = np.cos(theta), np.sin(theta)
        p = rows[..., 1] * c * c + rows[..., 2] * c * s + rows[..., 3] * s * s
        q = rows[..., 4] * c + rows[..., 5] * s
        root = np.sqrt(np.maximum(q * q - 4.0 * p * rows[..., 6], 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(q > 0.0, -2.0 * rows[..., 6] / (q + root), (root - q) / (2.0 * p))


def ellipse_major(r: float, s: float, rule: str = "exact") -> float:
    """Return the semi-major axis [m] of the ellipse of semi-minor axis s r that has the circle's length 2 pi r.

    `rule` "exact" measures the curve's length by the periodic trapezoid rule; "ramanujan" uses his first
    approximation, as the dissertation does (eq. 3.2, by root finding instead of its closed form).

    >>> round(ellipse_major(1.0, 0.8), 10)
    1.1815868339
    """
    if s == 1.0:
        return r
    b = s * r
    t = np.arange(_PERIMETER_NODES) * (2.0 * pi / _PERIMETER_NODES)
    sin2 = np.sin(t) ** 2

    def excess(a: float) -> float:
        if rule == "ramanujan":
            return 3.0 * (a + b) - sqrt((a + 3.0 * b) * (3.0 * a + b)) - 2.0 * r
        return float(np.mean(np.sqrt(a * a * sin2 + b * b * (1.0 - sin2)))) - r

    return brentq(excess, r * 0.5, r * 2.0, xtol=1e-16, rtol=8.9e-16)


def circle(r: float) -> Section:
    """Return a circle of radius r [m]."""
    return Section(np.array([_ellipse_piece(0.0, 0.0, 0.0, r, r, 0.0)]))


def ellipse(a: float, b: float, bearing: float = 0.0) -> Section:
    """Return an ellipse of semi-axes a, b [m], the axis a at `bearing` [rad]."""
    return Section(np.array([_ellipse_piece(0.0, 0.0, 0.0, a, b, bearing)]))


def hinged(r: float, top: tuple[float, float], bottom: tuple[float, float], *, rule: str = "exact") -> Section:
    """Return a section of two mirror-image quarter arcs above and two below, each swung about its hinges.

    Args:
        r: Radius of the undeformed pipe [m].
        top: (frozen severity s0, present severity s) of the upper quarter arcs; s r is the crown's height.
        bottom: The same for the lower quarter arcs.
        rule: Perimeter rule of the frozen ellipse, "exact" or "ramanujan".

    Raises:
        ParameterError: When the two halves do not meet at the springline.
    """
    corners, arcs = [], []
    for s0, s in (top, bottom):
        a, b = ellipse_major(r, s0, rule), s0 * r
        height = s * r
        reach2 = a * a + b * b - height * height
        if not 0.0 < s <= s0 <= 1.0 or reach2 <= 0.0:
            raise ParameterError(f"severity s = {s} with s0 = {s0}", expected="0 < s <= s0 <= 1")
        reach = sqrt(reach2)
        # The chord from the springline end to the crown end turns as a rigid bar, and the arc with it.
        turn = atan2(height, -reach) - atan2(b, -a)
        zc, yc = reach - a * cos(turn), -a * sin(turn)
        corners.append(reach)
        arcs.append((zc, yc, a, b, turn))
    if abs(corners[0] - corners[1]) > 1e-9 * r:
        raise ParameterError(
            f"the upper half reaches {corners[0]:.9f} m and the lower half {corners[1]:.9f} m at the springline",
            expected="halves that share the springline",
        )
    (zt, yt, at, bt, tt), (zb, yb, ab, bb, tb) = arcs
    return Section(
        np.array(
            [
                _ellipse_piece(0.0, zt, yt, at, bt, tt),
                _ellipse_piece(0.5 * pi, -zt, yt, at, bt, -tt),
                _ellipse_piece(pi, -zb, -yb, ab, bb, tb),
                _ellipse_piece(1.5 * pi, zb, -yb, ab, bb, -tb),
            ]
        )
    )


def severity_that_meets(r: float, s0: float, reach: float, *, rule: str = "exact") -> float:
    """Return the severity s at which quarter arcs frozen at s0 reach `reach` [m] along the springline."""
    a, b = ellipse_major(r, s0, rule), s0 * r
    height2 = a * a + b * b - reach * reach
    if height2 <= 0.0:
        raise ParameterError(
            f"quarter arcs frozen at s0 = {s0} cannot reach {reach:.6f} m", expected=f"at most {hypot(a, b):.6f} m"
        )
    return sqrt(height2) / r


def springline_reach(r: float, s0: float, s: float, *, rule: str = "exact") -> float:
    """Return how far [m] quarter arcs frozen at s0 reach along the springline when the crown is at height s r."""
    a, b = ellipse_major(r, s0, rule), s0 * r
    return sqrt(a * a + b * b - (s * r) ** 2)


def mode(number: int, r: float, s1: float, s02: float = 1.0, s01: float = 1.0, *, rule: str = "exact") -> Section:
    """Return the section of mode 1 to 5 with bottom severity s1 and frozen severities s02 (top) and s01 (bottom).

    The (frozen, present) pairs of top and bottom: 1 = (s1, s1)/(s1, s1); 2 = (1, s1)/(1, s1); 3 = (1, s2)/(s1, s1);
    4 = (s02, s2)/(s1, s1); 5 = (s02, s2)/(s01, s1); s2 follows from the shared springline.

    >>> bool(np.isclose(mode(1, 1.0, 0.9).radius(0.0), ellipse_major(1.0, 0.9)))
    True
    """
    frozen = {1: (s1, s1), 2: (1.0, 1.0), 3: (1.0, s1), 4: (s02, s1), 5: (s02, s01)}
    if number not in frozen:
        raise ParameterError(f"mode {number}", expected="a mode from 1 to 5")
    top0, bottom0 = frozen[number]
    reach = springline_reach(r, bottom0, s1, rule=rule)
    s2 = s1 if number in (1, 2) else severity_that_meets(r, top0, reach, rule=rule)
    return hinged(r, (top0, min(s2, top0)), (bottom0, s1), rule=rule)


def _ellipse_piece(start: float, zc: float, yc: float, a: float, b: float, turn: float) -> list[float]:
    """Return the piece from bearing `start` of the ellipse centred at (zc, yc), its axis a at bearing `turn`."""
    c, s = cos(turn), sin(turn)
    za, zb = (c / a) ** 2 + (s / b) ** 2, 2.0 * c * s * (a**-2 - b**-2)
    ya = (s / a) ** 2 + (c / b) ** 2
    return [
        start,
        za,
        zb,
        ya,
        -2.0 * za * zc - zb * yc,
        -2.0 * ya * yc - zb * zc,
        za * zc * zc + zb * zc * yc + ya * yc * yc - 1.0,
    ]
