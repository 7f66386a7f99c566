"""Ellipses through the readings of a ring, one ring or very many at once.

Frame and sign: a section is drawn as seen looking forward, z to the right and y up; centres come in the frame of the
readings. Lengths are metres, or any one unit throughout. NaN is no return.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Unpack

from springline.geometry.fitting import _batch
from springline.geometry.fitting.options import ELLIPSE_METHODS, FitOptions, resolve
from springline.geometry.fitting.results import EllipseFit, EllipseFits

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def fit_ellipses(z: ArrayLike, y: ArrayLike, **options: Unpack[FitOptions]) -> EllipseFits:
    """Return the ellipse of each ring of points.

    Args:
        z: To the right, (ring, point) [m], float32 or float64; NaN = no return.
        y: Up, same shape [m].
        **options: See `FitOptions`. `method` is "geometric" (least squared orthogonal distances), or an algebraic
            fit: "bookstein" (a^2 + b^2/2 + c^2 = 1), "fitzgibbon" (4 a c - b^2 = 1, the only one that cannot end in a
            hyperbola) or "gander" (a + c = 1).

    Raises:
        ParameterError: A shape, an option or a name does not fit.

    Source: section 2.9.1; Fitzgibbon's fit in the stable form of Halir and Flusser (1998).

    >>> import numpy as np
    >>> bearings = np.radians(np.arange(0, 360, 10))
    >>> fits = fit_ellipses([0.02 + 0.16 * np.cos(bearings)], [0.14 * np.sin(bearings)])
    >>> print(1000 * fits.semi_major.round(6), 1000 * fits.semi_minor.round(6))
    [160.] [140.]
    """
    return EllipseFits(**_batch.fit(5, _batch.points_source(z, y), resolve(options, ELLIPSE_METHODS)))


def fit_ellipses_to_ranges(ranges: ArrayLike, bearings: ArrayLike, **options: Unpack[FitOptions]) -> EllipseFits:
    """Return the ellipse of each ring of ranges, without holding all coordinates in memory.

    Args:
        ranges: From the origin to the wall, (ring, bearing) [m], float32 or float64; NaN = no return.
        bearings: From +z counter-clockwise to +y, (bearing,) or (ring, bearing) [rad].
        **options: As for `fit_ellipses`.

    Raises:
        ParameterError: A shape, an option or a name does not fit.

    >>> import numpy as np
    >>> bearings = np.radians(np.arange(0, 360, 10))
    >>> fit_ellipses_to_ranges(np.full((2, 36), 0.15, np.float32), bearings).mean_radius.round(6)
    array([0.15, 0.15])
    """
    return EllipseFits(**_batch.fit(5, _batch.ranges_source(ranges, bearings), resolve(options, ELLIPSE_METHODS)))


def fit_ellipse(points: ArrayLike, **options: Unpack[FitOptions]) -> EllipseFit:
    """Return the ellipse of one set of points; falsy, with its `.reason`, when there is none.

    Args:
        points: (point, 2), z and y of each [m].
        **options: As for `fit_ellipses`, but `noise` is "orthogonal" unless given.

    Raises:
        ParameterError: A shape, an option or a name does not fit.

    >>> fit = fit_ellipse([(2, 0), (0, 1), (-2, 0), (0, -1), (1.2, 0.8), (-1.2, 0.8)])
    >>> round(fit.semi_major, 9), round(fit.semi_minor, 9), round(fit.axis_bearing, 9)
    (2.0, 1.0, 0.0)
    >>> fit_ellipse([(1, 0), (0, 1)]).reason
    'too few readings'
    """
    options = resolve(options, ELLIPSE_METHODS, noise="orthogonal")
    return EllipseFits(**_batch.fit(5, _batch.one_source(points), options))[0]
