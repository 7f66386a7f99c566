"""Contours of a field on a grid, by marching squares."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Path = tuple[NDArray[np.float64], NDArray[np.float64]]


def contour_paths(x: ArrayLike, y: ArrayLike, values: ArrayLike, level: float) -> list[Path]:
    """Return the lines along which a field has the value `level`.

    Args:
        x: (columns,) ascending.
        y: (rows,) ascending.
        values: (rows, columns); cells with a NaN corner hold no line.
        level: The value.

    Returns:
        (x, y) of each line, in order along it; a closed line ends where it starts.

    >>> t = np.linspace(-1.0, 1.0, 41)
    >>> (ring,) = contour_paths(t, t, np.hypot(*np.meshgrid(t, t)), 0.5)
    >>> bool(np.allclose(np.hypot(*ring), 0.5, atol=1e-3)), bool(ring[0][0] == ring[0][-1])
    (True, True)
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    # a value that is exactly the level would make lines end at a corner
    field = np.asarray(values, float) - level
    field = np.where(field == 0.0, 1e-300, field)
    points = {**_crossings(x, y, field, along=1), **_crossings(x, y, field, along=0)}
    links: dict[tuple, list[tuple]] = defaultdict(list)
    above = field > 0.0
    whole = np.isfinite(field[:-1, :-1] + field[:-1, 1:] + field[1:, :-1] + field[1:, 1:])
    mixed = (above[:-1, :-1] != above[1:, 1:]) | (above[:-1, 1:] != above[1:, :-1])
    mixed |= above[:-1, :-1] != above[:-1, 1:]
    for i, j in zip(*np.nonzero(whole & mixed), strict=True):
        edges = [e for e in ((1, i, j), (0, i, j + 1), (1, i + 1, j), (0, i, j)) if e in points]
        if len(edges) == 4 and above[i, j] != (field[i : i + 2, j : j + 2].mean() > 0.0):
            edges = edges[1:] + edges[:1]  # a saddle: its middle tells which corners belong together
        for one, other in zip(edges[::2], edges[1::2], strict=True):
            links[one].append(other)
            links[other].append(one)
    return [tuple(np.array([points[e] for e in chain]).T) for chain in _chains(links)]


def _crossings(
    x: NDArray[np.float64], y: NDArray[np.float64], field: NDArray[np.float64], *, along: int
) -> dict[tuple, tuple[float, float]]:
    """Return where the field changes sign on the grid's edges, keyed by (along, row, column) of their start."""
    rows, columns = (field.shape[0], field.shape[1] - 1) if along else (field.shape[0] - 1, field.shape[1])
    low, high = field[:rows, :columns], field[1 - along :, along:]
    i, j = np.nonzero((low > 0.0) != (high > 0.0))
    share = low[i, j] / (low[i, j] - high[i, j])
    ok = np.isfinite(share)
    i, j, share = i[ok], j[ok], share[ok]
    px = x[j] + (share * (x[j + 1] - x[j]) if along else 0.0)
    py = y[i] + (0.0 if along else share * (y[i + 1] - y[i]))
    return dict(zip(((along, a, b) for a, b in zip(i, j, strict=True)), zip(px, py, strict=True), strict=True))


def _chains(links: dict[tuple, list[tuple]]) -> list[list[tuple]]:
    """Return the links as chains: open ones from their ends first, then closed ones."""
    chains = []
    for ends in (True, False):
        for start in list(links):
            if not links[start] or (ends and len(links[start]) != 1):
                continue
            chain = [start]
            while links[chain[-1]]:
                following = links[chain[-1]].pop()
                links[following].remove(chain[-1])
                chain.append(following)
            chains.append(chain)
    return chains
