"""Ovality as the dissertation's listing reckons it, a wrong sign included; only for reproducing its tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from springline.design.f1216 import ovality_factor
from springline.geometry.sections import hinge
from springline.geometry.sections.ellipses import polar_ellipse_about
from springline.geometry.sections.severity import canonical, s2_of_s1

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)


class PrintedOvality(NamedTuple):
    """Ovality as a fraction and reduction factor C, by the mean of the axes and by the integral as printed."""

    ovality_axes: Array
    factor_axes: Array
    ovality_polar: Array
    factor_polar: Array

    @property
    def ovality_difference(self) -> Array:
        """Difference of the ovalities over that by the axes; 0 for a circle, where both vanish."""
        return _relative(self.ovality_axes, self.ovality_polar)

    @property
    def factor_difference(self) -> Array:
        """Difference of the reduction factors over that by the axes."""
        return _relative(self.factor_axes, self.factor_polar)


def ovality_as_printed(mode: ArrayLike, s1: ArrayLike, s02: ArrayLike = 1.0, s01: ArrayLike = 1.0) -> PrintedOvality:
    """Return the ovality of a hinged section as Appendix A computes it.

    The listing turns the frozen ellipse of the top-left arc counter-clockwise by alpha where the arc has turned
    clockwise, so that in modes 4 and 5 its integral belongs to no section. Circular arcs (modes 2 and 3) have no
    axes to turn, and come out right.

    Args:
        mode: 1 to 5.
        s1: Severity of the bottom half.
        s02: Severity at which the top arcs froze; read in modes 4 and 5.
        s01: Severity at which the bottom arcs froze; read in mode 5.

    Returns:
        PrintedOvality of the broadcast shape, with the perimeter kept by Ramanujan's first formula as published.

    Raises:
        ParameterError: A severity out of range for the given others.

    Source: (3.16), (3.21), (3.22), (3.28) and Appendix A; erratum A1. `springline.geometry.sections.hinged` is right.

    >>> wrong = ovality_as_printed(4, 0.9 - 1e-6, 0.95)
    >>> round(100 * float(wrong.ovality_axes), 2), round(100 * float(wrong.ovality_polar), 2)
    (9.89, 10.89)
    """
    s2 = s2_of_s1(mode, s1, s02, s01, rule="ramanujan")
    s1, s02, s01 = canonical(mode, s1, s02, s01, rule="ramanujan")
    halves = [hinge(frozen, s, rule="ramanujan") for frozen, s in ((s02, s2), (s01, s1))]
    largest, axes = 2.0 * halves[0].springline, halves[0].springline + 0.5 * (s1 + s2)
    theta = np.pi / 4 * (_NODES + 3.0)
    polar = np.zeros(np.shape(largest))
    for half in halves:
        a, b, z, y, alpha = (
            np.asarray(x)[..., None] for x in (half.a, half.b, half.centre_z, half.centre_y, half.alpha)
        )
        # the printed slip: the arc's own tilt, counter-clockwise, is -alpha
        radius = polar_ellipse_about(theta, a, b, np.hypot(z, y), np.arctan2(y, z), alpha)
        polar = polar + 0.5 * radius @ _WEIGHTS
    ovality = (largest / axes - 1.0, largest / polar - 1.0)
    # a circle's ovality may come out a rounding below zero
    factor = [ovality_factor(np.maximum(q, 0.0)) for q in ovality]
    return PrintedOvality(ovality[0], factor[0], ovality[1], factor[1])


def _relative(first: Array, second: Array) -> Array:
    first, second = np.asarray(first), np.asarray(second)
    same = np.abs(first - second) <= 1e-12
    return np.where(same, 0.0, (first - second) / np.where(same, 1.0, first))
