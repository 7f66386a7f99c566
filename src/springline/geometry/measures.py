"""What an engineer reads off a fitted ellipse: chords, means, area, perimeter and ovalities, each with its gradient.

The ellipse is given by `conventions.SECTION_PARAMETERS`: m, the half sum of the semi-axes, and (u, v), their half
difference d times cos and sin of twice the major axis's bearing. Everything smooth in the ellipse is smooth in
(m, u, v), the circle included; only the largest and the smallest chord have a kink there, because d = hypot(u, v).

With x = d/m every mean is m times a function of x alone: the perimeter by the Gauss-Kummer series, the polar mean by
the arithmetic-geometric mean, both as hypergeometric functions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import hyp2f1

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Measure:
    """A quantity per section and its one-sigma from the covariance of the section's parameters."""

    value: Array
    sigma: Array


def ellipse_measures(parameters: ArrayLike, covariance: ArrayLike) -> dict[str, Measure]:
    """Return every measure of ellipses, with one-sigma by linear propagation.

    Args:
        parameters: (..., 3): mean_radius, oval_cos, oval_sin [m]; NaN where there is no fit.
        covariance: (..., 3, 3): their covariance [m2].

    Returns:
        Measures by name: `semi_major`, `semi_minor`, `axis_bearing`, `diameter_max`, `diameter_max_bearing`,
        `diameter_min`, `diameter_x`, `diameter_y`, the means `diameter_axes`, `diameter_polar`, `diameter_area`,
        `diameter_caliper`, the ovalities `ovality_axes`, `ovality_polar`, `ovality_area`, `ovality_caliper`
        (fractions), `area` [m2], `perimeter` [m] and `conveyance` [m^(8/3)], the full-flow capacity after Manning but
        for slope and roughness: area^(5/3) perimeter^(-2/3). NaN parameters give NaN measures.

    Source: dissertation 3.3.5 (3.16 to 3.21) with errata A2, A8 and A9: the four means, all as diameters.

    >>> circle = ellipse_measures([0.15, 0.0, 0.0], np.diag([1e-8, 1e-8, 1e-8]))
    >>> float(circle["diameter_polar"].value), round(float(circle["diameter_polar"].sigma), 9)
    (0.3, 0.0002)
    """
    p = np.asarray(parameters, float)
    m, u, v = p[..., 0], p[..., 1], p[..., 2]
    d = np.hypot(u, v)
    toward_u, toward_v = _direction(u, v, d, np.asarray(covariance, float))
    axis = 0.5 * np.arctan2(v, u)
    axis = np.where(axis <= -np.pi / 2, axis + np.pi, axis)
    x = d / m
    one, zero = np.ones_like(m), np.zeros_like(m)

    def of_axes(value: Array, by_m: Array, by_d: Array) -> tuple[Array, Array]:
        return value, np.stack([by_m, by_d * toward_u, by_d * toward_v], axis=-1)

    means = {
        "axes": of_axes(2 * m, 2 * one, zero),
        "polar": of_axes(*_scaled(m, x, *_polar_mean(x))),
        "area": of_axes(2 * m * np.sqrt(1 - x * x), 2 / np.sqrt(1 - x * x), -2 * x / np.sqrt(1 - x * x)),
        "caliper": of_axes(*_scaled(m, x, *_caliper_mean(x))),
    }
    largest = of_axes(2 * (m + d), 2 * one, 2 * one)
    found = {
        "semi_major": of_axes(m + d, one, one),
        "semi_minor": of_axes(m - d, one, -one),
        "axis_bearing": (axis, _axis_gradient(u, v, d)),
        "diameter_max": largest,
        "diameter_max_bearing": (axis, _axis_gradient(u, v, d)),
        "diameter_min": of_axes(2 * (m - d), 2 * one, -2 * one),
        "diameter_x": _chord(p, 0.0),
        "diameter_y": _chord(p, np.pi / 2),
        **{f"diameter_{name}": mean for name, mean in means.items()},
        **{f"ovality_{name}": _ratio(largest, mean) for name, mean in means.items()},
        "area": of_axes(np.pi * (m * m - d * d), 2 * np.pi * m, -2 * np.pi * d),
        "perimeter": (np.pi * means["caliper"][0], np.pi * means["caliper"][1]),
    }
    found["conveyance"] = _conveyance(found["area"], found["perimeter"])
    return {name: Measure(value, _propagate(gradient, covariance)) for name, (value, gradient) in found.items()}


