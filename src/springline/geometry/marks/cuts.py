"""A narrow joint told from rings that it cuts: which readings lie in it, and which beside it do not.

Where rings are farther apart than a joint is wide, most bearings see nothing of it. That they do not is half of what is
known: between two rings that both show the wall, the joint lies wholly between them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_STRAY = 0.02
"""Share of the readings that are not where their surface is."""
_RAGGED = 0.05
"""Length over which the edge of a reading's side is blurred, of the spacing."""
_LEVEL = 0.1
_NARROW = 0.1
"""Tilt and gap below which they are as good as none, of the spacing."""
_KINK = np.radians(0.7)
"""One-sigma of what the two ends of a joint are turned against each other."""
_TILT = np.radians(3.0)
"""One-sigma of a ring's tilt against the joint."""
_MOST = 90
_TRIALS, _STEPS, _BURNT = 6000, 16000, 2000


def cut_ends(
    inside: ArrayLike, known: ArrayLike, place: ArrayLike, bearings: ArrayLike, *, radius: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean and covariance of the planes of both ends of a joint: x = c + a cos(bearing) + b sin(bearing).

    Args:
        inside: (ring, bearing) whether a reading lies in the joint.
        known: (ring, bearing) whether there is a reading.
        place: (ring,) chainage, rising [m].
        bearings: (bearing,) [rad].
        radius: Of the pipe [m].

    Returns:
        (6,) c, a, b of the nearer and of the farther end [m], and (6, 6).

    Source: the posterior by random walk (Metropolis) of two planes of which the farther lies behind the nearer. Before,
    gaps between 1 and 2 mm are as many as between 2 and 4; tilts fall with their square.

    >>> x, theta = 0.01 * np.arange(8.0), np.radians(np.arange(0.0, 360.0, 4.0))
    >>> off = x[:, None] - 0.0335 - 0.012 * np.cos(theta)
    >>> mean, covariance = cut_ends(np.abs(off) < 0.002, np.ones(off.shape, bool), x, theta, radius=0.15)
    >>> bool(abs(mean[3] - mean[0] - 0.004) < 0.001)
    True
    """
    inside, known = np.asarray(inside, bool), np.asarray(known, bool)
    place, bearings = np.asarray(place, float), np.asarray(bearings, float)
    part = np.unique(np.linspace(0, len(bearings) - 1, min(_MOST, len(bearings))).astype(int))
    inside, known, theta = inside[:, part], known[:, part], bearings[part]
    spacing = max(float(np.median(np.diff(place))), 1e-6)
    random = np.random.default_rng(3)
    moves = random.standard_normal((_STEPS, 6)) * spacing * random.choice([0.3, 0.1, 0.03], (_STEPS, 1))
    # both ends together, or one alone
    both = random.random(_STEPS) < 0.4
    moves[both, 3:] = moves[both, :3]
    moves[~both & (random.random(_STEPS) < 0.5), 3:] = 0.0
    trig = np.stack([np.cos(theta), np.sin(theta)])
    state = np.where(known, np.where(inside, 1, 0), -1).astype(np.int8)
    limits = np.array([spacing, radius * np.tan(_KINK), radius * np.tan(_TILT)])
    start = _start(state, place, trig, limits, random)
    walk = _walk(state, place, trig, start, moves, np.log(random.random(_STEPS)), limits)
    drawn = walk[_BURNT:]
    return drawn.mean(axis=0), np.cov(drawn.T)


def _start(
    state: NDArray, place: NDArray, trig: NDArray, limits: NDArray, random: np.random.Generator
) -> NDArray[np.float64]:
    """Return the likeliest of many parallel planes in any place that a ring is cut at, tilted and apart at random."""
    spacing, _, tilted = limits
    rings = np.flatnonzero((state == 1).any(axis=1))
    middle = random.uniform(place[rings[0]] - spacing, place[rings[-1]] + spacing, _TRIALS)
    tilt = random.normal(0.0, 0.6 * tilted, (_TRIALS, 2)) * random.random((_TRIALS, 1))
    half = 0.5 * spacing * np.exp(random.uniform(np.log(0.1), np.log(1.5), _TRIALS))
    ends = np.column_stack([middle - half, tilt, middle + half, tilt])
    return ends[np.argmax(_logs(state, place, trig, ends, limits))]


@njit(cache=True, nogil=True, error_model="numpy")
def _log(state, place, trig, ends, limits):
    spacing, kink, tilt = limits
    gap = ends[3] - ends[0]
    if gap <= 0.0:
        return -np.inf
    total = -0.5 * np.log(gap * gap + (_NARROW * spacing) ** 2)
    total -= np.log(ends[1] ** 2 + ends[2] ** 2 + (_LEVEL * spacing) ** 2)
    total -= 0.5 * (ends[1] ** 2 + ends[2] ** 2) / tilt**2
    total -= 0.5 * ((ends[4] - ends[1]) ** 2 + (ends[5] - ends[2]) ** 2) / kink**2
    blur = _RAGGED * spacing
    for j in range(trig.shape[1]):
        near = ends[0] + ends[1] * trig[0, j] + ends[2] * trig[1, j]
        far = ends[3] + ends[4] * trig[0, j] + ends[5] * trig[1, j]
        for i in range(place.size):
            if state[i, j] < 0:
                continue
            depth = min(place[i] - near, far - place[i]) / blur
            if depth > 20.0:
                share = 1.0
            elif depth < -20.0:
                share = 0.0
            else:
                share = 1.0 / (1.0 + np.exp(-depth))
            share = _STRAY + (1.0 - 2.0 * _STRAY) * share
            total += np.log(share if state[i, j] == 1 else 1.0 - share)
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def _logs(state, place, trig, ends, limits):
    out = np.empty(len(ends))
    for k in range(len(ends)):
        out[k] = _log(state, place, trig, ends[k], limits)
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def _walk(state, place, trig, start, moves, chances, limits):
    out = np.empty(moves.shape)
    here = start.copy()
    level = _log(state, place, trig, here, limits)
    for k in range(len(moves)):
        there = here + moves[k]
        other = _log(state, place, trig, there, limits)
        if other - level > chances[k]:
            here, level = there, other
        out[k] = here
    return out
