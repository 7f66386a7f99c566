"""Three inspections or more: each placed on the first, and how every quantity goes from one to the next."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from ..errors import InputError
from .pair import _YEAR, Comparison, compare_epochs
from .paired import BY_GAP, MEASURED
from .sharpen import depth_at
from .templates import FALSE_ALARMS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .epochs import Epoch
    from .options import MatchOptions
    from .scan import Patch

_FEWEST = 3
_BLOCK = 1.0  # m over which a station's values are averaged
_HUNDRED = 100.0
_RAREST = 0.01


@dataclass(frozen=True)
class Trend:
    """How a quantity goes at one place or of one feature, by a weighted straight line over the inspections.

    Attributes:
        quantity: Key of `verdicts.QUANTITIES`.
        chainage: In the first inspection [m].
        bearing: Of a feature [rad]; NaN for a station.
        kind: Of a feature; empty for a station.
        values: (k,) by inspection, less the first's for a station; NaN where it was not seen.
        sigmas: (k,) their one-sigma.
        rate: Rise per year, or per inspection where dates are not known.
        rate_sigma: Its one-sigma.
        significant: Whether the rate is told at the stated rate of false alarms.
    """

    quantity: str
    chainage: float
    bearing: float
    kind: str
    values: tuple[float, ...]
    sigmas: tuple[float, ...]
    rate: float
    rate_sigma: float
    significant: bool


@dataclass(frozen=True)
class Series:
    """A series of inspections.

    Attributes:
        epochs: In the order given.
        pairs: The comparison of each but the first with the first.
        times: (k,) years since the first; 0, 1, 2 ... where a date is missing.
        dated: Whether `times` are years.
        stations: Trends by station.
        patches: Trends of the wall, where any comparison with the first tells a patch.
        features: Trends by feature.
    """

    epochs: tuple[Epoch, ...]
    pairs: tuple[Comparison, ...]
    times: tuple[float, ...]
    dated: bool
    stations: tuple[Trend, ...]
    patches: tuple[Trend, ...]
    features: tuple[Trend, ...]

    def __bool__(self) -> bool:
        return any(self.pairs)


def compare_series(
    epochs: Sequence[Epoch],
    *,
    options: MatchOptions | None = None,
    false_alarms: float = FALSE_ALARMS,
    works: bool = False,
) -> Series:
    """Return the trends of three inspections or more, each placed on the first.

    A station's value is the change of a profile since the first inspection, averaged over a metre; all later ones share
    the error of the first, so the line through them leaves its own value at the first free.

    Args:
        epochs: Inspections, the earliest first.
        options, false_alarms, works: As for `compare`.

    Raises:
        InputError: There are fewer than three, or dates go back.
    """
    if len(epochs) < _FEWEST:
        raise InputError(f"a series of {len(epochs)}", where="epochs", expected="three inspections or more")
    times, dated = _times(epochs)
    given = {"options": options, "false_alarms": false_alarms, "works": works}
    pairs = tuple(compare_epochs(epochs[0], other, **given) for other in epochs[1:])
    found = _stations(pairs, times), _patches(pairs, times), _features(epochs, pairs, times)
    length = max(epochs[0].extent[1] - epochs[0].extent[0], 1.0)
    return Series(
        tuple(epochs), pairs, times, dated,
        *(_judged(trends, false_alarms, length) for trends in found),
    )  # fmt: skip


def _times(epochs: Sequence[Epoch]) -> tuple[tuple[float, ...], bool]:
    dates = [e.date for e in epochs]
    if any(d is None for d in dates):
        return tuple(float(k) for k in range(len(epochs))), False
    times = tuple((d - dates[0]).days / _YEAR for d in dates)
    falls = np.flatnonzero(np.diff(times) <= 0)
    if falls.size:
        k = int(falls[0]) + 1
        raise InputError(
            f"{epochs[k].name} of {dates[k]} comes after {epochs[k - 1].name} of {dates[k - 1]}",
            where="epochs", expected="inspections in the order of their dates", mend="give the earliest first",
        )  # fmt: skip
    return times, True


def _line(times: NDArray, values: NDArray, sigmas: NDArray) -> tuple[float, float]:
    """Return slope and its one-sigma of a weighted line; NaN with fewer than two known values."""
    known = np.isfinite(values) & np.isfinite(sigmas) & (sigmas > 0)
    if known.sum() < _FEWEST:
        return np.nan, np.nan
    w, t, v = 1.0 / sigmas[known] ** 2, times[known], values[known]
    middle = np.sum(w * t) / np.sum(w)
    spread = np.sum(w * (t - middle) ** 2)
    return float(np.sum(w * (t - middle) * v) / spread), float(1.0 / np.sqrt(spread))


def _stations(pairs: tuple[Comparison, ...], times: tuple[float, ...]) -> list[Trend]:
    """Return the trend of each profile in each metre of the first inspection."""
    ready = [(k, p) for k, p in enumerate(pairs, 1) if p and p.profiles]
    if not ready:
        return []
    first = ready[0][1].difference
    edges = np.arange(first.chainage[0], first.chainage[-1] + _BLOCK, _BLOCK)
    names = [profile.quantity for profile in ready[0][1].profiles]
    trends = []
    for name in names:
        values, sigmas = np.full((len(times), len(edges) - 1), np.nan), np.full((len(times), len(edges) - 1), np.nan)
        for k, pair in ready:
            profile = next((p for p in pair.profiles if p.quantity == name), None)
            if profile is not None:
                values[k], sigmas[k] = _averaged(pair.difference.chainage, profile, edges)
        # Half the variance of a change is the first inspection's own, and stands at its 0.
        known = np.isfinite(sigmas[1:])
        total = np.where(known, sigmas[1:] ** 2, 0.0).sum(axis=0)
        own = np.where(known.any(axis=0), total / np.maximum(known.sum(axis=0), 1), np.nan) / 2.0
        values[0], sigmas[0] = 0.0, np.sqrt(own)
        sigmas[1:] = np.sqrt(np.maximum(sigmas[1:] ** 2 - own, 0.5 * sigmas[1:] ** 2))
        for m in range(len(edges) - 1):
            rate, sigma = _line(np.array(times), values[:, m], sigmas[:, m])
            if np.isfinite(rate):
                middle = 0.5 * float(edges[m] + edges[m + 1])
                trends.append(
                    Trend(name, middle, np.nan, "", tuple(values[:, m]), tuple(sigmas[:, m]), rate, sigma, False)
                )
    return trends


def _patches(pairs: tuple[Comparison, ...], times: tuple[float, ...]) -> list[Trend]:
    """Return the trend of the wall where a comparison with the first tells a patch, the clearest first."""
    ready = [(k, p) for k, p in enumerate(pairs, 1) if p and p.scan is not None]
    patches = sorted((patch for _, p in ready for patch in p.scan.patches), key=lambda p: -abs(p.score))
    kept: list[Patch] = []
    for patch in patches:
        if not any(_same(patch, other) for other in kept):
            kept.append(patch)
    trends = []
    for patch in kept:
        values, sigmas = np.full(len(times), np.nan), np.full(len(times), np.nan)
        for k, pair in ready:
            values[k], sigmas[k] = depth_at(pair.difference, patch.chainage, patch.bearing, patch.length, patch.width)
        if not np.isfinite(sigmas).any():
            continue
        # Half the variance of a change is the first inspection's own, and stands at its 0.
        own = float(np.nanmedian(sigmas) / np.sqrt(2.0))
        sigmas = np.sqrt(np.maximum(sigmas**2 - own**2, 0.5 * sigmas**2))
        values[0], sigmas[0] = 0.0, own
        rate, sigma = _line(np.array(times), values, sigmas)
        if np.isfinite(rate):
            trends.append(
                Trend("patch", patch.chainage, patch.bearing, "", tuple(values), tuple(sigmas), rate, sigma, False)
            )
    return trends


def _same(a: Patch, b: Patch) -> bool:
    """Return whether two patches cover each other's middle."""
    turn = np.mod(a.bearing - b.bearing + np.pi, 2 * np.pi) - np.pi
    return bool(abs(a.chainage - b.chainage) <= max(a.length, b.length) and abs(turn) <= max(a.width, b.width))


