"""Edges by the classical operators (2.9.3): Canny, Laplacian of Gaussian, Sobel, Prewitt and Roberts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import choice, require
from springline.imaging.illumination import otsu_threshold
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Image = NDArray[np.uint8]

OPERATORS = ("canny", "log", "sobel", "prewitt", "roberts")
"""What `edge_map` can use."""

_KERNELS = {
    "sobel": (
        np.array([[-1, 0, 1], [-2, 0, 2], [-1, 0, 1]]) / 8.0,
        np.array([[-1, -2, -1], [0, 0, 0], [1, 2, 1]]) / 8.0,
    ),
    "prewitt": (np.array([[-1, 0, 1]] * 3) / 6.0, np.array([[-1] * 3, [0] * 3, [1] * 3]) / 6.0),
    "roberts": (np.array([[1, 0], [0, -1]]) / 2.0**0.5, np.array([[0, 1], [-1, 0]]) / 2.0**0.5),
}
_LEAST = 0.5  # grey levels a pixel, below which light is flat
_LOW = 0.4  # Canny's lower threshold, as a share of the upper


def edge_map(
    grey: Image, operator: str = "canny", *, threshold: float | None = None, sigma: float = 1.4
) -> NDArray[np.bool_]:
    """Return where a frame has edges.

    Args:
        grey: (row, column) of 8 bits.
        operator: One of `OPERATORS`.
        threshold: Least slope, in grey levels per pixel; of `log`, least step of the Laplacian through zero. Otsu's of
            all slopes when not given, for `canny` as its upper one.
        sigma: Of the Gaussian before Canny and in the Laplacian of Gaussian [px].

    Returns:
        Mask (row, column): lines one pixel wide for `canny` and `log`, bands otherwise.

    Raises:
        ParameterError: The operator is unknown, or a number is out of range.
        MissingExtraError: OpenCV is not installed.

    Source: 2.9.3; Canny (1986); Marr and Hildreth (1980).

    >>> step = np.repeat(np.uint8([[10] * 8 + [200] * 8]), 16, axis=0)
    >>> edge_map(step, "sobel")[8].nonzero()[0]
    array([7, 8])
    """
    choice("operator", operator, OPERATORS)
    require(sigma > 0, "sigma", sigma, "sigma > 0 px", "give the width of the smoothing")
    if operator == "log":
        return _zero_crossings(grey, threshold, sigma)
    cv2 = opencv()
    if operator != "canny":
        slope = slopes(grey, operator)
        return slope > (_by_otsu(slope) if threshold is None else threshold)
    smooth = cv2.GaussianBlur(grey, (0, 0), sigma).astype(np.float32)
    # 8 sixteenths of a grey level per unit keep small slopes apart in the integers that Canny takes
    across, down = (np.round(cv2.Sobel(smooth, cv2.CV_32F, *order)).astype(np.int16) for order in ((1, 0), (0, 1)))
    upper = 8.0 * (_by_otsu(np.hypot(across, down) / 8.0) if threshold is None else threshold)
    return cv2.Canny(across, down, _LOW * upper, upper, L2gradient=True) > 0


def slopes(grey: Image, operator: str = "sobel") -> NDArray[np.float32]:
    """Return the slope of the light [grey levels per pixel] by `sobel`, `prewitt` or `roberts`.

    Raises:
        ParameterError: The operator is unknown.

    >>> slopes(np.arange(0, 50, 10, dtype=np.uint8)[None].repeat(5, axis=0))[2, 2]
    np.float32(10.0)
    """
    choice("operator", operator, tuple(_KERNELS))
    cv2 = opencv()
    parts = [cv2.filter2D(grey.astype(np.float32), cv2.CV_32F, kernel) for kernel in _KERNELS[operator]]
    return np.hypot(*parts)


def _by_otsu(slope: NDArray[np.float32]) -> float:
    top = float(slope.max())
    if top <= _LEAST:
        return _LEAST
    return max(otsu_threshold(np.round(slope / top * 255.0).astype(np.uint8)) / 255.0 * top, _LEAST)


def _zero_crossings(grey: Image, threshold: float | None, sigma: float) -> NDArray[np.bool_]:
    cv2 = opencv()
    bend = cv2.Laplacian(cv2.GaussianBlur(grey.astype(np.float32), (0, 0), sigma), cv2.CV_32F, ksize=3)
    step = np.zeros_like(bend)
    for axis in (0, 1):
        here, there = np.moveaxis(bend, axis, 0)[:-1], np.moveaxis(bend, axis, 0)[1:]
        crossing = np.where(here * there < 0, np.abs(here - there), 0.0)
        place = np.moveaxis(step, axis, 0)[:-1]
        np.maximum(place, crossing, out=place)
    found = step[step > 0]
    if not found.size:
        return step > 0
    least = threshold
    if least is None:
        least = _by_otsu(step)
    return step > least
