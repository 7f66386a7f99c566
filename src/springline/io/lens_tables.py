"""Tables from which a lens is calibrated: pairs of zenith and radius, and sights of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .named_columns import Rows, check_columns, number_of, read_named

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

PAIRS = ("zenith_deg", "radius_px")
"""Columns of pairs: angle to the optical axis, and distance from the principal point."""

SIGHTS = ("joint", "distance_m", "radius_px")
"""Columns of sights: which joint, the odometer then, and the image radius of its circle."""


def read_lens_table(path: Path, columns: tuple[str, ...]) -> dict[str, NDArray]:
    """Read the named columns of a CSV; `joint` as text, all others as numbers, an empty cell as NaN.

    Raises:
        InputError: The file or a column is missing or unknown, or a cell is no number; row and column named.
        FormatError: It is not a text table.
    """
    header, rows = read_named(path)
    check_columns(header, columns, columns, path)
    return {
        name: np.array([cells[name] for _, cells in rows]) if name == "joint" else _numbers(rows, name, path)
        for name in columns
    }


def _numbers(rows: Rows, name: str, path: Path) -> NDArray[np.float64]:
    return np.array([
        number_of(cells[name], f"{path}, row {number}, column {name}") if cells[name] else np.nan
        for number, cells in rows
    ])  # fmt: skip
