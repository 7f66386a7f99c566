"""A dent, deposit or intrusion sized on the unrolled wall: how deep, where it is deepest, and how far it reaches."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_EDGE = 0.1
_CORE = 0.6
_SMALL, _LARGE = 30, 60
_TAKEN_UP = 0.35
"""Part of the variance that neighbours share which the lowest place of the surface has, measured on simulated pipes."""


class Bump(NamedTuple):
    """An inward bump, each value with its one-sigma.

    Attributes:
        depth: Of its deepest place, negative [m].
        x: Chainage of its middle [m].
        bearing: Of its middle [rad].
        length: Over which it stands inward by more than a tenth of its depth, along the pipe [m].
        span: The same round the pipe [rad].
        steep: Depth over half its shorter extent along the wall.
    """

    depth: tuple[float, float]
    x: tuple[float, float]
    bearing: tuple[float, float]
    length: tuple[float, float]
    span: tuple[float, float]
    steep: float


def size_bump(
    x: ArrayLike,
    bearing: ArrayLike,
    height: ArrayLike,
    seed: tuple[float, float],
    *,
    radius: float,
    reach: tuple[float, float],
    noise: float,
    alike: float,
) -> Bump | None:
    """Return the size of a bump.

    A surface of fourth degree is laid through the readings about its deepest place, those deeper than about half of it;
    its lowest value is the depth. Extents come from the profiles through that place, each averaged over the core.

    Args:
        x: (ring,) chainage [m].
        bearing: (bearing,) of a window that is not all round, rising [rad].
        height: (ring, bearing) deviation of the wall from what it would be without the bump [m]; NaN = no reading.
        seed: Chainage [m] and bearing [rad] at which it was found.
        radius: Of the pipe [m].
        reach: Extents along [m] and round [rad] at which it was found.
        noise: One-sigma of a reading [m].
        alike: Factor on variances for errors that neighbouring readings share.

    Returns:
        None when too few readings show it.
    """
    x, bearing, height = (np.asarray(v, float) for v in (x, bearing, height))
    at, half = np.array(seed), 0.25 * np.maximum(reach, [2.0 * _step(x), 4.0 * _step(bearing)])
    depth = np.nan
    for _ in range(6):
        rows = (np.abs(x - at[0]) < 2.0 * half[0]), (np.abs(bearing - at[1]) < 2.0 * half[1])
        u, v = np.meshgrid((x[rows[0]] - at[0]) / half[0], (bearing[rows[1]] - at[1]) / half[1], indexing="ij")
        part = height[np.ix_(*rows)]
        core = np.isfinite(part) & (u**2 + v**2 < 1.0)
        found = _surface(u[core], v[core], part[core], noise)
        if found is None:
            return None
        depth, move, variance, place_sigma = found
        if depth >= 0.0:
            return None
        at = at + np.clip(move, -0.5, 0.5) * half
        widths = _half_widths(x, bearing, height, at, half, depth)
        if not np.isfinite(widths).all():
            break
        new = _CORE * widths
        settled = np.all(np.abs(new - half) < 0.05 * half) and np.all(np.abs(move) < 0.05)
        half = np.maximum(new, [1.5 * _step(x), 2.5 * _step(bearing)])
        if settled:
            break
    along, round_ = _extent(x, bearing, height, at, half, depth)
    share = np.maximum(alike, 1.0)
    sigma = np.sqrt(variance * (1.0 + _TAKEN_UP * (share - 1.0)) + (0.15 * noise) ** 2)
    rough = 0.4 * noise * np.sqrt(share)
    extent_sigma = np.hypot([_step(x), _step(bearing)], np.sqrt(2.0) * rough * np.array([along[2], round_[2]]))
    place = np.sqrt(share) * place_sigma * half
    length, span = along[1] - along[0], round_[1] - round_[0]
    shorter = max(min(length, span * radius), 1e-6)
    return Bump(
        depth=(float(depth), float(sigma)),
        x=(float(at[0]), float(np.hypot(place[0], _step(x) / np.sqrt(12.0)))),
        bearing=(float(at[1]), float(place[1])),
        length=(float(length), float(extent_sigma[0])),
        span=(float(span), float(extent_sigma[1])),
        steep=float(-depth / (0.5 * shorter)),
    )


def _step(values: NDArray) -> float:
    return float(np.median(np.diff(values))) if len(values) > 1 else 0.0


def _surface(u: NDArray, v: NDArray, values: NDArray, noise: float) -> tuple | None:
    """Return the lowest value, where it is, its variance, and the one-sigma of the place."""
    if len(values) < 8:
        return None
    terms = [np.ones_like(u), u, v, u * u, u * v, v * v]
    if len(values) >= _SMALL and len(np.unique(u)) >= 5:
        terms += [u**3, u * u * v, u * v * v, v**3]
    if len(values) >= _LARGE and len(np.unique(u)) >= 6:
        terms += [u**4, u * u * v * v, v**4]
    rows = np.stack(terms, axis=1)
    weight = np.ones(len(values))
    for _ in range(4):
        normal = (rows * weight[:, None]).T @ rows + 1e-9 * np.eye(len(terms))
        found = np.linalg.solve(normal, (rows * weight[:, None]).T @ values)
        off = values - rows @ found
        scatter = max(1.4826 * float(np.median(np.abs(off))), 0.3 * noise, 1e-6)
        weight = np.clip(1.0 - (off / (4.5 * scatter)) ** 2, 0.0, 1.0) ** 2
    grid = np.linspace(-0.8, 0.8, 33)
    a, b = (m.ravel() for m in np.meshgrid(grid, grid, indexing="ij"))
    b, a = b[np.hypot(a, b) < 0.8], a[np.hypot(a, b) < 0.8]
    every = [np.ones_like(a), a, b, a * a, a * b, b * b, a**3, a * a * b, a * b * b, b**3, a**4, a * a * b * b, b**4]
    surface = np.stack(every[: len(terms)], axis=1)
    lowest = int(np.argmin(surface @ found))
    inverse = np.linalg.inv((rows * weight[:, None]).T @ rows + 1e-9 * np.eye(len(terms)))
    variance = float(surface[lowest] @ inverse @ surface[lowest]) * scatter**2
    curve = np.maximum([2.0 * found[3], 2.0 * found[5]], 1e-6)
    place = scatter * np.sqrt([inverse[1, 1], inverse[2, 2]]) / curve
    return float(surface[lowest] @ found), np.array([a[lowest], b[lowest]]), variance, np.minimum(place, 1.0)


def _profiles(x: NDArray, bearing: NDArray, height: NDArray, at: NDArray, half: NDArray) -> tuple[NDArray, NDArray]:
    """Return the profiles along and round through a place, each averaged over a third of the core across it."""
    near_x = np.abs(x - at[0]) <= max(0.35 * half[0], 0.51 * _step(x))
    near_b = np.abs(bearing - at[1]) <= max(0.35 * half[1], 0.51 * _step(bearing))
    return _mean(height[:, near_b], 1), _mean(height[near_x], 0)


def _mean(values: NDArray, axis: int) -> NDArray[np.float64]:
    seen = np.isfinite(values)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(seen, values, 0.0).sum(axis=axis) / np.where(seen.any(axis=axis), seen.sum(axis=axis), np.nan)


def _half_widths(x: NDArray, bearing: NDArray, height: NDArray, at: NDArray, half: NDArray, depth: float) -> NDArray:
    """Return the half widths at half depth along and round."""
    found = []
    for place, profile, middle in zip((x, bearing), _profiles(x, bearing, height, at, half), at, strict=True):
        low, high, _ = _crossing(place, profile, middle, 0.5 * depth)
        found.append(0.5 * (high - low))
    return np.array(found)


def _extent(x: NDArray, bearing: NDArray, height: NDArray, at: NDArray, half: NDArray, depth: float) -> tuple:
    """Return first and last place along and round where it stands inward by a tenth of its depth, and how blurred."""
    along, round_ = _profiles(x, bearing, height, at, half)
    return tuple(
        _crossing(place, profile, middle, _EDGE * depth)
        for place, profile, middle in ((x, along, at[0]), (bearing, round_, at[1]))
    )


def _crossing(place: NDArray, profile: NDArray, middle: float, level: float) -> tuple[float, float, float]:
    """Return where a profile rises through a (negative) level on both sides of its middle, and its reach per rise."""
    seen = np.isfinite(profile)
    place, profile = place[seen], profile[seen]
    if len(place) < 2:
        return np.nan, np.nan, np.nan
    centre = int(np.argmin(np.abs(place - middle)))
    ends = []
    for side in (-1, 1):
        k = centre
        while 0 <= k + side < len(place) and profile[k + side] < level:
            k += side
        nearer = k + side
        if not 0 <= nearer < len(place):
            ends.append(float(place[k]))
            continue
        share = (level - profile[k]) / max(profile[nearer] - profile[k], 1e-12)
        ends.append(float(place[k] + np.clip(share, 0.0, 1.0) * (place[nearer] - place[k])))
    # From the depth at which a smooth bump is steepest to its edge it takes about a third of its reach.
    return ends[0], ends[1], 0.5 * (ends[1] - ends[0]) / max(abs(level) * 6.0, 1e-9)
