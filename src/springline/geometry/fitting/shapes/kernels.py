"""Compiled parts of the fit of a wall to rings: residuals, steps that keep to their floors, and their judgement.

Unknowns of a ring are centre z, centre y, K coordinates of the wall and, where it is free, the turn. Residuals are
readings less wall, positive outside; a row of the jacobian is how the wall moves towards the reading. Arrays run over
(ring, ..., reading); `rows` are the rings to do.
"""

from __future__ import annotations

from math import atan2, cos, log, pi, sin, sqrt

import numpy as np

from .._jit import kernel, vector_kernel
from .._linalg import factorise, substitute
from .._readings import quantile
from .._refine import (
    LOSS,
    SCALE_KAPPA,
    SCALE_MOMENT,
    SCALE_WEIGHT,
    SCORE,
    SLOPE,
    USED,
    WEIGHT,
    weigh,
)

PLAIN, CAUCHY, TUKEY = range(3)
"""Losses: least squares, one that every reading keeps pulling at, and one that lets go of outliers."""

CAUCHY_CUT = 2.385
"""Width of Cauchy's loss in sigmas: 95 % efficiency on Gaussian noise."""

LEAST_FACING = 0.2
"""Least cosine of a ray to the wall's normal by which a distance to the wall is turned into one along the ray."""

LEAST_SQUARE = 1e-6
"""Squared distance, over the squared radius, below which readings count as being on the wall."""

LEAST_NOISE = 3e-6
"""Smallest noise that is believed, over the radius: no reading is finer, and below it a few readings that the fit has
not yet reached would look like outliers."""

MOVED, CONVERGED, STALLED = range(3)

_MOST_DAMPING = 1e4
_HEAVY_DAMPING = 1.0
_LEAST_GAIN = 1e-4
_RIDGE = 1e-12


@kernel
def place(rows, z, y, counts, unknowns, turning, fixed_turn, bearing):
    """Fill the bearing of each reading about O in the section's own frame; unknowns are (ring, unknown)."""
    last = unknowns.shape[1] - 1
    for ring in rows:
        turn = fixed_turn[ring] + (unknowns[ring, last] if turning else 0.0)
        for i in range(counts[ring]):
            angle = atan2(y[ring, i] - unknowns[ring, 1], z[ring, i] - unknowns[ring, 0])
            bearing[ring, i] = (angle - turn) % (2.0 * pi)


@vector_kernel
def compare(
    rows, z, y, counts, unknowns, turning, fixed_turn, bearing, radius, slope, by, rays, along, side, residual, jacobian
):
    """Fill residuals and jacobian in the side of each ring that `side` names.

    Args:
        bearing, radius, slope, by: Of the wall, in the section's own frame.
        rays: (2, N, M) unit vectors from the sensor to each reading.
        along: Whether residuals are along these rays; otherwise along the wall's normal.
        side: (N,) 0 or 1.
        residual: (2, N, M) output.
        jacobian: (2, N, P, M) output.
    """
    count = by.shape[1]
    last = unknowns.shape[1] - 1
    for ring in rows:
        turn = fixed_turn[ring] + (unknowns[ring, last] if turning else 0.0)
        e, j = residual[side[ring], ring], jacobian[side[ring], ring]
        for i in range(counts[ring]):
            dz, dy = z[ring, i] - unknowns[ring, 0], y[ring, i] - unknowns[ring, 1]
            r, s = radius[ring, i], slope[ring, i]
            inverse = 1.0 / sqrt(r * r + s * s)
            facing, lean = r * inverse, s * inverse
            ez, ey = cos(bearing[ring, i] + turn), sin(bearing[ring, i] + turn)
            nz, ny = facing * ez + lean * ey, facing * ey - lean * ez
            factor = 1.0
            if along:
                factor = 1.0 / max(rays[0, ring, i] * nz + rays[1, ring, i] * ny, LEAST_FACING)
            e[i] = (sqrt(dz * dz + dy * dy) - r) * facing * factor
            j[0, i] = nz * factor
            j[1, i] = ny * factor
            for k in range(count):
                j[2 + k, i] = by[ring, k, i] * facing * factor
            if turning:
                j[last, i] = -r * lean * factor


