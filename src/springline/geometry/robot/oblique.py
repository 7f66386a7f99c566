"""The ellipse that a tilted ring cuts from an elliptical pipe, and the ring's radii about any origin.

In the ring plane a point rho (cos phi z3 + sin phi y3) of a centred ring obeys
(1/rho^2) = m_zz cos^2 + 2 m_zy sin cos + m_yy sin^2: the ring form M = P' diag(1/r1^2, 1/r2^2) P, where P holds the
pipe's z and y components of the robot's z and y axes. Its eigenvectors are the axes of the measured ellipse, so no
branch or root has to be chosen (errata 2, 13, 16). beta and phi run in the ring plane from robot z towards robot y.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import finite, positive, require
from springline.geometry.robot.attitude import frame

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

CIRCLE = 1e-12
"""Relative difference of the form's eigenvalues below which an ellipse is a circle and has no major axis."""


class ObliqueEllipse(NamedTuple):
    """Semi-axes [m] and bearing of the major axis [rad] in (-pi/2, pi/2]; NaN bearing for a circle."""

    major: np.ndarray
    minor: np.ndarray
    beta: np.ndarray


class Ellipse(NamedTuple):
    """Centre, semi-axes [m] and bearing of the major axis [rad] in (-pi/2, pi/2]; NaN bearing for a circle."""

    zc: np.ndarray
    yc: np.ndarray
    major: np.ndarray
    minor: np.ndarray
    beta: np.ndarray


def design_matrix(frames: Array) -> Array:
    """Return the matrix that takes (1/r1^2, 1/r2^2) to the ring form (m_zz, m_zy, m_yy).

    Args:
        frames: Robot frames (..., 3, 3), rows x, y, z in pipe coordinates.

    Returns:
        Array (..., 3, 2).

    Source: all three entries of the ring form; (5.28) has two of them (erratum 4).

    >>> design_matrix(np.eye(3))
    array([[1., 0.],
           [0., 0.],
           [0., 1.]])
    """
    y3, z3 = frames[..., 1, 1:], frames[..., 2, 1:]
    return np.stack([(z3 * z3)[..., ::-1], (z3 * y3)[..., ::-1], (y3 * y3)[..., ::-1]], axis=-2)


def oblique_ellipse(
    r1: ArrayLike, r2: ArrayLike, pitch: ArrayLike, yaw: ArrayLike, roll: ArrayLike = 0.0, *, order: str = "direct"
) -> ObliqueEllipse:
    """Return the ellipse that a tilted ring measures in a straight elliptical pipe.

    Args:
        r1: Semi-axis of the pipe on z [m].
        r2: Semi-axis of the pipe on y [m]; may exceed `r1`.
        pitch: Nose up [rad].
        yaw: Nose right [rad].
        roll: From robot z towards robot y [rad]; a pure roll gives beta = -roll.
        order: `direct`, `pitch_yaw` or `yaw_pitch`, see `frame`.

    Returns:
        ObliqueEllipse of broadcast arrays; major * minor = r1 r2 / a.

    Raises:
        ParameterError: An axis is not positive, an angle out of range or the order unknown.

    Source: (5.13), (5.14), (5.16) as a 2 by 2 eigenproblem with a signed beta (errata 2, 13, 15).

    >>> major, minor, beta = oblique_ellipse(11, 10, *np.radians([15, 7.5]))
    >>> [round(float(v), 6) for v in (major, minor, np.degrees(beta))]
    [11.135205, 10.309418, 13.04213]
    """
    r1, r2 = positive("r1", r1), positive("r2", r2)
    frames = frame(pitch, yaw, roll, order=order)
    curvature = np.stack(np.broadcast_arrays(r1**-2.0, r2**-2.0), axis=-1)
    form = (design_matrix(frames) @ curvature[..., None])[..., 0]
    mean, spread, beta = _principal(form)
    minor = 1.0 / np.sqrt(mean + spread)
    return ObliqueEllipse(r1 * r2 / (frames[..., 0, 0] * minor), minor, beta)


