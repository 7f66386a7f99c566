"""The pipe's axis in the Earth frame: straight and circular cells between mitre planes.

Earth frame: east, north, up [m], not rotating. The **local pipe frame** at a chainage has x along the axis, y in the
vertical plane and z = x cross y to the right. A cell is a straight or a circular arc; where two cells meet, the plane
that halves the angle between them parts them, so that a ray passes from one to the next exactly once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import ParameterError

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Cell:
    """One piece of the axis.

    Attributes:
        chainage: Chainage at its start [m].
        length: Length along the axis [m].
        curvature: 1/radius [1/m]; 0 = straight.
        towards: Bearing [rad] in the section plane at the start towards the centre of curvature.
        origin: Start point, east, north, up [m].
        frame: Rows x, y, z of the local pipe frame at the start.
        groove: How much farther out [m] the wall of this cell lies (the socket in an open joint).
        joint: Whether the cell is the gap of a joint.
    """

    chainage: float
    length: float
    curvature: float
    towards: float
    origin: np.ndarray
    frame: np.ndarray
    groove: float = 0.0
    joint: bool = False

    @property
    def end(self) -> float:
        """Chainage at the cell's end [m]."""
        return self.chainage + self.length


def level_frame(tangent: np.ndarray) -> np.ndarray:
    """Return the rows x, y, z of the local pipe frame (..., 3, 3) for tangents (..., 3) in east, north, up.

    >>> level_frame(np.array([0.0, 1.0, 0.0])).tolist()
    [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    """
    x = tangent / np.linalg.norm(tangent, axis=-1, keepdims=True)
    y = UP - x[..., 2:3] * x
    y = y / np.linalg.norm(y, axis=-1, keepdims=True)
    return np.stack([x, y, np.cross(x, y)], axis=-2) + 0.0


def direction(heading: float, gradient: float) -> np.ndarray:
    """Return the unit tangent for a heading [rad, clockwise from north] and a gradient [rise per metre of run]."""
    run = 1.0 / np.hypot(1.0, gradient)
    return np.array([np.sin(heading) * run, np.cos(heading) * run, gradient * run])


def along(cell: Cell, distance: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Return points (..., 3) and tangents (..., 3) at distances [m] from the cell's start along its axis."""
    d = np.asarray(distance, float)[..., None]
    x, y, z = cell.frame
    if cell.curvature == 0.0:
        return cell.origin + d * x, np.broadcast_to(x, (*d.shape[:-1], 3)).copy()
    inward = np.cos(cell.towards) * z + np.sin(cell.towards) * y
    phi, radius = d * cell.curvature, 1.0 / cell.curvature
    # 2 sin2(phi/2) instead of 1 - cos(phi): a sag is an arc of hundreds of metres of radius.
    point = cell.origin + radius * (np.sin(phi) * x + 2.0 * np.sin(0.5 * phi) ** 2 * inward)
    return point, np.cos(phi) * x + np.sin(phi) * inward


class Centreline:
    """The chain of cells and what can be asked of it.

    Args:
        cells: Cells in order; each starts where the one before ends, but for a joint's offset and kink.
    """

    def __init__(self, cells: list[Cell]) -> None:
        self.cells = cells
        self.starts = np.array([c.chainage for c in cells])
        self.start, self.end = cells[0].chainage, cells[-1].end
        self.planes = np.array([_mitre(a, b) for a, b in zip(cells, [*cells[1:], None], strict=True)])
        """Unit normal and offset (cells, 4) of the plane that ends each cell: n . p > d lies beyond."""

    def index(self, chainage: np.ndarray | float) -> np.ndarray:
        """Return the cell in which each chainage lies; beyond the ends, the first or last cell."""
        return np.clip(np.searchsorted(self.starts, chainage, side="right") - 1, 0, len(self.cells) - 1)

    def at(self, chainage: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Return the axis point (..., 3) and the local pipe frame (..., 3, 3) at each chainage [m].

        Beyond its ends the pipe's axis is carried on by the first and last cells.
        """
        s = np.asarray(chainage, float)
        flat = s.ravel()
        which = self.index(flat)
        point, tangent = np.empty((flat.size, 3)), np.empty((flat.size, 3))
        for k in np.unique(which):
            rows = which == k
            point[rows], tangent[rows] = along(self.cells[k], flat[rows] - self.cells[k].chainage)
        return point.reshape(*s.shape, 3), level_frame(tangent).reshape(*s.shape, 3, 3)

    def project(self, points: np.ndarray, guess: np.ndarray) -> np.ndarray:
        """Return the chainage [m] (n,) of the section plane that holds each point (n, 3), sought from `guess` (n,).

        At a kink the plane of the cell on whose side of the mitre plane the point lies is taken.
        """
        which = self.find(points, guess)
        out = np.empty(len(points))
        for k in np.unique(which):
            rows = which == k
            cell = self.cells[k]
            local = (points[rows] - cell.origin) @ cell.frame.T
            if cell.curvature == 0.0:
                out[rows] = cell.chainage + local[:, 0]
            else:
                q = np.sin(cell.towards) * local[:, 1] + np.cos(cell.towards) * local[:, 2]
                radius = 1.0 / cell.curvature
                out[rows] = cell.chainage + radius * np.arctan2(local[:, 0], radius - q)
        return out

    def find(self, points: np.ndarray, guess: np.ndarray) -> np.ndarray:
        """Return the cell (n,) between whose mitre planes each point (n, 3) lies, sought from chainage `guess`."""
        which = self.index(guess).copy()
        last = len(self.cells) - 1
        for _ in range(len(self.cells)):
            beyond = np.einsum("ij,ij->i", self.planes[which, :3], points) > self.planes[which, 3]
            ahead = beyond & (which < last)
            before = np.maximum(which - 1, 0)
            short = np.einsum("ij,ij->i", self.planes[before, :3], points) <= self.planes[before, 3]
            behind = short & (which > 0) & ~ahead
            if not (ahead.any() or behind.any()):
                return which
            which = which + ahead - behind
        raise ParameterError("a point lies between no two mitre planes", expected="a pipe that does not fold on itself")


def _mitre(cell: Cell, following: Cell | None) -> np.ndarray:
    point, tangent = along(cell, cell.length)
    normal = tangent if following is None else tangent + following.frame[0]
    normal = normal / np.linalg.norm(normal)
    return np.array([*normal, normal @ point])
