"""A deterministic robust start: algebraic fits, most of which leave out a part of the wall, and then trimming."""

from __future__ import annotations

from math import log

from springline.geometry.fitting._eigen import GANDER, conic_from_moments
from springline.geometry.fitting._jit import kernel, vector_kernel
from springline.geometry.fitting._moments import (
    TAUBIN,
    add_moments,
    circle_from_moments,
    ellipse_of_conic,
)
from springline.geometry.fitting._readings import quantile

SECTORS = 12
"""Parts of equal count into which the readings, in order round the wall, are cut."""

LEFT_OUT = 5
"""Neighbouring sectors that each candidate leaves out: any run of outliers over a quarter of the wall is in one."""

JUDGED = 96
"""About how many readings judge the candidates and trim the best of them."""

FINALISTS = 3

TRIMMED_TO = 0.6
"""Share of the readings on which the finalists concentrate (least trimmed squares)."""

CONCENTRATIONS = 3

LEAST_SQUARE = 1e-12
"""Squared distance, in units of the squared rms radius, below which readings count as being on the wall."""

MOST_OVAL_START = 0.667
"""(a - b)/(a + b) of the flattest ellipse that may be a start."""

NO_FIT = 1e300


@vector_kernel
def _squared_distances(z, y, n, conic, out):
    """Write the square of the first-order distance |F|/|grad F| of each reading to the conic."""
    a, b, c, d, e, f = conic[0], conic[1], conic[2], conic[3], conic[4], conic[5]
    for i in range(n):
        az = a * z[i] + 0.5 * b * y[i]
        cy = 0.5 * b * z[i] + c * y[i]
        value = (az + d) * z[i] + (cy + e) * y[i] + f
        gz = 2.0 * az + d
        gy = 2.0 * cy + e
        out[i] = value * value / (gz * gz + gy * gy + 1e-30)


@vector_kernel
def _misfit(squares, n):
    """Return the sum of the logarithms of the squared distances, which many small ones rule whatever the few large.

    Logarithms are taken of products of 24, whose floor keeps them from underflow.
    """
    total = 0.0
    for first in range(0, n, 24):
        product = 1.0
        for i in range(first, min(first + 24, n)):
            product *= min(squares[i], 1e6) + LEAST_SQUARE
        total += log(product)
    return total


@kernel
def algebraic_start(p, moments, par, conic, small):
    """Write the algebraic circle (p = 3) or ellipse (p = 5) of `moments` as `par` (5) and `conic`; False if none.

    An ellipse flatter than MOST_OVAL_START is passed over for the circle of the same readings.
    """
    found = p == 5 and conic_from_moments(moments, GANDER, conic, small) and ellipse_of_conic(conic, par)
    if found and par[3] ** 2 + par[4] ** 2 < (MOST_OVAL_START * par[2]) ** 2:
        return True
    if not circle_from_moments(moments, TAUBIN, par):
        return False
    par[3] = 0.0
    par[4] = 0.0
    conic[0] = 1.0
    conic[1] = 0.0
    conic[2] = 1.0
    conic[3] = -2.0 * par[0]
    conic[4] = -2.0 * par[1]
    conic[5] = par[0] ** 2 + par[1] ** 2 - par[2] ** 2
    return True


@kernel
def _concentrate(p, judged, n, par, conic, moments, small):
    """Refit to the readings nearest to the candidate, some times over; return the misfit that is left.

    `judged` holds z, y, prior weight, and two rows of scratch.
    """
    z, y, prior, squares, weight = judged[0], judged[1], judged[2], judged[3], judged[4]
    kept = min(max(int(TRIMMED_TO * n), p + 1), n)
    for _ in range(CONCENTRATIONS):
        _squared_distances(z, y, n, conic, squares)
        limit = quantile(squares, n, kept)
        for i in range(n):
            weight[i] = prior[i] if squares[i] <= limit else 0.0
        add_moments(z, y, weight, 0, n, moments)
        if not algebraic_start(p, moments, par, conic, small):
            return NO_FIT
    _squared_distances(z, y, n, conic, squares)
    return _misfit(squares, n)


@kernel
def robust_start(p, z, y, w, n, par, sectors, judged, small):
    """Write the start for the circle (p = 3) or the ellipse (p = 5) into `par`; return whether there is one.

    `sectors` (SECTORS + 3, 15), `judged` (5, n) and `small` (5, 5, 5) are scratch.
    """
    everything, part = sectors[SECTORS], sectors[SECTORS + 1]
    for j in range(15):
        everything[j] = 0.0
    for k in range(SECTORS):
        add_moments(z, y, w, k * n // SECTORS, (k + 1) * n // SECTORS, sectors[k])
        for j in range(15):
            everything[j] += sectors[k, j]
    stride = max(n // JUDGED, 1)
    few = n // stride
    for k in range(few):
        judged[0, k] = z[k * stride]
        judged[1, k] = y[k * stride]
        judged[2, k] = w[k * stride]
    conic = sectors[SECTORS + 2]
    trial = small[4, 2]
    # finalists in order: misfit in the first row, their parts in the second
    misfits, places = small[4, 3], small[4, 4]
    for f in range(FINALISTS):
        misfits[f] = NO_FIT
    for k in range(SECTORS + 1):
        _leave_out(sectors, k, part)
        if not algebraic_start(p, part, trial, conic, small):
            continue
        _squared_distances(judged[0], judged[1], few, conic, judged[3])
        misfit = _misfit(judged[3], few)
        place = float(k)
        for f in range(FINALISTS):
            if misfit < misfits[f]:
                misfit, misfits[f] = misfits[f], misfit
                place, places[f] = places[f], place
    best = NO_FIT
    for f in range(FINALISTS):
        if misfits[f] < NO_FIT:
            _leave_out(sectors, int(places[f]), part)
            if algebraic_start(p, part, trial, conic, small):
                misfit = _concentrate(p, judged, few, trial, conic, part, small)
                if misfit < best:
                    best = misfit
                    for j in range(p):
                        par[j] = trial[j]
    return best < NO_FIT


@kernel
def _leave_out(sectors, first, part):
    """Add up the moments of all sectors but LEFT_OUT from `first` on; of all when `first` is SECTORS."""
    for j in range(15):
        part[j] = sectors[SECTORS, j] if first == SECTORS else 0.0
    if first < SECTORS:
        for away in range(LEFT_OUT, SECTORS):
            sector = sectors[(first + away) % SECTORS]
            for j in range(15):
                part[j] += sector[j]
