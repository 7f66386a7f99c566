"""Geometric fits, ring by ring: gather, start, refine, remove the noise's own bias, judge."""

from __future__ import annotations

from math import atan2, pi, sqrt

import numpy as np
from numba import njit

from springline.geometry.fitting._linalg import FAST, factorise, invert, substitute
from springline.geometry.fitting._moments import (
    TAUBIN,
    add_moments,
    circle_from_moments,
    ellipse_of_conic,
    gander,
)
from springline.geometry.fitting._readings import gather, normalise, order_by_angle
from springline.geometry.fitting._refine import SCORE, SLOPE, SUMS, USED, WEIGHT, gram, possible, refine
from springline.geometry.fitting._start import SECTORS, robust_start

FITTED, TOO_FEW, COLLINEAR, SHORT_ARC, NO_CONVERGENCE, NOT_AN_ELLIPSE, SCATTERED = range(7)

ORTHOGONAL, ISOTROPIC, RANGE = range(3)

ARC_BINS = 64


@njit(cache=True, nogil=True, error_model="numpy")
def spans(least, z, y, omega, n, par, low, high):
    """Return whether the readings with weight span at least the angle `least` [rad] about the centre.

    The span is 2 pi less the widest gap. `low` and `high` are scratch for bins of the diamond angle, which orders as
    the bearing does and turns at most twice as slowly; only a doubtful case asks for true angles.
    """
    bins = low.size
    for k in range(bins):
        low[k] = 9.0
        high[k] = -9.0
    for i in range(n):
        if omega[i] > 0.0:
            dz = z[i] - par[0]
            dy = y[i] - par[1]
            turn = dy / (abs(dz) + abs(dy) + 1e-300)
            if dz < 0.0:
                turn = 2.0 - turn
            elif turn < 0.0:
                turn += 4.0
            k = min(int(turn * (0.25 * bins)), bins - 1)
            low[k] = min(low[k], turn)
            high[k] = max(high[k], turn)
    for exact in range(2):
        first = last = -1.0
        widest = 0.0
        for k in range(bins):
            if high[k] >= 0.0:
                if first < 0.0:
                    first = low[k]
                elif exact:
                    widest = max(widest, _bearing(low[k]) - _bearing(last))
                else:
                    widest = max(widest, 2.0 * (low[k] - last))
                last = high[k]
        if exact:
            widest = max(widest, _bearing(first) + 2.0 * pi - _bearing(last))
        else:
            widest = max(widest, 2.0 * (first + 4.0 - last))
        if 2.0 * pi - widest >= least:
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def _bearing(turn):
    """Return the bearing [rad], in [0, 2 pi), of a diamond angle in [0, 4)."""
    quarter = int(turn)
    part = turn - quarter
    return 0.5 * pi * quarter + atan2(part, 1.0 - part)


@njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
def _noise_bias(p, z, y, n, par, jacobian, variance, origin_z, origin_y, along_rays, bias):
    """Write the mean distance that noise alone gives each reading: variance times half the wall's curvature.

    Only the part of the noise along the wall bends away from it: all of it when isotropic, the square of the ray's
    sine to the normal when the noise lies along the ray.
    """
    mean = par[2]
    u = par[3] if p == 5 else 0.0
    v = par[4] if p == 5 else 0.0
    product = mean * mean - u * u - v * v
    for i in range(n):
        nz = jacobian[0, i]
        ny = jacobian[1, i]
        # the support function h has h^2 = m^2 + d^2 + 2 m d cos 2(normal - phi), and curvature is h^3/(a b)^2
        support2 = mean * mean + u * u + v * v + 2.0 * mean * (u * (nz * nz - ny * ny) + 2.0 * v * nz * ny)
        curvature = support2 * sqrt(support2) / (product * product)
        part = 1.0
        if along_rays:
            rz = z[i] - origin_z
            ry = y[i] - origin_y
            cross = rz * ny - ry * nz
            part = cross * cross / (rz * rz + ry * ry + 1e-300)
        bias[i] = 0.5 * variance * curvature * part


