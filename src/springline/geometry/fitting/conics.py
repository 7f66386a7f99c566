"""From the coefficients of a circle or a conic to its centre and axes, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class CircleShape(NamedTuple):
    """A circle: centre and radius, in the unit of the readings."""

    centre_z: NDArray[np.float64]
    centre_y: NDArray[np.float64]
    radius: NDArray[np.float64]


class EllipseShape(NamedTuple):
    """An ellipse: centre, semi-axes, and the bearing of the major axis [rad] in (-pi/2, pi/2]."""

    centre_z: NDArray[np.float64]
    centre_y: NDArray[np.float64]
    semi_major: NDArray[np.float64]
    semi_minor: NDArray[np.float64]
    axis_bearing: NDArray[np.float64]


def circle_from_coefficients(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> CircleShape:
    """Return the circle a (z^2 + y^2) + b z + c y + d = 0; the coefficients broadcast.

    NaN where the coefficients are no circle: a = 0, or a radius that is not real.

    Source: equations 2.7 to 2.9, with erratum A10 (the radius is r = sqrt((b^2 + c^2)/(4 a^2) - d/a)).

    >>> print(*circle_from_coefficients(1, 4, -6, -12))
    -2.0 3.0 5.0
    """
    a, b, c, d = np.broadcast_arrays(*(np.asarray(x, np.float64) for x in (a, b, c, d)))
    with np.errstate(divide="ignore", invalid="ignore"):
        centre_z, centre_y = -b / (2.0 * a), -c / (2.0 * a)
        radius = np.sqrt(centre_z**2 + centre_y**2 - d / a)
    real = radius > 0.0
    return CircleShape(*(np.where(real, x, np.nan) for x in (centre_z, centre_y, radius)))


def conic_to_ellipse(
    a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike, e: ArrayLike, f: ArrayLike
) -> EllipseShape:
    """Return the ellipse a z^2 + b z y + c y^2 + d z + e y + f = 0; the coefficients broadcast, either sign will do.

    NaN where the conic is no real ellipse. The bearing of a circle is 0.

    Source: section 2.9.1; the conversion printed in 5.2.3 mixes two conventions and is not used.

    >>> ellipse = conic_to_ellipse(1, 0, 4, -2, -8, 1)
    >>> print(*(round(float(x), 9) for x in ellipse))
    1.0 1.0 2.0 1.0 0.0
    """
    a, b, c, d, e, f = np.broadcast_arrays(*(np.asarray(x, np.float64) for x in (a, b, c, d, e, f)))
    sign = np.where(a + c < 0.0, -1.0, 1.0)
    a, b, c, d, e, f = (sign * x for x in (a, b, c, d, e, f))
    with np.errstate(divide="ignore", invalid="ignore"):
        determinant = 4.0 * a * c - b * b
        centre_z = (b * e - 2.0 * c * d) / determinant
        centre_y = (b * d - 2.0 * a * e) / determinant
        level = -(f + 0.5 * (d * centre_z + e * centre_y))
        # the small eigenvalue as determinant over the large one, which does not cancel
        large = 0.5 * (a + c + np.hypot(a - c, b))
        semi_minor = np.sqrt(level / large)
        semi_major = np.sqrt(4.0 * level * large / determinant)
        bearing = 0.5 * np.arctan2(-b, c - a)
        # a vertical axis is +pi/2, whatever the sign of a b that is zero or rounds to it
        bearing = np.where(bearing <= -0.5 * np.pi, 0.5 * np.pi, bearing + 0.0)
    real = (determinant > 0.0) & (level > 0.0)
    shape = (centre_z, centre_y, semi_major, semi_minor, bearing)
    return EllipseShape(*(np.where(real, x, np.nan) for x in shape))


def ellipse_to_conic(parameters: ArrayLike) -> NDArray[np.float64]:
    """Return the coefficients (..., 6) of a z^2 + b z y + c y^2 + d z + e y + f = 0, scaled to 4 a c - b^2 = 1.

    Args:
        parameters: (..., 5) centre_z, centre_y, mean_radius, oval_cos, oval_sin, as ellipse fits return them [m].

    >>> ellipse_to_conic([1.0, 1.0, 1.5, 0.5, 0.0]).round(9).tolist()
    [0.25, -0.0, 1.0, -0.5, -2.0, 0.25]
    """
    zc, yc, mean, u, v = np.moveaxis(np.asarray(parameters, np.float64), -1, 0)
    square, product = mean * mean + u * u + v * v, mean * mean - u * u - v * v
    # the quadratic form of the ellipse times (a b)^2, then scaled by 1/(2 a b)
    a, c = (square - 2.0 * mean * u) / (2.0 * product), (square + 2.0 * mean * u) / (2.0 * product)
    b = -2.0 * mean * v / product
    d, e = -2.0 * a * zc - b * yc, -b * zc - 2.0 * c * yc
    f = a * zc * zc + b * zc * yc + c * yc * yc - 0.5 * product
    return np.stack([a, b, c, d, e, f], axis=-1)
