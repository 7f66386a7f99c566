"""A lens from pairs of zenith and image radius, its model chosen by evidence among the five and the polynomial."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import choice, finite, positive, require
from springline.geometry.lenses.lens import LENS_MODELS, POLYNOMIAL, Lens
from springline.geometry.lenses.models import image_radius
from springline.geometry.lenses.polynomial import MOST_COEFFICIENTS, polynomial_limit
from springline.geometry.lenses.results import LensCandidate, LensFit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

FEWEST_PAIRS = 8
"""Fewer pairs cannot tell models apart."""

WORST_RMS = 0.02
"""Residual rms, as a share of the largest radius, beyond which no model is taken to fit."""

LEAST_CHANCE = 1e-6
"""Chance, under the stated sigma, of residuals as large as these below which no model is taken to fit."""

POLYNOMIAL_PRIOR = 0.02
"""Odds beforehand of the polynomial against one of the five: it can imitate them all, so it must be needed."""

_SPARE_PAIRS = 4
_CONDITION = 1e-10


def fit_lens(
    zenith: ArrayLike,
    radius: ArrayLike,
    *,
    sigma: ArrayLike | None = None,
    models: Sequence[str] = LENS_MODELS,
    confidence: float = 0.95,
) -> LensFit:
    """Fit a lens to pairs of zenith and image radius and choose its model by evidence.

    Every model is linear in its unknowns, so each fit is exact; their evidence is the Bayesian information criterion,
    and the polynomial is the mean over its number of coefficients.
    A polynomial is fitted as a check even when `models` leaves it out: where it explains the pairs and the models
    asked for do not, there is no lens.

    Args:
        zenith: (n,) angles to the optical axis [rad]; NaN where unknown.
        radius: (n,) distances from the image centre [px]; NaN where unknown.
        sigma: One-sigma of the radii [px], one or (n,); None estimates it from the residuals.
        models: Models to choose among, of `LENS_MODELS`.
        confidence: Least probability of the chosen model against the others.

    Returns:
        LensFit; falsy with a reason when the pairs are too few, lie too near the axis, fit no model, or do not tell
        the models apart (then the candidates still stand in it, to be chosen from by other knowledge).

    Raises:
        ParameterError: The arrays differ in length, or a number or a model is out of range.

    Source: 2.7, "the best model that fits the calibration data"; Schwarz, Annals of Statistics 6 (1978).

    >>> zenith = np.radians(np.arange(2.0, 70.0, 2.0))
    >>> fit = fit_lens(zenith, 300 * np.sin(zenith) + 0.3 * np.cos(40 * zenith))
    >>> fit.lens.model, round(fit.lens.k, 1), bool(fit_lens(zenith[:4], 300 * zenith[:4]))
    ('sine', 300.0, False)
    """
    zenith, radius, weight = _checked(zenith, radius, sigma)
    names = tuple(dict.fromkeys(choice("models", name, LENS_MODELS) for name in models))
    if not names:
        raise ParameterError("models is empty", expected="one or more of " + ", ".join(LENS_MODELS))
    require(0 < confidence < 1, "confidence", confidence, "0 < confidence < 1", "give a probability such as 0.95")
    used = np.isfinite(zenith) & np.isfinite(radius) & (weight > 0)
    count = int(used.sum())
    if count < FEWEST_PAIRS:
        return _none(f"too few pairs: {count} usable, at least {FEWEST_PAIRS} are needed", count)
    if not np.any(zenith[used] > 0) or not np.any(radius[used] > 0):
        return _none("all pairs lie at the optical axis", count)
    pairs = _Pairs(zenith[used], radius[used], weight[used], sigma is not None)
    fits = [fit for name in LENS_MODELS if (fit := _fitted(name, pairs)) is not None]
    return _chosen(fits, names, confidence, pairs)


class _Pairs(NamedTuple):
    """The usable pairs, and whether their sigma was stated."""

    zenith: Array
    radius: Array
    weight: Array
    known: bool


class _Fit(NamedTuple):
    """One model fitted: its lens, covariance, weighted misfit, and -2 ln of its evidence."""

    lens: Lens
    covariance: Array
    misfit: float
    freedom: int
    criterion: float


class _Linear(NamedTuple):
    """One linear least-squares fit: coefficients, covariance, weighted misfit, readings left over, criterion."""

    values: Array
    covariance: Array
    misfit: float
    freedom: int
    criterion: float


def _fitted(name: str, pairs: _Pairs) -> _Fit | None:
    """The fit of a model; None where the pairs do not determine it or it cannot be one-to-one over them."""
    if name == POLYNOMIAL:
        return _polynomial(pairs)
    found = _linear(image_radius(pairs.zenith, model=name)[:, None], pairs)
    if found is None or found.values[0] <= 0:
        return None
    return _Fit(Lens(name, found.values[0]), *found[1:])


def _polynomial(pairs: _Pairs) -> _Fit | None:
    """The mean of the polynomials with one to four coefficients, each with the weight of its evidence.

    A single number of coefficients, chosen from the same pairs, would state too small a sigma.
    """
    powers = pairs.zenith[:, None] ** (2 * np.arange(MOST_COEFFICIENTS + 1) + 1)
    most = min(MOST_COEFFICIENTS, len(pairs.zenith) - 1 - _SPARE_PAIRS)
    found = [(n, fit) for n in range(1, most + 1) if (fit := _linear(powers[:, : n + 1], pairs)) is not None]
    if not found:
        return None
    criteria = np.array([fit.criterion for _, fit in found])
    weights = np.exp(-0.5 * (criteria - criteria.min()))
    evidence = float(criteria.min() - 2.0 * np.log(weights.mean()))
    weights /= weights.sum()
    size = found[-1][0] + 1
    values = np.array([np.pad(fit.values, (0, size - n - 1)) for n, fit in found])
    mean = weights @ values
    apart = values - mean
    covariance = np.einsum("w,wi,wj->ij", weights, apart, apart)
    for share, (n, fit) in zip(weights, found, strict=True):
        covariance[: n + 1, : n + 1] += share * fit.covariance
    k, odd, limit = mean[0], mean[1:] / mean[0], float(pairs.zenith.max())
    if k <= 0 or polynomial_limit(odd) < limit:
        return None
    turn = np.eye(size) / k  # from (k, k k1, ...) to (k, k1, ...)
    turn[0, 0], turn[1:, 0] = 1.0, -odd / k
    misfit = _misfit(pairs.radius - powers[:, :size] @ mean, pairs)
    best = found[int(np.argmin(criteria))][1]
    lens = Lens(POLYNOMIAL, k, tuple(odd), 2.0 * limit)
    return _Fit(lens, turn @ covariance @ turn.T, misfit, best.freedom, evidence)


def _linear(basis: Array, pairs: _Pairs) -> _Linear | None:
    from scipy.special import stdtrit

    solved = _solve(basis, pairs)
    if solved is None:
        return None
    values, inverse = solved
    count, freedom = len(pairs.zenith), len(pairs.zenith) - len(values)
    misfit = _misfit(pairs.radius - basis @ values, pairs)
    widening = 1.0 if pairs.known else misfit / freedom * (stdtrit(freedom, 0.975) / 1.959963984540054) ** 2
    criterion = (misfit if pairs.known else count * np.log(misfit)) + len(values) * np.log(count)
    return _Linear(values, inverse * widening, misfit, freedom, float(criterion))


def _misfit(residuals: Array, pairs: _Pairs) -> float:
    """Weighted sum of squares; an exact fit has none to weigh, and keeps the rounding of its radii."""
    floor = float(np.finfo(float).eps) ** 2 * np.sum(pairs.weight * pairs.radius**2)
    return max(float(np.sum(pairs.weight * residuals**2)), floor)


def _solve(basis: Array, pairs: _Pairs) -> tuple[Array, Array] | None:
    """Weighted least squares and the inverse of its normal matrix; None where the pairs do not determine it."""
    if not np.isfinite(basis).all():
        return None
    root = np.sqrt(pairs.weight)[:, None]
    design = basis * root
    lengths = np.linalg.norm(design, axis=0)
    if not np.all(lengths > 0):
        return None
    left, values, right = np.linalg.svd(design / lengths, full_matrices=False)
    if values[-1] < _CONDITION * values[0]:
        return None
    back = right.T / values / lengths[:, None]
    return back @ (left.T @ (pairs.radius * root[:, 0])), back @ back.T


def _chosen(fits: list[_Fit], names: tuple[str, ...], confidence: float, pairs: _Pairs) -> LensFit:
    """Weigh the models that were asked for, most probable first, and judge whether the first may stand."""
    count = len(pairs.zenith)
    asked = sorted((f for f in fits if f.lens.model in names), key=_odds)
    if not asked:
        return _none(f"none of the models asked for ({', '.join(names)}) can image these pairs", count)
    best = asked[0]
    weights = np.exp(-0.5 * np.array([_odds(f) - _odds(best) for f in asked]))
    candidates = tuple(_candidate(f, pairs, w) for f, w in zip(asked, weights / weights.sum(), strict=True))
    reason = _misfitting(best, candidates[0].residual_rms, pairs)
    rivals = [f for f in fits if f.lens.model == POLYNOMIAL and POLYNOMIAL not in names]
    if not reason and any(_odds(f) < _odds(best) + 2.0 * np.log(1.0 - confidence) for f in rivals):
        reason = f"no model asked for fits: the residuals of the best, {best.lens.model}, keep a pattern"
    if not reason and candidates[0].probability < confidence:
        pair = " and ".join(f"{c.lens.model} ({c.probability:.2f})" for c in candidates[:2])
        reason = f"the pairs do not tell {pair} apart: wider angles or more pairs are needed"
    noise = candidates[0].residual_rms * np.sqrt(count / best.freedom)
    return LensFit(None if reason else candidates[0], candidates, float(noise), count, reason)


def _odds(fit: _Fit) -> float:
    """-2 ln of evidence times prior."""
    return fit.criterion - (2.0 * np.log(POLYNOMIAL_PRIOR) if fit.lens.model == POLYNOMIAL else 0.0)


def _candidate(fit: _Fit, pairs: _Pairs, probability: float) -> LensCandidate:
    parameters = np.array([fit.lens.k, *fit.lens.coefficients])
    residuals = pairs.radius - fit.lens.radius(pairs.zenith)
    rms = float(np.sqrt(np.mean(residuals**2)))
    return LensCandidate(fit.lens, parameters, fit.covariance, residuals, rms, float(probability))


def _misfitting(best: _Fit, rms: float, pairs: _Pairs) -> str:
    """Why the most probable model cannot be true, or an empty string."""
    from scipy.special import gammaincc

    largest = float(pairs.radius.max())
    if pairs.known and gammaincc(best.freedom / 2.0, best.misfit / 2.0) < LEAST_CHANCE:
        told = f"{np.sqrt(best.misfit / best.freedom):.1f} times the stated sigma"
    elif not pairs.known and rms > WORST_RMS * largest:
        told = f"{100 * rms / largest:.1f} % of the largest radius"
    else:
        return ""
    return f"no model fits: the rms of the best, {best.lens.model}, is {told}"


def _none(reason: str, count: int) -> LensFit:
    return LensFit(None, (), np.nan, count, reason)


def _checked(zenith: ArrayLike, radius: ArrayLike, sigma: ArrayLike | None) -> tuple[Array, Array, Array]:
    zenith, radius = np.atleast_1d(finite("zenith", zenith)), np.atleast_1d(finite("radius", radius))
    if zenith.shape != radius.shape or zenith.ndim != 1:
        raise ParameterError(
            f"zenith has shape {zenith.shape} and radius {radius.shape}",
            expected="two arrays (n,) of the same length",
            mend="give one radius for each zenith",
        )
    below = np.isnan(zenith) | ((zenith >= 0) & (zenith <= np.pi))
    require(below, "zenith", zenith, "0 <= zenith <= pi rad", "measure angles from the optical axis, in radians")
    require(np.isnan(radius) | (radius >= 0), "radius", radius, "radius >= 0", "measure from the image centre")
    spread = np.broadcast_to(positive("sigma", 1.0 if sigma is None else sigma, "give pixels"), zenith.shape)
    return zenith, radius, np.nan_to_num(1.0 / spread**2)
