"""Ovality and what noise makes of it: definitions that are numbers, not shapes.

A section's own ovalities, by any of the four means, are `section.diameters.ovality(...)`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import ellipe, ellipeinc, log_ndtr

from springline.geometry.checks import between, positive

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


def ovality(maximum: ArrayLike, mean: ArrayLike) -> Array:
    """Return the ovality (maximum - mean)/mean as a fraction; both diameters, or both radii.

    Source: (1.3), without the factor 100.

    >>> round(float(ovality(12.6, 12.0)), 12)
    0.05
    """
    mean = positive("mean", mean)
    return np.asarray(maximum, float) / mean - 1.0


def mean_radius_of_circular_hinges(s: ArrayLike) -> Array:
    """Return the mean polar radius of mode 2 over r, in closed form.

    Args:
        s: Severity, in (0, 1].

    Returns:
        (4/pi) [E(m) - E(pi/4 | m)] with m = 1 - s sqrt(2 - s^2).

    Source: (3.21) with errata C: its first term integrates to zero.

    >>> round(float(mean_radius_of_circular_hinges(0.9)), 12)
    0.992517883177
    """
    s = between("s", s, 0.0, 1.0, bounds="(]")
    m = 1.0 - s * np.sqrt(2.0 - s * s)
    return 4.0 / np.pi * (ellipe(m) - ellipeinc(np.pi / 4, m))


def expected_maximum(count: ArrayLike) -> Array:
    """Return the expected largest of `count` standard normal numbers.

    A perfect circle read raw, with relative noise sigma/r on each of its readings, shows an ovality of sigma/r times
    this: fit first, then read chords off the fit.

    Args:
        count: How many, from 1.

    Source: errata A15.

    >>> round(float(expected_maximum(120)), 3)
    2.572
    """
    count = between("count", count, 1.0, np.inf, bounds="[)")
    # E = int x d(Phi^n) by the trapezoidal rule, which is spectral for an integrand that dies off like this one
    x, step = np.linspace(-10.0, 40.0, 4001, retstep=True)
    log_density = -0.5 * x * x - 0.5 * np.log(2.0 * np.pi)
    n = count[..., None]
    return step * np.sum(x * n * np.exp(log_density + (n - 1.0) * log_ndtr(x)), axis=-1)


def reduction_factor(ovality: ArrayLike) -> Array:
    """Return the ovality reduction factor C = ((1 - q)/(1 + q)^2)^3 of an ovality q as a fraction.

    The bare formula, for tables that go beyond any pipe; `springline.design.f1216.ovality_factor` keeps its range.

    Source: (1.2).

    >>> round(float(reduction_factor(0.1)), 12)
    0.411501495009
    """
    q = np.asarray(ovality, float)
    return ((1.0 - q) / (1.0 + q) ** 2) ** 3
