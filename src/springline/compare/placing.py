"""Pairs and drift of the fitted chain, averaged over the odometer scales that carry weight."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .chain import likeliest
from .lattice import lattice_places
from .result import ONE_PLACE

if TYPE_CHECKING:
    from .fit import Fit, Sense

_LEAST_WEIGHT = 0.01
_MOST_SCALES = 12
_HALF_MODE = 1.2
_HALF_MODULE = 0.4
_LEAST_DOUBT = 1e-9
_CLAIM_SLACK = 0.01


@dataclass(frozen=True)
class Placed:
    """Pairs and drift in the sense that was looked at; fields as in `Pairs` and `Drift`."""

    index_a: np.ndarray
    index_b: np.ndarray
    probability: np.ndarray
    residual: np.ndarray
    chainage_a: np.ndarray
    chainage_b: np.ndarray
    sigma: np.ndarray
    mode_probability: np.ndarray
    spread: float


def place(sense: Sense, fit: Fit, extent: tuple[float, float]) -> Placed:
    """Return pairs and drift, averaged over scales; the drift from end to end of A's `extent` [m]."""
    weights = np.exp(fit.log_evidence - fit.total)
    order = np.argsort(weights)[::-1][:_MOST_SCALES]
    order = order[weights[order] > _LEAST_WEIGHT * weights.max()]
    weights = weights[order] / weights[order].sum()
    half = _half_mode(sense)
    shares = np.zeros((len(sense.a), len(sense.b)))
    modes = []
    for scale, weight in zip(fit.scales[order], weights, strict=True):
        passes = sense.passes(replace(fit.state, scale=float(scale)))
        shares += weight * passes.shares
        mean, variance, mass = likeliest(passes.gamma, passes.grid.drift, half)
        modes.append((passes.u + mean, variance, mass))
    y, sigma, probability = _mix(np.array(modes), weights, half)
    index, index_b, share = _choose(shares, sense.laid.seen, sense.options.accept_pair)
    residual = sense.b.chainage[index_b] - y[index]
    k, at, own = lattice_places(sense, fit.state, index, index_b)
    weight = sigma[k] ** 2 / (sigma[k] ** 2 + own**2)
    sure = probability[k] > ONE_PLACE
    y[k] = np.where(sure, y[k] + weight * (at - y[k]), y[k])
    sigma[k] = np.where(sure, np.sqrt(weight) * own, sigma[k])
    index_a = (np.cumsum(sense.laid.seen) - 1)[index]
    x, keep = np.unique(sense.a.chainage, return_index=True)
    o = sense.options
    spread = fit.state.walk**2 + 2.0 * o.slip_rate * o.slip_scale**2
    nodes = _to_ends(extent, fit.state.scale, spread, np.array([x, y[keep], sigma[keep], probability[keep]]))
    return Placed(index_a, index_b, share, residual, *nodes, spread)


def _to_ends(extent: tuple[float, float], scale: float, spread: float, nodes: np.ndarray) -> np.ndarray:
    """Return nodes (4, n) of chainage in A and B, sigma and probability, carried on to the ends of A."""
    for end, at in ((extent[0], 0), (extent[1], nodes.shape[1])):
        x, y, sigma, probability = nodes[:, min(at, nodes.shape[1] - 1)]
        if x == end:
            continue
        further = [end, y + scale * (end - x), np.sqrt(sigma**2 + spread * abs(end - x)), probability]
        nodes = np.insert(nodes, at if at == 0 else nodes.shape[1], further, axis=1)
    return nodes


def _half_mode(sense: Sense) -> float:
    """Return how far from its top a place reaches [m]: less than half a joint's length, where there are joints."""
    module = sense.laid.module
    return min(_HALF_MODE, _HALF_MODULE * module) if np.isfinite(module) and module > 0 else _HALF_MODE


def _mix(modes: np.ndarray, weights: np.ndarray, half: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return place (n,), sigma (n,) and probability (n,) from the modes (k, 3, n) of k scales of weights (k,)."""
    y, variance, mass = modes[:, 0], modes[:, 1], weights[:, None] * modes[:, 2]
    near = np.abs(y[:, None, :] - y[None, :, :]) < half
    support = (near * mass[None, :, :]).sum(axis=1)
    top = np.argmax(support, axis=0)
    part = near[top, :, np.arange(y.shape[1])].T * mass
    total = part.sum(axis=0)
    mean = (part * y).sum(axis=0) / total
    spread = (part * (variance + (y - mean) ** 2)).sum(axis=0) / total
    return mean, np.sqrt(spread), np.minimum(total, 1.0)


def _choose(shares: np.ndarray, seen: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the pairs (k,), (k,) and their probability (k,): each seen feature of A and each of B at most once."""
    shares = _exclusive(shares)
    i, j = np.nonzero((shares >= least) & seen[:, None])
    order = np.argsort(shares[i, j], kind="stable")[::-1]
    used_a, used_b, kept = set(), set(), []
    for k in order:
        if i[k] not in used_a and j[k] not in used_b:
            used_a.add(i[k])
            used_b.add(j[k])
            kept.append(k)
    kept = np.array(sorted(kept, key=lambda k: (i[k], j[k])), dtype=np.int64)
    return i[kept], j[kept], np.minimum(shares[i[kept], j[kept]], 1.0)


def _exclusive(shares: np.ndarray) -> np.ndarray:
    """Return pair probabilities (n, m) in which a feature of B claimed by several of A is shared out by their odds.

    The chain lets two neighbours in A take the same feature of B; one of them is false.
    """
    p = np.clip(shares, 0.0, 1.0 - _LEAST_DOUBT)
    odds = p / (1.0 - p)
    claimed = shares.sum(axis=0) > 1.0 + _CLAIM_SLACK
    return np.where(claimed, odds / np.maximum(odds.sum(axis=0), _LEAST_DOUBT), np.minimum(shares, 1.0))
