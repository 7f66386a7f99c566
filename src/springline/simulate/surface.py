"""The wall as a radius: what a direction meets at a chainage, and how far out."""

from __future__ import annotations

from math import atan2, cos, floor, pi, sin, sqrt

import numpy as np
from numba import njit

from .kernels import inner
from .wall import BUMP, FLOOR, JOINT, VARYING_LOBE, WALL, Wall


@inner(forceinline=True)
def _section(pieces, n, theta, c, s):
    """Return the radius of section n at bearing theta in [0, 2 pi), whose cosine and sine are c and s."""
    k = 0
    while k + 1 < pieces.shape[1] and pieces[n, k + 1, 0] <= theta:
        k += 1
    p = pieces[n, k, 1] * c * c + pieces[n, k, 2] * c * s + pieces[n, k, 3] * s * s
    q = pieces[n, k, 4] * c + pieces[n, k, 5] * s
    root = sqrt(max(q * q - 4.0 * p * pieces[n, k, 6], 0.0))
    if q > 0.0:
        return -2.0 * pieces[n, k, 6] / (q + root)
    return (root - q) / (2.0 * p)


@inner
def lattice(i, j, seed):
    """Return a number of unit variance, always the same at one lattice point: splitmix64 of its indices."""
    h = np.uint64(i) * np.uint64(0x9E3779B97F4A7C15) ^ np.uint64(j) * np.uint64(0xC2B2AE3D27D4EB4F) ^ seed
    h = (h ^ (h >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    h = (h ^ (h >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    h = h ^ (h >> np.uint64(31))
    return (float(h >> np.uint64(11)) / 9007199254740992.0 - 0.5) * sqrt(12.0)


@inner
def _weight(k, f):
    """Return weight k, 0 to 3, of the uniform cubic B-spline at share f of a step."""
    if k == 0:
        return (1.0 - f) ** 3 / 6.0
    if k == 1:
        return (3.0 * f**3 - 6.0 * f**2 + 4.0) / 6.0
    if k == 2:
        return (-3.0 * f**3 + 3.0 * f**2 + 3.0 * f + 1.0) / 6.0
    return f**3 / 6.0


@inner
def _relief(x, theta, roughness):
    """Return the wall's roughness [m]: a cubic B-spline over random lattice values, periodic in bearing."""
    around = int(roughness.around)
    u, v = x / roughness.along, theta * around / (2.0 * pi)
    i, j = floor(u), floor(v)
    total = 0.0
    for a in range(4):
        for b in range(4):
            value = lattice(i + a - 1, (j + b - 1) % around, roughness.seed)
            total += _weight(a, u - i) * _weight(b, v - j) * value
    # 151/315 is the mean of the squared weights along one direction: it restores the stated rms.
    return roughness.rms * total / (151.0 / 315.0)


@inner
def _window(u):
    """Return 1 at u = 0 falling to 0, with its slope, at |u| = 1."""
    return cos(0.5 * pi * u) ** 2 if abs(u) < 1.0 else 0.0


@inner
def _ramp(x, start, end, ramp):
    """Return 1 between start and end, smoothly down to 0 over `ramp` inside both ends."""
    if x <= start or x >= end:
        return 0.0
    d = min(x - start, end - x)
    if d >= ramp:
        return 1.0
    u = d / ramp
    return u * u * (3.0 - 2.0 * u)


@inner(forceinline=True)
def _bare(wall, cell, x, theta, c, s):
    """Return the radius of the section alone, blended between its knots, with its harmonics."""
    first, count = wall.cells[cell].first, wall.cells[cell].count
    k, w = 0, 0.0
    if count > 1:
        u = (x - wall.cells[cell].chainage) / wall.cells[cell].step
        k = min(max(floor(u), 0), count - 2)
        w = min(max(u - k, 0.0), 1.0)
    rho = _section(wall.pieces, first + k, theta, c, s)
    if w > 0.0:
        rho += w * (_section(wall.pieces, first + k + 1, theta, c, s) - rho)
    for n in range(wall.orders.shape[0]):
        a, b = wall.harmonics[first + k, n, 0], wall.harmonics[first + k, n, 1]
        if w > 0.0:
            a += w * (wall.harmonics[first + k + 1, n, 0] - a)
            b += w * (wall.harmonics[first + k + 1, n, 1] - b)
        rho += a * cos(wall.orders[n] * theta) + b * sin(wall.orders[n] * theta)
    return rho


@inner
def _at(wall, cell, x, theta):
    """Return the bare section's radius at any bearing."""
    theta -= 2.0 * pi * floor(theta / (2.0 * pi))
    return _bare(wall, cell, x, theta, cos(theta), sin(theta))


@inner
def _varying_lobe(wall, cell, x, turn, row):
    """Return the radius of the varying-amplitude lobe `turn` from its middle: (k1 - kappa |t/phi|^p) cos + k3.

    k3 makes it meet the host at its edges, k1 sets its depth, kappa gives it the host's slope there (chapter 7,
    eq. 7.23 in the form that stays regular at zero depth).
    """
    phi, power, step = row.half, row.power, 1e-5
    edge = row.bearing + phi
    k3 = _at(wall, cell, x, edge)
    slope = (_at(wall, cell, x, edge + step) - _at(wall, cell, x, edge - step)) / (2.0 * step)
    k1 = _at(wall, cell, x, row.bearing) - row.depth - k3
    kappa = k1 + 2.0 * phi * slope / pi
    u = abs(turn) / phi
    return (k1 - kappa * u**power) * cos(0.5 * pi * u) + k3


@inner
def wall_at(wall, cell, x, y, z, h):
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
    if wall.cells[cell].gap:
        kind = JOINT
        rho += wall.cells[cell].groove
    if wall.roughness[0].rms > 0.0:
        rho += _relief(x, theta, wall.roughness[0])
    for n in range(wall.feature_from[cell], wall.feature_from[cell + 1]):
        row = wall.features[wall.feature_of[n]]
        if x <= row.first or x >= row.last:
            continue
        if row.form == FLOOR:
            if s < 0.0:
                level = _ramp(x, row.first, row.last, row.ramp) * row.depth - _bare(wall, cell, x, 1.5 * pi, 0.0, -1.0)
                if rho * s < level:
                    rho = level / s
                    kind = row.kind
            continue
        turn = theta - row.bearing
        turn -= 2.0 * pi * floor(turn / (2.0 * pi) + 0.5)
        if abs(turn) >= row.half:
            continue
        if row.form == VARYING_LOBE:
            rho += _ramp(x, row.first, row.last, row.ramp) * (_varying_lobe(wall, cell, x, turn, row) - rho)
            continue
        if row.form == BUMP:
            drop = (
                row.depth
                * _window(turn / row.half)
                * _window((x - 0.5 * (row.first + row.last)) / (0.5 * (row.last - row.first)))
            )
            if drop > 0.0:
                kind = row.kind
        else:
            drop = row.depth * cos(0.5 * pi * turn / row.half) ** row.power * _ramp(x, row.first, row.last, row.ramp)
        rho -= drop
    return rho, kind


@njit(cache=True)
def radius_of_wall(wall: Wall, cell, chainage, theta, bare):
    """Return the true polar radius [m] (stations, bearings) about the axis.

    Args:
        wall: Arrays of `wall.build`.
        cell: Cell of each station (stations,).
        chainage: Chainage [m] of each station (stations,).
        theta: Bearings [rad], (1, bearings) for all stations or (stations, bearings).
        bare: True = the section alone, False = the wall with everything on it.
    """
    out = np.empty((chainage.size, theta.shape[-1]))
    for i in range(chainage.size):
        for j in range(theta.shape[-1]):
            at = theta[i % theta.shape[0], j]
            if bare:
                out[i, j] = _at(wall, cell[i], chainage[i], at)
            else:
                out[i, j] = wall_at(wall, cell[i], chainage[i], sin(at), cos(at), 1.0)[0]
    return out
