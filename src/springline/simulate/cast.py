"""Rays cast on the true wall: the first thing each ray meets, to the rounding of double precision.

A ray marches through the cells of the pipe. Each step is the gap to the wall divided by a bound on the wall's slope, so
that no inward feature is stepped through; close to the wall a bracketed secant finishes. Where it crosses into the
next cell outside that cell's bore it has met the face of a joint.
"""

from __future__ import annotations

from math import atan2, cos, floor, pi, sin, sqrt

import numpy as np
from numba import njit, prange

from .wall import (
    BED,
    BUMP,
    DENT,
    FLOOR,
    JOINT,
    LATERAL,
    NOTHING,
    WALL,
    WATER,
    Wall,
)

__all__ = ["BED", "DENT", "WATER", "cast_rays", "radius_of_wall"]

_STEPS = 2000
_CLOSE = 0.003
_TINY = 1e-13


@njit(cache=True, inline="always")
def _section(pieces, theta, c, s):
    """Return the radius of one section at bearing theta in [0, 2 pi), whose cosine and sine are c and s."""
    k = 0
    while k + 1 < pieces.shape[0] and pieces[k + 1, 0] <= theta:
        k += 1
    p = pieces[k, 1] * c * c + pieces[k, 2] * c * s + pieces[k, 3] * s * s
    q = pieces[k, 4] * c + pieces[k, 5] * s
    root = sqrt(max(q * q - 4.0 * p * pieces[k, 6], 0.0))
    if q > 0.0:
        return -2.0 * pieces[k, 6] / (q + root)
    return (root - q) / (2.0 * p)


