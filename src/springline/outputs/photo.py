"""What frames show of the wall, as pictures: chainage to the right, bearing downwards from 0."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..survey import Survey

UNSEEN = (118, 118, 118)
"""Colour of wall that no frame shows, red, green and blue."""


@dataclass(frozen=True)
class Photo:
    """The wall's colours, cells by chainage and bearing.

    Attributes:
        start: Chainage where the first row begins [m].
        cell: Length of a row [m].
        bearing: Of the first column's middle [rad]; the columns are equal and go all round.
        colour: (rows, columns, 3) red, green and blue, `UNSEEN` where no frame reaches, uint8.
        seen: (rows, columns) share of the cell that a frame shows, float32.
    """

    start: float
    cell: float
    bearing: float
    colour: np.ndarray
    seen: np.ndarray

    def at_most(self, pixels: int) -> Photo:
        """Return the same with at most about so many cells: neighbours averaged."""
        step = int(np.ceil(np.sqrt(self.seen.size / pixels)))
        return self if step <= 1 else self._averaged(step, step)

    def columns(self, edges: np.ndarray) -> Photo:
        """Return the same in rows between chainage `edges` [m], equally spaced; unseen beyond what was surveyed."""
        first = (edges[:-1] - self.start) / self.cell
        wide = float(edges[1] - edges[0]) / self.cell
        photo = self._averaged(int(wide), 1) if wide >= 2 else self
        row = np.floor((first + 0.5 * wide) * (self.cell / photo.cell)).astype(int)
        there = (row >= 0) & (row < len(photo.seen))
        colour = np.full((len(row), *photo.colour.shape[1:]), UNSEEN, np.uint8)
        seen = np.zeros((len(row), photo.seen.shape[1]), np.float32)
        colour[there], seen[there] = photo.colour[row[there]], photo.seen[row[there]]
        return Photo(float(edges[0]), float(edges[1] - edges[0]), photo.bearing, colour, seen)

    def piece(self, low: float, high: float) -> tuple[float, float, np.ndarray]:
        """Return where a picture of the wall between two chainages [m] begins and ends, and its pixels.

        It begins at or before `low` and ends at or after `high`; what was not surveyed is unseen.
        """
        first = int(np.floor((low - self.start) / self.cell))
        last = max(int(np.ceil((high - self.start) / self.cell)), first + 1)
        picture = np.full((last - first, *self.colour.shape[1:]), UNSEEN, np.uint8)
        a, b = max(first, 0), min(last, len(self.colour))
        if b > a:
            picture[a - first : b - first] = self.colour[a:b]
        ends = (self.start + first * self.cell, self.start + last * self.cell)
        return *ends, np.ascontiguousarray(picture.transpose(1, 0, 2))

    def _averaged(self, along: int, around: int) -> Photo:
        """Join cells; last rows that fill no cell are dropped, and as many bearings are joined as go into the whole."""
        around = max(k for k in range(1, around + 1) if self.seen.shape[1] % k == 0)
        rows = max(len(self.seen) // along, 1)
        along = min(along, len(self.seen))

        def joined(values: np.ndarray) -> np.ndarray:
            cut = values[: rows * along]
            return cut.reshape(rows, along, cut.shape[1] // around, around, *cut.shape[2:]).mean(
                axis=(1, 3), dtype=np.float32
            )

        seen = joined(self.seen)
        weighted = joined(self.colour * self.seen[..., None])
        colour = np.where(seen[..., None] > 0, weighted / np.maximum(seen, 1e-9)[..., None], UNSEEN)
        first = self.bearing + (around - 1) * np.pi / self.seen.shape[1]
        return Photo(self.start, self.cell * along, first, np.rint(colour).astype(np.uint8), seen)


def photo_of(survey: Survey) -> Photo | None:
    """Return what the frames of a finished survey show of its wall; None when it has none."""
    if not survey.has("texture"):
        return None
    texture = survey.texture
    seen = texture["seen"].values > 0
    colour = np.where(seen[..., None], texture["colour"].values, np.array(UNSEEN, np.uint8))
    cell = float(texture.attrs["cell"])
    first = float(texture["bearing"].values[0])
    return Photo(float(texture["chainage"].values[0]) - 0.5 * cell, cell, first, colour, seen.astype(np.float32))
