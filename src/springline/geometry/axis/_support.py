"""How well a cylinder explains the points about it, and which way it should go: the kernels of the search."""

from __future__ import annotations

from math import atan2, pi, sqrt

import numpy as np
from numba import njit

_OUTER = 2.0
"""Distance from the axis, in radii, within which a point speaks for or against the wall."""
_SLICE, _SECTORS = 0.15, 60


@njit(cache=True, nogil=True, error_model="numpy")
def support(points, centres, directions, radii, ovals, window, tolerance, least_arc, score, share):
    """Score cylinders by the area of wall that the points show on them, in place.

    The stretch of each cylinder is divided into cells of 0.15 radii by 6 degrees. A cell is seen when a point lies in
    it, from the axis out to two radii, and wall when at least half of its points lie within `tolerance` radii of the
    cylinder. The score is the number of wall cells times their share among those seen, so that a huge or a tiny
    cylinder that merely touches a plane loses against a pipe, whatever the density of the points. Wall over fewer
    sectors than `least_arc` scores nothing: any smooth patch lies on some cylinder.

    Args:
        points: (point, 3).
        centres: (hypothesis, 3) a point on each axis, in the middle of its stretch.
        directions: (hypothesis, 3) unit vectors.
        radii: (hypothesis,).
        ovals: (hypothesis, 3) as `Cylinder.oval`.
        window: Half length of the stretch that a cylinder answers for, in radii.
        tolerance: Half thickness of the wall, in radii.
        least_arc: Sectors of 6 degrees.
        score: (hypothesis,) filled with the score.
        share: (hypothesis,) filled with the share of wall among the cells seen.
    """
    slices = int(2.0 * window / _SLICE) + 1
    seen = np.empty(slices * _SECTORS, np.int64)
    near = np.empty(slices * _SECTORS, np.int64)
    for h in range(radii.size):
        seen[:] = 0
        near[:] = 0
        ax, ay, az = directions[h, 0], directions[h, 1], directions[h, 2]
        ux, uy, uz, vx, vy, vz = across(ax, ay, az)
        r = radii[h]
        ox, oy, oz = ovals[h, 0], ovals[h, 1], ovals[h, 2]
        amplitude = ox * ox + oy * oy + oz * oz
        for i in range(points.shape[0]):
            dx = points[i, 0] - centres[h, 0]
            dy = points[i, 1] - centres[h, 1]
            dz = points[i, 2] - centres[h, 2]
            along = (dx * ax + dy * ay + dz * az) / r
            if abs(along) >= window:
                continue
            p = (dx * ux + dy * uy + dz * uz) / r
            q = (dx * vx + dy * vy + dz * vz) / r
            rho = sqrt(p * p + q * q)
            if rho > _OUTER:
                continue
            wall_at = 1.0
            if amplitude > 0.0 and rho > 0.0:
                toward = (dx * ox + dy * oy + dz * oz) / (r * rho)
                wall_at += 2.0 * toward * toward - amplitude
            slice_ = int((along + window) / _SLICE)
            sector = min(int((atan2(q, p) + pi) * (_SECTORS / (2.0 * pi))), _SECTORS - 1)
            cell = slice_ * _SECTORS + sector
            seen[cell] += 1
            if abs(rho - wall_at) < tolerance:
                near[cell] += 1
        cells = 0
        wall = 0
        arc = 0
        for sector in range(_SECTORS):
            wall_before = wall
            for cell in range(sector, slices * _SECTORS, _SECTORS):
                if seen[cell] > 0:
                    cells += 1
                    if 2 * near[cell] >= seen[cell]:
                        wall += 1
            if wall > wall_before:
                arc += 1
        share[h] = wall / cells if cells > 0 else 0.0
        score[h] = wall * share[h] if arc >= least_arc else 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def gather(points, centre, direction, radius, oval, window, gate, normal, target):
    """Fill the normal equations of a cylinder's step: radius, shift, tilt and oval in two directions across it.

    Args:
        points: (point, 3).
        centre: (3,) a point on the axis, in the middle of the stretch that counts.
        direction: (3,) unit vector.
        radius: The cylinder's.
        oval: (2,) its oval_cos and oval_sin in those directions, in radii.
        window: Half length of the stretch, in radii.
        gate: Points further from the wall than this, in radii, do not count.
        normal: (7, 7) filled; in units of the radius.
        target: (7,) filled.

    Returns:
        How many points count.
    """
    ax, ay, az = direction
    ux, uy, uz, vx, vy, vz = across(ax, ay, az)
    normal[:] = 0.0
    target[:] = 0.0
    row = np.empty(7)
    row[0] = 1.0
    count = 0
    for i in range(points.shape[0]):
        dx = (points[i, 0] - centre[0]) / radius
        dy = (points[i, 1] - centre[1]) / radius
        dz = (points[i, 2] - centre[2]) / radius
        along = dx * ax + dy * ay + dz * az
        if abs(along) >= window:
            continue
        p = dx * ux + dy * uy + dz * uz
        q = dx * vx + dy * vy + dz * vz
        rho = sqrt(p * p + q * q)
        if rho == 0.0:
            continue
        cos, sin = p / rho, q / rho
        row[5], row[6] = cos * cos - sin * sin, 2.0 * cos * sin
        misfit = rho - 1.0 - oval[0] * row[5] - oval[1] * row[6]
        if abs(misfit) >= gate:
            continue
        count += 1
        weight = (1.0 - (misfit / gate) ** 2) ** 2
        row[1], row[2] = cos, sin
        row[3], row[4] = along * row[1], along * row[2]
        for j in range(7):
            target[j] += weight * row[j] * misfit
            for k in range(j + 1):
                normal[j, k] += weight * row[j] * row[k]
    for j in range(7):
        for k in range(j):
            normal[k, j] = normal[j, k]
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def across(ax, ay, az):
    """Return two unit vectors at right angles to a unit vector and to each other."""
    if abs(ax) <= abs(ay) and abs(ax) <= abs(az):
        ux, uy, uz = 0.0, az, -ay
    elif abs(ay) <= abs(az):
        ux, uy, uz = -az, 0.0, ax
    else:
        ux, uy, uz = ay, -ax, 0.0
    size = sqrt(ux * ux + uy * uy + uz * uz)
    ux, uy, uz = ux / size, uy / size, uz / size
    return ux, uy, uz, ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux
