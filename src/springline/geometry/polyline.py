"""Lines of straight pieces: where a point stands beside one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

_BLOCK = 1 << 20


class Beside(NamedTuple):
    """Where points stand beside a line; arrays run over points.

    Attributes:
        along: Length of the line up to each foot [m]; below zero and beyond the whole length off the line's ends.
        right: Distance to the right of the line, seen along it [m].
        piece: The piece on which the foot lies.
        tangent: Unit vector along it (n, 2).
    """

    along: np.ndarray
    right: np.ndarray
    piece: np.ndarray
    tangent: np.ndarray


def beside_line(points: np.ndarray, line: np.ndarray) -> Beside:
    """Return where points stand beside a line in the plane; the first and last piece are prolonged.

    Args:
        points: Easting and northing [m] (n, 2).
        line: Its corners, easting and northing [m] (m, 2), no two neighbours the same.

    >>> found = beside_line(np.array([[3.0, 1.0]]), np.array([[0.0, 0.0], [2.0, 0.0], [4.0, 0.0]]))
    >>> found.along.tolist(), found.right.tolist(), found.piece.tolist()
    ([3.0], [-1.0], [1])
    """
    start, way = line[:-1], np.diff(line, axis=0)
    length = np.hypot(*way.T)
    unit = way / length[:, None]
    before = np.concatenate([[0.0], np.cumsum(length)])
    count = len(points)
    piece = np.empty(count, np.int64)
    rows = max(_BLOCK // len(way), 1)
    # Blocks bound what is held at once; within one every point meets every piece.
    for first in range(0, count, rows):
        off = points[first : first + rows, None, :] - start
        share = np.clip(np.einsum("nmk,mk->nm", off, unit), 0.0, length)
        away = off - share[..., None] * unit
        piece[first : first + rows] = np.argmin(np.einsum("nmk,nmk->nm", away, away), axis=1)
    off, tangent = points - start[piece], unit[piece]
    along = np.einsum("nk,nk->n", off, tangent)
    # Inner pieces end at their corners; the outer ones run on.
    low = np.where(piece == 0, -np.inf, 0.0)
    high = np.where(piece == len(way) - 1, np.inf, length[piece])
    foot = np.clip(along, low, high)
    # On the outside of a corner the distance is that to the corner, with the side of the piece.
    side = off[:, 0] * tangent[:, 1] - off[:, 1] * tangent[:, 0]
    right = np.where(side < 0.0, -1.0, 1.0) * np.hypot(side, along - foot)
    return Beside(before[piece] + foot, right, piece, tangent)
