"""Gauss-Newton with Levenberg's damping on exact orthogonal distances; robust by Tukey's bisquare."""

from __future__ import annotations

from math import sqrt

from springline.geometry.fitting._feet import circle_feet, ellipse_feet
from springline.geometry.fitting._gram import gram
from springline.geometry.fitting._jit import kernel, vector_kernel
from springline.geometry.fitting._linalg import factorise, substitute
from springline.geometry.fitting._readings import quantile

CUT = 4.685
"""Readings beyond this many sigmas are rejected: 95 % efficiency on Gaussian noise (Tukey's bisquare)."""

SCALE_CUT = 3.0
"""The noise is that of the readings within this many sigmas, by the bisquare that ends there: a wider one would let
outliers widen the noise, and the noise let in more of them."""

SCALE_KAPPA = 0.6324068194537749
"""E[w x^2]/E[w] for the bisquare weight w that ends at SCALE_CUT, x standard normal."""

SCALE_POWER = 1.7
"""Overrelaxation of the scale: its fixed-point steps alone leave 0.43 of the logarithmic error each time."""

SETTLED = 30
"""Iterations after which the noise of a robust fit no longer changes."""

FLOOR = 1e-13
"""Smallest noise that is told from rounding, in units of the rms radius."""

SUMS = 8
LOSS, WEIGHT, SLOPE, SCORE, USED, MOMENT, SCALE_WEIGHT, SCALE_MOMENT = range(SUMS)


@kernel
def feet(p, z, y, n, par, distance, jacobian, foot):
    """Write distances and derivatives for the circle (p = 3) or the ellipse (p = 5)."""
    if p == 3:
        circle_feet(z, y, n, par, distance, jacobian)
    else:
        ellipse_feet(z, y, n, par, distance, jacobian, foot)


@kernel
def possible(p, par):
    """Return whether `par` is a circle or an ellipse at all."""
    if p == 3:
        return par[2] > 0.0
    return par[2] > 0.0 and par[3] * par[3] + par[4] * par[4] < (0.9999 * par[2]) ** 2


@vector_kernel
def weigh(distance, prior, n, sigma, robust, omega, sums):
    """Write each reading's total weight into `omega` and fill `sums` with what is summed over readings.

    For x = distance/sigma and the bisquare weight w that ends at CUT: LOSS of rho(x), WEIGHT of w, SLOPE of psi'(x),
    SCORE of psi(x)^2, USED counts w > 0, MOMENT of x^2; SCALE_WEIGHT and SCALE_MOMENT of w and w x^2 for the w that
    ends at SCALE_CUT. Without `robust`, w = 1 and rho = x^2/2.
    """
    loss = weight = slope = score = used = moment = scale_weight = scale_moment = 0.0
    inverse = 1.0 / (sigma * sigma)
    if robust:
        for i in range(n):
            x2 = prior[i] * distance[i] * distance[i] * inverse
            u = min(x2 * (1.0 / CUT**2), 1.0)
            left = 1.0 - u
            w = left * left
            omega[i] = w * prior[i]
            loss += 1.0 - w * left
            weight += w
            slope += left * (1.0 - 5.0 * u)
            score += w * w * x2
            used += 1.0 if left > 0.0 else 0.0
            narrow = max(1.0 - x2 * (1.0 / SCALE_CUT**2), 0.0)
            narrow *= narrow
            scale_weight += narrow
            scale_moment += narrow * x2
        loss *= CUT**2 / 6.0
    else:
        for i in range(n):
            omega[i] = prior[i]
            moment += prior[i] * distance[i] * distance[i]
        moment *= inverse
        loss = 0.5 * moment
        score = moment
        weight = slope = used = float(n)
    sums[LOSS] = loss
    sums[WEIGHT] = weight
    sums[SLOPE] = slope
    sums[SCORE] = score
    sums[USED] = used
    sums[MOMENT] = moment
    sums[SCALE_WEIGHT] = scale_weight
    sums[SCALE_MOMENT] = scale_moment


@vector_kernel
def _median_scale(distance, prior, n, p, scratch):
    """Return the noise from the median absolute distance, at least FLOOR."""
    for i in range(n):
        scratch[i] = prior[i] * distance[i] * distance[i]
    # p of the distances are near zero because the fit passes through them
    return max(1.4826 * sqrt(quantile(scratch, n, min(n, (n + p) // 2 + 1))), FLOOR)


@kernel
def _next_scale(sums, sigma, n, p):
    """Return a noise nearer to that whose own weighted mean square is that of Gaussian noise."""
    ratio = sums[SCALE_MOMENT] / (SCALE_KAPPA * sums[SCALE_WEIGHT]) * n / (n - p)
    return max(sigma * ratio ** (0.5 * SCALE_POWER), FLOOR)


@kernel
def _damped_step(p, normal, gradient, damping, low, step):
    """Solve for the step; return its squared length in the metric of the normal matrix, or -1 if it is singular."""
    for a in range(p):
        for b in range(p):
            low[a, b] = normal[a, b]
        low[a, a] += damping * normal[a, a]
    if not factorise(low, p, low):
        return -1.0
    substitute(low, p, gradient, step)
    length = 0.0
    for a in range(p):
        length += step[a] * gradient[a]
    return length


@kernel
def refine(p, z, y, prior, n, par, robust, tolerance, rows, sums, small):
    """Bring `par` to the least (robust) sum of squared distances; return (whether it converged, sigma).

    `rows` (10, n) is scratch that leaves with the distances in row 0, the weights in row 1 and the derivatives in rows
    5 to 9; `small` (5, 5, 5) is scratch, `sums` leaves as `weigh` fills it. `tolerance` is the length of the last
    step in sigmas of the parameters: what the distances of the step before it are off by.
    """
    distance, omega, foot, scratch, jacobian = rows[0], rows[1], rows[2], rows[3], rows[5:10]
    normal, low = small[0], small[1]
    gradient, step, trial = small[2, 0], small[2, 1], small[2, 2]
    feet(p, z, y, n, par, distance, jacobian, foot)
    sigma = 1.0
    if robust:
        sigma = _median_scale(distance, prior, n, p, scratch)
        for _ in range(4):
            weigh(distance, prior, n, sigma, robust, omega, sums)
            sigma = _next_scale(sums, sigma, n, p)
    weigh(distance, prior, n, sigma, robust, omega, sums)
    damping = 0.0
    for count in range(100):
        gram(p, n, jacobian, distance, omega, normal, gradient)
        loss = sums[LOSS]
        if not robust:
            sigma = max(sqrt(2.0 * loss / max(n - p, 1)), FLOOR)
        # a redescending score is flatter than its weights: stretching the step makes convergence nearly quadratic
        stretch = min(max(sums[WEIGHT] / max(sums[SLOPE], 1e-3), 1.0), 1.6)
        moved = False
        for _ in range(30):
            length = _damped_step(p, normal, gradient, damping, low, step)
            if length >= 0.0:
                for a in range(p):
                    trial[a] = par[a] + stretch * step[a]
                if length <= (tolerance * sigma) ** 2 + n * 1e-30:
                    for a in range(p):
                        par[a] = trial[a]
                    return possible(p, par), sigma
                if possible(p, trial):
                    feet(p, z, y, n, trial, distance, jacobian, foot)
                    weigh(distance, prior, n, sigma if robust else 1.0, robust, omega, sums)
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
            # a shape that is no ellipse can make scale and weights chase each other; the scale stops first
            if count < SETTLED:
                sigma = _next_scale(sums, sigma, n, p)
            weigh(distance, prior, n, sigma, robust, omega, sums)
    return False, sigma