@njit(cache=True, nogil=True, error_model="numpy")
def _plain_start(p, z, y, w, n, par, sectors, small):
    """Write the algebraic start of all readings into `par`; return whether there is one."""
    add_moments(z, y, w, 0, n, sectors[0])
    if p == 5 and gander(sectors[0], sectors[1], small[0], small[1, 0]) and ellipse_of_conic(sectors[1], par):
        return True
    if not circle_from_moments(sectors[0], TAUBIN, par):
        return False
    if p == 5:
        par[3] = 0.0
        par[4] = 0.0
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def _fit_one(p, n, z, y, w, index, robust, noise, least_arc, rows, keys, counts, sectors, small, sums, par, cov, out):
    """Fit one gathered ring in place; return its status. `out` receives residual rms and noise."""
    if n < p:
        return TOO_FEW
    mean_z, mean_y, scale, flatness = normalise(z, y, n)
    if not flatness > 1e-9:
        return COLLINEAR
    robust = robust and n >= 3 * p
    if robust:
        order_by_angle(z, y, w, index, n, keys, counts, rows)
        started = robust_start(p, z, y, w, n, par, sectors, rows, small)
    else:
        started = _plain_start(p, z, y, w, n, par, sectors, small)
    if not started:
        return COLLINEAR
    converged, sigma = refine(p, z, y, w, n, par, robust, 1e-4 if robust else 1e-9, rows, sums, small)
    distance, omega, jacobian = rows[0], rows[1], rows[5:10]
    if not possible(p, par) or (p == 5 and par[3] ** 2 + par[4] ** 2 > (0.99 * par[2]) ** 2):
        return NOT_AN_ELLIPSE
    if not spans(least_arc, z, y, omega, n, par, rows[2, :ARC_BINS], rows[3, :ARC_BINS]):
        return SHORT_ARC
    if not converged:
        return NO_CONVERGENCE
    normal, low, inverse = small[0], small[1], small[2]
    gram(p, n, jacobian, distance, omega, rows[3], normal, low[0])
    if not factorise(normal, p, low):
        return NO_CONVERGENCE
    used = sums[USED]
    freedom = used - p
    variance = np.nan
    if freedom > 0.0:
        # psi^2 over (psi')^2 in means; the information is that of the readings that still have weight
        variance = sigma * sigma
        if robust:
            variance *= sums[SCORE] * sums[WEIGHT] / sums[SLOPE] ** 2 * used / freedom
        out[1] = scale * sigma
    else:
        out[1] = np.nan
    total = 0.0
    for i in range(n):
        if omega[i] > 0.0:
            total += distance[i] * distance[i]
    out[0] = scale * sqrt(total / used)
    if noise != ORTHOGONAL and freedom > 0.0:
        bias = rows[2]
        along_rays = noise == RANGE
        _noise_bias(p, z, y, n, par, jacobian, sigma * sigma, -mean_z / scale, -mean_y / scale, along_rays, bias)
        gram(p, n, jacobian, bias, omega, rows[3], normal, inverse[0])
        substitute(low, p, inverse[0], inverse[0])
        for a in range(p):
            par[a] -= inverse[0, a]
    invert(low, p, inverse)
    for a in range(p):
        for b in range(p):
            cov[a, b] = variance * inverse[a, b] * scale * scale
    # a spread that the linear theory cannot describe is no answer
    if freedom > 0.0 and (sigma > 0.25 * par[2] or variance * inverse[2, 2] > (0.25 * par[2]) ** 2 or 2 * used < n):
        return SCATTERED
    for a in range(p):
        par[a] *= scale
    par[0] += mean_z
    par[1] += mean_y
    return FITTED


@njit(cache=True, nogil=True, error_model="numpy")
def fit_rings(p, z, y, weight, weighted, robust, noise, least_arc, keep, par, cov, out, used, status, omega):
    """Fit every row of `z` and `y`; see `rings.fit` for what is filled. One kernel serves circle and ellipse."""
    rings, points = z.shape
    gathered = np.empty((3, points))
    index = np.empty(points, np.int64)
    keys = np.empty(points, np.int64)
    counts = np.empty(129, np.int64)
    rows = np.empty((10, max(points, ARC_BINS)))
    sectors = np.empty((SECTORS + 2, 15))
    small = np.empty((3, 5, 5))
    sums = np.empty(SUMS)
    for k in range(rings):
        row = k if weighted else 0
        n = gather(z[k], y[k], weight[row], weighted, gathered[0], gathered[1], gathered[2], index)
        code = _fit_one(
            p,
            n,
            gathered[0],
            gathered[1],
            gathered[2],
            index,
            robust,
            noise,
            least_arc,
            rows,
            keys,
            counts,
            sectors,
            small,
            sums,
            par[k],
            cov[k],
            out[k],
        )
        status[k] = code
        used[k] = n
        if code != FITTED:
            par[k] = np.nan
            cov[k] = np.nan
            out[k] = np.nan
            continue
        used[k] = int(sums[USED])
        if keep:
            for i in range(n):
                omega[k, index[i]] = rows[1, i] / gathered[2, i]
