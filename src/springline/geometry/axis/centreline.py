"""The centreline of a pipe, straight or curved, and where points lie about it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from scipy.interpolate import CubicSpline

_BLOCK = 500_000
_STEEP = 0.9
"""A pipe whose direction has a larger share of the vertical than this is a shaft: 26 degrees from the vertical."""
_NEWTON = 4


class Placed(NamedTuple):
    """Points about a centreline.

    Attributes:
        along: (point,) distance along the centreline from its beginning [m]; negative before it.
        y: (point,) up from the axis, in the section [m].
        z: (point,) to the right of the axis, in the section [m].
    """

    along: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Centreline:
    """A pipe's centreline in the frame of a cloud: x forward, y up, z to the right.

    The pipe frame at each place has x along the centreline, y in the vertical plane through it and z level, so that
    the bearing of the crown is pi/2. In a shaft, where the vertical tells nothing, the cloud's x takes its place.

    Attributes:
        nodes: (node, 3) places along it, forward; two for a straight one [m].

    >>> line = Centreline(np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]))
    >>> line.place(np.array([[0.5, 0.1, -0.2]]))
    Placed(along=array([0.5]), y=array([0.1]), z=array([-0.2]))
    """

    nodes: NDArray[np.float64]

    @property
    def straight(self) -> bool:
        """Whether it is one straight line."""
        return len(self.nodes) == 2

    @property
    def length(self) -> float:
        """From the first node to the last [m]."""
        return float(self._curve.x[-1])

    @cached_property
    def _curve(self) -> CubicSpline:
        """The curve by arc length: a spline through the nodes, measured finely and drawn anew."""
        from scipy.interpolate import CubicSpline

        nodes = self.nodes
        for _ in range(3):
            chords = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1)))
            if self.straight:
                return CubicSpline(chords, nodes)
            draft = CubicSpline(chords, nodes)
            fine = np.linspace(0.0, chords[-1], 16 * len(nodes))
            run = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(draft(fine), axis=0), axis=1)))
            nodes = draft(np.interp(np.linspace(0.0, run[-1], len(nodes)), run, fine))
        return CubicSpline(np.linspace(0.0, run[-1], len(nodes)), nodes)

    def at(self, along: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return places (n, 3) at distances (n,) along it; beyond its ends it goes on straight."""
        inside = np.clip(along, 0.0, self.length)
        return self._curve(inside) + (along - inside)[:, None] * self.direction(inside)

    def direction(self, along: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return unit vectors (n, 3) along it, forward, at distances (n,)."""
        tangent = self._curve(np.clip(along, 0.0, self.length), 1)
        return tangent / np.linalg.norm(tangent, axis=-1, keepdims=True)

    def frames(self, along: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return pipe frames (n, 3, 3) at distances (n,); the rows are the pipe's x, y and z in the cloud's frame."""
        x = self.direction(along)
        y = self._up - (x @ self._up)[:, None] * x
        y /= np.linalg.norm(y, axis=1, keepdims=True)
        return np.stack([x, y, np.cross(x, y)], axis=1)

    @cached_property
    def _up(self) -> NDArray[np.float64]:
        overall = self.nodes[-1] - self.nodes[0]
        steep = abs(overall[1]) > _STEEP * np.linalg.norm(overall)
        return np.array([1.0, 0.0, 0.0]) if steep else np.array([0.0, 1.0, 0.0])

    def place(self, points: NDArray[np.float64]) -> Placed:
        """Return where points (n, 3) lie about the centreline: at the foot of their perpendicular to it."""
        parts = list(self._place(points))
        return Placed(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def _place(self, points: NDArray) -> Iterator[tuple[NDArray, NDArray, NDArray]]:
        if self.straight:
            start, frame = self.nodes[0], self.frames(np.zeros(1))[0]
            offset = (points - start) @ frame.T
            yield offset[:, 0], offset[:, 1], offset[:, 2]
            return
        from scipy.spatial import cKDTree

        stations = np.linspace(0.0, self.length, max(64, 8 * len(self.nodes)))
        tree = cKDTree(self.at(stations))
        for start in range(0, len(points), _BLOCK):
            block = points[start : start + _BLOCK]
            along = stations[tree.query(block)[1]]
            for _ in range(_NEWTON):
                # One step along the tangent; exact when straight, and contracts inside the radius of curvature.
                along = along + np.einsum("ij,ij->i", block - self.at(along), self.direction(along))
            offset = np.einsum("nij,nj->ni", self.frames(along), block - self.at(along))
            yield along, offset[:, 1], offset[:, 2]

    def turned(self) -> Centreline:
        """Return it run the other way."""
        return Centreline(self.nodes[::-1].copy())
