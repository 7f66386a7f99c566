"""One change between two inspections, and the runs of a profile in which it shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import convolve1d
from scipy.optimize import brentq

from .scan import DETECTION

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

WINDOWS = (0.25, 1.0, 4.0)
"""Lengths over which profiles are averaged [m], at half height."""

TOLD = 1.0
"""Length for which the detectable change of a profile is stated [m]."""

_HUNDRED = 100.0
_LEAST_SEEN = 0.6
_MOST = 200


@dataclass(frozen=True)
class Change:
    """A significant change, in the units of `verdicts.QUANTITIES` before their factor.

    Attributes:
        quantity: Key of `verdicts.QUANTITIES`.
        chainage: Of its middle in A [m]; of the whole pipe when NaN.
        length: Along the pipe [m].
        bearing: Of its middle [rad]; NaN for what goes all round.
        width: Round the pipe [rad]; NaN as `bearing`.
        value_a, value_b: Before and after; NaN where only their difference is known.
        change: B less A.
        sigma: Its one-sigma; NaN where it is not known.
        false_alarms: How many as clear appear by chance in 100 m of unchanged pipe; NaN where that is not known.
        verdict: change, measurement error, or unclear.
        reason: Why it is not taken for a change, or words for what numbers do not say.
    """

    quantity: str
    chainage: float
    length: float
    bearing: float
    width: float
    value_a: float
    value_b: float
    change: float
    sigma: float
    false_alarms: float
    verdict: str
    reason: str


@dataclass(frozen=True)
class Profile:
    """A quantity along the pipe, B less A.

    Attributes:
        quantity: Key of `verdicts.QUANTITIES`.
        value_a: (n,) in A.
        change: (n,) B less A; NaN where it cannot be told.
        sigma: (n,) one-sigma of each station, independent of the next.
        fixed: (n,) one-sigma of what all stations near each other share.
    """

    quantity: str
    value_a: NDArray[np.float64]
    change: NDArray[np.float64]
    sigma: NDArray[np.float64]
    fixed: NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """A stretch in which a profile changed: index of its middle, length [m], mean change, its sigma, and how rare."""

    index: int
    length: float
    change: float
    sigma: float
    false_alarms: float


@dataclass(frozen=True)
class Looked:
    """What was found in a profile: runs, and the change over 1 m that is told in 95 % of cases."""

    runs: tuple[Run, ...]
    detectable: float


def look(profile: Profile, step: float, rate: float) -> Looked:
    """Return the stretches in which a profile changed.

    A cos^2 window of each of `WINDOWS` slides along; its mean over its sigma passes u by chance, for both signs,
    sqrt(l) / pi exp(-u^2 / 2) times per station, with l the second spectral moment (Rice's formula).

    Args:
        profile: The profile, at equal steps.
        step: Between stations [m].
        rate: False alarms per 100 m, over all windows.

    Source: S. O. Rice, Bell System Technical Journal 24 (1945) 46-156, section 3.3.
    """
    known = np.isfinite(profile.change) & np.isfinite(profile.sigma) & np.isfinite(profile.fixed)
    windows = [w for w in WINDOWS if 2 * w / step >= 3 and w <= 0.5 * step * max(int(known.sum()), 1)]
    if not windows or known.sum() < 3:
        return Looked((), np.nan)
    shapes = [_window(w / step) for w in windows]
    steepness = sum(np.sqrt(np.sum(np.diff(h, prepend=0, append=0) ** 2) / np.sum(h**2)) for h in shapes)

    def alarms(u: float) -> float:
        return float(_HUNDRED / step * steepness / np.pi * np.exp(-0.5 * u**2))

    limit = float(brentq(lambda u: np.log(alarms(u) / rate), 0.5, 12.0))
    weight = np.where(known, 1.0 / np.maximum(np.nan_to_num(profile.sigma), 1e-12) ** 2, 0.0)
    pull = np.where(known, profile.change, 0.0) * weight
    # A window may stand on a station that is not known itself, such as a joint.
    fixed = np.interp(np.arange(len(known)), np.flatnonzero(known), profile.fixed[known])
    best, found = np.zeros(len(known)), np.zeros((len(known), 3))
    detectable = np.nan
    for length, h in zip(windows, shapes, strict=True):
        total, squares = (convolve1d(weight, h**k, mode="constant") for k in (1, 2))
        share = convolve1d(known.astype(float), h, mode="constant") / h.sum()
        mean = convolve1d(pull, h, mode="constant") / np.maximum(total, 1e-30)
        own = np.sqrt(squares) / np.maximum(total, 1e-30)
        seen = share > _LEAST_SEEN
        if not seen.any():
            continue
        off = mean[seen] - np.median(mean[seen])
        spread = max(1.0, 1.4826 * float(np.median(np.abs(off / own[seen]))))
        sigma = np.hypot(spread * own, fixed)
        if length == TOLD:
            detectable = (limit + DETECTION) * float(np.median(sigma[seen]))
        score = np.where(seen, mean, 0.0) / np.maximum(sigma, 1e-15)
        better = np.abs(score) > np.abs(best)
        best[better] = score[better]
        found[better] = np.column_stack((mean, sigma, np.full(len(mean), length)))[better]
    short = convolve1d(pull, shapes[0], mode="constant") / np.maximum(
        convolve1d(weight, shapes[0], mode="constant"), 1e-30
    )
    return Looked(_runs(best, found, np.where(known, short, 0.0), limit, step, alarms), detectable)


def _window(size: float) -> NDArray[np.float64]:
    half = int(np.ceil(size)) - 1
    return np.cos(0.5 * np.pi * np.arange(-half, half + 1) / size) ** 2


def _runs(
    best: NDArray, found: NDArray, short: NDArray, limit: float, step: float, alarms: Callable[[float], float]
) -> tuple[Run, ...]:
    """Return the clearest place of each run of stations above the limit, with the length over half its change."""
    runs = []
    for sign in (1.0, -1.0):
        over = np.concatenate(([False], sign * best > limit, [False]))
        edges = np.flatnonzero(np.diff(over))
        for first, last in zip(edges[::2], edges[1::2], strict=True):
            top = first + int(np.argmax(np.abs(best[first:last])))
            mean, sigma, length = found[top]
            half = np.flatnonzero(short[first:last] * sign < 0.5 * abs(mean)) + first
            begin = int(half[half < top].max(initial=first - 1)) + 1
            end = int(half[half > top].min(initial=last))
            longer = max((end - begin) * step, float(length))
            at = (begin + end) // 2 if end > begin else top
            runs.append(Run(at, longer, float(mean), float(sigma), alarms(abs(best[top]))))
    return tuple(sorted(runs, key=lambda r: r.false_alarms)[:_MOST])
