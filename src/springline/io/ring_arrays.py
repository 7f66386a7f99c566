"""Rings as a file holds them, before units and bearings are settled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from .tables import Rows


class Table(Protocol):
    """A table of numbers, whatever the file: column names and blocks of rows."""

    path: Path
    names: tuple[str, ...]

    def blocks(self) -> Iterator[Rows]:
        """Yield the table's numbers."""


@dataclass
class RingArrays:
    """Rings as a file holds them, before bearings and units are settled.

    Args:
        distance: Per ring, in the file's unit.
        ranges: (ring, reading) float32 in the file's unit; NaN = no return.
        angle: Device angle of each reading [rad], from the device's zero in its sense.
        rows: Row number of each ring's first reading, for messages.
        time: Per ring, in the file's unit, or None.
        no_return: Count of readings given as zero or infinite.
    """

    distance: np.ndarray
    ranges: np.ndarray
    angle: np.ndarray
    rows: np.ndarray
    time: np.ndarray | None = None
    no_return: int = 0


def clean_ranges(ranges: np.ndarray, rows: np.ndarray, names: list[str], path: Path) -> int:
    """Turn zero and infinite ranges into NaN, in place, and return their count; devices write either for no return.

    Args:
        ranges: (row, column).
        rows: Row numbers, for messages.
        names: Column names, for messages.
        path: The file, for messages.

    Raises:
        InputError: A range is negative; row and column named.
    """
    negative = np.argwhere(ranges < 0)
    negative = negative[np.isfinite(ranges[tuple(negative.T)])] if negative.size else negative
    if negative.size:
        i, j = negative[0]
        raise InputError(
            f"the range {ranges[i, j]:g} is negative",
            where=f"{path}, row {rows[i]}, column {names[j]}",
            expected="a positive range, or an empty cell for no return",
        )
    none = (ranges == 0) | np.isinf(ranges)
    ranges[none] = np.nan
    return int(none.sum())