@njit(cache=True)
def _lattice(i, j, seed):
    """Return a number of unit variance, always the same at one lattice point: splitmix64 of its indices."""
    h = np.uint64(i) * np.uint64(0x9E3779B97F4A7C15) ^ np.uint64(j) * np.uint64(0xC2B2AE3D27D4EB4F) ^ seed
    h = (h ^ (h >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    h = (h ^ (h >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    h = h ^ (h >> np.uint64(31))
    return (float(h >> np.uint64(11)) / 9007199254740992.0 - 0.5) * sqrt(12.0)


@njit(cache=True)
def _relief(x, theta, roughness, seed):
    """Return the wall's roughness [m]: a cubic B-spline over random lattice values, periodic in bearing."""
    around = int(roughness[2])
    u, v = x / roughness[1], theta * around / (2.0 * pi)
    i, j = floor(u), floor(v)
    fu, fv = u - i, v - j
    wu = np.empty(4)
    wv = np.empty(4)
    for w, f in ((wu, fu), (wv, fv)):
        w[0] = (1.0 - f) ** 3 / 6.0
        w[1] = (3.0 * f**3 - 6.0 * f**2 + 4.0) / 6.0
        w[2] = (-3.0 * f**3 + 3.0 * f**2 + 3.0 * f + 1.0) / 6.0
        w[3] = f**3 / 6.0
    total = 0.0
    for a in range(4):
        for b in range(4):
            total += wu[a] * wv[b] * _lattice(i + a - 1, (j + b - 1) % around, seed)
    # 151/315 is the mean of the squared weights along one direction: it restores the stated rms.
    return roughness[0] * total / (151.0 / 315.0)


@njit(cache=True, inline="always")
def _window(u):
    """Return 1 at u = 0 falling to 0, with its slope, at |u| = 1."""
    return cos(0.5 * pi * u) ** 2 if abs(u) < 1.0 else 0.0


@njit(cache=True, inline="always")
def _ramp(x, start, end, ramp):
    """Return 1 between start and end, smoothly down to 0 over `ramp` inside both ends."""
    if x <= start or x >= end:
        return 0.0
    d = min(x - start, end - x)
    if d >= ramp:
        return 1.0
    u = d / ramp
    return u * u * (3.0 - 2.0 * u)


@njit(cache=True)
def _bare(wall, cell, x, theta, c, s):
    """Return the radius of the section alone, blended between its knots, with its harmonics."""
    first, count = wall.knots[cell, 0], wall.knots[cell, 1]
    k, w = 0, 0.0
    if count > 1:
        u = (x - wall.cells[cell, 12]) / wall.cells[cell, 18]
        k = min(max(floor(u), 0), count - 2)
        w = min(max(u - k, 0.0), 1.0)
    rho = _section(wall.pieces[first + k], theta, c, s)
    if w > 0.0:
        rho += w * (_section(wall.pieces[first + k + 1], theta, c, s) - rho)
    for n in range(wall.orders.shape[0]):
        a, b = wall.harmonics[first + k, n, 0], wall.harmonics[first + k, n, 1]
        if w > 0.0:
            a += w * (wall.harmonics[first + k + 1, n, 0] - a)
            b += w * (wall.harmonics[first + k + 1, n, 1] - b)
        rho += a * cos(wall.orders[n] * theta) + b * sin(wall.orders[n] * theta)
    return rho


@njit(cache=True)
def _radius(wall, cell, x, y, z, h):
    """Return the wall's radius and kind at chainage x in the direction of (z, y), whose length is h."""
    if h == 0.0:
        c, s, theta = 1.0, 0.0, 0.0
    else:
        c, s = z / h, y / h
        theta = atan2(y, z)
        if theta < 0.0:
            theta += 2.0 * pi
            if theta >= 2.0 * pi:
                theta = 0.0
    rho = _bare(wall, cell, x, theta, c, s)
    kind = WALL
    if wall.cells[cell, 24] != 0.0:
        kind = JOINT
        rho += wall.cells[cell, 17]
    if wall.roughness[0] > 0.0:
        rho += _relief(x, theta, wall.roughness, wall.seed)
    for n in range(wall.feature_from[cell], wall.feature_from[cell + 1]):
        row = wall.features[wall.feature_of[n]]
        if x <= row[1] or x >= row[2]:
            continue
        if row[0] == FLOOR:
            if s < 0.0:
                level = _ramp(x, row[1], row[2], row[7]) * row[6] - _bare(wall, cell, x, 1.5 * pi, 0.0, -1.0)
                if rho * s < level:
                    rho = level / s
                    kind = int(row[3])
            continue
        turn = theta - row[4]
        turn -= 2.0 * pi * floor(turn / (2.0 * pi) + 0.5)
        if abs(turn) >= row[5]:
            continue
        if row[0] == BUMP:
            drop = row[6] * _window(turn / row[5]) * _window((x - 0.5 * (row[1] + row[2])) / (0.5 * (row[2] - row[1])))
            if drop > 0.0:
                kind = int(row[3])
        else:
            drop = row[6] * cos(0.5 * pi * turn / row[5]) ** row[8] * _ramp(x, row[1], row[2], row[7])
        rho -= drop
    return rho, kind


@njit(cache=True, inline="always")
def _locate(cells, cell, px, py, pz):
    """Return chainage and the levelled section coordinates y, z of an Earth point, in one cell."""
    row = cells[cell]
    dx, dy, dz = px - row[0], py - row[1], pz - row[2]
    x = row[3] * dx + row[4] * dy + row[5] * dz
    y = row[6] * dx + row[7] * dy + row[8] * dz
    z = row[9] * dx + row[10] * dy + row[11] * dz
    k = row[14]
    if k == 0.0:
        return row[12] + x, y, z
    ey, ez = row[15], row[16]
    q, w = ey * y + ez * z, ez * y - ey * z
    # sqrt((R - q)2 + x2) - R without the cancellation of a large R.
    t = k * (q * q + x * x) - 2.0 * q
    root = sqrt(1.0 + k * t)
    q_here = -t / (1.0 + root)
    chainage = row[12] + atan2(k * x, 1.0 - k * q) / k
    co, si = (1.0 - k * q) / root, k * x / root
    y, z = q_here * ey + w * ez, q_here * ez - w * ey
    # The section stays level: turn from the frame carried along the arc to the one whose y is in the vertical plane.
    inward_up = -si * row[5] + co * (ey * row[8] + ez * row[11])
    across_up = ez * row[8] - ey * row[11]
    up_y, up_z = ey * inward_up + ez * across_up, ez * inward_up - ey * across_up
    n = sqrt(up_y * up_y + up_z * up_z)
    return chainage, (y * up_y + z * up_z) / n, (z * up_y - y * up_z) / n


@njit(cache=True)
def _gap(wall, cell, ox, oy, oz, dx, dy, dz, t):
    """Return how far outside (+) or inside (-) the wall the ray's point at t lies, what is there, and its chainage."""
    x, y, z = _locate(wall.cells, cell, ox + t * dx, oy + t * dy, oz + t * dz)
    h = sqrt(y * y + z * z)
    rho, kind = _radius(wall, cell, x, y, z, h)
    return h - rho, kind, x


@njit(cache=True)
def _first_root(wall, cell, ray, near, far, gap):
    """Return where the ray meets the wall between `near` (inside, gap < 0) and `far`, or inf."""
    ox, oy, oz, dx, dy, dz = ray
    divisor = wall.cells[cell, 19]
    t = near
    for _ in range(_STEPS):
        step = -gap / divisor
        close = -gap < _CLOSE
        t_next = t + step if not close else t + max(-1.5 * gap, 1e-9)
        if t_next >= far:
            t_next = far
        gap_next, _, _ = _gap(wall, cell, ox, oy, oz, dx, dy, dz, t_next)
        if gap_next >= 0.0:
            return _close_in(wall, cell, ray, t, t_next, gap, gap_next)
        if t_next == far:
            return np.inf
        t, gap = t_next, gap_next
    return np.inf


@njit(cache=True)
def _close_in(wall, cell, ray, a, b, fa, fb):
    """Return the root between a (fa < 0) and b (fb >= 0): Illinois, then bisection when it stalls."""
    ox, oy, oz, dx, dy, dz = ray
    side = 0
    for k in range(100):
        if fb == 0.0 or b - a <= _TINY:
            break
        m = (a * fb - b * fa) / (fb - fa) if k < 40 else 0.5 * (a + b)
        if not a < m < b:
            m = 0.5 * (a + b)
        fm, _, _ = _gap(wall, cell, ox, oy, oz, dx, dy, dz, m)
        if fm >= 0.0:
            b, fb = m, fm
            if side == 1:
                fa *= 0.5
            side = 1
            if fm < 1e-16:
                break
        else:
            a, fa = m, fm
            if side == -1:
                fb *= 0.5
            side = -1
            if fm > -1e-16:
                return m
    return b


@njit(cache=True)
def _plane(cells, cell, ray):
    """Return where the ray crosses a cell's end plane and whether it goes forward through it."""
    ox, oy, oz, dx, dy, dz = ray
    nx, ny, nz, d = cells[cell, 20], cells[cell, 21], cells[cell, 22], cells[cell, 23]
    speed = nx * dx + ny * dy + nz * dz
    if speed == 0.0:
        return np.inf, True
    return (d - nx * ox - ny * oy - nz * oz) / speed, speed > 0.0


@njit(cache=True)
def _tube(row, ray, t_wall, limit):
    """Return the first hit of a lateral's tube at or before `limit`, given that the bare wall is met at t_wall.

    inf = the ray misses it; -1 = the ray goes out through the opening and is not seen again.
    """
    ox, oy, oz = ray[0] - row[0], ray[1] - row[1], ray[2] - row[2]
    dx, dy, dz = ray[3], ray[4], ray[5]
    w0 = ox * row[3] + oy * row[4] + oz * row[5]
    dw = dx * row[3] + dy * row[4] + dz * row[5]
    ax, ay, az = ox - w0 * row[3], oy - w0 * row[4], oz - w0 * row[5]
    bx, by, bz = dx - dw * row[3], dy - dw * row[4], dz - dw * row[5]
    a = bx * bx + by * by + bz * bz
    b = ax * bx + ay * by + az * bz
    r2 = ax * ax + ay * ay + az * az
    if a == 0.0:
        return np.inf
    outer = b * b - a * (r2 - row[7] * row[7])
    if outer <= 0.0:
        return np.inf
    inner = b * b - a * (r2 - row[6] * row[6])
    out_a, out_b = (-b - sqrt(outer)) / a, (-b + sqrt(outer)) / a
    in_a, in_b = np.inf, -np.inf
    if inner > 0.0:
        in_a, in_b = (-b - sqrt(inner)) / a, (-b + sqrt(inner)) / a
    opening = in_a < t_wall < in_b and w0 + t_wall * dw > row[8] - row[6]
    # The tube's own material before the wall: only the stub that stands into the pipe.
    if row[8] < 0.0:
        t = max(out_a, 1e-12)
        w = w0 + t * dw
        if w < row[8]:
            t = (row[8] - w0) / dw if dw > 0.0 else np.inf
        if in_a <= t < in_b:
            t = in_b
        if t <= out_b and t < t_wall and w0 + t * dw >= row[8] - 1e-12:
            return t if t <= limit else -1.0
    if not opening:
        return np.inf
    if w0 + in_b * dw > row[9] or in_b > limit:
        return -1.0
    return in_b


@njit(cache=True)
def _cast_one(wall, start_cell, ray, limit):
    """Return range, kind and chainage of the first thing one ray meets; range NaN where it meets nothing."""
    cell = start_cell
    last = wall.cells.shape[0] - 1
    t, hit, kind, chainage = 0.0, np.inf, NOTHING, np.nan
    entered = False
    while True:
        gap, _, x = _gap(wall, cell, ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], t)
        if gap >= 0.0:
            if entered:
                hit, kind, chainage = t, JOINT, x
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
        t_hit = _first_root(wall, cell, ray, t, far, gap)
        if t_hit < np.inf:
            hit = t_hit
            _, kind, chainage = _gap(wall, cell, ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], hit)
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
        away = sqrt((row[0] - ray[0]) ** 2 + (row[1] - ray[1]) ** 2 + (row[2] - ray[2]) ** 2)
        if away - row[7] - row[9] > min(hit, limit) + row[9]:
            continue
        tube = _tube(row, ray, hit, limit)
        if tube == -1.0:
            return np.nan, NOTHING, chainage
        if tube < np.inf:
            return tube, LATERAL, row[10]
    if hit > limit:
        return np.nan, NOTHING, np.nan
    return hit, kind, chainage


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
            reach[i, j], kind[i, j], chainage[i, j] = _cast_one(wall, cell[i], ray, limit)
    return reach, kind, chainage


@njit(cache=True)
def radius_of_wall(wall: Wall, cell, chainage, theta):
    """Return the wall's true polar radius [m] (stations, bearings) about the axis, everything on it included.

    Args:
        wall: Arrays of `wall.build`.
        cell: Cell of each station (stations,).
        chainage: Chainage [m] of each station (stations,).
        theta: Bearings [rad] (bearings,).
    """
    out = np.empty((chainage.size, theta.size))
    for i in range(chainage.size):
        for j in range(theta.size):
            out[i, j] = _radius(wall, cell[i], chainage[i], sin(theta[j]), cos(theta[j]), 1.0)[0]
    return out
