"""A circular cylinder through points: robust, by orthogonal distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.axis._support import across, gather

if TYPE_CHECKING:
    from numpy.typing import NDArray

WINDOW = 3.0
"""Half length of the stretch that a cylinder answers for while searching [radii]: a bend is straight over so little."""
_GATES = (0.3, 0.2, 0.12, 0.08, 0.08)
"""Readings further from the wall than this, in radii, do not count; the gate closes while the cylinder settles."""


@dataclass(frozen=True)
class Cylinder:
    """A circular cylinder.

    Attributes:
        point: (3,) a point on its axis, in the middle of what it describes.
        direction: (3,) unit vector along its axis.
        radius: Its radius, in the unit of the point.
    """

    point: NDArray[np.float64]
    direction: NDArray[np.float64]
    radius: float


def refine(points: NDArray[np.float64], start: Cylinder, *, window: float = WINDOW, steps: int = 4) -> Cylinder | None:
    """Return the cylinder that fits the points near `start` best, or None when it runs away.

    Gauss-Newton on the orthogonal distances of the points in the window along the axis, with Tukey weights whose gate
    closes from 0.3 to 0.08 radii. The axis may tilt and shift; the stretch stays where it is.

    Args:
        points: (point, 3), evenly spread over the surface.
        start: Where to begin.
        window: Half length of the stretch that counts, in radii.
        steps: Gauss-Newton steps per gate.
    """
    point, direction, radius = start.point, start.direction, float(start.radius)
    points = np.ascontiguousarray(points, dtype=np.float64)
    normal, target = np.empty((5, 5)), np.empty(5)
    for gate in _GATES:
        for _ in range(steps):
            if gather(points, point, direction, radius, window, gate, normal, target) < 12:
                return None
            # The slightest damping keeps arcs that do not fix the centre from blowing up.
            normal[np.diag_indices(5)] += 1e-6 * np.trace(normal)
            step = np.linalg.solve(normal, target)
            if not np.all(np.isfinite(step)) or np.abs(step).max() > 1.0:
                return None
            u, v = np.array(across(*direction)).reshape(2, 3)
            point = point + radius * (step[1] * u + step[2] * v)
            direction = direction + step[3] * u + step[4] * v
            direction = direction / np.linalg.norm(direction)
            radius = float(radius * (1.0 + step[0]))
            if not 0.2 * start.radius < radius < 5.0 * start.radius:
                return None
    return Cylinder(point, direction, radius)
