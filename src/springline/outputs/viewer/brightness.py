"""How bright each cell of the wall is, by the returned intensity or as frames show it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..photo import Photo
    from ..unroll import Unrolled

_SHADES = 40
GREYS = [[25 + 5 * n] * 3 for n in range(_SHADES)]
"""Shades from dark to bright."""
_LUMA = (0.299, 0.587, 0.114)
"""Weights of red, green and blue in the brightness of a colour (ITU-R BT.601)."""


@dataclass(frozen=True)
class Brightness:
    """What the wall's cells are shaded by.

    Attributes:
        name: What it is, for people.
        cells: (groups, rows) from 1 (dark) to 255 (bright), 0 where there is none, uint8.
        shades: Colours from dark to bright, each red, green and blue.
    """

    name: str
    cells: np.ndarray
    shades: list[list[int]]


def brightness_of(wall: Unrolled) -> Brightness | None:
    """Return the shades of the wall by its photo, else by its returned intensity; None when it has neither.

    A photo's shades are its own colours, each the mean of what is as bright.
    """
    if wall.photo is not None:
        colour = _on_cells(wall, wall.photo)
        cells = _levels(colour @ np.array(_LUMA, np.float32))
        return Brightness("Photograph", cells, _own_colours(colour, cells))
    if wall.intensity is not None:
        return Brightness("Returned intensity", _levels(wall.intensity), GREYS)
    return None


def _levels(values: np.ndarray) -> np.ndarray:
    """Return values as bytes from 1 (dark) to 255 (bright), outer hundredths cut off; 0 where there is none."""
    known = np.isfinite(values)
    low, high = np.quantile(values[known], [0.01, 0.99]) if known.any() else (0.0, 1.0)
    share = np.clip((np.nan_to_num(values) - low) / max(high - low, 1e-9), 0.0, 1.0)
    return np.where(known, np.rint(1 + 254 * share), 0).astype(np.uint8)


def _on_cells(wall: Unrolled, photo: Photo) -> np.ndarray:
    """Return the photo's mean colour in each cell of the wall (groups, rows, 3), NaN where no frame shows it."""
    rows, columns = photo.seen.shape
    place = photo.start + photo.cell * (np.arange(rows) + 0.5)
    group = np.clip(np.searchsorted(wall.start, place, "right") - 1, 0, wall.start.size - 1)
    inside = (place >= wall.start[group]) & (place <= wall.end[group])
    turn = (photo.bearing + np.arange(columns) * (2 * np.pi / columns)) * wall.bearing.size / (2 * np.pi)
    row = np.rint(turn).astype(int) % wall.bearing.size
    cell = group[inside, None] * wall.bearing.size + row
    size = wall.start.size * wall.bearing.size
    seen = photo.seen[inside]
    weight = np.bincount(cell.ravel(), seen.ravel(), size)
    out = np.full((size, 3), np.nan, np.float32)
    for k in range(3):
        total = np.bincount(cell.ravel(), (photo.colour[inside, :, k] * seen).ravel(), size)
        np.divide(total, weight, out=out[:, k], where=weight > 0, casting="same_kind")
    # a group shorter than a row of the photo takes the row that it lies in
    out = out.reshape(wall.start.size, wall.bearing.size, 3)
    short = np.flatnonzero(~np.isin(np.arange(wall.start.size), group[inside]))
    at = np.floor(((wall.start + wall.end)[short] / 2 - photo.start) / photo.cell).astype(int)
    short, at = short[(at >= 0) & (at < rows)], at[(at >= 0) & (at < rows)]
    column = np.rint((wall.bearing - photo.bearing) * columns / (2 * np.pi)).astype(int) % columns
    filled = photo.colour[at][:, column].astype(np.float32)
    filled[photo.seen[at][:, column] == 0] = np.nan
    out[short] = filled
    return out


def _own_colours(colour: np.ndarray, cells: np.ndarray) -> list[list[int]]:
    shade = np.rint((cells[cells > 0].astype(float) - 1.0) / 254.0 * (_SHADES - 1)).astype(int)
    count = np.bincount(shade, minlength=_SHADES)
    known = count > 0
    if not known.any():
        return GREYS
    means = [np.bincount(shade, colour[cells > 0][:, k], _SHADES)[known] / count[known] for k in range(3)]
    steps = np.arange(_SHADES)
    return np.rint([np.interp(steps, steps[known], mean) for mean in means]).astype(int).T.tolist()