@vector_kernel
def _weigh(kind, distance, prior, n, sigma, omega, sums):
    """As `_refine.weigh`, for any of the losses."""
    if kind != CAUCHY:
        weigh(distance, prior, n, sigma, kind == TUKEY, omega, sums)
        return
    loss = 0.0
    inverse = 1.0 / (CAUCHY_CUT * sigma) ** 2
    for i in range(n):
        u = 1.0 + prior[i] * distance[i] * distance[i] * inverse
        omega[i] = prior[i] / u
        loss += log(u)
    sums[LOSS] = 0.5 * CAUCHY_CUT**2 * loss
    sums[WEIGHT] = sums[SLOPE] = sums[USED] = n


@kernel
def _scale(kind, distance, prior, n, p, sigma, sums, scratch):
    """Return the noise that follows from the residuals: robust, but for least squares."""
    if kind == TUKEY:
        ratio = sums[SCALE_MOMENT] / (SCALE_KAPPA * sums[SCALE_WEIGHT]) * n / (n - p)
        return max(sigma * ratio**0.85, LEAST_NOISE)
    if kind == PLAIN:
        return max(sigma * sqrt(2.0 * sums[LOSS] / max(n - p, 1)), LEAST_NOISE)
    for i in range(n):
        scratch[i] = prior[i] * distance[i] * distance[i]
    return max(1.4826 * sqrt(quantile(scratch, n, min(n, (n + p) // 2 + 1))), LEAST_NOISE)


@kernel
def begin(rows, kind, counts, prior, side, residual, sigma, fixed, omega, sums):
    """Fill noise, weights and sums of the rings for a loss; a noise that is `fixed` stays as it is."""
    scratch = np.empty(prior.shape[1])
    size = 2
    for ring in rows:
        e, n = residual[side[ring], ring], counts[ring]
        if not fixed:
            sigma[ring] = _scale(CAUCHY, e, prior[ring], n, size, 1.0, sums[ring], scratch)
        _weigh(kind, e, prior[ring], n, sigma[ring], omega[ring], sums[ring])
        for _ in range(0 if fixed or kind == CAUCHY else 4):
            sigma[ring] = _scale(kind, e, prior[ring], n, size, sigma[ring], sums[ring], scratch)
            _weigh(kind, e, prior[ring], n, sigma[ring], omega[ring], sums[ring])


@vector_kernel
def _gram(p, n, jacobian, distance, omega, product, normal, gradient):
    """Fill normal = J W J^T and gradient = J W d for any number of unknowns; `product` is scratch."""
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


@kernel
def _bounded_step(p, normal, gradient, damping, room, head, low, right, held, step):
    """Solve for the step that stays above `room` and below `head` (both steps); return whether there is one.

    Unknowns whose free step would cross a limit are held there, and the others solved again.
    """
    largest = 0.0
    for a in range(p):
        held[a] = 0.0
        largest = max(largest, normal[a, a])
    for _ in range(p):
        for a in range(p):
            right[a] = 0.0 if held[a] else gradient[a]
            for b in range(p):
                low[a, b] = 0.0 if held[a] or held[b] else normal[a, b]
                if held[b] and not held[a]:
                    right[a] -= normal[a, b] * step[b]
            low[a, a] = 1.0 if held[a] else normal[a, a] * (1.0 + damping) + _RIDGE * largest
        if not factorise(low, p, low):
            return False
        for a in range(p):
            if held[a]:
                right[a] = step[a]
        substitute(low, p, right, right)
        crossed = False
        for a in range(p):
            if not held[a]:
                step[a] = right[a]
                if step[a] < room[a] or step[a] > head[a]:
                    step[a] = min(max(step[a], room[a]), head[a])
                    held[a] = 1.0
                    crossed = True
        if not crossed:
            break
    return True


@kernel
def propose(
    rows, kind, counts, side, residual, jacobian, omega, sums, unknowns, floor, ceiling, damping, trial, length
):
    """Fill the trial unknowns of the rings and the length of their step in sigmas times the noise, squared.

    The length is negative where no step can be solved for.
    """
    p = unknowns.shape[1]
    normal, low = np.empty((p, p)), np.empty((p, p))
    gradient, right, held, step = np.empty(p), np.empty(p), np.empty(p), np.empty(p)
    room, head, product = np.empty(p), np.empty(p), np.empty(omega.shape[1])
    for ring in rows:
        _gram(
            p, counts[ring], jacobian[side[ring], ring], residual[side[ring], ring], omega[ring], product, normal,
            gradient,
        )  # fmt: skip
        for a in range(p):
            room[a], head[a] = floor[a] - unknowns[ring, a], ceiling[a] - unknowns[ring, a]
        if not _bounded_step(p, normal, gradient, damping[ring], room, head, low, right, held, step):
            length[ring] = -1.0
            continue
        # a redescending score is flatter than its weights: a longer step makes convergence nearly quadratic
        stretch = 1.0
        if kind == TUKEY and damping[ring] == 0.0:
            stretch = min(max(sums[ring, WEIGHT] / max(sums[ring, SLOPE], 1e-3), 1.0), 1.6)
        total = 0.0
        for a in range(p):
            part = 0.0
            for b in range(p):
                part += normal[a, b] * step[b]
            total += step[a] * part
            trial[ring, a] = unknowns[ring, a] + min(max(stretch * step[a], room[a]), head[a])
        length[ring] = total


@kernel
def judge(
    rows, valid, kind, counts, prior, side, residual, fixed, unknowns, trial, length, tolerance, sigma, damping, omega,
    sums, verdict,
):  # fmt: skip
    """Take the trials that lessen the loss, refuse the others, and say how each ring stands in `verdict`.

    Residuals of the trials lie in the other side. A ring has converged when its step was shorter than `tolerance`
    sigmas, or when heavily damped steps along the gradient gain next to nothing: where a reading lies on a hinge or a
    corner the loss has a kink, and its minimum may lie there. A ring is stalled when no step leads to a section.
    """
    p = unknowns.shape[1]
    scratch_omega, scratch, scratch_sums = np.empty(omega.shape[1]), np.empty(omega.shape[1]), np.empty(sums.shape[1])
    for place in range(rows.size):
        ring = rows[place]
        n = counts[ring]
        better = False
        if valid[place] and length[ring] >= 0.0:
            e = residual[1 - side[ring], ring]
            _weigh(kind, e, prior[ring], n, sigma[ring], scratch_omega, scratch_sums)
            better = scratch_sums[LOSS] <= sums[ring, LOSS] * (1.0 + 1e-12) + 1e-12
        heavy = damping[ring] >= _HEAVY_DAMPING
        short = not heavy and 0.0 <= length[ring] <= (tolerance * sigma[ring]) ** 2 + n * 1e-30
        if better:
            side[ring] = 1 - side[ring]
            for a in range(p):
                unknowns[ring, a] = trial[ring, a]
            gain = sums[ring, LOSS] - scratch_sums[LOSS]
            verdict[ring] = CONVERGED if short or (heavy and gain < _LEAST_GAIN) else MOVED
            damping[ring] = 0.1 * damping[ring] if damping[ring] > 1e-6 else 0.0
            sums[ring] = scratch_sums
            if not fixed:
                sigma[ring] = _scale(kind, e, prior[ring], n, p, sigma[ring], scratch_sums, scratch)
            _weigh(kind, e, prior[ring], n, sigma[ring], omega[ring], sums[ring])
        else:
            damping[ring] = max(10.0 * damping[ring], 1e-3)
            last = damping[ring] > _MOST_DAMPING
            verdict[ring] = CONVERGED if short or (last and valid[place]) else STALLED if last else MOVED


@kernel
def information(rows, counts, side, residual, jacobian, omega, normal):
    """Fill the normal matrices (N, P, P) of the rings."""
    p = jacobian.shape[2]
    gradient, product = np.empty(p), np.empty(omega.shape[1])
    for ring in rows:
        _gram(
            p, counts[ring], jacobian[side[ring], ring], residual[side[ring], ring], omega[ring], product, normal[ring],
            gradient,
        )  # fmt: skip


@kernel
def variances(rows, kind, sigma, sums, size, out):
    """Fill (N,) the factor from inverse normal matrix to covariance: sigma^2 times what robustness costs.

    As for ellipses: the mean of psi^2 over the squared mean of psi', on the readings that still have weight.
    """
    for ring in rows:
        out[ring] = np.nan
        freedom = sums[ring, USED] - size
        if freedom > 0.0:
            out[ring] = sigma[ring] ** 2
            if kind == TUKEY:
                s = sums[ring]
                out[ring] *= s[SCORE] * s[WEIGHT] / s[SLOPE] ** 2 * s[USED] / freedom


@kernel
def misfits(rows, counts, side, residual):
    """Return (R,) mean logarithms of the squared residuals, which many small ones rule whatever the few large."""
    out = np.empty(rows.size)
    for place in range(rows.size):
        ring = rows[place]
        total = 0.0
        for i in range(counts[ring]):
            total += log(min(residual[side[ring], ring, i] ** 2, 1.0) + LEAST_SQUARE)
        out[place] = total / counts[ring]
    return out