def polar_radius(parameters: ArrayLike, bearing: ArrayLike) -> Array:
    """Return the polar radius of ellipses about their centre.

    In (m, u, v) it is (m^2 - d^2) / sqrt(m^2 + d^2 - 2 m w) with w = u cos 2 theta + v sin 2 theta.

    Args:
        parameters: (..., 3): mean_radius, oval_cos, oval_sin [m].
        bearing: (...): bearing [rad], from +z counter-clockwise; broadcast against the parameters.

    >>> float(polar_radius([1.1, 0.1, 0.0], 0.0)), float(polar_radius([1.1, 0.1, 0.0], np.pi / 2))
    (1.2000000000000002, 1.0)
    """
    p = np.asarray(parameters, float)
    m, u, v = p[..., 0], p[..., 1], p[..., 2]
    w = u * np.cos(2 * np.asarray(bearing)) + v * np.sin(2 * np.asarray(bearing))
    square = u * u + v * v
    return (m * m - square) / np.sqrt(m * m + square - 2 * m * w)


def _chord(p: Array, bearing: float) -> tuple[Array, Array]:
    """Return chords through the centre at one bearing, and their gradients with respect to the parameters."""
    m, u, v = p[..., 0], p[..., 1], p[..., 2]
    cos, sin = np.cos(2 * bearing), np.sin(2 * bearing)
    radius = polar_radius(p, bearing)
    root = np.sqrt(m * m + u * u + v * v - 2 * m * (u * cos + v * sin))
    by_square = radius / root**2
    gradient = np.stack(
        [
            2 * m / root - by_square * (m - u * cos - v * sin),
            -2 * u / root - by_square * (u - m * cos),
            -2 * v / root - by_square * (v - m * sin),
        ],
        axis=-1,
    )
    return 2 * radius, 2 * gradient


def _direction(u: Array, v: Array, d: Array, covariance: Array) -> tuple[Array, Array]:
    """Return the unit vector along (u, v); at an exact circle, where it has none, that of the larger variance."""
    with np.errstate(invalid="ignore", divide="ignore"):
        major = 0.5 * np.arctan2(2 * covariance[..., 1, 2], covariance[..., 1, 1] - covariance[..., 2, 2])
        return np.where(d > 0, u / d, np.cos(major)), np.where(d > 0, v / d, np.sin(major))


def _axis_gradient(u: Array, v: Array, d: Array) -> Array:
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.stack([np.zeros_like(u), -v / (2 * d * d), u / (2 * d * d)], axis=-1)


def _polar_mean(x: Array) -> tuple[Array, Array]:
    """Return twice the polar mean radius over m, and its derivative by x: 2 (1 - x^2) F(1/2, 1/2; 1; x^2)."""
    series = hyp2f1(0.5, 0.5, 1.0, x * x)
    slope = 0.5 * x * hyp2f1(1.5, 1.5, 2.0, x * x)
    return 2 * (1 - x * x) * series, 2 * ((1 - x * x) * slope - 2 * x * series)


def _caliper_mean(x: Array) -> tuple[Array, Array]:
    """Return perimeter / (pi m), and its derivative by x: 2 F(-1/2, -1/2; 1; x^2) (Gauss-Kummer)."""
    return 2 * hyp2f1(-0.5, -0.5, 1.0, x * x), x * hyp2f1(0.5, 0.5, 2.0, x * x)


def _scaled(m: Array, x: Array, f: Array, slope: Array) -> tuple[Array, Array, Array]:
    """Return m f(d/m) and its derivatives by m and by d."""
    return m * f, f - x * slope, slope


def _ratio(largest: tuple[Array, Array], mean: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return the ovality (max - mean)/mean and its gradient."""
    value = largest[0] / mean[0] - 1
    return value, (largest[1] - (1 + value)[..., None] * mean[1]) / mean[0][..., None]


def _conveyance(area: tuple[Array, Array], perimeter: tuple[Array, Array]) -> tuple[Array, Array]:
    value = area[0] ** (5 / 3) * perimeter[0] ** (-2 / 3)
    relative = 5 / 3 * area[1] / area[0][..., None] - 2 / 3 * perimeter[1] / perimeter[0][..., None]
    return value, value[..., None] * relative


def _propagate(gradient: Array, covariance: ArrayLike) -> Array:
    variance = np.einsum("...i,...ij,...j->...", gradient, np.asarray(covariance, float), gradient)
    return np.sqrt(np.maximum(variance, 0.0))
