"""A cylinder through points: robust, by orthogonal distance."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.axis._support import across, gather

if TYPE_CHECKING:
    from numpy.typing import NDArray

WINDOW = 3.0
"""Half length of the stretch that a cylinder answers for while searching [radii]: a bend is straight over so little."""
_GATES = (0.3, 0.2, 0.12, 0.08, 0.08)
"""Readings further from the wall than this, in radii, do not count; the gate closes while the cylinder settles."""
_MOST_OVAL = 0.2
"""Half the difference of the semi-axes beyond which a section is no deformed circle, in radii."""


@dataclass(frozen=True)
class Cylinder:
    """A cylinder, circular or slightly oval.

    Attributes:
        point: (3,) a point on its axis, in the middle of what it describes.
        direction: (3,) unit vector along its axis.
        radius: Its mean radius, in the unit of the point.
        oval: (3,) vector along the major axis of its section; its squared length is half the difference of the
            semi-axes over the mean radius, 0 for a circle.
    """

    point: NDArray[np.float64]
    direction: NDArray[np.float64]
    radius: float
    oval: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))


def refine(
    points: NDArray[np.float64], start: Cylinder, *, window: float = WINDOW, oval: bool = False, steps: int = 4
) -> Cylinder | None:
    """Return the cylinder that fits the points near `start` best, or None when it runs away.

    Gauss-Newton on the orthogonal distances of the points in the window along the axis, with Tukey weights whose gate
    closes from 0.3 to 0.08 radii. The axis may tilt and shift; the stretch stays where it is.

    Args:
        points: (point, 3), evenly spread over the surface.
        start: Where to begin.
        window: Half length of the stretch that counts, in radii.
        oval: Whether the section may be oval.
        steps: Gauss-Newton steps per gate.
    """
    point, direction, radius = start.point, start.direction, float(start.radius)
    points = np.ascontiguousarray(points, dtype=np.float64)
    normal, target, shape = np.empty((7, 7)), np.empty(7), np.zeros(2)
    free = 7 if oval else 5
    for gate in _GATES:
        for _ in range(steps):
            if gather(points, point, direction, radius, shape, window, gate, normal, target) < 12:
                return None
            # The slightest damping keeps arcs that do not fix the centre from blowing up.
            normal[np.diag_indices(7)] += 1e-6 * np.trace(normal)
            step = np.linalg.solve(normal[:free, :free], target[:free])
            if not np.all(np.isfinite(step)) or np.abs(step).max() > 1.0:
                return None
            u, v = np.array(across(*direction)).reshape(2, 3)
            major = _major(shape + step[5:] if oval else shape, u, v)
            point = point + radius * (step[1] * u + step[2] * v)
            direction = direction + step[3] * u + step[4] * v
            direction = direction / np.linalg.norm(direction)
            radius = float(radius * (1.0 + step[0]))
            u, v = np.array(across(*direction)).reshape(2, 3)
            # The directions across the axis turn with it, at times by a jump: the oval is told anew in them.
            shape = np.array([(major @ u) ** 2 - (major @ v) ** 2, 2.0 * (major @ u) * (major @ v)])
            if not 0.2 * start.radius < radius < 5.0 * start.radius or np.hypot(*shape) > _MOST_OVAL:
                return None
    return Cylinder(point, direction, radius, _major(shape, u, v))


def _major(shape: NDArray, u: NDArray, v: NDArray) -> NDArray[np.float64]:
    """Return the vector along the major axis that stands for oval_cos, oval_sin in the directions u, v."""
    half = 0.5 * np.arctan2(shape[1], shape[0])
    return np.sqrt(np.hypot(*shape)) * (np.cos(half) * u + np.sin(half) * v)