def _averaged(chainage: NDArray, profile: object, edges: NDArray) -> tuple[NDArray, NDArray]:
    """Return the mean change and its one-sigma between edges; NaN where less than half is known."""
    known = np.isfinite(profile.change) & np.isfinite(profile.sigma) & np.isfinite(profile.fixed)
    cell = np.clip(np.searchsorted(edges, chainage, side="right") - 1, 0, len(edges) - 2)
    size = len(edges) - 1
    all_of = np.bincount(cell, minlength=size)
    count = np.bincount(cell[known], minlength=size)

    def mean(values: NDArray) -> NDArray:
        return np.bincount(cell[known], weights=values[known], minlength=size) / np.maximum(count, 1)

    value = mean(profile.change)
    sigma = np.sqrt(mean(profile.sigma**2) / np.maximum(count, 1) + mean(profile.fixed**2))
    few = count < 0.5 * all_of
    return np.where(few, np.nan, value), np.where(few, np.nan, sigma)


def _features(epochs: Sequence[Epoch], pairs: tuple[Comparison, ...], times: tuple[float, ...]) -> list[Trend]:
    """Return the trend of each quantity of each feature that was found in three inspections or more."""
    first = epochs[0]
    if first.features is None:
        return []
    where = np.full((len(epochs), len(first.features)), -1)
    where[0] = np.arange(len(first.features))
    for k, pair in enumerate(pairs, 1):
        if pair and pair.paired is not None:
            where[k, pair.paired.index_a] = pair.paired.index_b
    kinds, trends = first.kinds(), []
    for n in np.flatnonzero((where >= 0).sum(axis=0) >= _FEWEST):
        for quantity, variable in MEASURED.get(kinds[n], ()):
            if variable == "bearing":
                continue
            rows = [e.measured(variable) if i[n] >= 0 else None for e, i in zip(epochs, where, strict=True)]
            sized = [e.measured("size")[0][i[n]] if i[n] >= 0 else np.nan for e, i in zip(epochs, where, strict=True)]
            values, sigmas = (
                np.array([r[part][i[n]] if r is not None else np.nan for r, i in zip(rows, where, strict=True)])
                for part in (0, 1)
            )
            if variable in BY_GAP:
                values = np.where(np.isfinite(sized), values, np.nan)
            rate, sigma = _line(np.array(times), values, sigmas)
            if np.isfinite(rate):
                trends.append(
                    Trend(
                        quantity, float(first.features.chainage[n]), float(first.features.bearing[n]), kinds[n],
                        tuple(values), tuple(sigmas), rate, sigma, False,
                    )
                )  # fmt: skip
    return trends


def _judged(trends: list[Trend], rate: float, length: float) -> tuple[Trend, ...]:
    """Return the trends with the verdict whether each is told, at `rate` false alarms per 100 m over all of them."""
    chance = min(rate * length / _HUNDRED / max(len(trends), 1), _RAREST)
    limit = float(norm.isf(chance / 2.0))
    return tuple(replace(t, significant=bool(abs(t.rate) > limit * t.rate_sigma)) for t in trends)
