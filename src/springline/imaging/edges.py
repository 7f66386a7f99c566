"""Edge points of a frame: where its light changes sharply, to a fraction of a pixel, and how it is made comparable.

Every frame is worked on at about the same number of pixels, so that one set of lengths serves all cameras. Columns
count to the right, rows downwards; a pixel's centre has whole coordinates.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

WORKING_PIXELS = 320 * 240
"""Pixels at which joints are sought: what analogue CCTV resolves."""

_VIDEO = {(width, height) for height in (240, 480) for width in (352, 704, 720)} | {
    (width, height) for height in (288, 576) for width in (352, 704, 720)
}
"""Sizes of digitised analogue video, whose pixels are not square: the picture is 4 to 3 (Rec. ITU-R BT.601)."""

_LIGHT_OFFSET = 10.0  # grey levels of stray light; below it the logarithm would only raise noise
_LOG_SCALE = 50.0
_BLUR = 1.2  # px
_SURROUNDINGS = 31  # px
_QUANTUM = 1.0  # grey levels a pixel that the compression of a frame can put there by itself
_RELATIVE = 0.01  # change of light a pixel below which nothing counts as an edge
_WEAK = 0.9
_MARGIN = 4  # px along the frame's border where filters see beyond it
_DARK = 20  # grey level that a column or row of a black border does not reach


@dataclass(frozen=True)
class EdgeField:
    """The edge points of a frame at working size.

    Attributes:
        points: (n, 6) column, row, direction of rising light (2), strength above the surroundings, slope.
        index: (row, column) number of the point in each pixel, -1 where none.
        light: Logarithm of the light, times 50: (row, column).
        grey: Blurred grey levels (row, column), for how dark a place is.
        box: First and last column, first and last row inside the frame's border.
        seen: (row, column) whether there is anything to see; edges of what is not are none.
        scale: Working pixels per pixel of the frame (2): along columns and rows.
    """

    points: Array
    index: NDArray[np.int32]
    light: NDArray[np.float32]
    grey: NDArray[np.float32]
    box: Array
    seen: NDArray[np.bool_]
    scale: Array

    @property
    def diagonal(self) -> float:
        """Diagonal of the working picture [px]."""
        return math.hypot(*self.index.shape)


def edge_field(
    image: NDArray[np.uint8], pixels: int = WORKING_PIXELS, seen: NDArray[np.bool_] | None = None
) -> EdgeField | None:
    """Return the edge points of a frame, or None for one that is black all over.

    The light is taken as its logarithm, so that an edge counts alike near the lamp and far from it; a point is an edge
    where the slope is largest along its own direction and stands out from the mean slope around.

    Args:
        image: (row, column, 3) of 8 bits.
        pixels: Working size.
        seen: (row, column) which pixels hold a picture, where not all do; then the picture is not resized.

    Returns:
        EdgeField, or None.
    """
    cv2 = opencv()
    rows, columns = image.shape[:2]
    if seen is not None:
        pixels = rows * columns
    wide = rows * 4.0 / 3.0 if (columns, rows) in _VIDEO else columns
    shrink = min(1.0, math.sqrt(pixels / (rows * wide)))
    size = (max(1, round(wide * shrink)), max(1, round(rows * shrink)))
    small = image if size == (columns, rows) else cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    box = _inside(small)
    if box is None:
        return None
    grey = cv2.cvtColor(small, cv2.COLOR_BGR2GRAY).astype(np.float32)
    blurred = cv2.GaussianBlur(grey, (0, 0), 2.0)
    light = cv2.GaussianBlur(np.log(grey + _LIGHT_OFFSET) * _LOG_SCALE, (0, 0), _BLUR)
    across, down = (cv2.Scharr(light, cv2.CV_32F, *order) / 32.0 for order in ((1, 0), (0, 1)))
    slope = np.hypot(across, down)
    around = cv2.blur(slope, (_SURROUNDINGS, _SURROUNDINGS))
    if seen is None:
        seen = np.ones(small.shape[:2], dtype=bool)
    else:
        seen = cv2.erode(seen.astype(np.uint8), np.ones((9, 9), np.uint8), borderValue=1) > 0
    strength = slope / (around + _LOG_SCALE * (_QUANTUM / (blurred + _LIGHT_OFFSET) + _RELATIVE))
    left, right, top, bottom = box.astype(int)
    inside = np.zeros(strength.shape, dtype=bool)
    inside[top : bottom + 1, left : right + 1] = seen[top : bottom + 1, left : right + 1]
    points, index = _thinned(across, down, slope, np.where(inside, strength, 0.0), _WEAK, _MARGIN)
    scale = np.array([small.shape[1] / columns, small.shape[0] / rows])
    return EdgeField(points, index, light, blurred, box, seen, scale)


def _inside(image: NDArray[np.uint8]) -> Array | None:
    """First and last column and row of what is not black border."""
    bright = image.max(axis=2)
    rows = np.flatnonzero(np.percentile(bright, 95, axis=1) > _DARK)
    columns = np.flatnonzero(np.percentile(bright, 95, axis=0) > _DARK)
    if len(rows) < 30 or len(columns) < 30:
        return None
    limits = [columns[0] + _MARGIN, columns[-1] - _MARGIN, rows[0] + _MARGIN, rows[-1] - _MARGIN]
    return np.array(limits, dtype=float)


@njit(cache=True)
def _thinned(across, down, slope, strength, weak, margin):
    """Points where the slope is largest along its own direction, and their place by a parabola."""
    rows, columns = slope.shape
    points = np.empty((rows * columns // 2, 6))
    index = -np.ones((rows, columns), np.int32)
    count = 0
    for y in range(margin, rows - margin):
        for x in range(margin, columns - margin):
            here = slope[y, x]
            if strength[y, x] < weak or here <= 0.0:
                continue
            ux, uy = across[y, x] / here, down[y, x] / here
            ahead = _between(slope, x + ux, y + uy)
            behind = _between(slope, x - ux, y - uy)
            if here > ahead and here >= behind:
                bend = ahead - 2.0 * here + behind
                shift = 0.0 if bend >= 0.0 else 0.5 * (behind - ahead) / bend
                points[count, 0], points[count, 1] = x + shift * ux, y + shift * uy
                points[count, 2], points[count, 3] = ux, uy
                points[count, 4], points[count, 5] = strength[y, x], here
                index[y, x] = count
                count += 1
    return points[:count], index


@njit(cache=True)
def _between(image, x, y):
    column, row = math.floor(x), math.floor(y)
    right, below = x - column, y - row
    top = image[row, column] * (1.0 - right) + image[row, column + 1] * right
    bottom = image[row + 1, column] * (1.0 - right) + image[row + 1, column + 1] * right
    return top * (1.0 - below) + bottom * below
