"""How well two pieces of wall agree: a likelihood ratio that knows the wall's own spectrum and the sensor's noise.

Each map is relief plus white noise. In every wave of the relief both inspections then share a part rho of their power,
0 where noise is all there is; log p(a, b) / (p(a) p(b)) of two complex Gaussians follows per wave. A smooth wall has
rho = 0 everywhere and says nothing, where a plain sum of squares would chase the noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft
from scipy.ndimage import uniform_filter, uniform_filter1d

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .wall import Wall

_SWELL = 1.0  # m: slower than this is shape, not relief
_CLIP = 4.0
_FRAME = 64
_MOST_SHARED = 0.98
_QUIET = 3.0
_LEAST_SHARED = 0.01


@dataclass(frozen=True)
class Relief:
    """The wall's relief on a grid of equal steps along the pipe; where nothing was seen it is 0 and `seen` false."""

    field: NDArray[np.float32]
    seen: NDArray[np.bool_]


def relief(wall: Wall, chainage: NDArray[np.float64], step: float) -> Relief:
    """Return the relief at `chainage` (n,) [m] of the wall, a grid of about `step` [m]; its swell is taken away.

    Rings at joints are left out: one joint looks like the next, and which ring meets it is chance.
    """
    plain = np.where(wall.at_joint[:, None], np.float32(np.nan), wall.surface)
    surface, seen = sample(wall.chainage, plain, chainage, 3.0 * max(wall.spacing, step))
    scatter = 1.4826 * float(np.median(np.abs(surface[seen]))) if seen.any() else 0.0
    field = np.clip(surface, -_CLIP * scatter, _CLIP * scatter)
    width = max(3, round(_SWELL / step))
    share = uniform_filter1d(seen.astype(np.float32), width, axis=0, mode="nearest")
    mean = uniform_filter1d(field, width, axis=0, mode="nearest") / np.maximum(share, 0.1)
    return Relief(np.where(seen, field - mean, 0.0).astype(np.float32), seen)


