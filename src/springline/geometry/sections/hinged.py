"""The hinged sections, modes 1 to 5: two half sections of two mirror-image quarter arcs each, sharing the springline.

O lies on the springline axis midway between the springline hinges, under the crown hinge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ellipe, ellipeinc

from springline.geometry.checks import TOLERANCE, between, choice, positive

from . import quadrature, severity
from .base import Chord, Section
from .ellipses import RULES, Rule, partner_axis

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hinge:
    """A quarter arc swung about its springline end; the top-left one, in the pipe's unit of length.

    Attributes:
        a, b: Semi-axes of the parent ellipse, along z and y before the swing.
        springline: Distance OA from O to the springline hinge A.
        crown: Distance OB from O to the crown hinge B.
        alpha: Clockwise turn of the arc [rad].
        centre_z, centre_y: The parent ellipse's centre; to the left of O (errata A7).

    Source: (3.5) to (3.12) and (3.23) to (3.26).
    """

    a: Array
    b: Array
    springline: Array
    crown: Array
    alpha: Array
    centre_z: Array
    centre_y: Array


def hinge(s0: ArrayLike, s: ArrayLike, r: ArrayLike = 1.0, *, rule: Rule = "exact") -> Hinge:
    """Return the quarter arc of frozen severity s0, swung until its crown end is at the height s r.

    Raises:
        ParameterError: s0 outside (0, 1], s outside (0, s0] (it would open upward), or r not above zero.

    >>> round(float(hinge(0.95, 0.9).springline), 6)
    1.091988
    """
    choice("rule", rule, RULES)
    r = positive("r", r)
    s0 = between("s0", s0, 0.0, 1.0, bounds="(]")
    s = between("s", s, 0.0, s0 * (1.0 + TOLERANCE), bounds="(]", given={"s0": s0})
    s = np.minimum(s, s0)
    a = partner_axis(s0, rule)
    square = a * a + s0 * s0
    axis = np.sqrt(square - s * s)
    return _hinge(a, s0, s, (s0 * axis - a * s) / square, (a * axis + s0 * s) / square, axis, r)


def _hinge(a: Array, b: Array, s: Array, sin: Array, cos: Array, axis: Array, r: Array) -> Hinge:
    return Hinge(a * r, b * r, axis * r, s * r, np.arctan2(sin, cos), -b * sin * r, (s - b * cos) * r)


def hinged(
    mode: ArrayLike,
    s1: ArrayLike,
    s02: ArrayLike = 1.0,
    s01: ArrayLike = 1.0,
    r: ArrayLike = 1.0,
    *,
    rule: Rule = "exact",
    inverted: ArrayLike = False,
) -> HingedSection:
    """Return sections of modes 1 to 5.

    Args:
        mode: 1 to 5; an array mixes modes.
        s1: Severity of the bottom half.
        s02: Severity at which the top arcs froze; read in modes 4 and 5.
        s01: Severity at which the bottom arcs froze; read in mode 5.
        r: Radius of the undeformed pipe.
        rule: How the perimeter is kept: `exact`, or `ramanujan` as published.
        inverted: Whether the section is upside down, hinged at the invert first.

    Raises:
        ParameterError: A parameter outside its range for the given others.

    Source: chapter 3.1 to 3.3 with errata A1, A6, A7, A14.

    >>> pipe = hinged(3, [1.0, 0.9], r=0.3)
    >>> pipe.polar_radius([0.0, np.pi / 2]).round(4).tolist()
    [[0.3, 0.3], [0.3286, 0.2684]]
    """
    choice("rule", rule, RULES)
    s1, s02, s01 = severity.canonical(mode, s1, s02, s01, rule=rule)
    shape = np.broadcast_shapes(s1.shape, np.shape(r), np.shape(inverted))
    table = np.broadcast_to(severity.hinge_table(s1, s02, s01, rule=rule), (*shape, 12))
    s1, s02, s01, r = (np.broadcast_to(x, shape) for x in (s1, s02, s01, positive("r", r)))
    return HingedSection(
        s1, table[..., 11], s02, s01, r, rule, np.broadcast_to(np.asarray(inverted, bool), shape), table
    )


@dataclass(frozen=True, eq=False)
class HingedSection(Section):
    """Sections of modes 1 to 5 as the one construction; made by `hinged`.

    Attributes:
        s1, s2: Severities of the bottom and of the top half.
        s02, s01: Severities at which their arcs froze.
        r: Radius of the undeformed pipe.
        rule: How the perimeter was kept.
        inverted: Whether top and bottom are exchanged.
    """

    s1: Array
    s2: Array
    s02: Array
    s01: Array
    r: Array
    rule: Rule
    inverted: NDArray[np.bool_]
    _table: Array

    def __getitem__(self, key: object) -> HingedSection:
        """Return some of a batch: `key` indexes the leading batch axes."""
        s1, s2, s02, s01, r, inverted = (x[key] for x in (self.s1, self.s2, self.s02, self.s01, self.r, self.inverted))
        return HingedSection(s1, s2, s02, s01, r, self.rule, inverted, self._table[key])

    def flipped(self) -> HingedSection:
        """Return the sections upside down."""
        return HingedSection(self.s1, self.s2, self.s02, self.s01, self.r, self.rule, ~self.inverted, self._table)

    @cached_property
    def top(self) -> Hinge:
        """The quarter arc of the half at the crown, mirrored when the section is upside down."""
        return self._half(upper=True)

    @cached_property
    def bottom(self) -> Hinge:
        """The quarter arc of the half at the invert, as if it lay above."""
        return self._half(upper=False)

    @property
    def springline(self) -> Array:
        """Distance OA from O to either springline hinge."""
        return self._table[..., 10] * self.r

    def contour_point(self, t: ArrayLike) -> tuple[Array, Array]:
        """Return z and y at the eccentric angle t of the parent ellipses.

        Args:
            t: (..., M) [rad]: 0 is the right springline, pi/2 the crown, pi the left springline, 3 pi/2 the invert.
        """
        t = np.asarray(t, float)
        cos, sin = np.cos(t), np.sin(t)
        upper = sin >= 0.0

        def pick(name: str) -> Array:
            top, bottom = (np.asarray(getattr(half, name)) for half in (self.top, self.bottom))
            if t.ndim:
                top, bottom = top[..., None], bottom[..., None]
            return np.where(upper, top, bottom)

        # the arc as if it were the top-left one: x to the right of its centre, negative
        x, y = -pick("a") * np.abs(cos), pick("b") * np.abs(sin)
        turn = pick("alpha")
        z = pick("centre_z") + np.cos(turn) * x + np.sin(turn) * y
        y = pick("centre_y") + np.cos(turn) * y - np.sin(turn) * x
        return np.where(cos > 0.0, -z, z), np.where(upper, y, -y)

    def _shape(self) -> tuple[int, ...]:
        return self.r.shape

    def _breaks(self) -> Array:
        return np.broadcast_to(np.arange(4) * (np.pi / 2), (*self.shape, 4))

    def _panels(self) -> Array:
        from . import kernels

        knees = np.empty((self.r.size, 2))
        kernels.knees(self._table.reshape(-1, 12), knees)
        top, bottom = np.moveaxis(knees.reshape(*self.shape, 2), -1, 0)
        top, bottom = np.where(self.inverted, bottom, top), np.where(self.inverted, top, bottom)
        quadrant = np.arange(4) * (np.pi / 2)
        inner = np.stack([top, np.pi - top, np.pi + bottom, 2 * np.pi - bottom], axis=-1)
        return np.stack([np.broadcast_to(quadrant, inner.shape), inner], axis=-1).reshape(*self.shape, 8)

    def _area(self) -> Array:
        def quarter(half: Hinge) -> Array:
            # the rigid segment between arc and chord, and the triangle O A B
            return np.pi / 4 * half.a * half.b - 0.5 * half.a * half.b + 0.5 * half.springline * half.crown

        return 2.0 * (quarter(self.top) + quarter(self.bottom))

    def _perimeter(self) -> Array:
        return 2.0 * sum(half.a * ellipe(1.0 - (half.b / half.a) ** 2) for half in (self.top, self.bottom))

    def _mean_radius(self) -> Array:
        from . import kernels

        out = np.empty(self.r.size)
        kernels.mean_radius(self._table.reshape(-1, 12), *quadrature.rule(), out)
        return out.reshape(self.shape) * self.r

    def _hull_perimeter(self) -> Array:
        """Return the arcs up to their highest points, bridged over the crown and the invert."""
        total = np.zeros(self.shape)
        for half in (self.top, self.bottom):
            sin, cos = np.sin(half.alpha), np.cos(half.alpha)
            t = np.arctan2(half.b * cos, -half.a * sin)  # eccentric angle of the top-left arc's highest point
            z = half.centre_z + half.a * cos * np.cos(t) + half.b * sin * np.sin(t)
            m = 1.0 - (half.b / half.a) ** 2
            total = total + 2.0 * (half.a * (ellipe(m) - ellipeinc(t - np.pi / 2, m)) - z)
        return total

    def _largest_chord(self) -> Chord:
        # the polar radius falls from A to B (errata A14)
        return Chord(2.0 * self.springline, np.zeros(self.shape))

    def _smallest_chord(self) -> Chord:
        return Chord((self.s1 + self.s2) * self.r, np.full(self.shape, np.pi / 2))

    def _support(self, direction: Array) -> Array:
        across, up = np.abs(np.cos(direction)), np.sin(direction)
        return np.maximum(_reach(self.top, across, up), _reach(self.bottom, across, -up))

    def _half(self, *, upper: bool) -> Hinge:
        here = np.where((self.inverted == upper)[..., None], self._table[..., 5:10], self._table[..., :5])
        return _hinge(*np.moveaxis(here, -1, 0), self._table[..., 10], self.r)

    def _radius(self, bearing: Array) -> Array:
        return self._polar(bearing, with_slope=False)[0]

    def _slope(self, bearing: Array) -> Array:
        return self._polar(bearing, with_slope=True)[1]

    def _curvature(self, bearing: Array) -> Array:
        return self._polar(bearing, with_slope=True)[2]

    def _polar(self, bearing: Array, *, with_slope: bool) -> tuple[Array, Array, Array]:
        from . import kernels

        sign = np.where(self.inverted, -1.0, 1.0)[..., None]
        if not np.all(sign == 1.0):
            bearing = bearing * sign
        lead = np.broadcast_shapes(self.shape, bearing.shape[:-1])
        shape = (*lead, bearing.shape[-1])
        table = np.ascontiguousarray(np.broadcast_to(self._table, (*lead, 12))).reshape(-1, 12)
        shared = all(n == 1 for n in bearing.shape[:-1])
        rows = bearing.reshape(1, -1) if shared else np.broadcast_to(bearing, shape).reshape(-1, shape[-1])
        radius = np.empty((table.shape[0], shape[-1]))
        slope, curvature = (np.empty(radius.shape if with_slope else (1, 0)) for _ in range(2))
        kernels.polar(np.ascontiguousarray(rows), table, radius, slope, curvature)
        r = self.r[..., None]
        if not with_slope:
            return radius.reshape(shape) * r, slope, curvature
        return radius.reshape(shape) * r, sign * slope.reshape(shape) * r, curvature.reshape(shape) / r


def _reach(half: Hinge, across: Array, up: Array) -> Array:
    """Return the support of a half section in the directions (across, up) from O, across to the arc's own side."""
    a, b, springline, crown, alpha, z, y = (
        np.asarray(x)[..., None]
        for x in (half.a, half.b, half.springline, half.crown, half.alpha, half.centre_z, half.centre_y)
    )
    nx, ny = -np.cos(alpha) * across - np.sin(alpha) * up, np.cos(alpha) * up - np.sin(alpha) * across
    on_arc = np.hypot(a * nx, b * ny) - z * across + y * up
    return np.where((nx <= 0.0) & (ny >= 0.0), on_arc, np.maximum(springline * across, crown * up))
