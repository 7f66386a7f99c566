"""A deterministic robust start: the best of thirteen algebraic fits, twelve of which leave out a third of the wall."""

from __future__ import annotations

from math import sqrt

from numba import njit

from springline.geometry.fitting._linalg import FAST
from springline.geometry.fitting._moments import (
    TAUBIN,
    add_moments,
    circle_from_moments,
    ellipse_of_conic,
    gander,
)

SECTORS = 12
"""Parts of equal count into which the readings, in order round the wall, are cut."""

LEFT_OUT = 4
"""Neighbouring sectors that each candidate leaves out: any run of outliers over a quarter of the wall is in one."""

JUDGED = 96
"""About how many readings judge the candidates."""


@njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
def _misfit(z, y, n, conic, stride):
    """Return the sum of the square roots of the first-order distances of every stride-th reading.

    Square roots let the many small distances outweigh a few large ones without asking for a scale.
    """
    a, b, c, d, e, f = conic[0], conic[1], conic[2], conic[3], conic[4], conic[5]
    total = 0.0
    for k in range(n // stride):
        i = k * stride
        az = a * z[i] + 0.5 * b * y[i]
        cy = 0.5 * b * z[i] + c * y[i]
        value = (az + d) * z[i] + (cy + e) * y[i] + f
        gz = 2.0 * az + d
        gy = 2.0 * cy + e
        total += sqrt(sqrt(value * value / (gz * gz + gy * gy + 1e-30)))
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def robust_start(p, z, y, w, n, par, sectors, small):
    """Write the start for the circle (p = 3) or the ellipse (p = 5) into `par`; return whether there is one.

    `sectors` (SECTORS + 2, 15) and `small` (3, 5, 5) are scratch. An ellipse candidate flatter than 5:1 is passed over
    for the circle of the same readings.
    """
    everything, part = sectors[SECTORS], sectors[SECTORS + 1]
    for j in range(15):
        everything[j] = 0.0
    for k in range(SECTORS):
        add_moments(z, y, w, k * n // SECTORS, (k + 1) * n // SECTORS, sectors[k])
        for j in range(15):
            everything[j] += sectors[k, j]
    normal, vectors = small[0], small[1]
    trial = vectors[0]
    conic = small[2].ravel()[:6]
    stride = max(n // JUDGED, 1)
    best = 1e300
    for k in range(SECTORS + 1):
        if k == SECTORS:
            part[:] = everything
        else:
            part[:] = 0.0
            for away in range(LEFT_OUT, SECTORS):
                sector = sectors[(k + away) % SECTORS]
                for j in range(15):
                    part[j] += sector[j]
        found = False
        if p == 5 and gander(part, conic, normal, vectors[1]):
            found = ellipse_of_conic(conic, trial)
            found = found and trial[3] ** 2 + trial[4] ** 2 < (2.0 / 3.0 * trial[2]) ** 2
        if not found:
            if not circle_from_moments(part, TAUBIN, trial):
                continue
            trial[3] = 0.0
            trial[4] = 0.0
            conic[0] = 1.0
            conic[1] = 0.0
            conic[2] = 1.0
            conic[3] = -2.0 * trial[0]
            conic[4] = -2.0 * trial[1]
            conic[5] = trial[0] ** 2 + trial[1] ** 2 - trial[2] ** 2
        misfit = _misfit(z, y, n, conic, stride)
        if misfit < best:
            best = misfit
            for j in range(p):
                par[j] = trial[j]
    return best < 1e300
