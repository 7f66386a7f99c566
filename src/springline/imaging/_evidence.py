"""How likely a contour is of a model at all, beside how well the best of its kind fits.

Three things that the misfit of the best fit does not say: how much of what the model could be it had to give up to fit
(Laplace's evidence); whether the points run along a joint in order, as they do along a real one; and whether an
irregular outline of that size, a stain's, fits by so much better that it is the likelier one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import isotonic_regression

from springline.imaging._casting import HELD, ROBUST, WIDE, WIDER, cast, off_edge, residuals

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_HARMONICS = np.arange(2, 7)
_UNEVEN = (0.05, 0.1, 0.2, 0.4)
"""How far a stain's outline departs from a round one, of its radius: one-sigma in all, each as likely as the others."""
_ANY_SIZE = 0.7
"""One-sigma of the logarithm of a bore's radius, of which nothing is known before."""
_ANY_PLACE = 1.0
"""One-sigma of a place along the pipe, or of a bearing, of which nothing is known before [radii, rad]."""


def occam(information: Array, sigma: Array, radius: float) -> float:
    """Return what a fit pays for its freedom: half the log of prior over posterior volume.

    Args:
        information: (n, n) at the fit, the prior's with it.
        sigma: (n) one-sigma of the prior; inf where there is none, 0 where held.
        radius: Of the pipe [m].
    """
    loose = np.full(len(sigma), _ANY_PLACE)
    loose[0] *= radius
    if len(sigma) > 7:
        loose[7] = _ANY_SIZE
    bound = np.isfinite(sigma)
    known = information + np.diag(np.where(bound, 0.0, loose**-2.0))
    width = np.where(bound, sigma, loose)
    free = np.flatnonzero(width > HELD)
    scaled = known[np.ix_(free, free)] * np.outer(width[free], width[free])
    return 0.5 * float(np.linalg.slogdet(scaled)[1])


def disorder(sets: Array, axes: Array, eye: Array, radii: Array, found: Array, noise: float, index: Array) -> float:
    """Return what it costs a joint that points do not run along it in order: a small ring runs out and back.

    Args:
        sets: (3, n, 3) rays of the points, and one pixel right and up of them.
        axes, eye, radii: Of camera and pipe, as for `_casting`.
        found: (7) the joint fitted.
        noise: One-sigma of the points [px].
        index: (n) place of each point along the contour; between points that do not follow each other anything may be.

    Returns:
        Robust misfit of the points along the joint from the nearest that keeps their order, one way or the other.
    """
    shape = radii * np.array([1.0 + found[6], 1.0 - found[6]])
    places = np.empty((3, sets.shape[1], 3))
    for k in range(3):
        if not cast(sets[k], axes, eye, shape, found, places[k]):
            return 0.0
    turn = np.arctan2(places[..., 1], places[..., 2])
    turned = _wrapped(turn[1:] - turn[0])
    ahead = places[1:, :, 0] - places[0, :, 0]
    steep = np.linalg.norm(ahead, axis=0) + 1e-12
    across = ahead / steep
    # the turn at the joint itself, and per pixel along it
    turn = turn[0] - (turned * across).sum(axis=0) * (places[0, :, 0] - found[0]) / steep
    pixel = np.abs(turned[1] * across[0] - turned[0] * across[1]) + 1e-9
    follows = np.diff(index) == 1
    least = math.inf
    for sense in (1.0, -1.0):
        step = _wrapped(np.diff(sense * turn))
        # over what is hidden a joint may run on by up to a turn
        step = np.where(~follows & (step < 0.0), step + 2.0 * math.pi, step)
        run = np.concatenate([[0.0], np.cumsum(step)])
        apart = (run - isotonic_regression(run, weights=pixel**-2.0).x) / (pixel * noise)
        least = min(least, 0.5 * ROBUST**2 * float(np.log1p(apart**2 / ROBUST**2).sum()))
    return least


