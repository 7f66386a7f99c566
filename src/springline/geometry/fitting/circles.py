"""Circles through the readings of a ring, one ring or very many at once.

Frame and sign: a section is drawn as seen looking forward, z to the right and y up; centres come in the frame of the
readings. Lengths are metres, or any one unit throughout. NaN is no return.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Unpack

from springline.geometry.fitting import _batch
from springline.geometry.fitting.options import CIRCLE_METHODS, FitOptions, resolve
from springline.geometry.fitting.results import CircleFit, CircleFits

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def fit_circles(z: ArrayLike, y: ArrayLike, **options: Unpack[FitOptions]) -> CircleFits:
    """Return the circle of each ring of points.

    Args:
        z: To the right, (ring, point) [m], float32 or float64; NaN = no return.
        y: Up, same shape [m].
        **options: See `FitOptions`. `method` is "geometric" (least squared orthogonal distances), or an algebraic
            fit: "kasa" (2.12), "svd" (2.10, unit norm: depends on origin and unit, erratum A17), "pratt", "taubin".

    Raises:
        ParameterError: A shape, an option or a name does not fit.

    Source: section 2.9.1, errata A10 and A17; Pratt and Taubin after Chernov, Circular and Linear Regression (2010).

    >>> import numpy as np
    >>> bearings = np.radians(np.arange(0, 360, 10))
    >>> fits = fit_circles([0.02 + 0.15 * np.cos(bearings)], [0.15 * np.sin(bearings)])
    >>> print(1000 * fits.radius.round(6), 1000 * fits.centre_z.round(6))
    [150.] [20.]
    """
    return CircleFits(**_batch.fit(3, _batch.points_source(z, y), resolve(options, CIRCLE_METHODS)))


def fit_circles_to_ranges(ranges: ArrayLike, bearings: ArrayLike, **options: Unpack[FitOptions]) -> CircleFits:
    """Return the circle of each ring of ranges, without holding all coordinates in memory.

    Args:
        ranges: From the origin to the wall, (ring, bearing) [m], float32 or float64; NaN = no return.
        bearings: From +z counter-clockwise to +y, (bearing,) or (ring, bearing) [rad].
        **options: As for `fit_circles`.

    Raises:
        ParameterError: A shape, an option or a name does not fit.

    >>> import numpy as np
    >>> bearings = np.radians(np.arange(0, 360, 10))
    >>> fit_circles_to_ranges(np.full((2, 36), 0.15, np.float32), bearings).radius.round(6)
    array([0.15, 0.15])
    """
    return CircleFits(**_batch.fit(3, _batch.ranges_source(ranges, bearings), resolve(options, CIRCLE_METHODS)))


def fit_circle(points: ArrayLike, **options: Unpack[FitOptions]) -> CircleFit:
    """Return the circle of one set of points; falsy, with its `.reason`, when there is none.

    Args:
        points: (point, 2), z and y of each [m].
        **options: As for `fit_circles`, but `noise` is "orthogonal" unless given.

    Raises:
        ParameterError: A shape, an option or a name does not fit.

    >>> round(fit_circle([(1, 0), (0, 1), (-1, 0)]).radius, 9)
    1.0
    >>> fit_circle([(1, 0), (0, 1)]).reason
    'too few readings'
    """
    options = resolve(options, CIRCLE_METHODS, noise="orthogonal")
    return CircleFits(**_batch.fit(3, _batch.one_source(points), options))[0]
