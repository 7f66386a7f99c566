"""The wall unrolled: departure from a circle and from the fitted section, by chainage and bearing about the axis.

One pass over the rings feeds mesh, report and viewer. Where several readings share a cell the one furthest from the
fitted section stays, so that no resampling hides a dent. A cell without a used reading stays empty, with the reason.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ..conventions import MASK_REASONS
from .photo import photo_of

if TYPE_CHECKING:
    from .photo import Photo
    from .results import Results, RingBlock

NO_SECTION = 7
"""Reason beyond those of the mask: the reading is good, but its station has no section to stand on."""

REASONS = {**MASK_REASONS, NO_SECTION: "no_section"}
"""Why a cell shows a departure (0) or none."""

NO_STATION = 255
"""Reason of a column that no station reaches."""

REASON_WORDS = {
    "used": "used",
    "no_return": "no return",
    "outlier": "outlier",
    "water": "water or sediment",
    "occluded": "occluded",
    "lateral": "lateral",
    "out_of_range": "out of range",
    "by_hand": "left out by hand",
    "no_section": "seen, but no section was fitted",
    "no_station": "no readings here",
}
"""Why a reading is used or not, for people."""

# Which reason speaks for a cell that holds several.
_PRIORITY = (0, 5, 3, 8, NO_SECTION, 4, 2, 6, 1)
_ROWS = (12, 180)


@dataclass(frozen=True)
class Unrolled:
    """The unrolled wall, cells (group of stations, bearing about the axis).

    Attributes:
        start: Where each group starts [m].
        end: Where each group ends [m].
        bearing: Bearing about the axis of the cells' middles [rad].
        shape: Departure from the circle of `circle_diameter`, outward positive [m], float32; NaN = no used reading.
        surface: Departure from the fitted section, outward positive [m], float32.
        reason: Flags of `REASONS`, uint8.
        circle_diameter: Diameter of the circle [m].
        intensity: Mean returned intensity of the used readings, NaN = none; None when the survey has no intensity.
        photo: What frames show of the whole wall; None when the survey has no texture.
    """

    start: np.ndarray
    end: np.ndarray
    bearing: np.ndarray
    shape: np.ndarray
    surface: np.ndarray
    reason: np.ndarray
    circle_diameter: float
    intensity: np.ndarray | None = None
    photo: Photo | None = None

    def piece(self, low: float, high: float, columns: int, bearing: float, half: float) -> Unrolled:
        """Return a piece of the wall: `columns` between two chainages [m], bearings within `half` [rad] of one.

        Bearings run on past a full turn where the piece crosses 0.
        """
        near = (self.end > low) & (self.start < high)
        pick = {name: getattr(self, name)[near] for name in ("start", "end", "shape", "surface", "reason")}
        cut = replace(self, **pick).columns(np.linspace(low, high, columns + 1))
        step = 2 * pi / self.bearing.size
        reach = min(round(half / step), (self.bearing.size - 1) // 2)
        at = round(bearing / step) + np.arange(-reach, reach + 1)
        rows = at % self.bearing.size
        return replace(
            cut,
            bearing=at * step,
            shape=cut.shape[:, rows],
            surface=cut.surface[:, rows],
            reason=cut.reason[:, rows],
        )

    def columns(self, edges: np.ndarray) -> Unrolled:
        """Return the same wall on columns between chainage `edges` [m], for instance the pixels of a picture.

        Columns that no group reaches have the reason `NO_STATION`.
        """
        first = np.clip(np.searchsorted(edges, self.start, "right") - 1, 0, edges.size - 2)
        last = np.clip(np.searchsorted(edges, self.end, "left") - 1, first, edges.size - 2)
        counts = last - first + 1
        group = np.repeat(np.arange(first.size), counts)
        column = np.arange(group.size) - np.repeat(np.cumsum(counts) - counts - first, counts)
        order = np.argsort(column, kind="stable")
        group, column = group[order], column[order]
        reached, starts = np.unique(column, return_index=True)
        size = (edges.size - 1, self.bearing.size)
        shape, surface = np.full(size, np.nan, np.float32), np.full(size, np.nan, np.float32)
        reason = np.full(size, NO_STATION, np.uint8)
        rank = np.argsort(_PRIORITY).astype(np.uint8)
        stops = np.append(starts[1:], group.size)[: starts.size]
        for at, i, j in zip(reached.tolist(), starts.tolist(), stops.tolist(), strict=True):
            rows = group[i:j]
            furthest = np.argmax(np.nan_to_num(np.abs(self.surface[rows]), nan=-1.0), axis=0)[None]
            shape[at] = np.take_along_axis(self.shape[rows], furthest, 0)[0]
            surface[at] = np.take_along_axis(self.surface[rows], furthest, 0)[0]
            reason[at] = np.take(_PRIORITY, rank[self.reason[rows]].min(axis=0))
        return Unrolled(edges[:-1], edges[1:], self.bearing, shape, surface, reason, self.circle_diameter)


def unroll(results: Results, *, cells: int = 7_000_000) -> Unrolled:
    """Return the unrolled wall, with at most about `cells` cells.

    Bearings have half as many rows as a ring has readings, so that a sensor off the axis leaves no false hole, and 180
    at most.

    Args:
        results: The finished survey.
        cells: Largest number of cells; neighbouring stations are joined to stay below it.
    """
    rows = min(max(results.bearing.size // 2, _ROWS[0]), _ROWS[1])
    group = results.groups(max(cells // rows, 1))
    start, end = results.extents
    first = np.flatnonzero(np.diff(group, prepend=-1))
    last = np.append(first[1:], group.size) - 1
    size = first.size * rows
    furthest = np.zeros(size, np.uint64)
    seen = np.zeros(size, np.uint16)
    radius = results.circle_diameter / 2
    brightness = _Brightness(results, size) if "intensity" in results.survey.rings else None
    for block in results.blocks():
        at = group[results.station_of_ring[block.start : block.start + len(block.range)]]
        cell, used = _scatter(block, at, rows, results.bearing, radius, furthest, seen)
        if brightness is not None:
            brightness.add(block, cell, used)
    reason = np.full(size, 1, np.uint8)
    for flag in reversed(_PRIORITY):
        reason[(seen & (1 << flag)) > 0] = flag
    shape, surface = _unpack(furthest)
    shape[reason != 0] = surface[reason != 0] = np.nan
    grid = (first.size, rows)
    bearing = np.arange(rows) * (2 * pi / rows)
    return Unrolled(
        start[first],
        end[last],
        bearing,
        shape.reshape(grid),
        surface.reshape(grid),
        reason.reshape(grid),
        results.circle_diameter,
        None if brightness is None else brightness.mean().reshape(grid),
        photo_of(results.survey),
    )


class _Brightness:
    """Sums of the returned intensity of used readings by cell."""

    def __init__(self, results: Results, size: int) -> None:
        self._intensity = results.survey.rings["intensity"]
        self._sum, self._count = np.zeros(size, np.float32), np.zeros(size, np.float32)

    def add(self, block: RingBlock, cell: np.ndarray, used: np.ndarray) -> None:
        values = self._intensity[block.start : block.start + len(block.range)].values
        known = used & np.isfinite(values)
        np.add.at(self._sum, cell[known], values[known])
        np.add.at(self._count, cell[known], np.float32(1.0))

    def mean(self) -> np.ndarray:
        return np.divide(self._sum, self._count, out=np.full_like(self._sum, np.nan), where=self._count > 0)


def _pack(shape: np.ndarray, surface: np.ndarray) -> np.ndarray:
    """Return both departures as one integer that sorts by the size of `surface`.

    Positive floats sort as their bits do. The lowest bit of `surface` gives way to its sign.
    """
    bits = surface.astype(np.float32).view(np.uint32)
    key = (bits & np.uint32(0x7FFFFFFE)) | (bits >> np.uint32(31))
    return (key.astype(np.uint64) << np.uint64(32)) | shape.astype(np.float32).view(np.uint32)


def _unpack(packed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    key = (packed >> np.uint64(32)).astype(np.uint32)
    surface = ((key & np.uint32(0x7FFFFFFE)) | (key << np.uint32(31))).view(np.float32)
    return packed.astype(np.uint32).view(np.float32).copy(), surface.copy()


def _scatter(
    block: RingBlock,
    group: np.ndarray,
    rows: int,
    bearing: np.ndarray,
    radius: float,
    furthest: np.ndarray,
    seen: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """File the readings of a block; return the cell of each and whether it was used."""
    about, phi = block.about_centre(bearing)
    unplaced = np.where(np.isfinite(block.range), NO_SECTION, 1)
    reason = np.where((block.reason == 0) & ~np.isfinite(about), unplaced, block.reason)
    used = reason == 0
    # Every reading is filed where its ray meets the circle, so that neither a missing nor a short one leaves a gap.
    cy, cz = np.nan_to_num(block.centre_y), np.nan_to_num(block.centre_z)
    uy, uz = np.sin(bearing), np.cos(bearing)
    along = cy * uy + cz * uz
    ray = along + np.sqrt(np.maximum(radius**2 - cy**2 - cz**2 + along**2, 0.0))
    filed = np.arctan2(*block.in_pipe(ray * uy - cy, ray * uz - cz))
    cell = group[:, None] * rows + np.rint(filed * (rows / (2 * pi))).astype(np.int64) % rows
    surface = about - block.fitted(phi)
    np.maximum.at(furthest, cell[used], _pack((about - radius)[used], surface[used]))
    np.bitwise_or.at(seen, cell.ravel(), np.left_shift(1, reason).astype(np.uint16).ravel())
    return cell, used
