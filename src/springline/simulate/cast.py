"""Rays cast on the true wall: the first thing each ray meets, to the rounding of double precision.

A ray marches through the cells of the pipe. Each step is the gap to the wall divided by a bound on the wall's slope, so
that no inward feature is stepped through; close to the wall a bracketed secant finishes. Where it crosses into the
next cell outside that cell's bore it has met the face of a joint.
"""

from __future__ import annotations

from math import atan2, sqrt

import numpy as np
from numba import njit, prange

from .kernels import inner
from .surface import wall_at
from .wall import JOINT, LATERAL, NOTHING, Wall

_STEPS = 20000
_CLOSE = 0.003
_LEAP = 0.01
_TINY = 1e-13

EXACT = 1e-16
"""How far from the wall a ring's reading may lie [m]."""

SECTION, FACE = -1, -2
"""Which part of the pipe a ray met: the wall of its cell, or the face with which a cell begins; from 0 on, the lateral
of that number."""


@inner
def locate(cells, cell, px, py, pz):
    """Return chainage and the levelled section coordinates y, z of an Earth point, in one cell."""
    row = cells[cell]
    dx, dy, dz = px - row.origin[0], py - row.origin[1], pz - row.origin[2]
    x = row.x[0] * dx + row.x[1] * dy + row.x[2] * dz
    y = row.y[0] * dx + row.y[1] * dy + row.y[2] * dz
    z = row.z[0] * dx + row.z[1] * dy + row.z[2] * dz
    k = row.curvature
    if k == 0.0:
        return row.chainage + x, y, z
    ey, ez = row.inward_y, row.inward_z
    q, w = ey * y + ez * z, ez * y - ey * z
    # sqrt((R - q)2 + x2) - R without the cancellation of a large R.
    t = k * (q * q + x * x) - 2.0 * q
    root = sqrt(1.0 + k * t)
    q_here = -t / (1.0 + root)
    chainage = row.chainage + atan2(k * x, 1.0 - k * q) / k
    co, si = (1.0 - k * q) / root, k * x / root
    y, z = q_here * ey + w * ez, q_here * ez - w * ey
    # The section stays level: turn from the frame carried along the arc to the one whose y is in the vertical plane.
    inward_up = -si * row.x[2] + co * (ey * row.y[2] + ez * row.z[2])
    across_up = ez * row.y[2] - ey * row.z[2]
    up_y, up_z = ey * inward_up + ez * across_up, ez * inward_up - ey * across_up
    n = sqrt(up_y * up_y + up_z * up_z)
    return chainage, (y * up_y + z * up_z) / n, (z * up_y - y * up_z) / n


@inner
def gap_at(wall, cell, ox, oy, oz, dx, dy, dz, t):
    """Return how far outside (+) or inside (-) the wall the ray's point at t lies, what is there, and its chainage."""
    x, y, z = locate(wall.cells, cell, ox + t * dx, oy + t * dy, oz + t * dz)
    h = sqrt(y * y + z * z)
    rho, kind = wall_at(wall, cell, x, y, z, h)
    return h - rho, kind, x


@inner
def _speeds(wall, cell, ray):
    """Return how fast the gap can close along a ray, how fast it does where the wall is plain, and the longest leap.

    In a straight cell a ray nearly along the axis nears the wall as slowly as it goes sideways; only what varies along
    the pipe can come towards it faster.
    """
    row = wall.cells[cell]
    sideways, ahead = 1.0, 1.0
    if row.curvature == 0.0:
        ahead = abs(ray[3] * row.x[0] + ray[4] * row.x[1] + ray[5] * row.x[2])
        sideways = sqrt(max(1.0 - ahead * ahead, 1e-18))
    return sideways * row.around + ahead * row.ahead, sideways, np.inf if row.ahead == 0.0 else _LEAP


