"""A lens from the pipe itself: joints seen as circles, again and again as the camera drives towards them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import choice, finite, positive
from springline.geometry.lenses.fit import WORST_RMS
from springline.geometry.lenses.lens import Lens
from springline.geometry.lenses.models import MODELS, image_radius, model_range
from springline.geometry.lenses.results import LensCandidate, LensFit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

FEWEST_SIGHTS = 4
"""A joint seen less often says nothing of the lens once its own distance is found."""
_STEPS = 40


def fit_joints(
    joint: ArrayLike,
    distance: ArrayLike,
    radius: ArrayLike,
    pipe_radius: float,
    *,
    models: Sequence[str] = MODELS,
    confidence: float = 0.95,
) -> LensFit:
    """Fit a lens to the image radii of joints that the camera approaches.

    A joint whose distance ahead is d is a circle seen at zenith atan(R/d). Where it lies is not known, only by how
    much the camera has come nearer, so the place of each joint is found with the lens.

    Args:
        joint: (n,) which joint each sight is of; any labels.
        distance: (n,) odometer at the sight [m].
        radius: (n,) image radius of the joint's circle [px].
        pipe_radius: Inside radius of the pipe [m].
        models: Models to choose among, of the five.
        confidence: Least probability of the chosen model.

    Returns:
        LensFit; falsy with its reason when sights are too few or models fit alike. `n_used` counts sights.

    Raises:
        ParameterError: The arrays differ in length, or a number or a model is out of range.

    Source: 2.7, with the pipe as the target; Gauss-Newton for k and the joints' places, the model by the Bayesian
    information criterion.

    >>> s = np.tile(np.arange(0.0, 0.5, 0.02), 2)
    >>> at = np.repeat([0.62, 0.7], 25)
    >>> fit = fit_joints(at, s, 300.0 * np.arctan(0.15 / (at - s)), 0.15)
    >>> fit.lens.model, round(fit.lens.k, 6)
    ('equidistant', 300.0)
    """
    distance, radius = np.atleast_1d(finite("distance", distance)), np.atleast_1d(positive("radius", radius, "pixels"))
    labels, joint = np.unique(np.atleast_1d(joint), return_inverse=True)
    if not len(joint) == len(distance) == len(radius):
        raise ParameterError(
            f"joint, distance and radius have {len(joint)}, {len(distance)} and {len(radius)} entries",
            expected="one of each for every sight",
        )
    positive("pipe_radius", pipe_radius)
    names = tuple(dict.fromkeys(choice("models", name, MODELS) for name in models))
    sights = np.bincount(joint, np.isfinite(distance) & np.isfinite(radius), minlength=len(labels))
    used = np.isfinite(distance) & np.isfinite(radius) & (sights[joint] >= FEWEST_SIGHTS)
    if used.sum() < 2 * FEWEST_SIGHTS:
        return _none(f"too few sights: each joint must be seen {FEWEST_SIGHTS} times or more, and two joints at all")
    _, which = np.unique(joint[used], return_inverse=True)
    fits = [_fitted(name, which, distance[used], radius[used], float(pipe_radius)) for name in names]
    return _chosen([fit for fit in fits if fit is not None], confidence, radius[used])


def _fitted(
    name: str, which: NDArray[np.int64], distance: Array, radius: Array, pipe: float
) -> tuple[Lens, Array, Array, float, int] | None:
    """Return the lens, its k's variance, the residuals, the criterion and the freedom of one model."""
    last = np.full(which.max() + 1, -np.inf)
    np.maximum.at(last, which, distance)
    limit = model_range(name)[0]
    best = None
    for ahead in (0.5, 1.0, 2.0, 4.0):
        place = last + ahead * pipe
        zenith = np.arctan2(pipe, place[which] - distance)
        shape = image_radius(np.minimum(zenith, 0.99 * limit), model=name)
        k = float(shape @ radius / (shape @ shape))
        found = _settled(name, which, distance, radius, pipe, k, place)
        if found is not None and (best is None or found[2] < best[2]):
            best = found
    if best is None:
        return None
    k, slopes, misfit, rest = best
    freedom = len(radius) - slopes.shape[1]
    if freedom < FEWEST_SIGHTS:
        return None
    variance = np.linalg.pinv(slopes.T @ slopes, hermitian=True)[:1, :1] * max(misfit, 1e-300) / freedom
    criterion = len(radius) * np.log(max(misfit, 1e-300)) + slopes.shape[1] * np.log(len(radius))
    return Lens(name, k), variance, rest, criterion, freedom


def _settled(
    name: str, which: NDArray[np.int64], distance: Array, radius: Array, pipe: float, k: float, place: Array
) -> tuple[float, Array, float, Array] | None:
    """Return k, the derivatives, the sum of squares and the residuals at the least misfit near a start."""
    limit, damping = 0.999 * model_range(name)[0], 1e-3

    def state(k: float, place: Array) -> tuple[Array, Array]:
        away = place[which] - distance
        zenith = np.minimum(np.arctan2(pipe, away), limit)
        shape = image_radius(zenith, model=name)
        step = 1e-6
        slope = (image_radius(np.minimum(zenith + step, limit), model=name) - shape) / step
        slopes = np.zeros((len(radius), 1 + len(place)))
        slopes[:, 0] = shape
        slopes[np.arange(len(radius)), 1 + which] = -k * slope * pipe / (pipe**2 + away**2)
        return radius - k * shape, slopes

    rest, slopes = state(k, place)
    for _ in range(_STEPS):
        normal = slopes.T @ slopes
        step = np.linalg.solve(normal + damping * np.diag(np.diag(normal) + 1e-12), slopes.T @ rest)
        ahead_k, ahead_place = k + step[0], place + step[1:]
        new_rest, new_slopes = state(ahead_k, ahead_place)
        if ahead_k > 0 and new_rest @ new_rest <= rest @ rest:
            gain = rest @ rest - new_rest @ new_rest
            k, place, rest, slopes, damping = ahead_k, ahead_place, new_rest, new_slopes, max(damping / 10, 1e-12)
            if gain <= 1e-12 * (rest @ rest):
                break
        else:
            damping *= 10.0
            if damping > 1e8:
                break
    return (float(k), slopes, float(rest @ rest), rest) if k > 0 and np.isfinite(rest).all() else None


def _chosen(found: list, confidence: float, radius: Array) -> LensFit:
    if not found:
        return _none("no model can image these joints")
    odds = np.array([one[3] for one in found])
    weights = np.exp(-0.5 * (odds - odds.min()))
    weights /= weights.sum()
    candidates = tuple(
        LensCandidate(lens, np.array([lens.k]), variance, rest, float(np.sqrt(np.mean(rest**2))), float(weight))
        for (lens, variance, rest, _, _), weight in sorted(zip(found, weights, strict=True), key=lambda pair: -pair[1])
    )
    best = candidates[0]
    reason = ""
    if best.residual_rms > WORST_RMS * radius.max():
        reason = f"no model fits: the rms of the best, {best.lens.model}, is {best.residual_rms:.1f} px"
    elif best.probability < confidence and len(candidates) > 1:
        told = " and ".join(f"{one.lens.model} ({one.probability:.2f})" for one in candidates[:2])
        reason = f"the joints do not tell {told} apart: follow them nearer to the picture's edge"
    freedom = found[int(np.argmin(odds))][4]
    noise = best.residual_rms * float(np.sqrt(len(radius) / freedom))
    return LensFit(None if reason else best, candidates, noise, len(radius), reason)


def _none(reason: str) -> LensFit:
    return LensFit(None, (), np.nan, 0, reason)
