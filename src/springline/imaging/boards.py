"""Inner corners of a checkerboard in pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import InputError, ParameterError
from springline.imaging.frames import read_frame
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def board_points(columns: int, rows: int, square: float) -> Array:
    """Return the inner corners (corner, 2) of a checkerboard, right and down from its middle [m], row by row.

    Args:
        columns: Inner corners in a row: one less than the squares.
        rows: Inner corners in a column.
        square: Side of a square [m].

    Raises:
        ParameterError: A number is out of range.

    >>> board_points(4, 3, 0.02)[0].round(3).tolist()
    [-0.03, -0.02]
    """
    if columns < 3 or rows < 3 or columns == rows:
        raise ParameterError(
            f"a board of {columns} x {rows} inner corners cannot be used",
            expected="3 or more each way, and not as many both ways",
            mend="count where four squares meet; a board as wide as high cannot tell its sides apart",
        )
    if not 0 < square < 10:
        raise ParameterError(f"square = {square:g} m is out of range", expected="0 < square < 10 m")
    x, y = np.meshgrid(np.arange(columns) - 0.5 * (columns - 1), np.arange(rows) - 0.5 * (rows - 1))
    return np.stack([x.ravel(), y.ravel()], axis=1) * square


def find_boards(files: Sequence[Path], columns: int, rows: int) -> tuple[Array, tuple[int, int], list[str]]:
    """Return the corners of a checkerboard in pictures of one camera.

    Args:
        files: The pictures, all of one size.
        columns: Inner corners in a row.
        rows: Inner corners in a column.

    Returns:
        (picture, corner, 2) column and row [px] in the order of `board_points`, NaN in pictures where the board was
        not found; the pictures' width and height; and a sentence for each picture that gave nothing.

    Raises:
        InputError: No picture can be read.
        MissingExtraError: OpenCV is not installed.

    A checkerboard alone does not tell a mirrored picture: where its numbers of squares are of different parity it is
    its own mirror image, which does a radially symmetric lens no harm.
    """
    cv2 = opencv()
    size: tuple[int, int] | None = None
    found, troubles = [], []
    for path in files:
        corners = np.full((columns * rows, 2), np.nan)
        found.append(corners)
        try:
            picture = read_frame(path)
        except InputError as refusal:
            troubles.append(f"{path.name}: {refusal.what}")
            continue
        here = (picture.shape[1], picture.shape[0])
        size = size or here
        if here != size:
            troubles.append(f"{path.name}: {here[0]} x {here[1]} pixels, where the first has {size[0]} x {size[1]}")
            continue
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY
        seen, points = cv2.findChessboardCornersSB(grey, (columns, rows), flags=flags)
        if not seen:
            troubles.append(f"{path.name}: no board of {columns} x {rows} inner corners was found")
            continue
        corners[:] = points.reshape(-1, 2)
    if size is None:
        raise InputError("no picture can be read", expected="pictures of a checkerboard", mend="; ".join(troubles[:3]))
    return _same_sense(np.array(found), columns, rows), size, troubles


def _same_sense(found: Array, columns: int, rows: int) -> Array:
    """Return the corners with rows running downwards of their columns, as seen: a checkerboard's start is arbitrary."""
    grid = found.reshape(-1, rows, columns, 2)
    right, down = grid[:, 0, -1] - grid[:, 0, 0], grid[:, -1, 0] - grid[:, 0, 0]
    turned = right[:, 0] * down[:, 1] - right[:, 1] * down[:, 0] < 0
    grid[turned] = grid[turned][:, ::-1]
    return grid.reshape(found.shape)