@inner
def _first_root(wall, cell, ray, near, far, gap, exact):
    """Return where the ray meets the wall between `near` (inside, gap < 0) and `far`, or inf."""
    ox, oy, oz, dx, dy, dz = ray
    fastest, plain, leap = _speeds(wall, cell, ray)
    t = near
    for _ in range(_STEPS):
        step = -gap / fastest
        if -gap < _CLOSE:
            step = max(min(-1.2 * gap / plain, leap), step, 1e-9)
        t_next = min(t + step, far)
        gap_next, _, _ = gap_at(wall, cell, ox, oy, oz, dx, dy, dz, t_next)
        if gap_next >= 0.0:
            return _close_in(wall, cell, ray, t, t_next, gap, gap_next, exact)
        if t_next == far:
            return np.inf
        t, gap = t_next, gap_next
    return np.inf


@inner
def _close_in(wall, cell, ray, a, b, fa, fb, exact):
    """Return the root between a (fa < 0) and b (fb >= 0): Illinois, then bisection when it stalls."""
    ox, oy, oz, dx, dy, dz = ray
    side = 0
    for k in range(100):
        if fb == 0.0 or b - a <= _TINY:
            break
        m = (a * fb - b * fa) / (fb - fa) if k < 40 else 0.5 * (a + b)
        if not a < m < b:
            m = 0.5 * (a + b)
        fm, _, _ = gap_at(wall, cell, ox, oy, oz, dx, dy, dz, m)
        if fm >= 0.0:
            b, fb = m, fm
            if side == 1:
                fa *= 0.5
            side = 1
            if fm < exact:
                break
        else:
            a, fa = m, fm
            if side == -1:
                fb *= 0.5
            side = -1
            if fm > -exact:
                return m
    return b


@inner
def _plane(cells, cell, ray):
    """Return where the ray crosses a cell's end plane and whether it goes forward through it."""
    ox, oy, oz, dx, dy, dz = ray
    nx, ny, nz, d = cells[cell].plane[0], cells[cell].plane[1], cells[cell].plane[2], cells[cell].plane[3]
    speed = nx * dx + ny * dy + nz * dz
    if speed == 0.0:
        return np.inf, True
    return (d - nx * ox - ny * oy - nz * oz) / speed, speed > 0.0


@inner
def _tube(row, ray, t_wall, limit):
    """Return the first hit of a lateral's tube at or before `limit`, given that the bare wall is met at t_wall.

    inf = the ray misses it; -1 = the ray goes out through the opening and is not seen again.
    """
    ox, oy, oz = ray[0] - row.mouth[0], ray[1] - row.mouth[1], ray[2] - row.mouth[2]
    dx, dy, dz = ray[3], ray[4], ray[5]
    w0 = ox * row.axis[0] + oy * row.axis[1] + oz * row.axis[2]
    dw = dx * row.axis[0] + dy * row.axis[1] + dz * row.axis[2]
    ax, ay, az = ox - w0 * row.axis[0], oy - w0 * row.axis[1], oz - w0 * row.axis[2]
    bx, by, bz = dx - dw * row.axis[0], dy - dw * row.axis[1], dz - dw * row.axis[2]
    # A ray along the tube's own axis is taken as one that meets its wall far away.
    a = max(bx * bx + by * by + bz * bz, 1e-24)
    b = ax * bx + ay * by + az * bz
    r2 = ax * ax + ay * ay + az * az
    outer = b * b - a * (r2 - row.outer * row.outer)
    if outer <= 0.0:
        return np.inf
    inner = b * b - a * (r2 - row.inner * row.inner)
    out_a, out_b = (-b - sqrt(outer)) / a, (-b + sqrt(outer)) / a
    in_a, in_b = np.inf, -np.inf
    if inner > 0.0:
        in_a, in_b = (-b - sqrt(inner)) / a, (-b + sqrt(inner)) / a
    opening = in_a < t_wall < in_b and w0 + t_wall * dw > row.start - row.inner
    # The tube's own material before the wall: only the stub that stands into the pipe.
    if row.start < 0.0:
        t = max(out_a, 1e-12)
        w = w0 + t * dw
        if w < row.start:
            t = (row.start - w0) / dw if dw > 0.0 else np.inf
        if in_a <= t < in_b:
            t = in_b
        if t <= out_b and t < t_wall and w0 + t * dw >= row.start - 1e-12:
            return t if t <= limit else -1.0
    if not opening:
        return np.inf
    if w0 + in_b * dw > row.end or in_b > limit:
        return -1.0
    return in_b


