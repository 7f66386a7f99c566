"""Distances between the shapes of two closed contours: complex and elliptic Fourier, Procrustes.

All leave out position, size and sense, and run the contours at equal steps along their length, so that the sampling
does not count. Contours are arrays (..., n, 2) of z and y; those of the two arguments may differ in n, and their
leading axes broadcast. A contour with a missing point has no distance to any other: NaN.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.contours.curves import orient, resample, to_complex
from springline.geometry.contours.fourier import unit_descriptors

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

HARMONICS = 10
"""Highest frequency of the Fourier distances."""

_SAMPLES = 256
_NEWTON = 4


def fourier_distance(
    a: ArrayLike, b: ArrayLike, harmonics: int = HARMONICS, *, rotation: bool = True, steps: int = 720
) -> Array:
    """Return the smallest norm of the difference of the contours' unit complex descriptors.

    Args:
        a: Contour (..., n, 2).
        b: Contour (..., m, 2).
        harmonics: Highest frequency, positive and negative.
        rotation: Whether rotation is left out too; otherwise an upright contour differs from a lying one.
        steps: First points tried about the contour; the best is then refined.

    Returns:
        Distance (...), in [0, sqrt 2] with rotation left out.

    Raises:
        ParameterError: A contour cannot be used, or `harmonics` or `steps` is out of range.

    Source: 2.9.2 with its phases kept, which 6.7 leaves for later; start point by erratum 31.

    >>> turn = np.radians(np.arange(0, 360, 2))
    >>> ellipse = np.stack([2 * np.cos(turn), np.sin(turn)], axis=-1)
    >>> tall = ellipse[:, ::-1]
    >>> bool(fourier_distance(ellipse, tall) < 1e-6), bool(fourier_distance(ellipse, tall, rotation=False) > 0.3)
    (True, True)
    """
    if steps < 1:
        raise ParameterError(f"steps = {steps} is out of range", expected="steps >= 1")
    k = np.r_[-harmonics:0, 1 : harmonics + 1]
    count = max(_SAMPLES, 4 * harmonics)
    first, second = unit_descriptors(a, harmonics, count), unit_descriptors(b, harmonics, count)
    product = np.conj(first) * second
    starts = 2.0 * np.pi * np.arange(steps) / steps
    likeness = _likeness(product @ np.exp(1j * np.outer(k, starts)), rotation)
    missing = np.isnan(likeness).any(axis=-1)
    start = starts[np.argmax(np.where(missing[..., None], 0.0, likeness), axis=-1)]
    best = likeness.max(axis=-1)
    for _ in range(_NEWTON):
        value, slope, bend = (_turned(product, k, start, order) for order in range(3))
        if rotation:
            slope, bend = 2 * (np.conj(value) * slope).real, 2 * (np.abs(slope) ** 2 + (np.conj(value) * bend).real)
        else:
            slope, bend = slope.real, bend.real
        step = np.where(bend < 0, -slope / np.where(bend < 0, bend, 1.0), 0.0)
        start = start + np.clip(step, -np.pi / steps, np.pi / steps)
        best = np.fmax(best, _likeness(_turned(product, k, start, 0), rotation))
    return np.where(missing, np.nan, np.sqrt(np.maximum(2.0 - 2.0 * best, 0.0)))


def procrustes_distance(a: ArrayLike, b: ArrayLike, samples: int = 128) -> Array:
    """Return the full Procrustes distance between the contours at the best first point.

    Args:
        a: Contour (..., n, 2).
        b: Contour (..., m, 2).
        samples: Equal steps along the length at which they are compared; also the first points tried.

    Returns:
        Distance (...) in [0, 1]: the residual after the best position, size and rotation, each contour of unit size.

    Raises:
        ParameterError: A contour cannot be used, or `samples` is below three.

    Source: Dryden and Mardia, Statistical Shape Analysis, full Procrustes distance; a non-frequency metric for 6.7.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> bool(procrustes_distance(square, 3.0 + 2.0 * square[::-1]) < 1e-6)
    True
    """
    first, second = _shape(a, samples), _shape(b, samples)
    # the correlation at every first point at once
    match = np.fft.ifft(np.fft.fft(first, axis=-1) * np.conj(np.fft.fft(second, axis=-1)), axis=-1)
    best = np.abs(match).max(axis=-1)
    return np.sqrt(np.maximum(1.0 - best**2, 0.0))


def elliptic_descriptors(contour: ArrayLike, harmonics: int = HARMONICS) -> Array:
    """Return the elliptic Fourier coefficients of a contour, made free of position, size, rotation and first point.

    The first ellipse is laid along z with unit semi-major axis, and the contour is begun at its end. A first ellipse
    that is a circle leaves the first point open.

    Args:
        contour: (..., n, 2) z and y.
        harmonics: How many ellipses.

    Returns:
        Array (..., harmonics, 2, 2): [[a, b], [c, d]] with z = sum a cos + b sin and y = sum c cos + d sin.

    Raises:
        ParameterError: The contour cannot be used, or `harmonics` is below one.

    Source: Kuhl and Giardina, Computer Graphics and Image Processing 18 (1982), (7) and (13)-(19).

    >>> turn = np.radians(np.arange(0, 360, 1))
    >>> elliptic_descriptors(np.stack([np.cos(turn), 2 * np.sin(turn)], axis=-1), 1)[0].round(3) + 0.0
    array([[1.   , 0.   ],
           [0.   , 0.587]])
    """
    if harmonics < 1:
        raise ParameterError(f"harmonics = {harmonics} is out of range", expected="harmonics >= 1")
    raw = _elliptic(to_complex(orient(contour)), harmonics)
    (a, b), (c, d) = (np.moveaxis(raw[..., 0, row, :], -1, 0) for row in (0, 1))
    start = 0.5 * np.arctan2(2.0 * (a * b + c * d), a * a + c * c - b * b - d * d)
    order = np.arange(1, harmonics + 1)
    begun = raw @ _rotation(-order * start[..., None])
    axis = begun[..., 0, :, 0]
    turned = _rotation(np.arctan2(axis[..., 1], axis[..., 0]))[..., None, :, :] @ begun
    size = np.hypot(axis[..., 0], axis[..., 1])
    return turned / np.where(size > 0, size, np.nan)[..., None, None, None]


def elliptic_distance(a: ArrayLike, b: ArrayLike, harmonics: int = HARMONICS) -> Array:
    """Return the norm of the difference of the contours' elliptic descriptors, at the better of the two starts.

    Args:
        a: Contour (..., n, 2).
        b: Contour (..., m, 2).
        harmonics: How many ellipses.

    Returns:
        Distance (...); in units of the first ellipse's semi-major axis.

    Raises:
        ParameterError: A contour cannot be used, or `harmonics` is below one.

    Source: Kuhl and Giardina (1982), whose first point is open by half a turn of the first ellipse.

    >>> turn = np.radians(np.arange(0, 360, 2))
    >>> egg = np.stack([2 * np.cos(turn) + 0.3 * np.cos(2 * turn), np.sin(turn)], axis=-1)
    >>> bool(elliptic_distance(egg, -4.0 * np.roll(egg, 90, axis=0)) < 1e-6)
    True
    """
    first, second = elliptic_descriptors(a, harmonics), elliptic_descriptors(b, harmonics)
    half = (-1.0) ** np.arange(harmonics)[:, None, None]
    apart = (np.sqrt(np.sum((first - other) ** 2, axis=(-1, -2, -3))) for other in (second, half * second))
    return np.minimum(*apart)


def _likeness(inner: Array, rotation: bool) -> Array:
    return np.abs(inner) if rotation else inner.real


def _turned(product: Array, k: Array, start: Array, order: int) -> Array:
    """The inner product at first point `start`, or its derivative of `order`."""
    return np.sum((1j * k) ** order * product * np.exp(1j * k * start[..., None]), axis=-1)


def _shape(contour: ArrayLike, samples: int) -> Array:
    curve = to_complex(resample(orient(contour), samples))
    curve = curve - curve.mean(axis=-1, keepdims=True)
    with np.errstate(invalid="ignore"):  # a contour that is missing, or a single point, has no shape: NaN
        return curve / np.linalg.norm(curve, axis=-1, keepdims=True)


def _rotation(angle: Array) -> Array:
    """Matrices (..., 2, 2) that turn vectors clockwise by `angle`."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([cos, sin], axis=-1), np.stack([-sin, cos], axis=-1)], axis=-2)


def _elliptic(curve: Array, harmonics: int) -> Array:
    """Coefficients of the polygon, run at constant speed."""
    steps = np.diff(np.concatenate([curve, curve[..., :1]], axis=-1), axis=-1)
    lengths = np.abs(steps)
    with np.errstate(invalid="ignore"):  # a missing point leaves all coefficients NaN
        speed = steps / np.where(lengths == 0, 1.0, lengths)
    along = np.concatenate([np.zeros((*curve.shape[:-1], 1)), np.cumsum(lengths, axis=-1)], axis=-1)
    total = along[..., -1:]
    order = np.arange(1, harmonics + 1)[:, None]
    phase = 2.0 * np.pi * order * (along / np.where(total > 0, total, np.nan))[..., None, :]
    waves = np.stack([np.diff(np.cos(phase), axis=-1), np.diff(np.sin(phase), axis=-1)], axis=-2)
    parts = np.stack([speed.real, speed.imag], axis=-2)
    sums = np.einsum("...rn,...hwn->...hrw", parts, waves)
    return sums * (total[..., None, None] / (2.0 * (np.pi * order[..., None]) ** 2))
