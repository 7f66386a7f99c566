"""Ellipses of constant perimeter: the perimeter three ways, the axis that belongs to the other, polar radii.

Theta is the bearing, from +z counter-clockwise to +y; semi-axes and radii in one unit of length.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.special import ellipe, ellipkm1

from springline.geometry.checks import between, choice, positive

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

Rule = Literal["exact", "ramanujan"]
"""How the perimeter is kept at 2 pi r: by the ellipse's exact perimeter, or by Ramanujan's first approximation, as
published."""

RULES = ("exact", "ramanujan")
LARGEST_MAJOR = {"exact": np.pi / 2, "ramanujan": 1.0 + 1.0 / np.sqrt(3.0)}
"""Semi-major axis over r of the ellipse pressed flat, by rule."""


def perimeter(semi_a: ArrayLike, semi_b: ArrayLike) -> Array:
    """Return the exact perimeter 4 a E(1 - b^2/a^2) of ellipses; the axes may come in either order.

    Source: errata E, first item.

    >>> round(float(perimeter(2.0, 1.0)), 12)
    9.688448220548
    """
    a, b = positive("semi_a", semi_a), positive("semi_b", semi_b)
    large, small = np.maximum(a, b), np.minimum(a, b)
    return 4.0 * large * ellipe(1.0 - (small / large) ** 2)


def perimeter_ramanujan(semi_a: ArrayLike, semi_b: ArrayLike, *, order: Literal[1, 2] = 1) -> Array:
    """Return Ramanujan's first or second approximation of the perimeter of ellipses.

    Source: chapter 3.1, the equation above (3.2), for order 1.

    >>> round(float(perimeter_ramanujan(2.0, 1.0)), 10), round(float(perimeter_ramanujan(2.0, 1.0, order=2)), 10)
    (9.6884210977, 9.6884482161)
    """
    choice("order", order, (1, 2))
    a, b = positive("semi_a", semi_a), positive("semi_b", semi_b)
    if order == 1:
        return np.pi * (3.0 * (a + b) - np.sqrt((a + 3.0 * b) * (3.0 * a + b)))
    h = ((a - b) / (a + b)) ** 2
    return np.pi * (a + b) * (1.0 + 3.0 * h / (10.0 + np.sqrt(4.0 - 3.0 * h)))


def semi_major(s: ArrayLike, r: ArrayLike = 1.0, *, rule: Rule = "exact") -> Array:
    """Return the semi-major axis of the ellipse with semi-minor axis s r and the perimeter of the circle of radius r.

    Args:
        s: Severity, in (0, 1]; 1 is the circle.
        r: Radius of the undeformed pipe.
        rule: How the perimeter is reckoned.

    Raises:
        ParameterError: s outside (0, 1], or r not above zero.

    Source: (3.2) for `ramanujan`; errata A6 and E for `exact`.

    >>> round(float(semi_major(0.8)), 12), round(float(semi_major(0.8, rule="ramanujan")), 12)
    (1.181586833871, 1.181587019651)
    """
    choice("rule", rule, RULES)
    return positive("r", r) * partner_axis(between("s", s, 0.0, 1.0, bounds="(]"), rule)


def severity_of_major(a: ArrayLike, r: ArrayLike = 1.0, *, rule: Rule = "exact") -> Array:
    """Return the severity s of the constant-perimeter ellipse with semi-major axis a: the inverse of `semi_major`.

    The perimeter is symmetric in the axes, so this is the same function of the other axis.

    Raises:
        ParameterError: a / r outside [1, limit): the limit is pi/2 (exact) or 1 + 1/sqrt(3) (Ramanujan).

    >>> round(float(severity_of_major(semi_major(0.7))), 12)
    0.7
    """
    choice("rule", rule, RULES)
    r = positive("r", r)
    a = between("a", a, r, LARGEST_MAJOR[rule] * r, bounds="[)", given={"r": r})
    return np.minimum(partner_axis(a / r, rule), 1.0)


def partner_axis(x: ArrayLike, rule: Rule) -> Array:
    """Return the semi-axis that gives perimeter 2 pi together with the semi-axis x; NaN where there is none."""
    x = np.asarray(x, float)
    if rule == "ramanujan":
        with np.errstate(invalid="ignore"):
            return (3.0 - 2.0 * x + np.sqrt(3.0 + 6.0 * x - 5.0 * x * x)) / 3.0
    from .kernels import other_axes

    return other_axes(np.ravel(x), True).reshape(x.shape)


def polar_ellipse(theta: ArrayLike, semi_z: ArrayLike, semi_y: ArrayLike) -> Array:
    """Return the polar radius of ellipses about their centre; `semi_z` lies along z.

    Source: (3.17).

    >>> [round(float(polar_ellipse(t, 1.2, 1.0)), 6) for t in (0.0, np.pi / 2)]
    [1.2, 1.0]
    """
    theta = np.asarray(theta, float)
    return 1.0 / np.hypot(np.cos(theta) / semi_z, np.sin(theta) / semi_y)


def polar_circle_about(theta: ArrayLike, r: ArrayLike, centre_radius: ArrayLike, centre_bearing: ArrayLike) -> Array:
    """Return the polar radius, about O, of a circle whose centre lies at (centre_radius, centre_bearing) from O.

    The farther crossing is given; NaN where the ray misses the circle. Source: (3.20).

    >>> round(float(polar_circle_about(2.0, 1.0, 0.2, 5 * np.pi / 4)), 12)
    0.912532859893
    """
    return polar_ellipse_about(theta, r, r, centre_radius, centre_bearing, 0.0)


def polar_ellipse_about(
    theta: ArrayLike,
    semi_a: ArrayLike,
    semi_b: ArrayLike,
    centre_radius: ArrayLike,
    centre_bearing: ArrayLike,
    tilt: ArrayLike,
) -> Array:
    """Return the polar radius, about O, of an ellipse with its centre elsewhere.

    Args:
        theta: Bearing [rad].
        semi_a: Semi-axis at the bearing `tilt`.
        semi_b: The other semi-axis.
        centre_radius, centre_bearing: Where the centre lies from O.
        tilt: Counter-clockwise from +z to `semi_a` [rad].

    Returns:
        The farther crossing; NaN where the ray misses the ellipse.

    Source: (3.22), where alpha is counter-clockwise (errata A1).

    >>> round(float(polar_ellipse_about(2.0, 1.2, 0.8, 0.3, 3.9, -0.25)), 12)
    0.676600925604
    """
    a, b = positive("semi_a", semi_a), positive("semi_b", semi_b)
    along, toward = np.asarray(theta, float) - tilt, np.asarray(centre_bearing, float) - tilt
    r0 = np.asarray(centre_radius, float)
    ex, ey = np.cos(along) / a, np.sin(along) / b
    wx, wy = -r0 * np.cos(toward) / a, -r0 * np.sin(toward) / b
    square, half = ex * ex + ey * ey, wx * ex + wy * ey
    with np.errstate(invalid="ignore"):
        # |w|^2 |e|^2 - (w.e)^2 is the squared cross product, which keeps the root exact at grazing rays
        return (np.sqrt(square - (wx * ey - wy * ex) ** 2) - half) / square


def mean_radius(semi_a: ArrayLike, semi_b: ArrayLike) -> Array:
    """Return the mean over bearing of the polar radius of ellipses about their centre: a b / agm(a, b).

    Source: (3.18) and (3.19) with errata A8 and A9.

    >>> round(float(mean_radius(1.2, 1.0)), 12)
    1.093173573878
    """
    a, b = positive("semi_a", semi_a), positive("semi_b", semi_b)
    large, small = np.maximum(a, b), np.minimum(a, b)
    return 2.0 * small / np.pi * ellipkm1((small / large) ** 2)
