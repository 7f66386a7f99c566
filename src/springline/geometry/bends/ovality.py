"""The ovality that a tilt or a bend fakes: what a ring shows of a pipe that is not oval.

The ring is read about O, the centroid of the area it encloses, which is the conic's centre in a straight pipe.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from springline.errors import ParameterError
from springline.geometry.bends.torus import torus_hit
from springline.geometry.checks import finite, positive
from springline.geometry.robot.attitude import frame
from springline.geometry.robot.oblique import ring_cylinder

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

_READINGS = 720
"""Rays per ring: means converge spectrally, and a smooth extreme is interpolated to about 1e-9."""

_RECENTRES = 6


class ApparentOvality(NamedTuple):
    """What a ring shows, as a fraction: (max - mean)/mean under the four means of `conventions`.

    `diameter_max` and `diameter_min` are chords through O [m]; `axes`, `polar`, `area` and `caliper` are ovalities.
    """

    diameter_max: np.ndarray
    diameter_min: np.ndarray
    axes: np.ndarray
    polar: np.ndarray
    area: np.ndarray
    caliper: np.ndarray


def ring_ovality(radius: ArrayLike) -> ApparentOvality:
    """Return the extreme chords and the four ovalities of rings about O.

    Args:
        radius: Noise-free radii about O [m], (..., m) at m equal steps of bearing, m a multiple of 4 and at least
            64; noise would be taken for shape.

    Returns:
        ApparentOvality of the leading shape; NaN for a ring with a missing radius.

    Raises:
        ParameterError: Wrong number of readings, or a radius that is not positive.

    Source: means of DESIGN's `diameter_*` (errata A2): axes, polar, area, caliper = convex perimeter over pi.

    >>> t = np.linspace(0, 2 * np.pi, 360, endpoint=False)
    >>> shown = ring_ovality(12 * 10 / np.hypot(10 * np.cos(t), 12 * np.sin(t)))
    >>> [round(100 * float(q), 2) for q in shown[2:]]
    [9.09, 9.77, 9.54, 8.87]
    """
    radius = positive("radius", radius)
    count = radius.shape[-1] if radius.ndim else 0
    if count < 64 or count % 4:
        raise ParameterError(f"radius has {count} readings per ring", expected="a multiple of 4, at least 64")
    chord = radius[..., : count // 2] + radius[..., count // 2 :]
    largest, smallest = _extreme(chord), -_extreme(-chord)
    means = {
        "axes": (largest + smallest) / 2.0,
        "polar": chord.mean(axis=-1),
        "area": 2.0 * np.sqrt(np.mean(radius * radius, axis=-1)),
        "caliper": _convex_perimeter(radius) / np.pi,
    }
    return ApparentOvality(largest, smallest, **{name: largest / mean - 1.0 for name, mean in means.items()})


def tilt_ovality(r1: ArrayLike, r2: ArrayLike, pitch: ArrayLike, yaw: ArrayLike) -> ApparentOvality:
    """Return the ovality that a tilted ring shows of a straight pipe.

    Args:
        r1: Semi-axis of the pipe on z [m].
        r2: Semi-axis on y [m]; equal to `r1` for a round pipe.
        pitch: Nose up [rad].
        yaw: Nose right [rad].

    Returns:
        ApparentOvality of the broadcast shape; roll and offset change nothing.

    Raises:
        ParameterError: A value is out of range.

    Source: 4.3; a round pipe tilted by 10 degrees shows an ovality of 0.8 percent (axes).

    >>> round(100 * float(tilt_ovality(0.1, 0.1, np.radians(10), 0.0).axes), 3)
    0.765
    """
    r1, r2, pitch, yaw = (np.asarray(v, float)[..., None] for v in (r1, r2, pitch, yaw))
    return ring_ovality(ring_cylinder(_bearings(), r1, r2, pitch, yaw))


def bend_ovality(
    bend_radius: ArrayLike,
    r1: ArrayLike,
    r2: ArrayLike,
    pitch: ArrayLike = 0.0,
    yaw: ArrayLike = 0.0,
    *,
    offset: tuple[ArrayLike, ArrayLike] = (0.0, 0.0),
) -> ApparentOvality:
    """Return the ovality that a ring shows in a bend.

    Args:
        bend_radius: Radius of the pipe's axis [m], above `r2`.
        r1: Semi-axis of the section across the bend's plane [m].
        r2: Semi-axis in the plane of the bend [m].
        pitch: Nose towards the bend's centre [rad], against the tangent at the robot.
        yaw: Nose sideways [rad].
        offset: The scanner's origin, towards the bend's centre and sideways [m].

    Returns:
        ApparentOvality of the broadcast shape, about the ring's own centroid.

    Raises:
        ParameterError: A value is out of range, or the origin is not inside the bend.

    Source: 4.2 and the application named in 4.3.

    >>> round(100 * float(bend_ovality(2.0, 0.15, 0.15, np.radians(5)).axes), 3)
    0.192
    """
    values = (bend_radius, r1, r2, pitch, yaw, *offset)
    big, r1, r2, pitch, yaw, y0, z0 = (finite("argument", v)[..., None] for v in np.broadcast_arrays(*values))
    phi = _bearings()
    shift = np.zeros((2, *np.shape(y0)))
    for _ in range(_RECENTRES):
        radius = _recast(phi, big, r1, r2, pitch, yaw, (y0, z0), shift)
        weight = radius**3 / (1.5 * np.sum(radius**2, axis=-1, keepdims=True))
        step = np.stack([np.sum(weight * np.cos(phi), axis=-1), np.sum(weight * np.sin(phi), axis=-1)])[..., None]
        shift = shift + step
    return ring_ovality(_recast(phi, big, r1, r2, pitch, yaw, (y0, z0), shift))


def _bearings() -> Array:
    return np.linspace(0.0, 2.0 * np.pi, _READINGS, endpoint=False)


def _recast(
    phi: Array, big: Array, r1: Array, r2: Array, pitch: Array, yaw: Array, offset: tuple[Array, Array], shift: Array
) -> Array:
    """Return the radii about the point that lies `shift` (z, y) from the origin in the ring plane."""
    frames = frame(pitch, yaw)
    x, y, z = np.broadcast_arrays(0.0, offset[0] - big, offset[1])
    origin = np.stack([x, y, z], axis=-1)
    origin = origin + shift[0][..., None] * frames[..., 2, :] + shift[1][..., None] * frames[..., 1, :]
    direction = np.cos(phi)[:, None] * frames[..., 2, :] + np.sin(phi)[:, None] * frames[..., 1, :]
    return torus_hit(origin, direction, big, r1, r2)


def _extreme(chord: Array) -> Array:
    """Return the largest value over the last, periodic axis, through a parabola about the largest sample."""
    index = np.argmax(np.where(np.isnan(chord), -np.inf, chord), axis=-1)[..., None]
    before, top, after = (
        np.take_along_axis(chord, (index + shift) % chord.shape[-1], axis=-1)[..., 0] for shift in (-1, 0, 1)
    )
    bow = before - 2.0 * top + after
    # A circle has no bow: every sample is its extreme.
    flat = np.abs(bow) <= 1e-14 * np.abs(top)
    return top - np.where(flat, 0.0, (after - before) ** 2 / (8.0 * np.where(flat, 1.0, bow)))


def _convex_perimeter(radius: Array) -> Array:
    """Return the perimeter of the convex hull: of the curve itself where it is convex, else of its polygon's hull."""
    count = radius.shape[-1]
    wave = 1j * np.fft.rfftfreq(count, 1.0 / count)
    spectrum = np.fft.rfft(radius, axis=-1)
    first, second = (np.fft.irfft(spectrum * wave**k, count, axis=-1) for k in (1, 2))
    perimeter = 2.0 * np.pi * np.mean(np.hypot(radius, first), axis=-1)
    hollow = (radius**2 + 2.0 * first**2 - radius * second < -1e-9 * radius**2).any(axis=-1)
    if hollow.any():
        perimeter = np.array(perimeter)
        perimeter[hollow] = [_hull_perimeter(ring) for ring in radius[hollow]]
    return perimeter


def _hull_perimeter(radius: Array) -> float:
    from scipy.spatial import ConvexHull

    phi = np.linspace(0.0, 2.0 * np.pi, radius.size, endpoint=False)
    # In the plane a hull's "area" is its perimeter.
    return ConvexHull(np.stack([radius * np.cos(phi), radius * np.sin(phi)], axis=-1)).area
