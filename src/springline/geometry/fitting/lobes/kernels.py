"""Compiled polar radii of lobed liners in a tilted elliptical host, with slopes and derivatives.

The host is given by m = half sum of the semi-axes and (u, v) = their half difference times cos and sin of twice the
major axis's bearing, regular at the circle. With q = u cos 2 theta + v sin 2 theta and d^2 = u^2 + v^2 its polar radius
about its centre is (m^2 - d^2) / sqrt(m^2 + d^2 - 2 m q).

A lobe is its bearing, half angle phi, depth (the host's radius at its centre less what is left there) and a power:
`PROPOSED` is the published lobe with power p of its amplitude, `SMOOTH` the host's radius less depth cos^n(pi x / 2).
"""

from __future__ import annotations

from math import cos, log, pi, sin, sqrt

import numpy as np

from .._jit import kernel

PROPOSED, SMOOTH = range(2)

HOST = 3
"""How many numbers a host has; they stand before the lobe's."""

LOBE = 4
"""How many numbers a lobe has: bearing, half angle, depth, power."""

_STEP = 1e-6


@kernel
def host(theta, m, u, v):
    """Return the host's polar radius at a bearing, its slope, and its derivatives by m, u and v."""
    c, s = cos(2.0 * theta), sin(2.0 * theta)
    product = m * m - u * u - v * v
    q = u * c + v * s
    g = m * m + u * u + v * v - 2.0 * m * q
    root = 1.0 / sqrt(g)
    radius = product * root
    slope = radius * m * 2.0 * (v * c - u * s) / g
    by_m = root * (2.0 * m - product * (m - q) / g)
    by_u = root * (-2.0 * u - product * (u - m * c) / g)
    by_v = root * (-2.0 * v - product * (v - m * s) / g)
    return radius, slope, by_m, by_u, by_v


@kernel
def coefficients(p, side, out):
    """Fill k1, kappa and k3 of the published lobe on one side; p are the host's and the lobe's numbers.

    Source: (7.13) to (7.23), errata A12 and A13.
    """
    edge = host(p[3] + side * p[4], p[0], p[1], p[2])
    k1 = host(p[3], p[0], p[1], p[2])[0] - p[5] - edge[0]
    out[0] = k1
    out[1] = k1 + 2.0 * p[4] * side * edge[1] / pi
    out[2] = edge[0]


@kernel
def _moved_coefficients(p, sides, moved):
    """Fill the coefficients (2, 3) of both sides, and their derivatives (7, 2, 3) by all numbers but the power."""
    shifted = p.copy()
    above, below = np.empty(3), np.empty(3)
    for side in range(2):
        sign = 2.0 * side - 1.0
        coefficients(p, sign, sides[side])
        # the host's radii are smooth, and the lobe's bearing, angle and depth enter through them alone
        for k in range(HOST + LOBE - 1):
            shifted[k] = p[k] + _STEP
            coefficients(shifted, sign, above)
            shifted[k] = p[k] - _STEP
            coefficients(shifted, sign, below)
            shifted[k] = p[k]
            for c in range(3):
                moved[k, side, c] = (above[c] - below[c]) / (2.0 * _STEP)


@kernel
def lobed_radius(rows, kind, numbers, first, bearing, counts, radius, slope, by):
    """Fill radius, slope and derivatives at the readings of some rings.

    Args:
        rows: (R,) the rings.
        kind: `PROPOSED` or `SMOOTH`.
        numbers: (R, HOST + LOBE): m, u, v, bearing, half angle, depth, power.
        first: The first number by which derivatives are wanted.
        bearing: (N, M) about the host's centre [rad].
        counts: (N,) readings.
        radius, slope: (N, M) output.
        by: (N, K, M) output: derivatives by K numbers.
    """
    wanted = by.shape[1]
    sides, moved = np.empty((2, 3)), np.empty((HOST + LOBE - 1, 2, 3))
    own = np.empty(HOST + LOBE)
    for place in range(rows.size):
        ring, p = rows[place], numbers[place]
        if kind == PROPOSED:
            _moved_coefficients(p, sides, moved)
        for i in range(counts[ring]):
            radius[ring, i], slope[ring, i] = _one(kind, p, sides, moved, bearing[ring, i], own)
            for k in range(wanted):
                by[ring, k, i] = own[first + k]


@kernel
def _one(kind, p, sides, moved, theta, by):
    """Return radius and slope at one bearing, and fill the derivatives by all numbers."""
    phi, depth, power = p[4], p[5], p[6]
    r, s, by_m, by_u, by_v = host(theta, p[0], p[1], p[2])
    by[0], by[1], by[2] = by_m, by_u, by_v
    offset = (theta - p[3] + pi) % (2.0 * pi) - pi
    sign = 1.0 if offset >= 0.0 else -1.0
    x = abs(offset) / phi
    if x >= 1.0:
        for k in range(HOST, HOST + LOBE):
            by[k] = 0.0
        return r, s
    c, lean = cos(0.5 * pi * x), sin(0.5 * pi * x)
    if kind == SMOOTH:
        lower = c ** (power - 1.0)
        # what the radius rises by as x grows
        rise = depth * power * 0.5 * pi * lower * lean
        by[3], by[4], by[5] = -sign * rise / phi, -x * rise / phi, -lower * c
        by[6] = -depth * lower * c * log(max(c, 1e-300))
        return r - depth * lower * c, s + sign * rise / phi
    k1, kappa, k3 = sides[1 if sign > 0.0 else 0]
    raised = x**power
    amplitude = k1 - kappa * raised
    rise = -kappa * power * raised / max(x, 1e-12) * c - 0.5 * pi * amplitude * lean
    for k in range(HOST + LOBE - 1):
        d = moved[k, 1 if sign > 0.0 else 0]
        by[k] = (d[0] - d[1] * raised) * c + d[2]
    by[3] -= sign * rise / phi
    by[4] -= x * rise / phi
    by[6] = -kappa * raised * log(max(x, 1e-300)) * c
    return amplitude * c + k3, sign * rise / phi
