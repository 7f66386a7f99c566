"""A patch of changed wall by least squares: its place, its size and its depth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import least_squares

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .difference import Difference

_REACH = 2.5  # of the length, to each side of the middle
_SMALLER, _LARGER = 0.4, 2.5
_MARGIN = 0.02  # of the logarithm of a size: nearer to the bounds the fit has run off
_LEAST_SCORE = 4.0
_MOST_ROWS = 240
_FEWEST = 40
_LEAST_SEEN = 0.3
_WORST_CONDITION = 1e8


def dent_fit(
    found: Difference, chainage: float, bearing: float, length: float, width: float, depth: float
) -> tuple[float, float, float, float, float, float] | None:
    """Return the cos^2 dent that fits a difference map best near a first guess.

    Both map and dent are taken without the orders 0 to 2 of each ring, so that a section which a dent has moved or bent
    does not make the dent look shallower.

    Args:
        found: The difference map.
        chainage, bearing, length, width, depth: The guess [m, rad]; length and width at half depth.

    Returns:
        Chainage, bearing, length, width, depth, and the depth's one-sigma; None where the fit does not settle.
    """
    window = _Window.about(found, chainage, length)
    if window is None:
        return None
    wall = window.without(window.change)

    def dent(q: NDArray) -> NDArray:
        return window.dent(q[0], q[1], length * np.exp(q[2]), width * np.exp(q[3]))

    def off(q: NDArray) -> NDArray:
        return (wall - q[4] * window.without(dent(q))).ravel()

    low, high, half = np.log(_SMALLER), np.log(_LARGER), np.pi / 3
    bounds = (
        (chainage - length, bearing - half, low, low, -np.inf),
        (chainage + length, bearing + half, high, high, np.inf),
    )
    guess, scale = (chainage, bearing, 0.0, 0.0, depth), (length, width, 0.5, 0.5, abs(depth))
    solved = least_squares(off, guess, bounds=bounds, x_scale=scale, max_nfev=40)
    q, normal = solved.x, solved.jac.T @ solved.jac
    unit = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    settled = solved.success and np.linalg.cond(normal / np.outer(unit, unit)) < _WORST_CONDITION
    inside = low + _MARGIN < min(q[2], q[3]) and max(q[2], q[3]) < high - _MARGIN
    if not settled or q[4] * depth <= 0 or not inside:
        return None
    spread = float(np.sqrt(np.linalg.inv(normal)[4, 4]))
    if abs(q[4]) < _LEAST_SCORE * spread:
        return None
    size = float(length * np.exp(q[2])), float(width * np.exp(q[3]))
    return float(q[0]), float(q[1] % (2 * np.pi)), *size, float(q[4]), spread


def depth_at(found: Difference, chainage: float, bearing: float, length: float, width: float) -> tuple[float, float]:
    """Return the depth of a dent of known place and size [m], and its one-sigma; NaN where too little of it is seen.

    Args:
        found: A difference map.
        chainage, bearing, length, width: Of the dent [m, rad]; length and width at half depth.
    """
    window = _Window.about(found, chainage, length)
    if window is None:
        return np.nan, np.nan
    shape = window.dent(chainage, bearing, length, width)
    seen = float(np.where(window.weight > 0, shape**2, 0.0).sum())
    if not seen > _LEAST_SEEN * float((shape**2).sum()) > 0.0:
        return np.nan, np.nan
    wall, one = window.without(window.change), window.without(shape)
    total = float((one**2).sum())
    return float((wall * one).sum() / total), float(total**-0.5)


@dataclass(frozen=True)
class _Window:
    """A piece of a difference map: its rows, with what is not known at weight 0."""

    x: NDArray
    bearing: NDArray
    change: NDArray
    weight: NDArray
    without: _Without

    @classmethod
    def about(cls, found: Difference, chainage: float, length: float) -> _Window | None:
        """Return the rows about a dent; None where too few cells are known."""
        near = np.abs(found.chainage - chainage) <= _REACH * length
        rows = np.flatnonzero(near)[:: int(near.sum()) // _MOST_ROWS + 1]
        change, sigma = found.change[rows].astype(float), found.sigma[rows].astype(float)
        weight = np.where(np.isfinite(change) & np.isfinite(sigma), 1.0 / sigma, 0.0)
        if (weight > 0).sum() < _FEWEST:
            return None
        without = _Without(found.bearing, weight)
        return cls(found.chainage[rows][:, None], found.bearing[None, :], np.nan_to_num(change), weight, without)

    def dent(self, chainage: float, bearing: float, length: float, width: float) -> NDArray:
        """Return a cos^2 dent of unit depth."""
        turn = np.mod(self.bearing - bearing + np.pi, 2 * np.pi) - np.pi
        u, v = np.abs(self.x - chainage) / length, np.abs(turn) / width
        shape = (np.cos(0.5 * np.pi * u) * np.cos(0.5 * np.pi * v)) ** 2
        return np.where((u < 1.0) & (v < 1.0), shape, 0.0)


class _Without:
    """Maps in sigmas, less the orders 0 to 2 of each of their rings."""

    def __init__(self, bearing: NDArray, weight: NDArray) -> None:
        waves = [np.ones_like(bearing), *(f(k * bearing) for k in (1, 2) for f in (np.cos, np.sin))]
        self._weight = weight
        self._waves = weight[:, :, None] * np.column_stack(waves)[None, :, :]
        left = np.einsum("rbi,rbj->rij", self._waves, self._waves)
        left += (1e-9 * np.trace(left, axis1=1, axis2=2)[:, None, None] + 1e-12) * np.eye(5)
        self._solve = np.linalg.solve(left, np.swapaxes(self._waves, 1, 2))

    def __call__(self, values: NDArray) -> NDArray:
        weighted = values * self._weight
        found = np.einsum("rib,rb->ri", self._solve, weighted)
        return weighted - np.einsum("rbi,ri->rb", self._waves, found)
