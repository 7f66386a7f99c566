"""The hidden chain of the drift: forward and backward passes on a grid, compiled; the model is in docs/compare.md.

Lengths in m. The grid of drift is d_k = low + k step, k = 0 ... cells - 1.
"""

from __future__ import annotations

import numpy as np
from numba import njit

WIDE_SHARE = 0.1
"""Share of readings whose noise is `WIDE` times the usual: miscounted, or misjudged by eye."""
WIDE = 4.0
_REACH = 4.5
_NARROW = 20.0
_ROOT_TWO_PI = 2.5066282746310002


@njit(cache=True, error_model="numpy")
def density(z, sigma):
    """Return the density [1/m] of a difference of chainages z [m] of the same feature, sd `sigma` [m] with outliers."""
    half = 0.5 * (z / sigma) ** 2
    found = WIDE_SHARE / WIDE * np.exp(-half / (WIDE * WIDE))
    if half < _NARROW:
        found += (1.0 - WIDE_SHARE) * np.exp(-half)
    return found / (_ROOT_TWO_PI * sigma)


@njit(cache=True, error_model="numpy")
def emission(u, shared, y, ratio, extent, sigma, low, step, cells, out):
    """Fill `out` (cells,) with the likelihood ratio of one feature of A at each drift.

    u: its scaled chainage; shared: its probability of being in B; y (m,) B's chainages, rising; ratio (m,) weight of
    each, 1/m taken off by the density; extent (2,) of B; sigma: sd of a difference.
    """
    for k in range(cells):
        v = u + low + k * step
        out[k] = 1.0 - shared if extent[0] <= v <= extent[1] else 1.0
    reach = _REACH * WIDE * sigma
    first = np.searchsorted(y, u + low - reach)
    last = np.searchsorted(y, u + low + (cells - 1) * step + reach)
    for j in range(first, last):
        if ratio[j] < 1e-12:
            continue
        centre = (y[j] - u - low) / step
        begin = max(0, int(np.ceil(centre - reach / step)))
        end = min(cells - 1, int(np.floor(centre + reach / step)))
        for k in range(begin, end + 1):
            out[k] += ratio[j] * density((k - centre) * step, sigma)


@njit(cache=True, error_model="numpy")
def _walk(p, sd, step, out, kernel):
    """Convolve p with a Gaussian of `sd`, its variance kept also when it is under a cell."""
    n = p.size
    variance = (sd / step) ** 2
    if variance < 0.3:
        half = 0.5 * variance
        for k in range(n):
            left = p[k - 1] if k > 0 else 0.0
            right = p[k + 1] if k < n - 1 else 0.0
            out[k] = (1.0 - variance) * p[k] + half * (left + right)
        return
    reach = min(kernel.size - 1, int(np.ceil(_REACH * sd / step)))
    total = 0.0
    for w in range(reach + 1):
        kernel[w] = np.exp(-0.5 * w * w / variance)
        total += kernel[w] if w == 0 else 2.0 * kernel[w]
    for k in range(n):
        out[k] = 0.0
    for w in range(-reach, reach + 1):
        g = kernel[abs(w)] / total
        for k in range(max(0, -w), min(n, n - w)):
            out[k] += g * p[k + w]


@njit(cache=True, error_model="numpy")
def transition(p, gap, walk, slip_rate, slip_scale, step, out, jump, kernel):
    """Fill `out` with p (cells,) carried over `gap` [m]: a Gaussian walk, and at times a Laplace jump; symmetric."""
    n = p.size
    _walk(p, walk * np.sqrt(gap), step, out, kernel)
    slip = 1.0 - np.exp(-slip_rate * gap)
    if slip <= 0.0:
        return
    a = np.exp(-step / slip_scale)
    share = (1.0 - a) / (1.0 + a)
    run = 0.0
    for k in range(n):
        run = a * run + out[k]
        jump[k] = share * run
    run = 0.0
    for k in range(n - 1, -1, -1):
        jump[k] += share * a * run
        run = a * run + out[k]
    for k in range(n):
        out[k] = (1.0 - slip) * out[k] + slip * jump[k]


@njit(cache=True, error_model="numpy")
def forward(u, shared, y, ratio, extent, sigma, walk, slip_rate, slip_scale, low, step, start, end, keep):
    """Run the chain over A's features.

    Args:
        u: (n,) scaled chainages of A, rising.
        shared: (n,) probability of being in B.
        y: (m,) chainages of B, rising.
        ratio: (n, m) weights of the pairs.
        extent: (2,) of B.
        sigma: (n,) one-sigma of the distance of each feature to its partner in B.
        walk, slip_rate, slip_scale: As in `MatchOptions`.
        low, step: The grid of drift.
        start: (cells,) weight of each drift at the first feature.
        end: (cells,) weight of each drift at the last.
        keep: Whether to return the passes.

    Returns:
        Log of the evidence; filtered probabilities (n, cells) and emissions (n, cells) in float32, empty unless kept.
    """
    n, cells = u.size, start.size
    rows = n if keep else 0
    alpha = np.empty((rows, cells), np.float32)
    seen = np.empty((rows, cells), np.float32)
    p, q, e, jump = start.copy(), np.empty(cells), np.empty(cells), np.empty(cells)
    kernel = np.empty(cells)
    log_evidence = 0.0
    for i in range(n):
        if i > 0:
            transition(p, u[i] - u[i - 1], walk, slip_rate, slip_scale, step, q, jump, kernel)
            p, q = q, p
        emission(u[i], shared[i], y, ratio[i], extent, sigma[i], low, step, cells, e)
        total = 0.0
        for k in range(cells):
            p[k] *= e[k]
            if i == n - 1:
                p[k] *= end[k]
            total += p[k]
        if not total > 0.0:
            return -np.inf, alpha, seen
        log_evidence += np.log(total)
        for k in range(cells):
            p[k] /= total
        if keep:
            alpha[i] = p
            seen[i] = e
    return log_evidence, alpha, seen


