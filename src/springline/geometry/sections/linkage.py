"""Four hinges anywhere: rigid arcs joined at hinges are a four-bar linkage with one degree of freedom.

Modes 2 to 5 put the hinges at crown, invert and springlines, where the linkage is symmetric. Elsewhere the arcs differ
and the section skews. O is the centroid of the area, which for the undeformed pipe is its centre.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import between, choice, positive

from ...errors import ParameterError
from .arcs import ArcSection, Pieces
from .ellipses import RULES, Rule, partner_axis

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]
    Points = NDArray[np.complex128]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


def linkage(
    hinges: ArrayLike, closing: ArrayLike, s0: ArrayLike = 1.0, r: ArrayLike = 1.0, *, rule: Rule = "exact"
) -> ArcSection:
    """Return sections hinged at four points of an ellipse of severity s0 (a circle by default), and pressed together.

    The second and the fourth hinge move towards each other; the line from the first to the third keeps its bearing.

    Args:
        hinges: (..., 4): eccentric angles of the hinges on the undeformed ellipse, ascending within one turn [rad]; for
            springline, crown, springline, invert these are 0, pi/2, pi, 3 pi/2, and the section is mode 2.
        closing: Distance between the second and the fourth hinge over what it was, at most 1.
        s0: Severity of the ellipse before it cracked.
        r: Radius of the undeformed pipe.
        rule: How the perimeter is kept.

    Raises:
        ParameterError: Hinges out of order, a closing at which the bars no longer reach, or one so deep that O does not
            see the whole section.

    Source: errata E: area = the rigid segments + the quadrilateral.

    >>> skewed = linkage([0.0, 1.3, np.pi, 4.8], 0.9)
    >>> round(float(skewed.perimeter / (2 * np.pi)), 12)
    1.0
    """
    choice("rule", rule, RULES)
    r = positive("r", r)
    s0 = between("s0", s0, 0.0, 1.0, bounds="(]")
    hinges = np.asarray(hinges, float)
    span = np.diff(hinges, axis=-1, append=hinges[..., :1] + 2 * np.pi)
    if hinges.shape[-1:] != (4,) or not np.all(span > 0.0):
        raise ParameterError(
            f"hinges = {hinges.tolist()} are not four in order", expected="4 ascending angles in a turn"
        )
    shape = np.broadcast_shapes(hinges.shape[:-1], np.shape(closing), s0.shape, r.shape)
    t0, span = np.broadcast_to(hinges, (*shape, 4)), np.broadcast_to(span, (*shape, 4))
    a, b = (np.broadcast_to((x * r)[..., None], (*shape, 4)) for x in (partner_axis(s0, rule), s0))
    before = a * np.cos(t0) + 1j * b * np.sin(t0)
    with np.errstate(invalid="ignore"):
        after = _pressed(before, closing)
    # each bar moves rigidly with the chord between its hinges
    turn = (np.roll(after, -1, axis=-1) - after) / (np.roll(before, -1, axis=-1) - before)
    pieces = Pieces(np.zeros(4, bool), after, after - turn * before, a, b, np.angle(turn), t0, t0 + span)
    return ArcSection(pieces.moved(shift=-_centroid(pieces)))


def closing_lower(hinges: ArrayLike, s0: ArrayLike = 1.0, *, rule: Rule = "exact") -> Array:
    """Return the closing at which a pair of bars lies folded flat: the lower limit of `linkage`'s closing.

    >>> float(closing_lower([0.0, np.pi / 2, np.pi, 3 * np.pi / 2]))
    0.0
    """
    t, s0 = np.asarray(hinges, float), np.asarray(s0, float)[..., None]
    return _reach(partner_axis(s0, rule) * np.cos(t) + 1j * s0 * np.sin(t))


def _reach(points: Points) -> Array:
    bars = np.abs(np.roll(points, -1, axis=-1) - points)
    least = np.maximum(np.abs(bars[..., 1] - bars[..., 2]), np.abs(bars[..., 0] - bars[..., 3]))
    low = least / np.abs(points[..., 3] - points[..., 1])
    return np.where(low < 1e-12, 0.0, low)  # equal bars fold flat at 0, up to rounding


def _pressed(points: Points, closing: ArrayLike) -> Points:
    """Return the hinges with the second and the fourth brought together."""
    closing = between("closing", closing, _reach(points), 1.0, bounds="(]")
    bars = np.abs(np.roll(points, -1, axis=-1) - points)
    diagonal = closing * np.abs(points[..., 3] - points[..., 1])

    def apex(near: Array, far: Array) -> tuple[Array, Array]:
        along = (diagonal**2 + near**2 - far**2) / (2.0 * diagonal)
        return along, np.sqrt(np.maximum(near**2 - along**2, 0.0))

    along, height = apex(bars[..., 1], bars[..., 2])
    third = along - 1j * height
    along, height = apex(bars[..., 0], bars[..., 3])
    first = along + 1j * height
    moved = np.stack([first, np.zeros_like(first), third, diagonal.astype(complex)], axis=-1)
    spin = (points[..., 2] - points[..., 0]) / (third - first)
    return moved * (spin / np.abs(spin))[..., None]


def _centroid(pieces: Pieces) -> Points:
    """Return the centroid of the area inside, by Gauss's rule, which is exact for quarter turns of an ellipse."""
    total, first = 0.0, 0.0
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        half = 0.5 * (pieces.t1 - pieces.t0)
        point, along = pieces.at(pieces.t0 + half * (1.0 + node))
        swept = weight * half * (np.conj(point) * along).imag
        total = total + np.sum(swept, axis=-1) / 2.0
        first = first + np.sum(swept * point, axis=-1) / 3.0
    with np.errstate(invalid="ignore"):
        return first / total
