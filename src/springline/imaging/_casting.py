"""Kernels behind `reprojection`: rays of a contour cast back onto the wall, and the model's edge fitted to them.

A camera's `axes` are rows backwards, up and right; `parameters` are those of `reprojection.LATERAL` or `JOINT`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

ROBUST = 3.0
"""Sigmas beyond which a point counts less and less (Cauchy)."""
WIDE = 0.7
"""Bores beyond this share of the pipe's radius are unusual."""
WIDER = 0.1
"""How fast they become so, relative."""
HELD = 1e-8
"""One-sigma of the prior below which a parameter stays where it is."""
WALK, STRIDE = 4, 4.0
"""Steps towards the model's edge, and the longest of them [px]."""


@njit(cache=True)
def _turned(axes, pose):
    """Rows backwards, up and right of the camera turned about its own axes: yaw, pitch, roll."""
    n, v, u = axes[0].copy(), axes[1].copy(), axes[2].copy()
    cos, sin = math.cos(-pose[4]), math.sin(-pose[4])
    n, u = cos * n + sin * u, cos * u - sin * n
    cos, sin = math.cos(-pose[3]), math.sin(-pose[3])
    n, v = cos * n + sin * v, cos * v - sin * n
    cos, sin = math.cos(pose[5]), math.sin(pose[5])
    u, v = cos * u + sin * v, cos * v - sin * u
    return n, v, u


@njit(cache=True)
def cast(directions, axes, eye, radii, pose, places):
    """Where rays meet the wall, x from the camera's; False when the camera is outside the pipe."""
    n, v, u = _turned(axes, pose)
    eye_y, eye_z = eye[1] + pose[1], eye[2] + pose[2]
    wy, wz = 1.0 / radii[1] ** 2, 1.0 / radii[0] ** 2
    c = wy * eye_y * eye_y + wz * eye_z * eye_z - 1.0
    if c >= -0.01:
        return False
    for k in range(directions.shape[0]):
        back, up, right = directions[k, 0], directions[k, 1], directions[k, 2]
        dx = back * n[0] + up * v[0] + right * u[0]
        dy = back * n[1] + up * v[1] + right * u[1]
        dz = back * n[2] + up * v[2] + right * u[2]
        a = max(wy * dy * dy + wz * dz * dz, 1e-12)
        b = wy * dy * eye_y + wz * dz * eye_z
        t = (-b + math.sqrt(b * b - a * c)) / a
        places[k, 0], places[k, 1], places[k, 2] = t * dx, eye_y + t * dy, eye_z + t * dz
    return True


@njit(cache=True)
def off_edge(lateral, places, parameters, out):
    """How far points of the wall lie off the model's edge [m]."""
    x = parameters[0]
    if not lateral:
        for k in range(places.shape[0]):
            out[k] = places[k, 0] - x
        return
    bearing, radius, tilt = parameters[6], math.exp(parameters[7]), parameters[8]
    ax, ay, az = math.sin(tilt), math.cos(tilt) * math.sin(bearing), math.cos(tilt) * math.cos(bearing)
    for k in range(places.shape[0]):
        qx, qy, qz = places[k, 0] - x, places[k, 1], places[k, 2]
        along = qx * ax + qy * ay + qz * az
        across = math.sqrt(max(qx * qx + qy * qy + qz * qz - along * along, 0.0))
        # the far side of the bore's axis is another wall: what lies there is off by the way round
        out[k] = (across if along > 0.0 else across - 2.0 * along) - radius


@njit(cache=True)
def residuals(lateral, sets, axes, eye, radii, parameters, places, off, out):
    """How far each point is off [px], by first order; False when the parameters make no sense."""
    shape = radii
    if not lateral:
        shape = np.array([radii[0] * (1.0 + parameters[6]), radii[1] * (1.0 - parameters[6])])
    elif parameters[7] > math.log(1.02 * min(radii[0], radii[1])) or abs(parameters[8]) > 1.3:
        return False
    for which in range(3):
        if not cast(sets[which], axes, eye, shape, parameters, places):
            return False
        off_edge(lateral, places, parameters, off[which])
    for k in range(out.shape[0]):
        right, up = off[1, k] - off[0, k], off[2, k] - off[0, k]
        out[k] = off[0, k] / math.sqrt(right * right + up * up + 1e-18)
    return True


@njit(cache=True)
def distances(lateral, sets, axes, eye, radii, parameters, out):
    """How far each point is from the model's edge [px], walking there; False when the parameters make no sense.

    By first order alone, edges seen at a slant are near to everything.
    """
    count = out.shape[0]
    places, off, moved = np.empty((count, 3)), np.empty((3, count)), np.zeros((2, count))
    if not residuals(lateral, sets, axes, eye, radii, parameters, places, off, out):
        return False
    shape = radii
    if not lateral:
        shape = np.array([radii[0] * (1.0 + parameters[6]), radii[1] * (1.0 - parameters[6])])
    here = sets.copy()
    for _ in range(WALK):
        for which in range(3):
            cast(here[which], axes, eye, shape, parameters, places)
            off_edge(lateral, places, parameters, off[which])
        for k in range(count):
            right, up = off[1, k] - off[0, k], off[2, k] - off[0, k]
            back = off[0, k] / (right * right + up * up + 1e-18)
            size = abs(back) * math.sqrt(right * right + up * up)
            if size > STRIDE:
                back *= STRIDE / size
            moved[0, k] += back * right
            moved[1, k] += back * up
            for c in range(3):
                step = back * right * (here[1, k, c] - here[0, k, c]) + back * up * (here[2, k, c] - here[0, k, c])
                for which in range(3):
                    here[which, k, c] -= step
    for k in range(count):
        out[k] = math.sqrt(moved[0, k] ** 2 + moved[1, k] ** 2)
    return True


