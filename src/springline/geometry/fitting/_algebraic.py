"""Algebraic fits, ring by ring: moments in one pass, a small eigenproblem, and the covariance to first order."""

from __future__ import annotations

from math import sqrt

import numpy as np

from springline.geometry.fitting._eigen import UNIT_NORM, conic_from_moments, unit_norm_circle
from springline.geometry.fitting._feet import circle_feet
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
from springline.geometry.fitting._linalg import factorise, invert
from springline.geometry.fitting._moments import add_moments, circle_from_moments, ellipse_of_conic
from springline.geometry.fitting._readings import gather, normalise


@vector_kernel
def _ellipse_slopes(z, y, prior, n, par, distance, jacobian, information, noise):
    """Write first-order distances and derivatives at the ray's crossing, and the weights of the covariance.

    F of the fit is its gradient's length g times the distance, so least squares of F weigh a distance by
    `information` = w g^2, and its noise enters as `noise` = w g^4 (for a variance 1/w).
    """
    mean, u, v = par[2], par[3], par[4]
    half = sqrt(u * u + v * v)
    e0 = mean + half
    e1 = mean - half
    cos2 = u / half if half > 0.0 else 1.0
    sin2 = v / half if half > 0.0 else 0.0
    ca = sqrt(max(0.5 * (1.0 + cos2), 0.0))
    sa = sqrt(max(0.5 * (1.0 - cos2), 0.0))
    sa = -sa if sin2 < 0.0 else sa
    for i in range(n):
        dz = z[i] - par[0]
        dy = y[i] - par[1]
        c = (ca * dz + sa * dy) / e0
        s = (ca * dy - sa * dz) / e1
        ratio = sqrt(c * c + s * s) + 1e-300
        c /= ratio
        s /= ratio
        g0 = c / e0
        g1 = s / e1
        square = g0 * g0 + g1 * g1
        slope = sqrt(square)
        distance[i] = (ratio - 1.0) / slope
        nz = (ca * g0 - sa * g1) / slope
        ny = (sa * g0 + ca * g1) / slope
        cos_psi = ca * c - sa * s
        sin_psi = sa * c + ca * s
        jacobian[0, i] = nz
        jacobian[1, i] = ny
        jacobian[2, i] = nz * cos_psi + ny * sin_psi
        jacobian[3, i] = nz * cos_psi - ny * sin_psi
        jacobian[4, i] = nz * sin_psi + ny * cos_psi
        information[i] = prior[i] * square
        noise[i] = prior[i] * square * square


@vector_kernel
def _squares(distance, prior, n):
    """Return the weighted and the plain sum of squared distances."""
    weighted = 0.0
    plain = 0.0
    for i in range(n):
        square = distance[i] * distance[i]
        plain += square
        weighted += prior[i] * square
    return weighted, plain


@kernel
def _sandwich(p, bread, meat, work, out):
    """Write bread meat bread into `out`, all symmetric p x p."""
    for a in range(p):
        for b in range(p):
            total = 0.0
            for k in range(p):
                total += meat[a, k] * bread[k, b]
            work[a, b] = total
    for a in range(p):
        for b in range(p):
            total = 0.0
            for k in range(p):
                total += bread[a, k] * work[k, b]
            out[a, b] = total


@kernel
def _solve(p, method, moments, mean_z, mean_y, scale, small, conic, par):
    """Write the algebraic fit into `par`; return FITTED or why there is none."""
    if p == 5:
        if not conic_from_moments(moments, method, conic, small):
            return COLLINEAR
        return FITTED if ellipse_of_conic(conic, par) else NOT_AN_ELLIPSE
    if method == UNIT_NORM:
        found = unit_norm_circle(moments, mean_z, mean_y, scale, par, small)
        return FITTED if found == 1 else (COLLINEAR if found == 0 else NO_CONVERGENCE)
    return FITTED if circle_from_moments(moments, method, par) else COLLINEAR


@kernel
def _fit_one(p, method, n, z, y, w, least_arc, most_scatter, rows, moments, small, conic, par, cov, out):
    """Fit one gathered ring in place; return its status. `out` receives residual rms and noise."""
    if n < p:
        return TOO_FEW
    mean_z, mean_y, scale, flatness = normalise(z, y, n)
    if not flatness > FLATTEST:
        return COLLINEAR
    add_moments(z, y, w, 0, n, moments)
    code = _solve(p, method, moments, mean_z, mean_y, scale, small, conic, par)
    if code != FITTED:
        return code
    if collapsed(p, par):
        return NOT_AN_ELLIPSE
    if not spans(least_arc, z, y, w, n, par, rows[1, :ARC_BINS], rows[2, :ARC_BINS]):
        return SHORT_ARC
    distance, information, noise, jacobian = rows[0], rows[1], rows[2], rows[5:10]
    bread, meat, low, inverse, vector = small[0], small[1], small[2], small[3], small[4, 0]
    if p == 5:
        _ellipse_slopes(z, y, w, n, par, distance, jacobian, information, noise)
        gram(p, n, jacobian, distance, noise, meat, vector)
        gram(p, n, jacobian, distance, information, bread, vector)
    else:
        # a circle's gradient has one length all round: every algebraic circle has the geometric one's covariance
        circle_feet(z, y, n, par, distance, jacobian)
        gram(p, n, jacobian, distance, w, bread, vector)
    if not factorise(bread, p, low):
        return COLLINEAR
    invert(low, p, inverse)
    if p == 5:
        _sandwich(p, inverse, meat, low, cov)
    else:
        for a in range(p):
            for b in range(p):
                cov[a, b] = inverse[a, b]
    weighted, plain = _squares(distance, w, n)
    variance = weighted / (n - p) if n > p else np.nan
    if variance > (most_scatter * par[2]) ** 2:
        return SCATTERED
    out[0] = scale * sqrt(plain / n)
    out[1] = scale * sqrt(variance)
    for a in range(p):
        par[a] *= scale
        for b in range(p):
            cov[a, b] *= variance * scale * scale
    par[0] += mean_z
    par[1] += mean_y
    return FITTED


@kernel
def fit_rings(p, method, least_arc, most_scatter, z, y, weight, weighted, keep, par, cov, out, used, status, omega):
    """Fit the circle (p = 3) or ellipse (p = 5) of every row of `z` and `y`; fill what `_batch.run` returns."""
    rings, points = z.shape
    gathered = np.empty((3, points))
    index = np.empty(points, np.int64)
    rows = np.empty((10, max(points, ARC_BINS)))
    moments = np.empty(15)
    small = np.empty((5, 5, 5))
    conic = np.empty(6)
    for k in range(rings):
        a, b, c = gathered[0], gathered[1], gathered[2]
        n = gather(z[k], y[k], weight[k if weighted else 0], weighted, a, b, c, index)
        used[k] = n
        code = _fit_one(
            p, method, n, a, b, c, least_arc, most_scatter, rows, moments, small, conic, par[k], cov[k], out[k]
        )
        status[k] = code
        if code != FITTED:
            erase(par[k], cov[k], out[k])
        elif keep:
            for i in range(n):
                omega[k, index[i]] = 1.0
