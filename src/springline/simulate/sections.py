"""True cross-sections, built as rigid arcs and lines and read off as polar radii.

Every section is a closed chain of conic pieces about its origin O, each covering a range of bearings; the wall's radius
at a bearing is the far root of one quadratic. Hinged sections (modes 1 to 5) are made as the pipe itself makes them:
a quarter of the undeformed or ovalised ring is frozen, taken as a rigid body and swung until its ends stand on the
springline and on the crown line. Nothing here is shared with `springline.geometry`.

Frame: z right, y up, O on the springline line; a bearing runs from +z counter-clockwise. Parameters may be arrays: the
pieces of one section are (n, 7), those of many (..., n, 7).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from ..errors import ParameterError

PIECE = 7
"""Columns of a piece: first bearing, then A, B, C, D, E, F of A z2 + B z y + C y2 + D z + E y + F = 0."""

Values = np.ndarray | float

_NODES = 256
_EQUAL = 1e-9


@dataclass(frozen=True)
class Section:
    """A closed section, or an array of them: pieces (..., n, 7) in order of bearing, the first at bearing 0."""

    pieces: np.ndarray

    def radius(self, bearing: Values) -> np.ndarray:
        """Return the polar radius [m] about O of a single section at each bearing [rad].

        >>> float(mode(2, 0.15, 0.9).radius(np.pi / 2).round(12))
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


def ellipse_major(r: Values, s: Values, rule: str = "exact") -> np.ndarray:
    """Return the semi-major axis [m] of the ellipse of semi-minor axis s r that has the circle's length 2 pi r.

    `rule` "exact" measures the curve's length by the periodic trapezoid rule; "ramanujan" uses his first
    approximation, as the dissertation does (eq. 3.2, by Newton's iteration instead of its closed form).

    >>> float(ellipse_major(1.0, 0.8).round(10))
    1.1815868339
    """
    r, s = np.broadcast_arrays(np.asarray(r, float), np.asarray(s, float))
    b2 = np.square(s)[..., None]
    sin2 = np.sin(np.arange(_NODES) * (pi / _NODES)) ** 2
    a = 2.0 - s
    for _ in range(60):
        if rule == "ramanujan":
            root = np.sqrt((a + 3.0 * s) * (3.0 * a + s))
            length, slope = 1.5 * (a + s) - 0.5 * root, 1.5 - (3.0 * a + 5.0 * s) / (2.0 * root)
        else:
            speed = np.sqrt(np.square(a)[..., None] * sin2 + b2 * (1.0 - sin2))
            length, slope = speed.mean(-1), (a[..., None] * sin2 / speed).mean(-1)
        step = (length - 1.0) / slope
        a = a - step
        if np.all(np.abs(step) < 1e-15):
            break
    return np.where(s == 1.0, 1.0, a) * r


def ellipse(a: Values, b: Values, bearing: Values = 0.0) -> Section:
    """Return an ellipse of semi-axes a, b [m], the axis a at `bearing` [rad]; a circle when they are equal."""
    return Section(_ellipse_piece(0.0, 0.0, 0.0, a, b, bearing)[..., None, :])