@inner
def cast_one(wall, start_cell, ray, limit, exact):
    """Return range, kind, chainage, cell and part of the first thing one ray meets; range NaN where it meets nothing.

    `ray` is origin and unit direction, six numbers; part is `SECTION`, `FACE` or the number of a lateral; `exact` is
    how far from the wall [m] a hit may lie.
    """
    cell = start_cell
    last = wall.cells.shape[0] - 1
    t, hit, kind, chainage, part = 0.0, np.inf, NOTHING, np.nan, SECTION
    entered = False
    while True:
        gap, _, x = gap_at(wall, cell, ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], t)
        if gap >= 0.0:
            if entered:
                hit, kind, chainage, part = t, JOINT, x, FACE
            break
        ahead, forward = _plane(wall.cells, cell, ray)
        if not (forward and ahead >= t):
            ahead = np.inf
        behind = np.inf
        if cell > 0:
            behind, forward_there = _plane(wall.cells, cell - 1, ray)
            if forward_there or behind < t:
                behind = np.inf
        far = min(ahead, behind, limit)
        t_hit = _first_root(wall, cell, ray, t, far, gap, exact)
        if t_hit < np.inf:
            hit = t_hit
            _, kind, chainage = gap_at(wall, cell, ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], hit)
            break
        if far == limit:
            break
        cell += 1 if ahead <= behind else -1
        if cell > last:
            break
        t, entered = far, True
    for k in range(wall.laterals.shape[0]):
        row = wall.laterals[k]
        # A tube farther away than the ray can reach is passed over.
        away = sqrt((row.mouth[0] - ray[0]) ** 2 + (row.mouth[1] - ray[1]) ** 2 + (row.mouth[2] - ray[2]) ** 2)
        if away - row.outer - row.end > min(hit, limit) + row.end:
            continue
        tube = _tube(row, ray, hit, limit)
        if tube == -1.0:
            return np.nan, NOTHING, chainage, cell, part
        if tube < np.inf:
            return tube, LATERAL, row.chainage, cell, k
    if hit > limit:
        return np.nan, NOTHING, np.nan, cell, part
    return hit, kind, chainage, min(cell, last), part


@njit(cache=True, parallel=True)
def cast_rays(wall: Wall, origin, cell, direction, limit):
    """Return range [m], kind and chainage [m] (rings, rays) of what each ray meets first.

    Args:
        wall: Arrays of `wall.build`.
        origin: Ray origins (rings, 3), east, north, up [m], inside the pipe.
        cell: Cell (rings,) in which each origin lies, from `Centreline.find`.
        direction: Unit directions (rings, rays, 3), east, north, up.
        limit: Longest range [m]; beyond it there is no return (NaN).
    """
    rings, rays = direction.shape[0], direction.shape[1]
    reach = np.empty((rings, rays))
    kind = np.empty((rings, rays), np.uint8)
    chainage = np.empty((rings, rays))
    for i in prange(rings):
        for j in range(rays):
            ray = (
                origin[i, 0], origin[i, 1], origin[i, 2], direction[i, j, 0], direction[i, j, 1], direction[i, j, 2],
            )  # fmt: skip
            reach[i, j], kind[i, j], chainage[i, j], _, _ = cast_one(wall, cell[i], ray, limit, EXACT)
    return reach, kind, chainage
