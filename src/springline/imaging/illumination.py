"""Light taken out of a frame by morphology, and what stands out of it by Otsu's threshold (2.9.3, appendix D)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import choice, require
from springline.geometry.morphology import disk
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Image = NDArray[np.uint8]

DETAILS = ("bright", "dark", "both")
"""What is kept: bright detail (I less its opening, as printed), dark detail as joints (its closing less I), or both."""


def remove_illumination(grey: Image, radius: int = 6, *, detail: str = "bright") -> Image:
    """Return what a disk does not fit into: the frame less its background.

    Args:
        grey: (row, column) of 8 bits.
        radius: Of the disk [px].
        detail: One of `DETAILS`.

    Returns:
        (row, column) of 8 bits, 0 where there is background alone.

    Raises:
        ParameterError: The radius or the detail is out of range.
        MissingExtraError: OpenCV is not installed.

    Source: appendix D, `I - imopen(I, strel('disk', 6))`; dark detail by erratum 33, exact disk.
    """
    choice("detail", detail, DETAILS)
    require(radius >= 1, "radius", radius, "radius >= 1", "give a number of pixels")
    cv2 = opencv()
    element = disk(radius).astype(np.uint8)
    bright = cv2.morphologyEx(grey, cv2.MORPH_TOPHAT, element) if detail != "dark" else None
    dark = cv2.morphologyEx(grey, cv2.MORPH_BLACKHAT, element) if detail != "bright" else None
    if bright is None or dark is None:
        return bright if dark is None else dark
    return np.maximum(bright, dark)


def otsu_threshold(grey: Image) -> int:
    """Return the grey level that parts a frame's histogram best: above it is foreground.

    Source: Otsu, IEEE Trans. SMC 9 (1979); `graythresh` of appendix D.

    >>> otsu_threshold(np.repeat(np.uint8([[20, 200]]), 8, axis=0))
    20
    """
    cv2 = opencv()
    return int(cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)[0])


def open_by_area(mask: NDArray[np.bool_], least: int = 50) -> NDArray[np.bool_]:
    """Return a mask without its connected pieces (8 neighbours) of fewer than `least` pixels.

    Source: `bwareaopen` of appendix D.

    >>> open_by_area(np.eye(3, 7, dtype=bool), 3).sum(), open_by_area(np.eye(3, 7, dtype=bool), 4).sum()
    (np.int64(3), np.int64(0))
    """
    cv2 = opencv()
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    large = statistics[:, cv2.CC_STAT_AREA] >= least
    large[0] = False
    return large[labels]


def standing_out(grey: Image, radius: int = 6, *, detail: str = "bright", least: int = 50) -> NDArray[np.bool_]:
    """Return what stands out of a frame's background: the printed chain of appendix D.

    Args:
        grey: (row, column) of 8 bits.
        radius: Of the disk that background has room for [px].
        detail: One of `DETAILS`.
        least: Fewest pixels of a piece that is kept.

    Returns:
        Mask (row, column).

    Raises:
        ParameterError: The radius or the detail is out of range.

    Source: appendix D, morphological operations for edge detection.
    """
    flat = remove_illumination(grey, radius, detail=detail)
    return open_by_area(flat > otsu_threshold(flat), least)
