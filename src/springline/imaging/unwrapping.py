"""Frames laid out on the pipe's wall: rows along the pipe, columns by bearing.

Pipe frame of `springline.conventions`; lengths in metres, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.camera import project, to_pixels
from springline.geometry.checks import finite, positive
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens

    Array = NDArray[np.float64]


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
    z, y = r1 * np.cos(turned), r2 * np.sin(turned)
    wall = np.stack(np.broadcast_arrays(x[:, None], y, z), axis=-1)
    pixels = to_pixels(project(matrix, wall.reshape(-1, 3), lens), centre).reshape(*wall.shape[:2], 2)
    return WallGrid(x, bearing, pixels[..., 0].astype(np.float32), pixels[..., 1].astype(np.float32))
