"""Grey and binary morphology with an exact Euclidean disk (2.9.3): dilation, erosion, opening, closing.

Images are arrays (..., row, column); leading axes are separate images. Pixels outside the image, and missing ones
(NaN), never win; a pixel is missing where its whole neighbourhood is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import finite, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Image = NDArray[np.generic]


def disk(radius: float) -> NDArray[np.bool_]:
    """Return the structuring element of all pixels at most `radius` [px] from its centre.

    Raises:
        ParameterError: `radius` is negative or not finite.

    Source: 2.9.3; no approximation by lines, unlike the disk of appendix D (erratum 33).

    >>> disk(1).astype(int)
    array([[0, 1, 0],
           [1, 1, 1],
           [0, 1, 0]])
    """
    radius = finite("radius", radius)
    require(radius >= 0, "radius", radius, "radius >= 0", "give a number of pixels")
    reach = np.arange(-int(radius), int(radius) + 1)
    return reach[:, None] ** 2 + reach**2 <= radius**2


def dilate(image: ArrayLike, element: ArrayLike) -> Image:
    """Return the largest value under the element, placed on each pixel.

    Args:
        image: (..., row, column) of booleans, integers up to 2**53, or floats.
        element: (odd, odd) of booleans, its origin in the middle; not reflected.

    Returns:
        Array of the image's shape and type.

    Raises:
        ParameterError: The image has fewer than two axes, or the element is empty or has an even side.

    Source: 2.9.3.

    >>> dilate([[0, 0, 0, 1]], disk(1))
    array([[0, 0, 1, 1]])
    """
    return _extreme(image, element, largest=True)


def erode(image: ArrayLike, element: ArrayLike) -> Image:
    """Return the smallest value under the element, placed on each pixel; arguments as for `dilate`.

    >>> erode([[5, 5, 2, 5]], disk(1))
    array([[5, 2, 2, 2]])
    """
    return _extreme(image, element, largest=False)


def opening(image: ArrayLike, element: ArrayLike) -> Image:
    """Return the image eroded, then dilated: bright detail that the element does not fit into is gone.

    >>> opening([[0, 9, 0, 9, 9, 9]], disk(1))
    array([[0, 0, 0, 9, 9, 9]])
    """
    return dilate(erode(image, element), np.flip(_element(element)))


def closing(image: ArrayLike, element: ArrayLike) -> Image:
    """Return the image dilated, then eroded: dark detail that the element does not fit into is gone.

    >>> closing([[9, 0, 9, 0, 0, 0]], disk(1))
    array([[9, 9, 9, 0, 0, 0]])
    """
    return erode(dilate(image, element), np.flip(_element(element)))


def _extreme(image: ArrayLike, element: ArrayLike, *, largest: bool) -> Image:
    from scipy import ndimage

    image, footprint = np.asarray(image), _element(element)
    if image.ndim < 2:
        raise ParameterError(f"image has shape {image.shape}", expected="(..., row, column)")
    losing = -np.inf if largest else np.inf
    pixels = image.astype(float)
    footprint = footprint.reshape((1,) * (image.ndim - 2) + footprint.shape)
    extreme = ndimage.maximum_filter if largest else ndimage.minimum_filter
    found = extreme(np.where(np.isnan(pixels), losing, pixels), footprint=footprint, mode="constant", cval=losing)
    empty = found == losing
    if np.issubdtype(image.dtype, np.floating):
        return np.where(empty, np.nan, found).astype(image.dtype)
    found = np.where(empty, 0.0, found).astype(image.dtype)  # integers have no NaN: the value that never wins
    if empty.any():
        bounds = (False, True) if image.dtype == bool else (np.iinfo(image.dtype).min, np.iinfo(image.dtype).max)
        found[empty] = bounds[0 if largest else 1]
    return found


def _element(element: ArrayLike) -> NDArray[np.bool_]:
    element = np.asarray(element).astype(bool)
    if element.ndim != 2 or not element.any() or any(side % 2 == 0 for side in element.shape):
        raise ParameterError(
            f"element has shape {element.shape} and {int(element.sum())} pixels set",
            expected="a 2-D array with odd sides and at least one pixel set",
            mend="use springline.geometry.morphology.disk",
        )
    return element
