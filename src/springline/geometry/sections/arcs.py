"""Sections made of arcs and straight lines: a closed chain, counter-clockwise, that every ray from O meets once.

Points are complex, z + i y. A piece is a straight line or the arc centre + e^(i tilt) (a cos t + i b sin t) with t
rising from `t0` to `t1`, so that arcs bulge outward; circles have a = b.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ellipeinc

from ...errors import ParameterError
from .base import Section

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Points = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class Pieces:
    """The pieces of a chain, in order counter-clockwise; every array but `straight` is (*S, P).

    Attributes:
        straight: (P,): whether a piece is a line; its centre, axes and angles are not read.
        node: Where each piece begins; the last one ends where the first begins.
        centre: The centre of an arc.
        a, b, tilt: Its semi-axes, and the turn of `a` from +z [rad].
        t0, t1: Its eccentric angles, t0 <= t1 [rad].
    """

    straight: NDArray[np.bool_]
    node: Points
    centre: Points
    a: Array
    b: Array
    tilt: Array
    t0: Array
    t1: Array

    def moved(self, turn: Array | float = 0.0, shift: Points | complex = 0.0) -> Pieces:
        """Return the pieces turned counter-clockwise about the origin, then shifted; per section, shape S."""
        turn, shift = np.asarray(turn, float)[..., None], np.asarray(shift, complex)[..., None]
        spin = np.exp(1j * turn)
        return replace(self, node=spin * self.node + shift, centre=spin * self.centre + shift, tilt=self.tilt + turn)

    def mirrored(self) -> Pieces:
        """Return the pieces upside down: y changes its sign, and the order is kept counter-clockwise."""
        end = np.roll(self.node, -1, axis=-1)
        back = {name: getattr(self, name)[..., ::-1] for name in ("straight", "a", "b")}
        return Pieces(
            **back,
            node=np.conj(end)[..., ::-1],
            centre=np.conj(self.centre)[..., ::-1],
            tilt=-self.tilt[..., ::-1],
            t0=-self.t1[..., ::-1],
            t1=-self.t0[..., ::-1],
        )

    def at(self, t: Array) -> tuple[Points, Points]:
        """Return each arc's point and its derivative by t at the eccentric angles t, (*S, P)."""
        spin = np.exp(1j * self.tilt)
        cos, sin = np.cos(t), np.sin(t)
        return self.centre + spin * (self.a * cos + 1j * self.b * sin), spin * (-self.a * sin + 1j * self.b * cos)