def mode(number: int, r: Values, s1: Values, s02: Values = 1.0, s01: Values = 1.0, *, rule: str = "exact") -> Section:
    """Return the section of mode 1 to 5 with bottom severity s1 and frozen severities s02 (top) and s01 (bottom).

    The (frozen, present) pairs of top and bottom: 1 = (s1, s1)/(s1, s1); 2 = (1, s1)/(1, s1); 3 = (1, s2)/(s1, s1);
    4 = (s02, s2)/(s1, s1); 5 = (s02, s2)/(s01, s1); s2 follows because both halves share the springline.

    Raises:
        ParameterError: A severity lies outside (0, 1], exceeds its frozen one, or the halves cannot meet.

    >>> bool(np.isclose(mode(1, 1.0, 0.9).radius(0.0), ellipse_major(1.0, 0.9)))
    True
    """
    r, s1, s02, s01 = np.broadcast_arrays(*(np.asarray(v, float) for v in (r, s1, s02, s01)))
    one = np.ones_like(s1)
    top, bottom = {1: (s1, s1), 2: (one, one), 3: (one, s1), 4: (s02, s1), 5: (s02, s01)}[number]
    for name, value, most in (("s1", s1, bottom), ("s02", top, one), ("s01", bottom, one)):
        if not np.all((value > 0.0) & (value <= most)):
            bad = value[~((value > 0.0) & (value <= most))].flat[0]
            raise ParameterError(f"mode {number}: {name} = {bad:g}", expected="above 0 and at most its frozen severity")
    below = _chord2(bottom, rule)
    reach2 = below - np.square(s1)
    s2 = s1
    if number > 2:
        rest = _chord2(top, rule) - reach2
        if np.any(rest <= 0.0):
            raise ParameterError(
                f"mode {number}: s1 = {s1[rest <= 0.0].flat[0]:g} lies below the limit at which the crown reaches O"
            )
        s2 = np.sqrt(rest)
        if np.any(s2 > top + _EQUAL):
            raise ParameterError(
                f"mode {number}: s1 = {s1[s2 > top + _EQUAL].flat[0]:g} leaves the top half stretched, not bent in",
                expected="a bottom half at least as deformed as the top",
            )
        s2 = np.minimum(s2, top)
    (zt, yt, at, bt, tt), (zb, yb, ab, bb, tb) = (_swing(r, s0, s, rule) for s0, s in ((top, s2), (bottom, s1)))
    rows = [
        _ellipse_piece(0.0, zt, yt, at, bt, tt),
        _ellipse_piece(0.5 * pi, -zt, yt, at, bt, -tt),
        _ellipse_piece(pi, -zb, -yb, ab, bb, tb),
        _ellipse_piece(1.5 * pi, zb, -yb, ab, bb, -tb),
    ]
    return Section(np.stack(rows, axis=-2))


def top_severity(number: int, s1: Values, s02: Values = 1.0, s01: Values = 1.0, *, rule: str = "exact") -> np.ndarray:
    """Return s2, the severity of the top half, of modes 1 to 5: their height over O divided by r."""
    section = mode(number, 1.0, np.atleast_1d(s1), s02, s01, rule=rule)
    return np.array([float(Section(one).radius(0.5 * pi)) for one in section.pieces])


def _chord2(s0: np.ndarray, rule: str) -> np.ndarray:
    """Return the squared chord, over r2, from springline to crown of the ellipse frozen at s0."""
    return np.square(ellipse_major(1.0, s0, rule)) + np.square(s0)


def _swing(r: np.ndarray, s0: np.ndarray, s: np.ndarray, rule: str) -> tuple[np.ndarray, ...]:
    """Return centre (z, y), semi-axes and turn of a right quarter arc frozen at s0 and swung to a crown height s r.

    Its chord turns as a rigid bar about the springline end, and the arc, with its ellipse's centre, turns with it.
    """
    a, b = ellipse_major(r, s0, rule), s0 * r
    height = s * r
    reach = np.sqrt(a * a + b * b - height * height)
    turn = np.arctan2(height, -reach) - np.arctan2(b, -a)
    return reach - a * np.cos(turn), -a * np.sin(turn), a, b, turn


def _ellipse_piece(start: float, zc: Values, yc: Values, a: Values, b: Values, turn: Values) -> np.ndarray:
    """Return the piece (..., 7) from bearing `start` of the ellipse about (zc, yc), its axis a at bearing `turn`."""
    start, zc, yc, a, b, turn = np.broadcast_arrays(*(np.asarray(v, float) for v in (start, zc, yc, a, b, turn)))
    c, s = np.cos(turn), np.sin(turn)
    za, zb = (c / a) ** 2 + (s / b) ** 2, 2.0 * c * s * (a**-2 - b**-2)
    ya = (s / a) ** 2 + (c / b) ** 2
    return np.stack(
        [
            start,
            za,
            zb,
            ya,
            -2.0 * za * zc - zb * yc,
            -2.0 * ya * yc - zb * zc,
            za * zc * zc + zb * zc * yc + ya * yc * yc - 1.0,
        ],
        axis=-1,
    )
