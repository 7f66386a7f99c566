"""Frames laid out on the pipe's wall: rows along the pipe, columns by bearing.

Pipe frame of `springline.conventions`; lengths in metres, angles in radians.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from springline.errors import ParameterError
from springline.geometry.camera import project, to_pixels
from springline.geometry.checks import finite, positive
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens

    Array = NDArray[np.float64]

_BINS = 4096
_EXACT = 0.01
"""Error of a place in the frame that the table of a lens may make [px]; beyond, its places are computed one by one."""


@dataclass(frozen=True)
class WallGrid:
    """Places on the wall, and where a camera sees them; made once and used for every frame from that pose.

    Attributes:
        x: (rows) along the pipe [m].
        bearing: (columns) from +z counter-clockwise [rad].
        columns, rows: (rows, columns) column and row in the frame [px], float32; NaN where the lens sees nothing.
    """

    x: Array
    bearing: Array
    columns: NDArray[np.float32]
    rows: NDArray[np.float32]

    def unwrap(self, image: NDArray[np.generic]) -> NDArray[np.generic]:
        """Return the frame on the wall (rows, columns[, 3]); black where it sees nothing.

        Args:
            image: (row, column) or (row, column, 3).

        Raises:
            MissingExtraError: OpenCV is not installed.
        """
        cv2 = opencv()
        return cv2.remap(
            image, self.columns, self.rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=(0, 0, 0)
        )

    def seen(self, size: tuple[int, int]) -> NDArray[np.bool_]:
        """Return which places (rows, columns) lie inside a frame of `size`, its rows and columns."""
        with np.errstate(invalid="ignore"):
            inside = (self.columns >= 0) & (self.rows >= 0)
            return inside & (self.columns <= size[1] - 1) & (self.rows <= size[0] - 1)


def wall_grid(
    matrix: ArrayLike,
    lens: Lens,
    centre: ArrayLike,
    r1: float,
    r2: float,
    x: ArrayLike,
    *,
    columns: int = 720,
    first_bearing: float = 0.0,
) -> WallGrid:
    """Return where a camera sees places on the wall.

    Args:
        matrix: (4, 4) pose of the camera, as of `geometry.camera.camera_matrix`.
        lens: The lens.
        centre: Column and row of its principal point [px].
        r1, r2: Semi-axes of the pipe along z and y [m].
        x: (rows) along the pipe [m].
        columns: How many bearings, in equal steps.
        first_bearing: Bearing of the first column [rad].

    Returns:
        WallGrid.

    Raises:
        ParameterError: `columns` is below three, or a shape does not fit.

    Source: 6.3 and 6.4 turned round.
    """
    if columns < 3:
        raise ParameterError(f"columns = {columns} is out of range", expected="columns >= 3")
    x = np.atleast_1d(finite("x", x))
    bearing = first_bearing + np.arange(columns) * (2.0 * np.pi / columns)
    r1, r2 = float(positive("r1", r1)), float(positive("r2", r2))
    # a bearing is the polar angle, not the eccentric one
    turned = np.arctan2(r1 * np.sin(bearing), r2 * np.cos(bearing))
    round_ = np.stack([r2 * np.sin(turned), r1 * np.cos(turned)])
    matrix, (column, row) = finite("matrix", matrix), finite("centre", centre)
    if matrix.shape != (4, 4):
        raise ParameterError(f"matrix has shape {matrix.shape}", expected="(4, 4), as of camera_matrix")
    least, scale, rough = _lens_table(lens)
    columns_at, rows_at, doubtful = _laid_out(
        np.ascontiguousarray(matrix[:3]), x, round_, (float(column), float(row)), least, scale, rough
    )
    if doubtful.any():
        i, j = np.nonzero(doubtful)
        pixels = to_pixels(project(matrix, np.stack([x[i], round_[0, j], round_[1, j]], axis=-1), lens), centre)
        columns_at[i, j], rows_at[i, j] = pixels.T
    return WallGrid(x, bearing, columns_at, rows_at)


@lru_cache(maxsize=16)
def _lens_table(lens: Lens) -> tuple[float, Array, NDArray[np.bool_]]:
    """Image radius over the sine of the zenith, at equal steps of its cosine from the least that is seen, up to 1.

    Returns:
        The least cosine; (bins + 1) [px]; (bins) whether a line between two of them is off by more than allowed.
    """
    least = math.cos(lens.max_zenith)

    def scale(cosine: Array) -> Array:
        zenith = np.arccos(np.clip(cosine, -1.0, 1.0))
        sine = np.sin(zenith)
        near = sine < 1e-6
        # the limit along the axis; behind the camera there is none
        ends = np.where(cosine > 0.0, lens.slope(0.0), np.nan)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(near, ends, lens.radius(np.minimum(zenith, lens.max_zenith)) / sine)

    edges = np.linspace(least, 1.0, _BINS + 1)
    table = scale(edges)
    middle = 0.5 * (edges[1:] + edges[:-1])
    with np.errstate(invalid="ignore"):
        off = np.abs(0.5 * (table[1:] + table[:-1]) - scale(middle))
    return least, table, ~(off < _EXACT)


@njit(cache=True, error_model="numpy")
def _laid_out(matrix, x, wall, centre, least, scale, rough):
    """Column and row of each place of the wall, float32, and which of them the lens's table does not tell."""
    shape = (x.size, wall.shape[1])
    columns, rows = np.empty(shape, np.float32), np.empty(shape, np.float32)
    doubtful = np.zeros(shape, np.bool_)
    bins = rough.size
    per = bins / (1.0 - least)
    base = np.empty((3, shape[1]))
    for k in range(3):
        for j in range(shape[1]):
            base[k, j] = matrix[k, 1] * wall[0, j] + matrix[k, 2] * wall[1, j] + matrix[k, 3]
    for i in range(shape[0]):
        for j in range(shape[1]):
            back = base[0, j] + matrix[0, 0] * x[i]
            up = base[1, j] + matrix[1, 0] * x[i]
            right = base[2, j] + matrix[2, 0] * x[i]
            far = math.sqrt(back * back + up * up + right * right)
            cosine = -back / far
            if not cosine >= least:
                columns[i, j] = rows[i, j] = np.nan
                continue
            at = (cosine - least) * per
            k = min(int(at), bins - 1)
            if rough[k]:
                doubtful[i, j] = True
                continue
            size = (scale[k] + (at - k) * (scale[k + 1] - scale[k])) / far
            columns[i, j] = centre[0] + size * right
            rows[i, j] = centre[1] - size * up
    return columns, rows, doubtful
