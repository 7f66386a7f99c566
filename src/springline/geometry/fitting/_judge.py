"""What makes a fit a failure: too few readings, collinear, an arc too short, readings too scattered."""

from __future__ import annotations

from math import atan2, cos, nan, pi, sqrt

from springline.geometry.fitting._jit import kernel, vector_kernel

FITTED, TOO_FEW, COLLINEAR, SHORT_ARC, NO_CONVERGENCE, NOT_AN_ELLIPSE, SCATTERED = range(7)
"""The flags of `springline.conventions.FIT_STATUS`."""

FLATTEST = 1e-9
"""Spread of the readings across their line over that along it, below which they are collinear."""

MOST_OVAL = 0.99
"""(a - b)/(a + b) beyond which an ellipse has collapsed to a line."""

ARC_BINS = 64


@vector_kernel
def _mean_direction(z, y, omega, n, par):
    """Return the length of the mean unit vector from the centre to the readings with weight."""
    total_z = 0.0
    total_y = 0.0
    count = 0.0
    for i in range(n):
        dz = z[i] - par[0]
        dy = y[i] - par[1]
        used = 1.0 if omega[i] > 0.0 else 0.0
        unit = used / sqrt(dz * dz + dy * dy + 1e-300)
        total_z += dz * unit
        total_y += dy * unit
        count += used
    return sqrt(total_z * total_z + total_y * total_y) / count


@kernel
def spans(least, z, y, omega, n, par, low, high):
    """Return whether the readings with weight span at least the angle `least` [rad] about the centre.

    The span is 2 pi less the widest gap. `low` and `high` are scratch for bins of the diamond angle, which orders as
    the bearing does and turns at most twice as slowly; only a doubtful case asks for true angles.
    """
    # directions within a narrow fan have a long mean
    if least < pi and _mean_direction(z, y, omega, n, par) < cos(0.5 * least) - 1e-9:
        return True
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


@kernel
def _bearing(turn):
    """Return the bearing [rad], in [0, 2 pi), of a diamond angle in [0, 4)."""
    quarter = int(turn)
    part = turn - quarter
    return 0.5 * pi * quarter + atan2(part, 1.0 - part)


@kernel
def collapsed(p, par):
    """Return whether `par` is no ellipse, or one so flat that it is a line."""
    if p == 3:
        return not par[2] > 0.0
    return not (par[2] > 0.0 and par[3] ** 2 + par[4] ** 2 < (MOST_OVAL * par[2]) ** 2)


@kernel
def erase(par, cov, out):
    """Make everything of a failed fit missing."""
    for a in range(par.size):
        par[a] = nan
        for b in range(par.size):
            cov[a, b] = nan
    for a in range(out.size):
        out[a] = nan
