"""Area and length of a contour from polygons alone, refined until the extrapolation settles."""

from itertools import pairwise

import numpy as np


def measures(pieces, levels=9, start=16):
    """Return area and length of the closed curve that joins the pieces.

    `pieces` are callables from u in [0, 1] to (z, y), in order along the contour, each of them smooth. Polygons of
    start, 2 start, ... chords a piece are extrapolated (Romberg: their errors run in even powers of the chord).
    """
    table = []
    for level in range(levels):
        u = np.linspace(0.0, 1.0, start * 2**level + 1)
        area = length = 0.0
        for piece in pieces:
            z, y = piece(u)
            area += 0.5 * np.sum(z[:-1] * y[1:] - z[1:] * y[:-1])
            length += np.sum(np.hypot(np.diff(z), np.diff(y)))
        row = [np.array([area, length])]
        for power in range(1, min(level, 6) + 1):
            row.append(row[-1] + (row[-1] - table[-1][power - 1]) / (4.0**power - 1.0))
        table.append(row)
    return table[-1][-1]


def polar_pieces(section):
    """Return the pieces of one section between its breaks, from its polar radius."""
    edges = np.append(section.breaks, section.breaks[0] + 2 * np.pi)

    def piece(low, high):
        # the ends belong to this piece, not to its neighbour
        inset = 1e-15 * max(1.0, abs(low))

        def point(u):
            # slow at both ends, where a fractional power would spoil the extrapolation
            graded = u**4 * (35.0 - 84.0 * u + 70.0 * u**2 - 20.0 * u**3)
            return section.contour(np.clip(low + (high - low) * graded, low + inset, high - inset))

        return point

    return [piece(low, high) for low, high in pairwise(edges) if high - low > 1e-9]


def swung_quarters(a, b, s):
    """Return the four pieces of a half-and-half section from a rigid motion alone, as complex numbers.

    `a`, `b`, `s` are pairs for (top, bottom) in units of r. The quarter of the ellipse between (-a, 0) and (0, b) is
    carried by the one rotation and shift that take its ends to (-OA, 0) and (0, s); the rest follows by mirrors.
    """

    def quarter(a, b, s):
        axis = np.sqrt(a * a + b * b - s * s)
        turn = (axis + 1j * s) / (a + 1j * b)

        def point(u):
            t = np.pi * (1.0 - 0.5 * u)  # from the springline to the crown
            return -axis + turn * (a * np.cos(t) + 1j * b * np.sin(t) + a)

        return point

    top, bottom = (quarter(*half) for half in zip(a, b, s, strict=True))
    arcs = [
        lambda u: -np.conj(top(u)),  # right springline to crown
        lambda u: top(1.0 - u),  # crown to left springline
        lambda u: np.conj(bottom(u)),  # left springline to invert
        lambda u: -bottom(1.0 - u),  # invert to right springline
    ]
    return [lambda u, arc=arc: (arc(u).real, arc(u).imag) for arc in arcs]