class ArcSection(Section):
    """Sections made of arcs and lines.

    Args:
        pieces: The chain.

    Raises:
        ParameterError: Some ray from O meets the chain more than once, or not at all.

    >>> from springline.geometry.sections import egg
    >>> sewer = egg(0.6, 0.9, 0.15)
    >>> round(float(sewer.area), 6), round(float(sewer.perimeter), 6)
    (0.413472, 2.378968)
    """

    def __init__(self, pieces: Pieces) -> None:
        node = np.asarray(pieces.node)
        advance = np.angle(np.roll(node, -1, axis=-1) * np.conj(node))
        advance = np.where(advance < -1e-9, advance + 2 * np.pi, np.maximum(advance, 0.0))
        # an arc may also turn back on itself, seen from O; it then does so at one of its ends
        sweep = [(np.conj(p) * tangent).imag for p, tangent in (pieces.at(pieces.t0), pieces.at(pieces.t1))]
        back = np.where(pieces.straight, 0.0, np.minimum(*sweep)) / np.max(np.abs(node), axis=-1, keepdims=True) ** 2
        if np.any(np.abs(np.sum(advance, axis=-1) - 2 * np.pi) > 1e-6) or np.any(back < -1e-9):
            raise ParameterError(
                "a ray from O meets the chain of arcs and lines more than once, or O lies outside it",
                expected="a shape that is seen whole from O",
            )
        first = np.angle(node[..., :1]) % (2 * np.pi)
        self.pieces = pieces
        self._starts = np.concatenate([np.zeros_like(first), np.cumsum(advance[..., :-1], axis=-1)], axis=-1)
        self._first = first

    def __getitem__(self, key: object) -> ArcSection:
        """Return some of a batch: `key` indexes the leading batch axes."""
        kept = {f.name: getattr(self.pieces, f.name) for f in fields(Pieces)}
        return ArcSection(Pieces(**{name: x if name == "straight" else x[key] for name, x in kept.items()}))

    def flipped(self) -> ArcSection:
        """Return the sections upside down."""
        return ArcSection(self.pieces.mirrored())

    def turned(self, turn: Array | float) -> ArcSection:
        """Return the sections turned counter-clockwise about O by `turn` [rad], shape S."""
        return ArcSection(self.pieces.moved(turn))

    def _shape(self) -> tuple[int, ...]:
        return self.pieces.node.shape[:-1]

    def _breaks(self) -> Array:
        return self._first + self._starts

    def _radius(self, bearing: Array) -> Array:
        return self._meet(bearing)[0]

    def _slope(self, bearing: Array) -> Array:
        r, piece, t = self._meet(bearing)
        tangent = np.where(piece.straight, np.exp(1j * piece.tilt), piece.at(t)[1])
        across = np.conj(np.exp(1j * bearing)) * tangent
        return r * across.real / across.imag

    def _curvature(self, bearing: Array) -> Array:
        _, piece, t = self._meet(bearing)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            bend = piece.a * piece.b / np.hypot(piece.a * np.sin(t), piece.b * np.cos(t)) ** 3
        return np.where(piece.straight, 0.0, bend)

    def _meet(self, bearing: Array) -> tuple[Array, Pieces, Array]:
        """Return the radius at (..., M) bearings, the piece met, and the eccentric angle there (none on a line)."""
        ahead = (bearing - self._first) % (2 * np.pi)
        index = np.sum(ahead[..., :, None] >= self._starts[..., None, :], axis=-1) - 1
        piece = self._picked(index)
        ray = np.exp(1j * bearing)
        own = np.conj(np.exp(1j * piece.tilt))
        e = own * ray
        w = -own * piece.centre
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            ex, ey, wx, wy = e.real / piece.a, e.imag / piece.b, w.real / piece.a, w.imag / piece.b
            square, half = ex * ex + ey * ey, wx * ex + wy * ey
            arc = (np.sqrt(np.maximum(square - (wx * ey - wy * ex) ** 2, 0.0)) - half) / square
            # for a line the tilt is its direction
            along = np.exp(1j * piece.tilt)
            line = (np.conj(piece.node) * along).imag / (np.conj(ray) * along).imag
            t = np.arctan2(wy + arc * ey, wx + arc * ex)
        return np.where(piece.straight, line, arc), piece, t

    def _picked(self, index: NDArray[np.int64]) -> Pieces:
        lead = np.broadcast_shapes(index.shape[:-1], self.shape)
        index = np.broadcast_to(index, (*lead, index.shape[-1]))

        def pick(x: Array) -> Array:
            return np.take_along_axis(np.broadcast_to(x, (*lead, x.shape[-1])), index, axis=-1)

        p = self.pieces
        heading = np.angle(np.roll(p.node, -1, axis=-1) - p.node)
        return Pieces(
            straight=p.straight[index],
            node=pick(p.node),
            centre=pick(p.centre),
            a=pick(p.a),
            b=pick(p.b),
            tilt=pick(np.where(p.straight, heading, p.tilt)),
            t0=pick(p.t0),
            t1=pick(p.t1),
        )

    def _area(self) -> Array:
        p, end = self.pieces, np.roll(self.pieces.node, -1, axis=-1)
        arc = p.a * p.b * (p.t1 - p.t0) + (np.conj(p.centre) * (end - p.node)).imag
        return 0.5 * np.sum(np.where(p.straight, (np.conj(p.node) * end).imag, arc), axis=-1)

    def _perimeter(self) -> Array:
        p, end = self.pieces, np.roll(self.pieces.node, -1, axis=-1)
        a, b = (np.where(p.straight, 1.0, np.where(x > 0.0, x, 1.0)) for x in (p.a, p.b))
        m = 1.0 - (b / a) ** 2
        arc = a * (ellipeinc(p.t1 - np.pi / 2, m) - ellipeinc(p.t0 - np.pi / 2, m))
        return np.sum(np.where(p.straight, np.abs(end - p.node), np.where(p.a > 0.0, arc, 0.0)), axis=-1)

    def _hull_perimeter(self) -> Array:
        p = self.pieces
        chord = np.roll(p.node, -1, axis=-1) - p.node
        # where a piece has no length it has no direction either, and the bend across it counts as none
        begin, end = (np.where(p.straight, chord, p.at(t)[1]) for t in (p.t0, p.t1))
        length = np.abs(chord)
        bend = (np.conj(end) * np.roll(begin, -1, axis=-1)).imag
        convex = np.all(bend >= -1e-12 * np.max(length, axis=-1, keepdims=True) ** 2, axis=-1)
        return self.perimeter if convex.all() else np.where(convex, self.perimeter, super()._hull_perimeter())

    def _support(self, direction: Array) -> Array:
        p = self.pieces
        n = np.exp(
            1j
            * np.broadcast_to(direction, (*np.broadcast_shapes(direction.shape[:-1], self.shape), direction.shape[-1]))
        )
        n = n[..., None]
        at_nodes = np.max((np.conj(n) * p.node[..., None, :]).real, axis=-1)
        own = n * np.conj(np.exp(1j * p.tilt))[..., None, :]
        a, b, t0, t1 = (x[..., None, :] for x in (p.a, p.b, p.t0, p.t1))
        touch = np.arctan2(b * own.imag, a * own.real)
        inside = ((touch - t0) % (2 * np.pi) <= t1 - t0) & ~p.straight
        on_arc = (np.conj(n) * p.centre[..., None, :]).real + np.hypot(a * own.real, b * own.imag)
        return np.maximum(at_nodes, np.max(np.where(inside, on_arc, -np.inf), axis=-1))
