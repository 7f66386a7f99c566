"""A circular cylinder through points: robust, by orthogonal distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

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


def across(direction: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two unit vectors u, v at right angles to a unit vector, so that (direction, u, v) is right-handed.

    >>> u, v = across(np.array([1.0, 0.0, 0.0]))
    >>> np.cross(u, v) + 0.0
    array([1., 0., 0.])
    """
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    u = np.cross(direction, helper)
    u /= np.linalg.norm(u)
    return u, np.cross(direction, u)


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
    point, direction, radius = start.point, start.direction, start.radius
    for gate in _GATES:
        for _ in range(steps):
            u, v = across(direction)
            offset = points - point
            along = offset @ direction
            p, q = offset @ u, offset @ v
            rho = np.hypot(p, q)
            near = (np.abs(along) < window * radius) & (np.abs(rho - radius) < gate * radius) & (rho > 0)
            if near.sum() < 12:
                return None
            along, p, q, rho = along[near] / radius, p[near], q[near], rho[near]
            misfit = rho - radius
            weight = (1.0 - (misfit / (gate * radius)) ** 2) ** 2
            cos, sin = p / rho, q / rho
            model = np.column_stack([np.ones_like(cos), cos, sin, along * cos, along * sin])
            normal = (model * weight[:, None]).T @ model
            # The slightest damping keeps arcs that do not fix the centre from blowing up.
            normal[np.diag_indices(5)] += 1e-6 * np.trace(normal)
            step = np.linalg.solve(normal, (model * weight[:, None]).T @ misfit)
            if not np.all(np.isfinite(step)) or np.abs(step).max() > radius:
                return None
            tilt = (step[3] * u + step[4] * v) / radius
            point = point + step[1] * u + step[2] * v
            direction = direction + tilt
            direction = direction / np.linalg.norm(direction)
            radius = float(radius + step[0])
            if not 0.2 * start.radius < radius < 5.0 * start.radius:
                return None
    return Cylinder(point, direction, radius)
