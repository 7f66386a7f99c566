"""Rays and laser rings in a bend: quartic coefficients, first wall hit, ring radii.

The torus lies about the z axis: its centreline is the circle of radius R in the plane z = 0, r1 is the section's
semi-axis on z and r2 the one in the plane of the bend. A robot on the axis of an upward bend stands at (0, -R, 0)
and looks along x, with y up towards the bend's centre.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.bends._cast import first_hits
from springline.geometry.bends.curves import bend_radii
from springline.geometry.checks import finite, positive, require
from springline.geometry.robot.attitude import frame

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


def torus_quartic(
    origin: ArrayLike, direction: ArrayLike, bend_radius: ArrayLike, r1: ArrayLike, r2: ArrayLike
) -> Array:
    """Return the coefficients c4 ... c0 of a ray's crossings with a torus.

    Args:
        origin: Points (..., 3) [m].
        direction: Directions (..., 3); the quartic's roots are in units of their length.
        bend_radius: Radius R of the centreline [m], above `r2`.
        r1: Semi-axis of the section on z [m].
        r2: Semi-axis in the plane of the bend [m].

    Returns:
        Array (..., 5), highest power first. Negative values of the polynomial lie inside the pipe.

    Raises:
        ParameterError: A value is out of range.

    Source: (4.12), from (4.7) with 4 r2^2 R^2 on its right side (erratum 20).

    >>> np.roots(torus_quartic([0, -20, 0], [0, -1, 0], 20.0, 10.0, 10.0)).real.round(9) + 0.0
    array([-50., -30.,  10., -10.])
    """
    origin, direction = _vectors("origin", origin), _vectors("direction", direction)
    r1 = positive("r1", r1)
    bend_radius, r2 = bend_radii(bend_radius, r2)
    (x, y, z), (u, v, w) = np.moveaxis(origin, -1, 0), np.moveaxis(direction, -1, 0)
    # In the text's own order of operations, so that its coefficients come out to the last bit.
    k = (r2**2 - r1**2) / r1**2
    pull = (r2 * bend_radius / r1) ** 2
    square = 1.0 + k * w**2
    mixed = x * u + y * v + z * w + z * w * k
    level = x**2 + y**2 + z**2 + z**2 * k - r2**2 - bend_radius**2
    coefficients = (
        square**2,
        4.0 * square * mixed,
        4.0 * mixed**2 + 2.0 * square * level + 4.0 * pull * w**2,
        4.0 * mixed * level + 8.0 * pull * z * w,
        level**2 - 4.0 * r2**2 * bend_radius**2 + 4.0 * pull * z**2,
    )
    return np.stack(np.broadcast_arrays(*coefficients), axis=-1)


def torus_hit(origin: ArrayLike, direction: ArrayLike, bend_radius: ArrayLike, r1: ArrayLike, r2: ArrayLike) -> Array:
    """Return the distance from a point inside a bend to the first wall along a ray.

    Args:
        origin: Points (..., 3) inside the bend [m].
        direction: Directions (..., 3) of any length but zero; turn it round for the hit backwards.
        bend_radius: Radius of the centreline [m], above `r2`.
        r1: Semi-axis of the section on z [m].
        r2: Semi-axis in the plane of the bend [m].

    Returns:
        Distances [m] of the broadcast shape, NaN where an input is NaN.

    Raises:
        ParameterError: A point is not inside the bend, a direction is zero or a value out of range.

    Source: (4.12), smallest positive root; |real(t)| < 20 of Appendix B is no rule (erratum 24).

    >>> round(float(torus_hit([0, -20, 0], [0, -1, 0], 20.0, 10.0, 10.0)), 9)
    10.0
    """
    origin, direction = _vectors("origin", origin), _vectors("direction", direction)
    length = np.linalg.norm(direction, axis=-1)
    require(~(length == 0), "direction", length, "a direction that is not zero", "give three components")
    direction = direction / length[..., None]
    r1 = positive("r1", r1)
    bend_radius, r2 = bend_radii(bend_radius, r2)
    depth = ((np.hypot(origin[..., 0], origin[..., 1]) - bend_radius) / r2) ** 2 + (origin[..., 2] / r1) ** 2
    require(~(depth >= 1), "section level of the origin", depth, "below 1", "put the origin inside the bend")
    shape = np.broadcast_shapes(origin.shape[:-1], direction.shape[:-1], bend_radius.shape, r1.shape, r2.shape)
    # Copies, so that the kernel meets one kind of array: writable and contiguous.
    rays = (np.array(np.broadcast_to(v, (*shape, 3))).reshape(-1, 3) for v in (origin, direction))
    sizes = (np.array(np.broadcast_to(v, shape)).reshape(-1) for v in (bend_radius, r1, r2))
    return first_hits(*rays, *sizes).reshape(shape)[()]


def ring_bend(
    phi: ArrayLike,
    bend_radius: ArrayLike,
    r1: ArrayLike,
    r2: ArrayLike,
    pitch: ArrayLike = 0.0,
    yaw: ArrayLike = 0.0,
    roll: ArrayLike = 0.0,
    *,
    order: str = "direct",
    offset: tuple[ArrayLike, ArrayLike] = (0.0, 0.0),
) -> Array:
    """Return the radii of a laser ring in an upward bend.

    Args:
        phi: Bearings of the rays in the ring plane, from robot z towards robot y [rad], broadcast against the rest:
            to batch over rings give the pose as (n, 1) and phi as (m,).
        bend_radius: Radius of the pipe's axis [m], above `r2`.
        r1: Semi-axis of the section on z [m].
        r2: Semi-axis in the plane of the bend [m].
        pitch: Nose up [rad], against the axis' tangent at the robot.
        yaw: Nose right [rad].
        roll: From robot z towards robot y [rad].
        order: How the attitude was reached: `direct`, `pitch_yaw` or `yaw_pitch`.
        offset: The scanner's origin (y0, z0) above and right of the pipe's axis [m].

    Returns:
        Ranges [m] of the broadcast shape.

    Raises:
        ParameterError: The origin is not inside the pipe, or a value is out of range.

    Source: 4.2.4 with an origin offset and roll.

    >>> ring_bend(np.radians([90, 270]), 20.0, 10.0, 10.0, np.radians(15)).round(6)
    array([10.76252 , 10.231527])
    """
    frames = frame(pitch, yaw, roll, order=order)
    phi = finite("phi", phi)[..., None]
    direction = np.cos(phi) * frames[..., 2, :] + np.sin(phi) * frames[..., 1, :]
    y0, z0 = (finite("offset", part) for part in offset)
    x, y, z = np.broadcast_arrays(0.0, y0 - positive("bend_radius", bend_radius), z0)
    return torus_hit(np.stack([x, y, z], axis=-1), direction, bend_radius, r1, r2)


def _vectors(name: str, value: ArrayLike) -> Array:
    value = finite(name, value)
    if value.shape[-1:] != (3,):
        raise ParameterError(f"{name} has shape {value.shape}", expected="(..., 3) components x, y, z")
    return value
