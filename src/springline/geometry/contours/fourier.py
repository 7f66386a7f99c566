"""Discrete Fourier transform of contours and the descriptors made of it (2.9.2, appendix D).

Complex curves (..., n) are c = z + i y; f_k is the coefficient of exp(+2 pi i k n / N). Contours (..., n, 2) hold z
and y.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.contours.curves import orient, resample, to_complex

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]
    Complex = NDArray[np.complex128]

KEEP = 32
"""Frequencies kept by the published criterion."""

_DOMINANT = 1.0 - 1e-9


def dft(curve: ArrayLike) -> Complex:
    """Return the coefficients f_k (..., n), k = 0 ... n-1, of a complex curve (..., n).

    Source: (2.13).

    >>> dft([1, 1j, -1, -1j]).round(12) + 0.0
    array([0.+0.j, 4.+0.j, 0.+0.j, 0.+0.j])
    """
    return np.fft.fft(np.asarray(curve, dtype=complex), axis=-1)


def inverse_dft(coefficients: ArrayLike) -> Complex:
    """Return the curve (..., n) of coefficients (..., n).

    Source: (2.14) with its 1/N (erratum 29).

    >>> inverse_dft([0, 4, 0, 0]).round(12) + 0.0
    array([ 1.+0.j,  0.+1.j, -1.+0.j,  0.-1.j])
    """
    return np.fft.ifft(np.asarray(coefficients, dtype=complex), axis=-1)


def reversed_dft(coefficients: ArrayLike) -> Complex:
    """Return the coefficients of the same curve run the other way from the same point: g_k = f_-k.

    Source: 2.9.2 with erratum 30: the magnitudes trade places, they do not stay.

    >>> reversed_dft([0, 1, 2, 3]).real
    array([0., 3., 2., 1.])
    """
    return np.roll(np.asarray(coefficients, dtype=complex)[..., ::-1], 1, axis=-1)


def shifted_dft(coefficients: ArrayLike, shift: float) -> Complex:
    """Return the coefficients of the same curve begun `shift` points later: g_k = exp(+2 pi i k shift / N) f_k.

    Source: 2.9.2 with the sign of erratum 31. A broken `shift` turns frequency k by its signed value.

    >>> shifted_dft([0, 1, 0, 0], 1).round(12) + 0.0
    array([0.+0.j, 0.+1.j, 0.+0.j, 0.+0.j])
    """
    coefficients = np.asarray(coefficients, dtype=complex)
    signed = np.fft.fftfreq(coefficients.shape[-1])
    return np.exp(2j * np.pi * signed * shift) * coefficients


def kept_frequencies(length: int, keep: int) -> NDArray[np.int64]:
    """Return the signed frequencies that remain when `keep` of `length` are kept, 0 first, negative ones last.

    Args:
        length: Points of the contour.
        keep: Frequencies to keep; all where `keep` is not below `length`.

    Returns:
        -floor(keep/2) ... ceil(keep/2) - 1, in the order of the transform.

    Raises:
        ParameterError: `length` or `keep` is below one.

    Source: `smoothDFT` of appendix D with erratum 32.

    >>> kept_frequencies(200, 4)
    array([ 0,  1, -2, -1])
    """
    if length < 1 or keep < 1:
        raise ParameterError(f"length = {length} and keep = {keep} are out of range", expected="both >= 1")
    count = min(length, keep)
    return np.fft.ifftshift(np.arange(count) - count // 2)


def normalised_magnitudes(contour: ArrayLike, keep: int = KEEP) -> Array:
    """Return |f_k| / |f_1| of the kept frequencies: free of position, size, rotation, first point and sense.

    Args:
        contour: (..., n, 2) z and y, taken with the sampling that it has.
        keep: Frequencies to keep.

    Returns:
        Array (..., min(keep, n)) in the order of `kept_frequencies`, its first entry 0; NaN where f_1 does not
        dominate, so that there is nothing to divide by, or a point is missing.

    Raises:
        ParameterError: The contour cannot be used, or `keep` is below one.

    Source: `extractDFT`, `normalizeDFT` and `smoothDFT` of appendix D; sense first by erratum 30.

    >>> turn = np.radians(np.arange(0, 360, 45))
    >>> normalised_magnitudes(np.stack([3 * np.cos(turn), np.sin(turn)], axis=-1), 4).round(6)
    array([0. , 1. , 0. , 0.5])
    """
    curve = to_complex(orient(contour))
    curve = curve - curve.mean(axis=-1, keepdims=True)
    magnitudes = np.abs(dft(curve))
    magnitudes[..., 0] = np.where(np.isnan(magnitudes[..., 0]), np.nan, 0.0)
    first = magnitudes[..., 1]
    usable = (first > 0) & (first >= _DOMINANT * magnitudes.max(axis=-1))
    scaled = magnitudes / np.where(usable, first, np.nan)[..., None]
    return scaled[..., kept_frequencies(curve.shape[-1], keep)]


def descriptor_norm(contour: ArrayLike, keep: int = KEEP) -> Array:
    """Return the norm (...) of `normalised_magnitudes`: 1 for a circle, and its square less 1 the power elsewhere.

    For an ellipse with semi-axes A and B at equal eccentric steps it is sqrt(1 + ((A - B)/(A + B))^2) exactly.

    Source: 6.6 and appendix D, `norm(F)`; what it measures by erratum 46.

    >>> turn = np.radians(np.arange(0, 360, 3))
    >>> round(float(descriptor_norm(np.stack([3 * np.cos(turn), np.sin(turn)], axis=-1))), 6)
    1.118034
    """
    return np.linalg.norm(normalised_magnitudes(contour, keep), axis=-1)


def norm_difference(template: ArrayLike, contour: ArrayLike, keep: int = KEEP) -> Array:
    """Return the published criterion, `descriptor_norm` of the template less that of the contour, with its sign.

    To first order it compares aspect ratios and nothing else; the template cancels out of any ranking by it.

    Source: 6.6, as published (erratum 46).

    >>> turn = np.radians(np.arange(0, 360, 3))
    >>> circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    >>> round(float(norm_difference(circle * [3.0, 1.0], circle)), 6)
    0.118034
    """
    return descriptor_norm(template, keep) - descriptor_norm(contour, keep)


def unit_descriptors(contour: ArrayLike, most: int, count: int) -> Complex:
    """Return f_k, k = -most ... -1, 1 ... most, scaled to unit norm: free of position, size, sampling and sense.

    Args:
        contour: (..., n, 2) z and y.
        most: Highest frequency.
        count: Equal steps along its length that it is sampled at, above 2 `most`.

    Returns:
        Complex array (..., 2 most); its phases still hold rotation and first point. NaN for a contour without extent.

    Raises:
        ParameterError: The contour cannot be used, or `most` does not fit `count`.

    >>> turn = np.radians(np.arange(0, 360, 1))
    >>> np.abs(unit_descriptors(np.stack([np.cos(turn), np.sin(turn)], axis=-1), 1, 64)).round(4)
    array([0., 1.])
    """
    if most < 1 or 2 * most >= count:
        raise ParameterError(f"most = {most} is out of range", expected=f"1 <= most < {count / 2:g}")
    coefficients = dft(to_complex(resample(orient(contour), count)))
    wanted = coefficients[..., np.r_[-most:0, 1 : most + 1]]
    norm = np.linalg.norm(wanted, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore"):  # a missing point leaves all of them NaN
        return wanted / np.where(norm > 0, norm, np.nan)