@njit(cache=True)
def _excess(lateral, radii, parameters):
    """By how many sigmas a bore is unusually wide."""
    if not lateral:
        return 0.0
    return max(parameters[7] - math.log(WIDE * min(radii[0], radii[1])), 0.0) / WIDER


@njit(cache=True)
def _cost(lateral, radii, residuals, noise, parameters, mean, sigma):
    total = 0.0
    square = ROBUST**2
    for k in range(residuals.shape[0]):
        total += 0.5 * square * math.log1p((residuals[k] / noise) ** 2 / square)
    for p in range(parameters.shape[0]):
        if sigma[p] < np.inf:
            total += 0.5 * ((parameters[p] - mean[p]) / sigma[p]) ** 2
    return total + 0.5 * _excess(lateral, radii, parameters) ** 2


@njit(cache=True)
def whole_cost(lateral, sets, axes, eye, radii, parameters, mean, sigma, noise):
    """Robust misfit by the distances from the edge, and what the prior says."""
    out = np.empty(sets.shape[1])
    if not distances(lateral, sets, axes, eye, radii, parameters, out):
        return np.inf
    return _cost(lateral, radii, out, noise, parameters, mean, sigma)


@njit(cache=True)
def _normal(lateral, sets, axes, eye, radii, parameters, sigma, noise, base, places, off):
    """Information matrix and gradient of the robust misfit, by differences."""
    count, size = base.shape[0], parameters.shape[0]
    slopes = np.zeros((count, size))
    moved = np.empty(count)
    for p in range(size):
        if sigma[p] < HELD:
            continue
        step = 1e-5 * (radii[0] if p < 3 else 1.0)
        trial = parameters.copy()
        trial[p] += step
        if residuals(lateral, sets, axes, eye, radii, trial, places, off, moved):
            slopes[:, p] = (moved - base) / step
    information = np.zeros((size, size))
    gradient = np.zeros(size)
    for k in range(count):
        weight = 1.0 / (1.0 + (base[k] / noise) ** 2 / ROBUST**2) / noise**2
        for p in range(size):
            gradient[p] += weight * slopes[k, p] * base[k]
            for q in range(p + 1):
                information[p, q] += weight * slopes[k, p] * slopes[k, q]
    for p in range(size):
        for q in range(p):
            information[q, p] = information[p, q]
    return information, gradient


@njit(cache=True)
def solve(lateral, sets, axes, eye, radii, start, mean, sigma, noise, steps):
    """Levenberg and Marquardt's steps from a first guess; parameters and cost."""
    count, size = sets.shape[1], start.shape[0]
    places, off = np.empty((count, 3)), np.empty((3, count))
    here, there = np.empty(count), np.empty(count)
    best = start.copy()
    if not residuals(lateral, sets, axes, eye, radii, best, places, off, here):
        return best, np.inf
    # wide noise at first, so that a far start feels where to go
    coarse = max(noise, 0.5 * np.median(np.abs(here)))
    damping = 1e-2
    cost = _cost(lateral, radii, here, coarse, best, mean, sigma)
    for step in range(steps):
        information, gradient = _normal(lateral, sets, axes, eye, radii, best, sigma, coarse, here, places, off)
        for p in range(size):
            if sigma[p] < HELD:
                information[p, :] = 0.0
                information[:, p] = 0.0
                information[p, p] = 1.0
                gradient[p] = 0.0
            elif sigma[p] < np.inf:
                information[p, p] += 1.0 / sigma[p] ** 2
                gradient[p] += (best[p] - mean[p]) / sigma[p] ** 2
        excess = _excess(lateral, radii, best)
        if excess > 0.0:
            information[7, 7] += 1.0 / WIDER**2
            gradient[7] += excess / WIDER
        gained = False
        for _ in range(6):
            damped = information.copy()
            for p in range(size):
                damped[p, p] = information[p, p] * (1.0 + damping) + 1e-12
            trial = best - np.linalg.solve(damped, gradient)
            if residuals(lateral, sets, axes, eye, radii, trial, places, off, there):
                new = _cost(lateral, radii, there, coarse, trial, mean, sigma)
                if new < cost:
                    gain = cost - new
                    best, cost = trial, new
                    here[:] = there
                    damping = max(damping * 0.3, 1e-9)
                    gained = gain > 1e-4
                    break
            damping = min(damping * 5.0, 1e9)
        if not gained and coarse <= noise:
            break
        if not gained or step % 4 == 3:
            coarse = max(noise, 0.4 * coarse)
            cost = _cost(lateral, radii, here, coarse, best, mean, sigma)
            damping = min(damping, 1e-2)
    return best, _cost(lateral, radii, here, noise, best, mean, sigma)


@njit(cache=True)
def information(lateral, sets, axes, eye, radii, parameters, sigma, noise):
    """What the points and the prior know of the parameters: the inverse of their covariance."""
    count = sets.shape[1]
    places, off, base = np.empty((count, 3)), np.empty((3, count)), np.empty(count)
    residuals(lateral, sets, axes, eye, radii, parameters, places, off, base)
    information, _ = _normal(lateral, sets, axes, eye, radii, parameters, sigma, noise, base, places, off)
    for p in range(parameters.shape[0]):
        if sigma[p] < np.inf:
            information[p, p] += 1.0 / max(sigma[p], HELD) ** 2
    return information
