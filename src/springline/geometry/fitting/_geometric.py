"""Geometric fits, ring by ring: gather, start, refine, remove the noise's own bias, judge."""

from __future__ import annotations

from math import sqrt

import numpy as np

from springline.geometry.fitting._bias import mean_gradient_along_rays, mean_gradient_isotropic
from springline.geometry.fitting._gram import gram
from springline.geometry.fitting._jit import kernel, vector_kernel
from springline.geometry.fitting._judge import (
    ARC_BINS,
    COLLINEAR,
    FITTED,
    FLATTEST,
    NO_CONVERGENCE,
    NOT_AN_ELLIPSE,
    SCATTERED,
    SHORT_ARC,
    TOO_FEW,
    collapsed,
    erase,
    spans,
)
from springline.geometry.fitting._linalg import factorise, invert, substitute
from springline.geometry.fitting._moments import TAUBIN, add_moments, circle_from_moments
from springline.geometry.fitting._readings import ANGLE_BINS, gather, normalise, order_by_angle
from springline.geometry.fitting._refine import SCORE, SLOPE, SUMS, USED, WEIGHT, refine
from springline.geometry.fitting._start import SECTORS, algebraic_start, robust_start
from springline.geometry.fitting.options import FEWEST_SEARCHED, NOISE_MODELS

ORTHOGONAL = NOISE_MODELS["orthogonal"]
RANGE = NOISE_MODELS["range"]

ROBUST_TOLERANCE = 1e-4
"""Length of the last robust step in sigmas of the parameters; each step is a small fraction of the one before."""

PLAIN_TOLERANCE = 1e-9


@vector_kernel
def _residual_rms(distance, omega, n):
    """Return the rms distance of the readings that have weight."""
    total = 0.0
    count = 0.0
    for i in range(n):
        used = 1.0 if omega[i] > 0.0 else 0.0
        total += used * distance[i] * distance[i]
        count += used
    return sqrt(total / count)


# fmt: off
@kernel
def _fit_one(
    p, n, z, y, w, index, robust, noise, least_arc, most_scatter,
    rows, keys, counts, sectors, small, sums, par, cov, out,
):
    # fmt: on
    """Fit one gathered ring in place; return its status. `out` receives residual rms and noise."""
    if n < p:
        return TOO_FEW
    mean_z, mean_y, scale, flatness = normalise(z, y, n)
    if not flatness > FLATTEST:
        return COLLINEAR
    robust = robust and n >= FEWEST_SEARCHED * p
    if robust:
        order_by_angle(z, y, w, index, n, keys, counts, rows)
        started = robust_start(p, z, y, w, n, par, sectors, rows, small)
    else:
        add_moments(z, y, w, 0, n, sectors[0])
        start = small[4, 2]
        started = algebraic_start(p, sectors[0], start, sectors[1], small)
        for a in range(p):
            par[a] = start[a]
    if not started:
        return COLLINEAR
    tolerance = ROBUST_TOLERANCE if robust else PLAIN_TOLERANCE
    converged, sigma = refine(p, z, y, w, n, par, robust, tolerance, rows, sums, small)
    distance, omega, jacobian = rows[0], rows[1], rows[5:10]
    oval = collapsed(p, par)
    if oval or not converged:
        # an arc too short may be why, which a circle still tells
        add_moments(z, y, w, 0, n, sectors[0])
        circle_from_moments(sectors[0], TAUBIN, par)
    if not spans(least_arc, z, y, omega, n, par, rows[2, :ARC_BINS], rows[3, :ARC_BINS]):
        return SHORT_ARC
    if oval:
        return NOT_AN_ELLIPSE
    normal, low, inverse, vector = small[0], small[1], small[2], small[3, 0]
    gram(p, n, jacobian, distance, omega, normal, vector)
    if not converged or not factorise(normal, p, low):
        return NO_CONVERGENCE
    invert(low, p, inverse)
    freedom = sums[USED] - p
    variance = np.nan
    if freedom > 0.0:
        # psi^2 over (psi')^2 in means; the information is that of the readings that still have weight
        variance = sigma * sigma
        if robust:
            variance *= sums[SCORE] * sums[WEIGHT] / sums[SLOPE] ** 2 * sums[USED] / freedom
        if sigma > most_scatter * par[2] or 2.0 * sums[USED] < n:
            return SCATTERED
        if noise != ORTHOGONAL:
            if noise == RANGE:
                mean_gradient_along_rays(p, z, y, omega, n, par, jacobian, -mean_z / scale, -mean_y / scale, vector)
            else:
                mean_gradient_isotropic(p, omega, n, par, jacobian, vector)
            for a in range(p):
                vector[a] *= sigma * sigma
            substitute(low, p, vector, vector)
            for a in range(p):
                par[a] -= vector[a]
    out[0] = scale * _residual_rms(distance, omega, n)
    out[1] = scale * sigma if freedom > 0.0 else np.nan
    for a in range(p):
        par[a] *= scale
        for b in range(p):
            cov[a, b] = variance * inverse[a, b] * scale * scale
    par[0] += mean_z
    par[1] += mean_y
    return FITTED


@kernel
def fit_rings(
    p, robust, noise, least_arc, most_scatter, z, y, weight, weighted, keep, par, cov, out, used, status, omega
):
    """Fit the circle (p = 3) or ellipse (p = 5) of every row of `z` and `y`; fill what `_batch.run` returns."""
    rings, points = z.shape
    gathered = np.empty((3, points))
    index = np.empty(points, np.int64)
    keys = np.empty(points, np.int64)
    counts = np.empty(ANGLE_BINS + 1, np.int64)
    rows = np.empty((10, max(points, ARC_BINS)))
    sectors = np.empty((SECTORS + 3, 15))
    small = np.empty((5, 5, 5))
    sums = np.empty(SUMS)
    a, b, c = gathered[0], gathered[1], gathered[2]
    for k in range(rings):
        n = gather(z[k], y[k], weight[k if weighted else 0], weighted, a, b, c, index)
        # fmt: off
        code = _fit_one(
            p, n, a, b, c, index, robust, noise, least_arc, most_scatter,
            rows, keys, counts, sectors, small, sums, par[k], cov[k], out[k],
        )
        # fmt: on
        status[k] = code
        if code != FITTED:
            used[k] = n
            erase(par[k], cov[k], out[k])
            continue
        used[k] = int(sums[USED])
        if keep:
            for i in range(n):
                omega[k, index[i]] = rows[1, i] / c[i]
