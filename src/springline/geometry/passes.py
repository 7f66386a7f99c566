"""Two measurements of one line laid on one another, and taken together with what their errors have in common."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_STEP = 0.01
_CLEAR = 25.0
"""By how much the best place must beat any other that lies apart, in chi-squared."""
_ASIDE = 0.1
_ALIKE = 1.0
"""Length over which errors of sections are taken as one [m]."""
_FLOOR = 1e-3
_LEAST = 0.05


@dataclass(frozen=True)
class Alignment:
    """Where the stations of one line lie in another.

    Attributes:
        place: Chainage in the other line at each station of the first [m] (n,); NaN beyond its ends.
        sigma: One-sigma of it [m] (n,).
    """

    place: np.ndarray
    sigma: np.ndarray

    def at(
        self, chainage: np.ndarray, values: np.ndarray, covariance: np.ndarray, *, moved: bool = True
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the other line's values (n, d) and covariance (n, d, d) at the first line's stations.

        Args:
            chainage: Of the other line's stations [m] (m,), increasing.
            values: (m, d).
            covariance: (m, d, d).
            moved: Whether the alignment's own doubt moves the values along their slope.
        """
        right = np.clip(np.searchsorted(chainage, self.place), 1, len(chainage) - 1)
        step = chainage[right] - chainage[right - 1]
        share = (self.place - chainage[right - 1]) / step
        share = np.where((share >= 0.0) & (share <= 1.0), share, np.nan)
        value = values[right - 1] + share[:, None] * (values[right] - values[right - 1])
        # Neighbouring stations err together: the mean of their covariances, not of their errors.
        spread = covariance[right - 1] + share[:, None, None] * (covariance[right] - covariance[right - 1])
        if moved:
            slope = (values[right] - values[right - 1]) / step[:, None]
            spread = spread + self.sigma[:, None, None] ** 2 * slope[:, :, None] * slope[:, None, :]
        return value, spread


@dataclass(frozen=True)
class Common:
    """What two passes err alike by.

    Attributes:
        place: Variance of each coordinate at every station [m2] (n,).
        slope: Variance of a slope between the ties.
    """

    place: np.ndarray
    slope: float


def align(
    first: tuple[np.ndarray, np.ndarray, np.ndarray], second: tuple[np.ndarray, np.ndarray, np.ndarray], reach: float
) -> Alignment | None:
    """Return where the stations of one line lie in another by what was measured along both; None when nothing tells.

    Args:
        first: Chainage [m] (n,), what was measured there (n, d), and its covariance (n, d, d).
        second: The same of the other line, chainage increasing and of the same sense.
        reach: How far the two counters may set the same place apart [m].
    """
    alike = max(_ALIKE / max(float(np.median(np.diff(first[0]))), 1e-9), 1.0)
    shifts = np.arange(-round(reach / _STEP), round(reach / _STEP) + 1) * _STEP
    cost = np.array([_apart(first, second, shift) for shift in shifts]) * len(first[0]) / alike
    best = int(np.argmin(cost))
    other = cost[np.abs(shifts - shifts[best]) > _ASIDE]
    if best in (0, len(shifts) - 1) or not np.isfinite(cost[best]) or other.min() - cost[best] < _CLEAR:
        return None
    before, at, after = cost[best - 1 : best + 2]
    bent = (before - 2.0 * at + after) / _STEP**2
    if not (np.isfinite(bent) and bent > 0.0):
        return None
    shift = shifts[best] + 0.5 * (before - after) / (bent * _STEP)
    # What sections differ by beyond their sigma is shared along a pass, and moves the place with it.
    unlike = max(at * alike / (len(first[0]) * first[1].shape[1]), 1.0)
    return Alignment(first[0] + shift, np.full(len(first[0]), np.sqrt(2.0 * unlike / bent)))


def _apart(
    first: tuple[np.ndarray, np.ndarray, np.ndarray], second: tuple[np.ndarray, np.ndarray, np.ndarray], shift: float
) -> float:
    """Return the mean squared difference over its variance; infinite where less than half of the line has a partner."""
    value, spread = Alignment(first[0] + shift, np.zeros(len(first[0]))).at(*second, moved=False)
    apart, both = first[1] - value, first[2] + spread
    known = np.isfinite(apart).all(axis=1) & np.isfinite(both).all(axis=(1, 2))
    if known.sum() < 0.5 * len(known):
        return np.inf
    square = np.einsum("ni,ni->n", apart[known], np.linalg.solve(both[known], apart[known][..., None])[..., 0])
    # Joints and misread rings must not decide where the rest lies.
    return float(np.mean(np.minimum(square, 25.0)))


def combined(
    first: np.ndarray, first_covariance: np.ndarray, second: np.ndarray, second_covariance: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the best mean of two measurements whose errors are independent, with its covariance.

    Args:
        first: (n, d).
        first_covariance: (n, d, d); what is not positive is brought up to a thousandth of its largest part.
        second: (n, d).
        second_covariance: (n, d, d).

    >>> one = np.ones((1, 1, 1))
    >>> value, spread = combined(np.array([[1.0]]), 4.0 * one, np.array([[2.0]]), one)
    >>> value.round(9).tolist(), spread.round(9).tolist()
    ([[1.8]], [[[0.8]]])
    """
    a, b = _positive(first_covariance), _positive(second_covariance)
    gain = np.swapaxes(np.linalg.solve(a + b, a), 1, 2)
    value = first + np.einsum("nij,nj->ni", gain, second - first)
    spread = a - gain @ a
    return value, 0.5 * (spread + np.swapaxes(spread, 1, 2))


def less(covariance: np.ndarray, common: np.ndarray) -> np.ndarray:
    """Return what is left of covariances (n, d, d) without a variance (n,) that is common to every coordinate.

    No direction is left with less than a twentieth of the largest part: what is common is known roughly itself.
    """
    size, axes = np.linalg.eigh(covariance - common[:, None, None] * np.eye(covariance.shape[1]))
    whole = np.linalg.eigvalsh(covariance)[:, -1:]
    return np.einsum("nij,nj,nkj->nik", axes, np.maximum(size, _LEAST * whole), axes)


def _positive(covariance: np.ndarray) -> np.ndarray:
    size, axes = np.linalg.eigh(covariance)
    size = np.maximum(size, _FLOOR * np.maximum(size[:, -1:], 1e-18))
    return np.einsum("nij,nj,nkj->nik", axes, size, axes)


def shared_by_ties(chainage: np.ndarray, at: np.ndarray, sigma: np.ndarray) -> Common:
    """Return what known points put into every line that is tied to them.

    Between the outermost two of the points a line leans on both; with one point, or none, on that alone, or on none.

    Args:
        chainage: Of the stations [m] (n,).
        at: Chainage of the shared points [m] (t,).
        sigma: One-sigma of each of their coordinates [m] (t,).

    >>> ends = np.array([0.0, 10.0])
    >>> shared_by_ties(np.array([0.0, 5.0, 10.0]), ends, np.array([0.01, 0.01])).place.round(6).tolist()
    [0.0001, 5e-05, 0.0001]
    """
    if not at.size:
        return Common(np.zeros(len(chainage)), 0.0)
    low, high = int(np.argmin(at)), int(np.argmax(at))
    length = at[high] - at[low]
    if length <= 0.0:
        return Common(np.full(len(chainage), sigma[low] ** 2), 0.0)
    share = (chainage - at[low]) / length
    place = ((1.0 - share) * sigma[low]) ** 2 + (share * sigma[high]) ** 2
    return Common(place, float((sigma[low] ** 2 + sigma[high] ** 2) / length**2))