def ring_cylinder(
    phi: ArrayLike,
    r1: ArrayLike,
    r2: ArrayLike,
    pitch: ArrayLike,
    yaw: ArrayLike,
    roll: ArrayLike = 0.0,
    *,
    order: str = "direct",
    offset: tuple[ArrayLike, ArrayLike] = (0.0, 0.0),
) -> Array:
    """Return the radii of a laser ring in a straight elliptical pipe.

    Args:
        phi: Bearings of the rays in the ring plane [rad], broadcast against the rest: to batch over rings give the
            pose as (n, 1) and phi as (m,).
        r1: Semi-axis of the pipe on z [m].
        r2: Semi-axis of the pipe on y [m].
        pitch: Nose up [rad].
        yaw: Nose right [rad].
        roll: From robot z towards robot y [rad].
        order: How the attitude was reached.
        offset: The scanner's origin (y0, z0) in the pipe [m], each broadcast.

    Returns:
        Ranges from the origin to the wall [m], NaN where an input is NaN.

    Raises:
        ParameterError: The origin is not inside the pipe, or a value is out of range.

    Source: (5.4)-(5.7) with an origin offset.

    >>> ring_cylinder(np.radians([0, 90]), 11, 10, 0.0, np.radians(60)).round(6)
    array([22., 10.])
    """
    r1, r2, phi = positive("r1", r1), positive("r2", r2), finite("phi", phi)
    y0, z0 = (finite("offset", part) for part in offset)
    inside = (y0 / r2) ** 2 + (z0 / r1) ** 2
    require(~(inside >= 1), "(y0/r2)^2 + (z0/r1)^2", inside, "below 1", "put the origin inside the pipe")
    frames = frame(pitch, yaw, roll, order=order)
    cos, sin = np.cos(phi), np.sin(phi)
    v = cos * frames[..., 2, 1] + sin * frames[..., 1, 1]
    w = cos * frames[..., 2, 2] + sin * frames[..., 1, 2]
    square = (v / r2) ** 2 + (w / r1) ** 2
    half = v * y0 / r2**2 + w * z0 / r1**2
    root = np.sqrt(half * half + square * (1.0 - inside))
    # Of the two equal forms, the one that does not subtract near-equal numbers.
    return np.where(half <= 0, (root - half) / square, (1.0 - inside) / (root + half))


def conic_to_ellipse(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike, e: ArrayLike, f: ArrayLike) -> Ellipse:
    """Return the ellipse a z^2 + b zy + c y^2 + d z + e y + f = 0.

    Args:
        a: Coefficient of z^2; b of z y; c of y^2; d of z; e of y; f: constant. Any common factor, either sign.
        b: See `a`.
        c: See `a`.
        d: See `a`.
        e: See `a`.
        f: See `a`.

    Returns:
        Ellipse of broadcast arrays, in the unit of the coordinates.

    Raises:
        ParameterError: The conic is not a real ellipse.

    Source: replaces the conversion printed in 5.2.3, which mixes two coefficient conventions (erratum 17).

    >>> [round(float(v), 9) for v in conic_to_ellipse(1 / 121, 0, 1 / 100, 0, 0, -1)]
    [0.0, 0.0, 11.0, 10.0, 0.0]
    """
    a, b, c, d, e, f = np.broadcast_arrays(*(finite(n, v) for n, v in zip("abcdef", (a, b, c, d, e, f), strict=True)))
    determinant = 4.0 * a * c - b * b
    if np.any(determinant <= 0):
        raise ParameterError(
            f"4 a c - b^2 = {np.nanmin(determinant):g} is not positive",
            expected="the coefficients of an ellipse",
            mend="the conic is a parabola or a hyperbola: fit an ellipse-specific conic",
        )
    zc, yc = (b * e - 2.0 * c * d) / determinant, (b * d - 2.0 * a * e) / determinant
    level = -(f + 0.5 * (d * zc + e * yc))
    if np.any(level * a <= 0):
        raise ParameterError(
            "the conic has no real points", expected="the coefficients of a real ellipse", mend="check the sign of f"
        )
    mean, spread, beta = _principal(np.stack([a, b / 2.0, c], axis=-1) / level[..., None])
    return Ellipse(zc, yc, 1.0 / np.sqrt(mean - spread), 1.0 / np.sqrt(mean + spread), beta)


def _principal(form: Array) -> tuple[Array, Array, Array]:
    """Return (mean, half difference) of the eigenvalues of (m_zz, m_zy, m_yy) and the bearing of the smaller one."""
    m_zz, m_zy, m_yy = np.moveaxis(form, -1, 0)
    mean, half = (m_zz + m_yy) / 2.0, (m_yy - m_zz) / 2.0
    spread = np.hypot(half, m_zy)
    beta = 0.5 * np.arctan2(0.0 - m_zy, half)
    beta = np.where(beta <= -np.pi / 2 + CIRCLE, beta + np.pi, beta)
    return mean, spread, np.where(spread > CIRCLE * mean, beta, np.nan)
