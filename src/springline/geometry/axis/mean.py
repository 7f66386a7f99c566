"""The mean of a quantity over stations that were fitted one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def mean_over_stations(values: ArrayLike, sigmas: ArrayLike) -> tuple[float, float]:
    """Return the mean along the pipe and its one-sigma.

    Stations differ because their fits err and because the pipe varies. The variance of the pipe is estimated from
    what the fits do not explain, and stations are weighted by both together: equally where the pipe varies, by their
    quality where it does not. The sigma counts that neighbouring stations err and vary alike, by the correlation
    that their departures from the mean show.

    Args:
        values: (station,) in their order along the pipe; NaN where there is none.
        sigmas: (station,) one-sigma of each.

    Returns:
        (mean, sigma), NaN when there is no station.

    Source: DerSimonian and Laird, Meta-analysis in clinical trials (1986) for the weights; Newey and West (1987) for
    the sigma.

    >>> mean, sigma = mean_over_stations([1.0, 1.2, 1.1, np.nan], [0.1, 0.1, 0.1, np.nan])
    >>> round(mean, 3), round(sigma, 3)
    (1.1, 0.058)
    """
    values, sigmas = np.asarray(values, dtype=np.float64), np.asarray(sigmas, dtype=np.float64)
    there = np.isfinite(values) & np.isfinite(sigmas) & (sigmas > 0)
    values, sigmas = values[there], sigmas[there]
    if len(values) == 0:
        return float("nan"), float("nan")
    weight = 1.0 / sigmas**2
    mean = np.average(values, weights=weight)
    excess = float(weight @ (values - mean) ** 2) - (len(values) - 1)
    varies = max(0.0, excess / (weight.sum() - (weight**2).sum() / weight.sum())) if len(values) > 1 else 0.0
    weight = 1.0 / (sigmas**2 + varies)
    mean = np.average(values, weights=weight)
    independent = 1.0 / weight.sum()
    return float(mean), float(np.sqrt(independent * _alike(weight * (values - mean))))


def _alike(score: np.ndarray) -> float:
    """Return by how much serial correlation raises the variance of the scores' sum, at least one."""
    count = len(score)
    variance = float(score @ score)
    if count < 8 or variance == 0.0:
        return 1.0
    reach = round(np.sqrt(count))
    products = np.array([score[k:] @ score[:-k] for k in range(1, reach + 1)]) / variance
    bartlett = 1.0 - np.arange(1, reach + 1) / (reach + 1.0)
    return max(1.0, 1.0 + 2.0 * float(bartlett @ products))
