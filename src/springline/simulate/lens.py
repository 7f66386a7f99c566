"""Lenses of the simulator: from a direction to a place in the picture and back, by half-angle algebra.

Camera axes are ahead, up, right. Where a direction lands: z (right) and y (up) from the principal point [px]. The five
models of chapter 2.7 are written in the direction's components, not in its zenith, so that they share no formula with
`springline.geometry`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import optics

LIMITS = {
    "equidistant": 180.0,
    "sine": 90.0,
    "equisolid": 180.0,
    "perspective": 90.0,
    "stereographic": 180.0,
    "polynomial": 180.0,
}
"""Zenith [degrees] up to which each model is one-to-one; the polynomial may end before."""

OPEN = ("perspective", "stereographic")
"""Models without a radius at their limit."""

_NEWTON = 60


@dataclass(frozen=True)
class LensModel:
    """A lens with its scale and where it ends.

    Attributes:
        model: One of the five, or polynomial.
        k: Scale [px].
        coefficients: k1 to k4 of the polynomial.
        limit: Largest zenith that is imaged [rad].

    >>> LensModel("sine", 100.0).project(np.array([[1.0, 0.0, 1.0]])).round(3).tolist()
    [[70.711, 0.0]]
    """

    model: str
    k: float
    coefficients: tuple[float, ...] = ()
    limit: float = np.pi

    def project(self, directions: np.ndarray) -> np.ndarray:
        """Return z (right), y (up) [px] (..., 2) of directions (..., 3) of any length; NaN where nothing is imaged."""
        ahead, up, right = np.moveaxis(np.asarray(directions, float), -1, 0)
        across = np.hypot(up, right)
        far = np.hypot(across, ahead)
        with np.errstate(divide="ignore", invalid="ignore"):
            radius = self.k * self._shape(ahead / far, across / far)
            out = np.stack([right, up], axis=-1) * np.where(across > 0.0, radius / across, 0.0)[..., None]
        seen = (np.arctan2(across, ahead) <= self.end) & (far > 0.0)
        if self.model in OPEN:
            seen &= ahead > (0.0 if self.model == "perspective" else -far)
        return np.where(seen[..., None], out, np.nan)

    def directions(self, image: np.ndarray) -> np.ndarray:
        """Return unit directions (..., 3) ahead, up, right of places (..., 2) z, y [px]; NaN where none lands."""
        z, y = np.moveaxis(np.asarray(image, float), -1, 0)
        radius = np.hypot(z, y)
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead, across = self._inverse(radius / self.k)
            share = np.where(radius > 0.0, across / radius, 0.0)
        out = np.stack([ahead, share * y, share * z], axis=-1)
        seen = np.arctan2(across, ahead) <= self.end
        return np.where(seen[..., None], out, np.nan)

    @property
    def end(self) -> float:
        """Largest zenith [rad] that is imaged and at which the model is still one-to-one."""
        own = np.radians(LIMITS[self.model])
        if self.model == "polynomial":
            own = rising_to(self.coefficients)
        return min(own, self.limit)

    def _shape(self, c: np.ndarray, s: np.ndarray) -> np.ndarray:
        """Return radius over k from cosine and sine of the zenith."""
        if self.model == "sine":
            return s
        if self.model == "perspective":
            return s / c
        if self.model == "stereographic":
            return s / (1.0 + c)
        if self.model == "equisolid":
            # sin(t/2) = s / sqrt(2 (1 + c)) where that is exact, sqrt((1 - c)/2) beyond.
            return np.where(c > 0.0, s / np.sqrt(2.0 * (1.0 + np.abs(c))), np.sqrt(0.5 * (1.0 - np.minimum(c, 0.0))))
        zenith = np.arctan2(s, c)
        return zenith if self.model == "equidistant" else _odd(zenith, self.coefficients)[0]

    def _inverse(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return cosine and sine of the zenith at radius q k."""
        if self.model == "sine":
            return np.sqrt(1.0 - q * q), q
        if self.model == "perspective":
            size = np.sqrt(1.0 + q * q)
            return 1.0 / size, q / size
        if self.model == "stereographic":
            return (1.0 - q * q) / (1.0 + q * q), 2.0 * q / (1.0 + q * q)
        if self.model == "equisolid":
            return 1.0 - 2.0 * q * q, 2.0 * q * np.sqrt(1.0 - q * q)
        if self.model == "polynomial":
            q = _undo(q, self.coefficients, rising_to(self.coefficients))
        return np.where(q <= np.pi, np.cos(q), np.nan), np.sin(q)


def lens_of(lens: optics.Lens, width: int) -> LensModel:
    """Return the lens of a scenario on a picture `width` pixels wide."""
    limit = np.pi if lens.view_angle_deg is None else np.radians(0.5 * lens.view_angle_deg)
    if lens.k_px is not None:
        return LensModel(lens.model, lens.k_px, lens.coefficients, limit)
    half = np.radians(0.5 * lens.field_of_view_deg)
    unit = LensModel(lens.model, 1.0, lens.coefficients)._shape(np.cos(half), np.sin(half))
    return LensModel(lens.model, float(0.5 * width / unit), lens.coefficients, limit)


def rising_to(coefficients: tuple[float, ...]) -> float:
    """Return the zenith [rad], at most pi, up to which the polynomial's radius rises.

    >>> round(rising_to((-1.0 / 3.0,)), 9)
    1.0
    """
    grid = np.linspace(0.0, np.pi, 4001)
    falls = np.flatnonzero(_odd(grid, coefficients)[1] <= 0.0)
    if not falls.size:
        return np.pi
    low, high = grid[falls[0] - 1], grid[falls[0]]
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _odd(np.array(middle), coefficients)[1] > 0.0 else (low, middle)
    return float(low)


def _odd(t: np.ndarray, coefficients: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return t + k1 t^3 + k2 t^5 + ... and its slope."""
    powers = 2 * np.arange(len(coefficients)) + 3
    value = t + sum((k * t**n for k, n in zip(coefficients, powers, strict=True)), np.zeros_like(t))
    slope = 1.0 + sum((n * k * t ** (n - 1) for k, n in zip(coefficients, powers, strict=True)), np.zeros_like(t))
    return value, slope


def _undo(q: np.ndarray, coefficients: tuple[float, ...], limit: float) -> np.ndarray:
    """Return the zenith of polynomial radius q, by Newton from a table's chord, held inside the rising range."""
    table = np.linspace(0.0, limit, 1025)
    heights = _odd(table, coefficients)[0]
    t = np.interp(q, heights, table)
    for _ in range(_NEWTON):
        value, slope = _odd(t, coefficients)
        change = np.clip((value - q) / np.where(slope > 1e-9, slope, 1e-9), -0.01, 0.01)
        t = np.clip(t - change, 0.0, limit)
        if np.all(np.abs(change) <= 4e-16 * (1.0 + t) + np.where(q > heights[-1], np.inf, 0.0)):
            break
    return np.where(q <= heights[-1] * (1.0 + 1e-15), t, np.nan)
