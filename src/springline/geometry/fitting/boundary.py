"""Confidence intervals for an amplitude, which cannot be negative: the ovality of a pipe that may be round.

The amplitude of (oval_cos, oval_sin) is Rayleigh distributed when the pipe is round: it is never zero, and estimate +-
1.96 sigma misses the truth. The rule declared here is one and continuous. An amplitude belongs to the interval when
the estimate lies within c of the circle of that amplitude, measured in sigmas (the Mahalanobis distance, so that
unequal and correlated sigmas count as they are), and c is chosen for each amplitude so that this happens with the
stated probability when the sigmas are equal:

- at zero c is that of the chi-square with two degrees of freedom (2.448 at 95 %), whatever the covariance: the
  interval holds zero in 95 % of round pipes, a one-sided statement;
- from about five sigmas on c is that of the normal distribution (1.960): the interval is two-sided;
- in between c follows from the noncentral chi-square with two degrees of freedom (the Rice distribution).

With equal sigmas the level is exact at every amplitude. With unequal ones it is exact at zero and far from it; in
between, sigmas of one to four hold a stated 95 % with 91 to 97 %.
"""

from __future__ import annotations

from functools import lru_cache
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

STEP = 0.02
"""Spacing, in sigmas, of the tabulated amplitudes."""

LAST = 12.0
"""Amplitude, in sigmas, beyond which c no longer changes; what is left of the change is 1e-3 of it."""


def amplitude_interval(
    vector: ArrayLike, covariance: ArrayLike, *, level: float = 0.95
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ends of the confidence interval for the length of a plane vector.

    Args:
        vector: (..., 2) estimate, such as oval_cos and oval_sin [any unit]; NaN gives NaN.
        covariance: (..., 2, 2) its covariance [that unit squared], positive definite.
        level: Probability with which the interval holds the true length, between 0 and 1.

    Returns:
        Lower and upper end, each of shape (...), in the unit of `vector`; the lower end is 0 when the vector does not
        differ from zero at that level.

    Raises:
        ParameterError: A shape does not fit, or the level is none.

    Source: the module's head; Rice distribution as noncentral chi-square with two degrees of freedom.

    >>> low, high = amplitude_interval([[2.0, 0.0], [10.0, 0.0]], np.eye(2))
    >>> low.round(2), high.round(2)
    (array([0.  , 8.04]), array([ 3.94, 11.96]))
    """
    from springline.geometry.fitting._amplitude import amplitude_ends

    vector, covariance = np.asarray(vector, np.float64), np.asarray(covariance, np.float64)
    if vector.shape[-1:] != (2,) or covariance.shape[-2:] != (2, 2):
        raise ParameterError(
            f"vector has shape {vector.shape} and covariance {covariance.shape}", expected="(..., 2) and (..., 2, 2)"
        )
    if not 0.0 < level < 1.0:
        raise ParameterError(f"level is {level}", expected="a probability between 0 and 1")
    shape = np.broadcast_shapes(vector.shape[:-1], covariance.shape[:-2])
    flat = np.ascontiguousarray(np.broadcast_to(vector, (*shape, 2)).reshape(-1, 2))
    spread = np.ascontiguousarray(np.broadcast_to(covariance, (*shape, 2, 2)).reshape(-1, 2, 2))
    ends = np.empty((len(flat), 2))
    amplitude_ends(flat, spread, critical_distances(level), STEP, ends)
    return ends[:, 0].reshape(shape), ends[:, 1].reshape(shape)


@lru_cache(maxsize=8)
def critical_distances(level: float) -> NDArray[np.float64]:
    """Return c, in sigmas, for true amplitudes of 0, STEP, ... LAST sigmas.

    c solves P(|r - amplitude| <= c) = level for a Rice distributed r.

    >>> table = critical_distances(0.95)
    >>> [round(float(c), 3) for c in (table[0], table[-1])]
    [2.448, 1.958]
    """
    from scipy.special import chndtr

    amplitude = np.arange(0.0, LAST + 0.5 * STEP, STEP)
    low, high = np.zeros_like(amplitude), np.full_like(amplitude, sqrt(-2.0 * np.log1p(-level)) + 1.0)
    for _ in range(60):
        middle = 0.5 * (low + high)
        inner = np.maximum(amplitude - middle, 0.0)
        held = chndtr((amplitude + middle) ** 2, 2, amplitude**2) - chndtr(inner**2, 2, amplitude**2)
        low, high = np.where(held < level, middle, low), np.where(held < level, high, middle)
    high.flags.writeable = False
    return high
