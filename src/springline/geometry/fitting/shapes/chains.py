"""Walls as chains of arcs and lines, and how a wall moves when a coordinate of its shape does.

At a fixed bearing the wall moves along its normal as its pieces do: an arc by its centre, axes and tilt, a line by its
ends. Pieces follow from a few numbers, so that differences are taken of pieces, a handful per ring, and never of the
hundreds of radii of its readings.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt
from typing import TYPE_CHECKING

import numpy as np

from .._jit import kernel

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from ...sections.arcs import Pieces

    Array = NDArray[np.float64]

FIELDS = 9
"""Columns of a piece: start z and y, end z and y, centre z and y, semi-axes a and b, tilt of a."""

STEP = 1e-6
"""Step of the differences, in units in which the pipe's mean radius is 1."""


def chain_of_pieces(pieces: Pieces) -> Array:
    """Return (N, P, FIELDS) of a batch of N chains."""
    node, centre = pieces.node, pieces.centre
    end = np.roll(node, -1, axis=-1)
    columns = (node.real, node.imag, end.real, end.imag, centre.real, centre.imag, pieces.a, pieces.b, pieces.tilt)
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


def chain_of_hinges(r: Array, table: Array) -> Array:
    """Return (N, 4, FIELDS) of hinged sections: the quarter arcs right of the crown, left of it, and below.

    Args:
        r: (N,) radius of the undeformed pipe.
        table: (N, 12) of `sections.severity.hinge_table`.
    """
    axis = table[:, 10]
    chain = np.empty((len(r), 4, FIELDS))
    for piece, (side, up) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        a, b, s, sin_a, cos_a = np.moveaxis(table[:, :5] if up > 0 else table[:, 5:10], -1, 0)
        springline, crown = (side * axis, np.zeros_like(axis)), (np.zeros_like(axis), up * s)
        start, end = (springline, crown) if side * up > 0 else (crown, springline)
        # the arc to the left of the crown turns clockwise by alpha about its hinge; the others are its mirror images
        centre = side * b * sin_a, up * (s - b * cos_a)
        tilt = side * up * np.arctan2(sin_a, cos_a)
        chain[:, piece] = np.stack([*start, *end, *centre, a, b, np.zeros_like(a)], axis=-1) * r[:, None]
        chain[:, piece, 8] = tilt
    return chain


def moving_chain(chain: Callable[[Array], Array], coordinates: Array, floor: Array) -> tuple[Array, Array]:
    """Return the chains (N, P, FIELDS) at `coordinates` (N, K), and their derivatives (N, K, P, FIELDS).

    Differences are central, and forward where a coordinate has no room above its `floor` (K,).
    """
    rings, count = coordinates.shape
    back = np.where(coordinates - STEP < floor, 0.0, STEP)
    shift = np.eye(count)
    ahead = coordinates[:, None, :] + STEP * shift
    behind = coordinates[:, None, :] - back[:, :, None] * shift
    every = np.concatenate([coordinates[:, None, :], ahead, behind], axis=1)
    found = chain(every.reshape(-1, count))
    found = found.reshape(rings, 2 * count + 1, *found.shape[1:])
    moved = (found[:, 1 : count + 1] - found[:, count + 1 :]) / (STEP + back)[:, :, None, None]
    return np.ascontiguousarray(found[:, 0]), np.ascontiguousarray(moved)


@kernel
def chain_radius(rows, bearing, counts, straight, chain, moved, radius, slope, by):
    """Fill radius, dr/dbearing and the derivatives of the radius by each coordinate, at the readings of some rings.

    Args:
        rows: (R,) rings to do; `chain` (R, P, FIELDS) and `moved` (R, K, P, FIELDS) are theirs, in this order.
        bearing: (N, M) about O, in the section's own frame [rad].
        counts: (N,) how many of the M are readings.
        straight: (P,) which pieces are lines.
        radius, slope: (N, M) output.
        by: (N, K, M) output.
    """
    pieces, count = chain.shape[1], moved.shape[1]
    begins = np.empty(pieces)
    for place in range(rows.size):
        ring = rows[place]
        own, change = chain[place], moved[place]
        first = atan2(own[0, 1], own[0, 0])
        begins[0] = 0.0
        for p in range(1, pieces):
            turn = (atan2(own[p, 1], own[p, 0]) - first) % (2.0 * pi)
            # rounding may put a piece without length a turn ahead
            begins[p] = max(turn if turn < 2.0 * pi - 1e-9 else 0.0, begins[p - 1])
        for i in range(counts[ring]):
            ahead = (bearing[ring, i] - first) % (2.0 * pi)
            p = 0
            for q in range(1, pieces):
                p += 1 if ahead >= begins[q] else 0
            ez, ey = cos(bearing[ring, i]), sin(bearing[ring, i])
            piece = own[p]
            if straight[p]:
                dz, dy = piece[2] - piece[0], piece[3] - piece[1]
                length = sqrt(dz * dz + dy * dy)
                nz, ny = dy / length, -dz / length
                across = nz * ez + ny * ey
                r = (nz * piece[0] + ny * piece[1]) / across
                part = ((r * ez - piece[0]) * dz + (r * ey - piece[1]) * dy) / (length * length)
                for k in range(count):
                    d = change[k, p]
                    move = (1.0 - part) * (nz * d[0] + ny * d[1]) + part * (nz * d[2] + ny * d[3])
                    by[ring, k, i] = move / across
            else:
                ct, st = cos(piece[8]), sin(piece[8])
                a, b = piece[6], piece[7]
                # ray and centre in the arc's own axes, over its semi-axes
                ux, uy = (ct * ez + st * ey) / a, (ct * ey - st * ez) / b
                wx, wy = -(ct * piece[4] + st * piece[5]) / a, -(ct * piece[5] - st * piece[4]) / b
                square, half, cross = ux * ux + uy * uy, wx * ux + wy * uy, wx * uy - wy * ux
                r = (sqrt(max(square - cross * cross, 0.0)) - half) / square
                cx, cy = wx + r * ux, wy + r * uy
                gx, gy = cx / a, cy / b
                size = sqrt(gx * gx + gy * gy)
                gx, gy = gx / size, gy / size
                nz, ny = ct * gx - st * gy, st * gx + ct * gy
                across = nz * ez + ny * ey
                rz, ry = r * ez - piece[4], r * ey - piece[5]
                for k in range(count):
                    d = change[k, p]
                    move = nz * d[4] + ny * d[5] + gx * cx * d[6] + gy * cy * d[7] + (ny * rz - nz * ry) * d[8]
                    by[ring, k, i] = move / across
            radius[ring, i] = r
            slope[ring, i] = r * (nz * ey - ny * ez) / across