def stain(
    sets: Array, axes: Array, eye: Array, radii: Array, found: Array, mean: Array, sigma: Array, noise: float
) -> float:
    """Return the log odds of an irregular outline, about as large and at the same place, against a round bore's.

    Args:
        sets, axes, eye, radii: As for `disorder`.
        found: (9) the lateral fitted.
        mean, sigma: (9) the prior.
        noise: One-sigma of the points [px].

    Source: the Bayes factor of a linear model: waves of two to six turns round the bore, falling with their number, on
    top of what the lateral's own parameters can do.
    """
    here = _residuals(sets, axes, eye, radii, found)
    foot = _feet(sets, axes, eye, radii, found)
    slopes, turn = _slopes(foot, axes, eye, radii, found, sigma), _round(foot[0], axes, eye, radii, found)
    if here is None or slopes is None or not np.isfinite(slopes).all():
        return 0.0
    weight = 1.0 / (1.0 + (here / noise) ** 2 / ROBUST**2) / noise**2
    angle = _HARMONICS[:, None] * turn
    waves = (slopes[:, 7] * np.concatenate([np.cos(angle), np.sin(angle)])).T
    falling = np.concatenate([1.0 / _HARMONICS] * 2)
    bound = np.isfinite(sigma) & (sigma > HELD)
    tight = np.where(bound, np.where(bound, sigma, 1.0) ** -2.0, 0.0)
    pull = slopes.T @ (weight * here) + np.where(bound, tight * (found - mean), 0.0)
    wide = max(found[7] - math.log(WIDE * radii.min()), 0.0)
    if wide > 0.0:
        tight[7] += WIDER**-2.0
        pull[7] += wide * WIDER**-2.0
    known = slopes.T @ (weight[:, None] * slopes) + np.diag(tight)
    shared = waves.T @ (weight[:, None] * slopes) @ np.linalg.pinv(known, hermitian=True)
    gain = waves.T @ (weight * here) - shared @ pull
    matrix = waves.T @ (weight[:, None] * waves) - shared @ (slopes.T @ (weight[:, None] * waves))
    odds = []
    for uneven in _UNEVEN:
        size = uneven * falling
        both = np.eye(len(size)) + size[:, None] * matrix * size
        odds.append(-0.5 * np.linalg.slogdet(both)[1] + 0.5 * (size * gain) @ np.linalg.solve(both, size * gain))
    return float(np.logaddexp.reduce(odds) - math.log(len(odds)))


def _wrapped(turn: Array) -> Array:
    return (turn + math.pi) % (2.0 * math.pi) - math.pi


def _residuals(sets: Array, axes: Array, eye: Array, radii: Array, found: Array) -> Array | None:
    count = sets.shape[1]
    out = np.empty(count)
    fine = residuals(True, sets, axes, eye, radii, found, np.empty((count, 3)), np.empty((3, count)), out)
    return out if fine else None


def _slopes(sets: Array, axes: Array, eye: Array, radii: Array, found: Array, sigma: Array) -> Array | None:
    """Derivatives of the residuals (n, 9) by the parameters, 0 for those that are held."""
    base = _residuals(sets, axes, eye, radii, found)
    if base is None:
        return None
    slopes = np.zeros((len(base), len(found)))
    for k in np.flatnonzero(sigma > HELD):
        # the limits of size and inclination lie above
        step = -1e-5 * (radii[0] if k < 3 else 1.0) * (1.0 if found[k] >= 0.0 else -1.0)
        there = found.copy()
        there[k] += step
        moved = _residuals(sets, axes, eye, radii, there)
        if moved is None:
            return None
        slopes[:, k] = (moved - base) / step
    return slopes


def _feet(sets: Array, axes: Array, eye: Array, radii: Array, found: Array) -> Array:
    """Rays of the places on the model's edge that are nearest to the points.

    What depends on where along the edge a point lies must not depend on how far it is off: their errors would be alike.
    """
    for _ in range(2):
        off, places = np.empty((3, sets.shape[1])), np.empty((sets.shape[1], 3))
        for k in range(3):
            cast(sets[k], axes, eye, radii, found, places)
            off_edge(True, places, found, off[k])
        right, up = off[1] - off[0], off[2] - off[0]
        back = off[0] / (right**2 + up**2 + 1e-18)
        sets = sets - (back * right)[:, None] * (sets[1] - sets[0]) - (back * up)[:, None] * (sets[2] - sets[0])
    return sets


def _round(directions: Array, axes: Array, eye: Array, radii: Array, found: Array) -> Array:
    """Angle of each point about the bore's axis [rad]."""
    places = np.empty((len(directions), 3))
    cast(directions, axes, eye, radii, found, places)
    places[:, 0] -= found[0]
    sin_b, cos_b, sin_t, cos_t = math.sin(found[6]), math.cos(found[6]), math.sin(found[8]), math.cos(found[8])
    ahead = places @ np.array([cos_t, -sin_t * sin_b, -sin_t * cos_b])
    return np.arctan2(places @ np.array([0.0, cos_b, -sin_b]), ahead)
