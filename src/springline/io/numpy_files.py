"""NPY and NPZ: clouds as arrays, and rings as arrays."""

from __future__ import annotations

import tokenize
import zipfile
import zlib
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError, InputError
from .axes import CAMERA
from .clouds import RawCloud, cloud_survey
from .columns import factor, parse_column
from .ring_arrays import RingArrays, clean_ranges
from .rings import Statements, is_ring_table, ring_survey, rings_from_arrays
from .tables import Rows

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

_CLOUDS = ("points", "xyz", "cloud")
_WIDEST = 8
_DAMAGE = (ValueError, OSError, EOFError, KeyError, SyntaxError, tokenize.TokenError, zipfile.BadZipFile, zlib.error)
"""What numpy raises on damaged files."""


def read_numpy(path: Path, options: ReadOptions, statements: Statements | None = None) -> Survey:
    """Read a cloud into `/points`, or rings into `/rings`.

    A cloud is an array (point, 3 or more) whose first columns are x, y, z, or a record array with these fields; in an
    NPZ it is called points, xyz or cloud, or stands as three arrays x, y, z. Rings are the arrays of an NPZ
    `distance_m` (ring,) and `range_m` (ring, reading), with `time_s` (ring,) and `bearing_deg` (reading,) if known;
    readings are at equal bearings otherwise. Or they are the columns of a ring table, each an array of its own, as
    `distance_m, r_0 ... r_n`.

    Raises:
        FormatError: Damaged, or the arrays are neither of these.
        InputError: As `clouds.cloud_survey` and `rings.ring_survey`.
    """
    try:
        loaded = np.load(path, allow_pickle=False)
        arrays = {"points": loaded} if isinstance(loaded, np.ndarray) else {name: loaded[name] for name in loaded.files}
    except _DAMAGE as error:
        raise FormatError(f"cut short or damaged: {error}", where=path, mend="copy or save it again") from None
    columns = all(array.ndim == 1 for array in arrays.values()) and not {"x", "y", "z"} <= set(arrays)
    if columns and is_ring_table(tuple(arrays)):
        return ring_survey(_columns(arrays, path), options, statements)
    by_quantity = {parse_column(name).quantity: name for name in arrays}
    if "distance" in by_quantity and {"range", "ranges"} & set(by_quantity):
        return _rings(arrays, path, options, statements)
    return cloud_survey(RawCloud(_cloud(arrays, path), axes=CAMERA), path, options)


@dataclass(frozen=True)
class _ArrayTable:
    path: Path
    names: tuple[str, ...]
    values: np.ndarray

    def blocks(self) -> Iterator[Rows]:
        """Yield the table's numbers; rows count from 1."""
        yield Rows(np.arange(1, len(self.values) + 1), self.values)


def _columns(arrays: dict[str, np.ndarray], path: Path) -> _ArrayTable:
    first, *others = arrays
    for name, array in arrays.items():
        if array.dtype.kind not in "fiu":
            raise InputError(f"it holds {array.dtype}", where=f"{path}, array {name}", expected="numbers")
    for name in others:
        if arrays[name].shape != arrays[first].shape:
            raise FormatError(
                f"'{first}' has {arrays[first].size} values and '{name}' {arrays[name].size}",
                where=path,
                expected="columns of one length",
            )
    return _ArrayTable(path, tuple(arrays), np.column_stack([*arrays.values()]).astype(np.float64))


def _cloud(arrays: dict[str, np.ndarray], path: Path) -> np.ndarray:
    name = next((n for n in _CLOUDS if n in arrays), None)
    if name is None and {"x", "y", "z"} <= set(arrays):
        parts = [np.ravel(arrays[axis]) for axis in "xyz"]
        if len({p.size for p in parts}) == 1:
            return np.column_stack(parts).astype(np.float64)
    if name is None:
        raise FormatError(
            f"the arrays {', '.join(arrays)} are neither a cloud nor rings",
            where=path,
            expected="points (n, 3), or x, y, z, or distance_m and range_m",
        )
    array = arrays[name]
    if array.dtype.names and {"x", "y", "z"} <= set(array.dtype.names):
        return np.column_stack([np.ravel(array[axis]) for axis in "xyz"]).astype(np.float64)
    if array.ndim == 3 and array.shape[2] >= 3:
        array = array.reshape(-1, array.shape[2])
    if array.ndim != 2 or not 3 <= array.shape[1] <= _WIDEST or array.dtype.kind not in "fiu":
        raise FormatError(
            f"the array '{name}' has shape {array.shape} and type {array.dtype}",
            where=path,
            expected=f"numbers of shape (n, 3) to (n, {_WIDEST})",
        )
    return array[:, :3].astype(np.float64)


def _rings(arrays: dict[str, np.ndarray], path: Path, options: ReadOptions, statements: Statements | None) -> Survey:
    columns = {c.quantity: c for c in (parse_column(n.replace("ranges", "range")) for n in arrays)}
    named = {parse_column(n.replace("ranges", "range")).quantity: a for n, a in arrays.items()}
    ranges, distance = np.array(named["range"], np.float64), np.asarray(named["distance"], np.float64)
    if ranges.ndim != 2 or distance.shape != ranges.shape[:1]:
        raise FormatError(
            f"distance has shape {distance.shape}, range {ranges.shape}",
            where=path,
            expected="(ring,) and (ring, reading)",
        )
    rows = np.arange(1, len(distance) + 1)
    zeros = clean_ranges(ranges, rows, [f"{k}" for k in range(ranges.shape[1])], path)
    angle = 2 * pi * np.arange(ranges.shape[1]) / ranges.shape[1]
    if "bearing" in named:
        column = columns["bearing"]
        if column.unit is None or named["bearing"].shape != angle.shape:
            raise InputError(
                f"the array '{column.name}' has shape {named['bearing'].shape} and states "
                f"{'no unit' if column.unit is None else column.unit}",
                where=path,
                expected=f"bearing_deg or bearing_rad of shape {angle.shape}",
            )
        angle = np.asarray(named["bearing"], np.float64) * factor(column) % (2 * pi)
    time = None
    if "time" in named:
        time = np.asarray(named["time"], np.float64)
        if time.shape != distance.shape:
            raise FormatError(f"time has shape {time.shape}", where=path, expected=f"{distance.shape}")
    rings = RingArrays(distance, ranges.astype(np.float32), angle, rows, time, zeros)
    return rings_from_arrays(rings, list(columns.values()), path, options, statements or Statements())