def sample(
    at: NDArray[np.float64], rows: NDArray[np.float32], wanted: NDArray[np.float64], reach: float
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return rows (n, m) given `at` (k,) [m] at the places `wanted` (n,) [m], by cubic interpolation.

    Args:
        at: Rising places of the rows.
        rows: (k, m); NaN where unknown.
        wanted: Places.
        reach: Nothing is given between rows further apart than this [m].

    Returns:
        Values, 0 where unknown, and whether they are known.
    """
    i = np.clip(np.searchsorted(at, wanted, side="right") - 1, 0, len(at) - 2)
    gap = at[i + 1] - at[i]
    t = (wanted - at[i]) / gap
    inside = (t >= 0.0) & (t <= 1.0) & (gap <= reach)
    weights = (weight.astype(np.float32)[:, None] for weight in _cubic(np.clip(t, 0.0, 1.0)))
    near = np.isfinite(rows[i]) & np.isfinite(rows[i + 1])
    total = np.zeros((len(wanted), rows.shape[1]), np.float32)
    for k, weight in zip((-1, 0, 1, 2), weights, strict=True):
        part = rows[np.clip(i + k, 0, len(at) - 1)]
        if k in (-1, 2):
            # Beyond a gap the nearer row stands in, so that known cells stay known.
            part = np.where(np.isfinite(part), part, rows[i] if k == -1 else rows[i + 1])
        total += weight * part
    known = near & inside[:, None]
    return np.where(known, total, 0.0).astype(np.float32), known


def _cubic(t: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Return the weights of the four rows about a place, the share `t` (n,) of the way from the second to the third."""
    return (
        ((-0.5 * t + 1.0) * t - 0.5) * t,
        (1.5 * t - 2.5) * t * t + 1.0,
        ((-1.5 * t + 2.0) * t + 0.5) * t,
        (0.5 * t - 0.5) * t * t,
    )


def white_kept(at: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the share (n,) of the variance of white noise that `sample` keeps in one row: 1 on a row, less between.

    What is averaged over several rows keeps all of it.

    >>> white_kept(np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, 1.5]))
    array([1.      , 0.640625])
    """
    i = np.clip(np.searchsorted(at, wanted, side="right") - 1, 0, len(at) - 2)
    weights = _cubic(np.clip((wanted - at[i]) / (at[i + 1] - at[i]), 0.0, 1.0))
    return sum(np.square(weight) for weight in weights)


def spectrum(one: Relief) -> NDArray[np.float64]:
    """Return the power of the waves (_FRAME, m // 2 + 1) of a relief: for white noise, its variance everywhere."""
    n, m = one.field.shape
    taper = np.hanning(_FRAME + 2)[1:-1].astype(np.float32)
    total, weight = np.zeros((_FRAME, m // 2 + 1)), 0.0
    for start in range(0, n - _FRAME + 1, _FRAME // 2):
        part = slice(start, start + _FRAME)
        share = float(one.seen[part].mean())
        if share < 0.5:
            continue
        wave = fft.fft(fft.rfft(one.field[part] * taper[:, None], axis=1), axis=0)
        total += np.abs(wave) ** 2 / (m * float((taper**2).sum()))
        weight += share
    return total / weight if weight else total


@dataclass(frozen=True)
class Shared:
    """What two reliefs share, by wave: shares (_FRAME, m // 2 + 1) of power, and the powers of both [m2]."""

    share: NDArray[np.float64]
    power_a: NDArray[np.float64]
    power_b: NDArray[np.float64]

    @property
    def expected(self) -> float:
        """Mean over waves of what agreement earns per cell, were it as expected."""
        r2 = self.share**2
        return _over_waves(r2 / (1.0 - r2))

    @property
    def constant(self) -> float:
        """Mean over waves of -log(1 - share^2) / 2, the part of the ratio that does not depend on the readings."""
        return _over_waves(-0.5 * np.log1p(-(self.share**2)))

    def times(self, factor: float) -> Shared:
        """Return the same with shares multiplied by `factor`."""
        return Shared(np.clip(self.share * factor, 0.0, _MOST_SHARED), self.power_a, self.power_b)


def _over_waves(values: NDArray[np.float64]) -> float:
    """Return the mean over all waves of a half spectrum: the middle columns stand for two."""
    weight = np.full(values.shape[1], 2.0)
    weight[0] = 1.0
    weight[-1] = 1.0
    return float((values * weight).sum() / (weight.sum() * values.shape[0]))


def shared(a: Relief, b: Relief) -> Shared:
    """Return what two reliefs may share at most, by their spectra: power above the noise that fast waves show."""
    powers, walls = [], []
    for one in (a, b):
        power = uniform_filter(spectrum(one), 3, mode="nearest")
        frames = max(2 * len(one.field) / _FRAME, 1.0)
        fast = power[_FRAME // 4 : 3 * _FRAME // 4, power.shape[1] // 2 :]
        noise = float(np.median(fast))
        # The mean of a few periodograms scatters; only what stands clear of that is relief.
        margin = 1.0 + _QUIET / np.sqrt(9.0 * frames)
        powers.append(np.maximum(power, max(noise, 1e-14)))
        walls.append(np.maximum(power - margin * noise, 0.0))
    wall = np.minimum(*walls)
    share = wall / np.sqrt(powers[0] * powers[1])
    share[share < _LEAST_SHARED] = 0.0
    return Shared(np.minimum(share, _MOST_SHARED), *powers)


@dataclass(frozen=True)
class Prepared:
    """Both reliefs, filtered so that sums of products and of squares are the terms of the likelihood ratio."""

    a: NDArray[np.float32]
    b: NDArray[np.float32]
    energy_a: NDArray[np.float64]
    energy_b: NDArray[np.float64]
    seen_a: NDArray[np.float64]
    seen_b: NDArray[np.float64]
    constant: float


def prepare(a: Relief, b: Relief, both: Shared) -> Prepared:
    """Return the filtered reliefs; energies and share seen are per step along the pipe."""
    r, sa, sb = both.share, both.power_a, both.power_b
    product = np.sqrt(r / ((1.0 - r**2) * np.sqrt(sa * sb)))
    squares = [np.sqrt(r**2 / ((1.0 - r**2) * s)) for s in (sa, sb)]
    energies = [
        np.square(_filtered(one.field, gain), dtype=np.float64).sum(axis=1)
        for one, gain in zip((a, b), squares, strict=True)
    ]
    return Prepared(
        _filtered(a.field, product), _filtered(b.field, product), *energies,
        a.seen.sum(axis=1), b.seen.mean(axis=1), both.constant,
    )  # fmt: skip


def _filtered(field: NDArray[np.float32], gain: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return a field after a gain given on _FRAME waves along it, interpolated to its own."""
    n = fft.next_fast_len(len(field) + _FRAME)
    wave = fft.fft(fft.rfft(field, axis=1), n=n, axis=0)
    at = np.abs(fft.fftfreq(n)) * _FRAME
    half = gain[: _FRAME // 2 + 1]
    low = np.minimum(at.astype(int), _FRAME // 2 - 1)
    t = (at - low)[:, None]
    wave *= ((1.0 - t) * half[low] + t * half[low + 1]).astype(np.float32)
    return fft.irfft(fft.ifft(wave, axis=0)[: len(field)], n=field.shape[1], axis=1).astype(np.float32)


def log_ratio(
    one: Prepared, rows: slice, low: int, high: int, fine: int, roll: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the log likelihood ratio of a piece of A lying at each shift in B, over all rolls.

    Args:
        one: The filtered reliefs, on one grid.
        rows: The piece of A.
        low, high: Least and largest shift [steps].
        fine: Shifts per step.
        roll: (m,) log prior of each roll of B against A, in cells of bearing.

    Returns:
        ((high - low) fine + 1, m) by shift and roll.
    """
    a = one.a[rows]
    n, m = a.shape
    first, last = rows.start + low, rows.start + n + high
    inside = slice(max(first, 0), max(min(last, len(one.b)), 0))
    b = np.zeros((last - first, m), np.float32)
    energy, seen = np.zeros(last - first), np.zeros(last - first)
    if inside.stop > inside.start:
        within = slice(inside.start - first, inside.stop - first)
        b[within], energy[within], seen[within] = one.b[inside], one.energy_b[inside], one.seen_b[inside]
    size = fft.next_fast_len(last - first)
    wave_a = fft.fft(fft.rfft(a, axis=1), n=size, axis=0)
    wave_b = fft.fft(fft.rfft(b, axis=1), n=size, axis=0)
    product = np.conj(wave_a) * wave_b
    if fine > 1:
        spread = np.zeros((size * fine, product.shape[1]), product.dtype)
        half = size // 2
        spread[:half], spread[-(size - half) :] = product[:half], product[half:]
        product = spread * fine
    shifts = (high - low) * fine + 1
    found = fft.irfft(fft.ifft(product, axis=0)[:shifts], n=m, axis=1).astype(np.float64)
    at = np.arange(shifts) / fine
    energy_b, share = (np.interp(at, np.arange(high - low + 1), _running(part, n)) for part in (energy, seen))
    fixed = one.constant * float(one.seen_a[rows].sum()) - 0.5 * one.energy_a[rows].sum()
    return found + (share / n * fixed - 0.5 * energy_b)[:, None] + roll


def _running(values: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    """Return sums over n neighbours."""
    sums = np.concatenate(([0.0], np.cumsum(values)))
    return sums[n:] - sums[:-n]
