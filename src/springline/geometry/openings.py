"""Laterals and joints as curves on the pipe's wall, and how large and where a camera sees them (6.2, 6.4, 6.5).

Pipe frame of `springline.conventions`: an elliptical pipe z^2/r1^2 + y^2/r2^2 = 1 about the x axis; a circular one has
r1 = r2. Lengths in metres, angles in radians.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.conventions import CROWN
from springline.geometry.checks import finite, positive, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens

    Array = NDArray[np.float64]


def lateral_contour(
    turn: ArrayLike,
    r1: ArrayLike,
    r2: ArrayLike,
    lateral_radius: ArrayLike,
    *,
    bearing: ArrayLike = CROWN,
    inclination: ArrayLike = 0.0,
    x: ArrayLike = 0.0,
) -> Array:
    """Return the edge along which a round lateral's bore cuts the pipe's wall.

    The bore's axis leaves the pipe's axis at `x`; the edge is found along the lines of the bore, so it is exact for
    any bearing, inclination and size.

    Args:
        turn: (n,) angle about the bore's axis [rad], from the side that faces +x; at the crown towards +z.
        r1: Semi-axis of the pipe along z [m].
        r2: Semi-axis of the pipe along y [m].
        lateral_radius: Radius of the bore [m].
        bearing: Where the bore leaves, from +z counter-clockwise [rad]; the crown when not given.
        inclination: Of the bore's axis, from across the pipe towards +x [rad], inside +-pi/2.
        x: Where the bore's axis meets the pipe's axis [m].

    Returns:
        Array (..., n, 3) of x, y, z [m], the leading axes being those of the other arguments broadcast; NaN where a
        bore wider than the pipe misses it.

    Raises:
        ParameterError: A radius is not above zero, or the inclination is not inside +-pi/2.

    Source: 6.2 for the crown of a circular pipe, carried to any bearing, inclination and ellipse.

    >>> lateral_contour(np.radians([0.0, 90.0]), 10.0, 10.0, 5.0).round(3) + 0.0
    array([[ 5.  , 10.  ,  0.  ],
           [ 0.  ,  8.66,  5.  ]])
    """
    turn = np.atleast_1d(finite("turn", turn))
    inclination = finite("inclination", inclination)
    require(
        ~(np.abs(inclination) >= np.pi / 2),
        "inclination",
        inclination,
        "-pi/2 < inclination < pi/2 rad",
        "measure from across the pipe, in radians",
    )
    r1, r2 = positive("r1", r1)[..., None], positive("r2", r2)[..., None]
    bore = positive("lateral_radius", lateral_radius)[..., None]
    tilt, x = inclination[..., None], finite("x", x)[..., None]
    sin, cos = np.sin(finite("bearing", bearing))[..., None], np.cos(finite("bearing", bearing))[..., None]
    ahead, aside = bore * np.cos(turn), bore * np.sin(turn)
    # a point of the wall: aside across the bore, and `rise` along the bearing within the section
    across_y, across_z = -aside * cos, aside * sin
    a = (sin / r2) ** 2 + (cos / r1) ** 2
    b = across_y * sin / r2**2 + across_z * cos / r1**2
    c = (across_y / r2) ** 2 + (across_z / r1) ** 2 - 1.0
    under = b * b - a * c
    # a bore as wide as the pipe touches it: rounding alone must not open the edge
    under = np.where((under < 0) & (under > -1e-14 * a), 0.0, under)
    with np.errstate(invalid="ignore"):
        rise = (np.sqrt(under) - b) / a
    # along the bore's axis the rise is foreshortened by the tilt of its cross-section
    forward = x + rise * np.tan(tilt) + ahead / np.cos(tilt)
    return np.stack(np.broadcast_arrays(forward, across_y + rise * sin, across_z + rise * cos), axis=-1)


def joint_contour(turn: ArrayLike, r1: ArrayLike, r2: ArrayLike, *, x: ArrayLike = 0.0) -> Array:
    """Return the ring along which two pipes meet.

    Args:
        turn: (n,) eccentric angle [rad], from +z towards +y.
        r1: Semi-axis of the pipe along z [m].
        r2: Semi-axis of the pipe along y [m].
        x: Where the joint lies [m].

    Returns:
        Array (..., n, 3) of x, y, z [m], the leading axes being those of the other arguments broadcast.

    Raises:
        ParameterError: A radius is not above zero.

    Source: 6.2.

    >>> joint_contour([0.0, np.pi / 2], 11.0, 9.0).round(12) + 0.0
    array([[ 0.,  0., 11.],
           [ 0.,  9.,  0.]])
    """
    turn = np.atleast_1d(finite("turn", turn))
    y = positive("r2", r2)[..., None] * np.sin(turn)
    z = positive("r1", r1)[..., None] * np.cos(turn)
    return np.stack(np.broadcast_arrays(finite("x", x)[..., None], y, z), axis=-1)


def zenith_far(zenith_near: ArrayLike, radius: ArrayLike, lateral_radius: ArrayLike) -> Array:
    """Return the zenith of a lateral's far edge, seen from the pipe's axis.

    Args:
        zenith_near: Zenith of its near edge [rad], in [0, pi).
        radius: Radius of the pipe [m].
        lateral_radius: Radius of the lateral [m], zero allowed.

    Returns:
        Zenith of the far edge [rad], at most `zenith_near`.

    Raises:
        ParameterError: An argument is out of range.

    Source: (6.1), in a form that holds beyond 90 degrees too.

    >>> round(float(np.degrees(zenith_far(np.radians(60), 10.0, 0.5))), 5)
    55.88824
    """
    near = finite("zenith_near", zenith_near)
    require(
        np.isnan(near) | ((near >= 0) & (near < np.pi)),
        "zenith_near",
        near,
        "0 <= zenith_near < pi rad",
        "measure from the optical axis, in radians",
    )
    bore = finite("lateral_radius", lateral_radius)
    require(~(bore < 0), "lateral_radius", bore, "lateral_radius >= 0", "give a length in metres")
    r = positive("radius", radius)
    return np.arctan2(r * np.sin(near), r * np.cos(near) + 2.0 * bore * np.sin(near))


def lateral_size(zenith_near: ArrayLike, radius: ArrayLike, lateral_radius: ArrayLike, lens: Lens) -> Array:
    """Return how long a lateral is in the image, along the pipe, seen from the pipe's axis.

    Args:
        zenith_near: Zenith of its near edge [rad].
        radius: Radius of the pipe [m].
        lateral_radius: Radius of the lateral [m].
        lens: The lens.

    Returns:
        Distance between the images of near and far edge [px]; NaN where the lens does not see the near one.

    Raises:
        ParameterError: An argument is out of range.

    Source: 6.4.1, 2 r_i of (6.1) (erratum 41).

    >>> from springline.geometry.lenses import Lens
    >>> round(float(lateral_size(np.radians(30), 10.0, 0.5, Lens("equidistant", 384.0))), 6)
    9.1998
    """
    return lens.radius(zenith_near) - lens.radius(zenith_far(zenith_near, radius, lateral_radius))


def distance_bias(length: ArrayLike, radius: ArrayLike, *, half_front: ArrayLike, half_rear: ArrayLike) -> Array:
    """Return how far apart two cameras on one robot first see the same place on the wall.

    Args:
        length: Distance between the cameras along the robot [m].
        radius: Radius of the pipe [m].
        half_front: Half the viewing angle of the front camera [rad], inside 0 to pi.
        half_rear: Half the viewing angle of the rear camera [rad], inside 0 to pi.

    Returns:
        Bias [m].

    Raises:
        ParameterError: A length or an angle is out of range.

    Source: (6.2) with the cotangent, since the wall enters view radius / tan(half) ahead (erratum 34).

    >>> half = np.radians(60)
    >>> round(float(distance_bias(20.0, 10.0, half_front=half, half_rear=half)), 4)
    31.547
    """
    r = positive("radius", radius)
    return finite("length", length) + r * (_cotangent("half_front", half_front) + _cotangent("half_rear", half_rear))


def _cotangent(name: str, half: ArrayLike) -> Array:
    half = finite(name, half)
    require(
        np.isnan(half) | ((half > 0) & (half < np.pi)),
        name,
        half,
        f"0 < {name} < pi rad",
        "give half the viewing angle, in radians",
    )
    return np.cos(half) / np.sin(half)
