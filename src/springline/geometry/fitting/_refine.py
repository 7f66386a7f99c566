"""Gauss-Newton with Levenberg's damping on exact orthogonal distances; robust by Tukey's bisquare."""

from __future__ import annotations

from math import sqrt

from numba import njit

from springline.geometry.fitting._feet import circle_feet, ellipse_feet
from springline.geometry.fitting._linalg import FAST, factorise, substitute
from springline.geometry.fitting._readings import select

CUT = 4.685
"""Readings beyond this many sigma are rejected: 95 % efficiency on Gaussian noise (Tukey's bisquare)."""

KAPPA = 0.8280
"""E[w x^2]/E[w] of the bisquare weight w at CUT for standard normal x."""

FLOOR = 1e-13
"""Smallest noise that is told from rounding, in units of the rms radius."""

# rows of the sums of `weigh`
LOSS, WEIGHT, SLOPE, SCORE, MOMENT, USED = range(6)


@njit(cache=True, nogil=True, error_model="numpy")
def feet(p, z, y, n, par, distance, jacobian, foot):
    """Write distances and derivatives for the circle (p = 3) or the ellipse (p = 5)."""
    if p == 3:
        circle_feet(z, y, n, par, distance, jacobian)
    else:
        ellipse_feet(z, y, n, par, distance, jacobian, foot)


@njit(cache=True, nogil=True, error_model="numpy")
def possible(p, par):
    """Return whether `par` is a circle or an ellipse at all."""
    if p == 3:
        return par[2] > 0.0
    return par[2] > 0.0 and par[3] * par[3] + par[4] * par[4] < (0.9999 * par[2]) ** 2


@njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
def weigh(distance, prior, n, sigma, robust, omega, sums):
    """Write each reading's total weight into `omega` and fill `sums`: loss, weight, slope, score, moment, used.

    For x = distance/sigma: loss is the sum of rho(x), weight of w(x), slope of psi'(x), score of psi(x)^2, moment of
    w(x) x^2, used the count of readings with a weight. Without `robust`, w = 1 and rho = x^2/2.
    """
    loss = 0.0
    weight = 0.0
    slope = 0.0
    score = 0.0
    moment = 0.0
    used = 0.0
    inverse = 1.0 / (sigma * sigma)
    if robust:
        cut2 = CUT * CUT
        for i in range(n):
            x2 = prior[i] * distance[i] * distance[i] * inverse
            u = min(x2 / cut2, 1.0)
            left = 1.0 - u
            w = left * left
            omega[i] = w * prior[i]
            loss += 1.0 - w * left
            weight += w
            slope += left * (1.0 - 5.0 * u)
            score += w * w * x2
            moment += w * x2
            used += 1.0 if left > 0.0 else 0.0
        loss *= cut2 / 6.0
    else:
        for i in range(n):
            x2 = prior[i] * distance[i] * distance[i] * inverse
            omega[i] = prior[i]
            moment += x2
        loss = 0.5 * moment
        weight = slope = used = n
        score = moment
    sums[LOSS] = loss
    sums[WEIGHT] = weight
    sums[SLOPE] = slope
    sums[SCORE] = score
    sums[MOMENT] = moment
    sums[USED] = used


@njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
def gram(p, n, jacobian, distance, omega, product, normal, gradient):
    """Fill normal = J W J^T and gradient = J W d, summing over readings; `product` is scratch."""
    for a in range(p):
        row = jacobian[a]
        total = 0.0
        for i in range(n):
            product[i] = omega[i] * row[i]
            total += product[i] * distance[i]
        gradient[a] = total
        for b in range(a, p):
            other = jacobian[b]
            total = 0.0
            for i in range(n):
                total += product[i] * other[i]
            normal[a, b] = total
            normal[b, a] = total


@njit(cache=True, nogil=True, error_model="numpy", fastmath=FAST)
def _standardised(distance, prior, n, out):
    for i in range(n):
        out[i] = abs(distance[i]) * sqrt(prior[i])


@njit(cache=True, nogil=True, error_model="numpy")
def quantile_scale(distance, prior, n, p, scratch):
    """Return the noise from the median absolute distance, at least FLOOR."""
    _standardised(distance, prior, n, scratch)
    # p of the distances are near zero because the fit passes through them
    k = min(n - 1, (n + p) // 2)
    return max(1.4826 * select(scratch, n, k), FLOOR)


@njit(cache=True, nogil=True, error_model="numpy")
def weighted_scale(sums, sigma, p):
    """Return the noise for which the weighted mean square is that of Gaussian noise, from the `sums` at `sigma`."""
    free = max(sums[USED] - p, 1.0) / sums[USED]
    return max(sigma * sqrt(sums[MOMENT] / (KAPPA * sums[WEIGHT] * free)), FLOOR)


@njit(cache=True, nogil=True, error_model="numpy")
def refine(p, z, y, prior, n, par, robust, tolerance, rows, sums, small):
    """Bring `par` to the least (robust) sum of squared distances; return (whether it converged, sigma).

    `rows` (10, n) is scratch that leaves with distance in row 0, the weights in row 1 and the derivatives in rows
    5 to 9; `small` (3, 5, 5) leaves with the normal matrix in 0. `sums` leaves as `weigh` fills it. The tolerance is
    the length of the last step in sigmas of the parameters.
    """
    distance, omega, foot, product, trial_omega = rows[0], rows[1], rows[2], rows[3], rows[4]
    jacobian = rows[5:10]
    normal, low, vectors = small[0], small[1], small[2]
    gradient, step, trial = vectors[0], vectors[1], vectors[2]
    feet(p, z, y, n, par, distance, jacobian, foot)
    sigma = quantile_scale(distance, prior, n, p, product) if robust else 1.0
    weigh(distance, prior, n, sigma, robust, omega, sums)
    damping = 0.0
    for _ in range(100):
        gram(p, n, jacobian, distance, omega, product, normal, gradient)
        loss = sums[LOSS]
        # a redescending score is flatter than its weights: stretching the step makes convergence nearly quadratic
        stretch = min(max(sums[WEIGHT] / max(sums[SLOPE], 1e-3), 1.0), 1.6)
        length = 0.0
        moved = False
        for _ in range(30):
            for a in range(p):
                for b in range(p):
                    low[a, b] = normal[a, b]
                low[a, a] += damping * normal[a, a]
            # low is overwritten from its own lower triangle, which the factor needs only once
            if factorise(low, p, low):
                substitute(low, p, gradient, step)
                length = 0.0
                for a in range(p):
                    length += step[a] * gradient[a]
                    trial[a] = par[a] + stretch * step[a]
                spread = sigma if robust else max(sqrt(2.0 * loss / max(n - p, 1)), FLOOR)
                if length <= (tolerance * spread) ** 2 + n * 1e-30:
                    for a in range(p):
                        par[a] = trial[a]
                    return possible(p, par), spread
                if possible(p, trial):
                    feet(p, z, y, n, trial, distance, jacobian, foot)
                    weigh(distance, prior, n, sigma, robust, trial_omega, sums)
                    if sums[LOSS] <= loss * (1.0 + 1e-12):
                        moved = True
                        break
            damping = max(10.0 * damping, 1e-3)
            stretch = 1.0
        if not moved:
            return False, sigma
        damping = 0.1 * damping if damping > 1e-6 else 0.0
        for a in range(p):
            par[a] = trial[a]
        if robust:
            sigma = weighted_scale(sums, sigma, p)
            weigh(distance, prior, n, sigma, robust, omega, sums)
        else:
            omega, trial_omega = trial_omega, omega
    return False, sigma