@njit(cache=True, error_model="numpy")
def smooth(u, alpha, seen, walk, slip_rate, slip_scale, step, end):
    """Turn filtered into smoothed probabilities, in place: alpha (n, cells) of `forward`, its rows then sum to one."""
    n, cells = alpha.shape
    beta, q, jump, kernel = end.copy(), np.empty(cells), np.empty(cells), np.empty(cells)
    for i in range(n - 2, -1, -1):
        for k in range(cells):
            beta[k] *= seen[i + 1, k]
        transition(beta, u[i + 1] - u[i], walk, slip_rate, slip_scale, step, q, jump, kernel)
        beta, q = q, beta
        top = beta.max()
        total = 0.0
        for k in range(cells):
            beta[k] /= top
            alpha[i, k] *= beta[k]
            total += alpha[i, k]
        for k in range(cells):
            alpha[i, k] /= total


@njit(cache=True, error_model="numpy")
def pair_shares(u, y, ratio, sigma, low, step, gamma, seen, out):
    """Add to `out` (n, m) the posterior of each pair, from smoothed gamma (n, cells) and emissions seen (n, cells)."""
    cells = gamma.shape[1]
    for i in range(u.size):
        reach = _REACH * WIDE * sigma[i]
        first = np.searchsorted(y, u[i] + low - reach)
        last = np.searchsorted(y, u[i] + low + (cells - 1) * step + reach)
        for j in range(first, last):
            if ratio[i, j] < 1e-12:
                continue
            centre = (y[j] - u[i] - low) / step
            begin = max(0, int(np.ceil(centre - reach / step)))
            end = min(cells - 1, int(np.floor(centre + reach / step)))
            share = 0.0
            for k in range(begin, end + 1):
                if gamma[i, k] > 1e-12:
                    share += gamma[i, k] * ratio[i, j] * density((k - centre) * step, sigma[i]) / seen[i, k]
            out[i, j] += share


@njit(cache=True, error_model="numpy")
def posterior(log_ratio, gap, walk, slip_rate, slip_scale, step, start):
    """Return the smoothed chain of a drift whose likelihood ratio is known on the grid.

    Args:
        log_ratio: (n, cells) log likelihood ratio of each place along the pipe at each drift.
        gap: (n - 1,) distances between the places [m].
        walk, slip_rate, slip_scale: As in `MatchOptions`.
        step: Of the grid of drift [m].
        start: (cells,) weight of each drift at the first place, summing to one.

    Returns:
        Posterior of the drift (n, cells) in float32, and the log of the evidence.
    """
    n, cells = log_ratio.shape
    alpha = np.empty((n, cells), np.float32)
    p, q, jump, kernel = start.copy(), np.empty(cells), np.empty(cells), np.empty(cells)
    log_evidence = 0.0
    for i in range(n):
        if i > 0:
            transition(p, gap[i - 1], walk, slip_rate, slip_scale, step, q, jump, kernel)
            p, q = q, p
        top = log_ratio[i].max()
        total = 0.0
        for k in range(cells):
            p[k] *= np.exp(log_ratio[i, k] - top)
            total += p[k]
        if not total > 0.0:
            return alpha, -np.inf
        log_evidence += top + np.log(total)
        for k in range(cells):
            p[k] /= total
        alpha[i] = p
    beta = np.ones(cells)
    for i in range(n - 2, -1, -1):
        top = log_ratio[i + 1].max()
        for k in range(cells):
            beta[k] *= np.exp(log_ratio[i + 1, k] - top)
        transition(beta, gap[i], walk, slip_rate, slip_scale, step, q, jump, kernel)
        beta, q = q, beta
        most = beta.max()
        total = 0.0
        for k in range(cells):
            beta[k] /= most
            alpha[i, k] *= beta[k]
            total += alpha[i, k]
        for k in range(cells):
            alpha[i, k] /= total
    return alpha, log_evidence


def likeliest(gamma: np.ndarray, drift: np.ndarray, half: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return mean (n,) [m], variance (n,) [m2] and probability (n,) of the likeliest place.

    Args:
        gamma: (n, cells) posterior of the drift.
        drift: (cells,) drift of each cell [m].
        half: How far a place reaches from its middle to both sides [m].
    """
    width = max(1, round(half / (drift[1] - drift[0])))
    sums = np.concatenate((np.zeros((len(gamma), 1)), np.cumsum(gamma, axis=1, dtype=np.float64)), axis=1)
    cells = np.arange(gamma.shape[1])
    low, high = np.maximum(cells - width, 0), np.minimum(cells + width + 1, gamma.shape[1])
    top = np.argmax(sums[:, high] - sums[:, low], axis=1)
    part = np.where(np.abs(cells[None, :] - top[:, None]) <= width, gamma, 0.0).astype(np.float64)
    mass = part.sum(axis=1)
    mean = part @ drift / mass
    return mean, (part * (drift[None, :] - mean[:, None]) ** 2).sum(axis=1) / mass, np.minimum(mass, 1.0)
