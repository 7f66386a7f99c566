"""The pipe's wall as a mesh in binary glTF 2.0, coloured by its departures or with the frames laid on it.

glTF is right-handed with y up, as the pipe frame is, so the axes are the same: x along the pipe in the direction of
travel (the chainage), y up to the crown, z to the right; metres. The pipe is drawn straight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .colours import levels, nice_limit, scale_colours
from .gltf import Gltf
from .png import rgb_png

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from .photo import Photo
    from .unroll import Unrolled

_VERTICES = 600_000
_PICTURE = 4096  # pixels of a picture along the pipe, what every reader takes
_PIXELS = 6_000_000


def write_glb(wall: Unrolled, path: Path, *, name: str, vertices: int = _VERTICES) -> None:
    """Write the wall as `.glb`, with its frames on it or coloured by its departures; what was not measured is a hole.

    About 40 bytes a vertex, 24 MB at most by default, whatever the length of the survey; pictures add about 12 MB.

    Args:
        wall: The unrolled wall; where it has a photo, that colours it, grey where no frame reaches.
        path: Where to write.
        name: Name of the mesh, such as the asset's.
        vertices: Largest number of cells that become vertices; neighbouring groups are joined to stay below it.
    """
    photo, wall = wall.photo, joined(wall, vertices)
    limit = nice_limit(wall.shape)
    shown = "frames of the survey, the lamp's fall of light taken away; grey where none reaches"
    departure = (
        f"departure from a circle of {wall.circle_diameter * 1e3:.2f} mm: red-brown {-limit * 1e3:g} mm (inward), "
        f"pale 0, blue {limit * 1e3:g} mm (outward)"
    )
    axes = "x along the pipe in the direction of travel, y up to the crown, z to the right"
    file = Gltf(name, {"unit": "m", "axes": axes, "colour": departure if photo is None else shown})
    if photo is None:
        position, colour, triangles = surface(wall, limit)
        file.add(position, triangles, colour=colour)
    else:
        for position, triangles, places, picture in _photographed(wall, photo.at_most(_PIXELS)):
            file.add(position, triangles, picture=(places, picture))
    path.write_bytes(file.content())


def joined(wall: Unrolled, vertices: int) -> Unrolled:
    """Return the wall with neighbouring groups joined until at most about so many cells remain."""
    step = -(-wall.shape.size // vertices)
    if step == 1:
        return wall
    # Edges at whole groups, and at both sides of every gap.
    gap = np.flatnonzero(wall.start[1:] > wall.end[:-1] + 1e-9)
    edges = np.unique(np.concatenate((wall.start[::step], wall.end[-1:], wall.end[gap], wall.start[gap + 1])))
    return wall.columns(edges)


def surface(wall: Unrolled, limit: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return vertices (n, 3) [m], their linear colours (n, 4) uint8, and triangles (m, 3) facing outward."""
    seen = np.isfinite(wall.shape)
    number = np.cumsum(seen).reshape(seen.shape).astype(np.uint32) - 1
    # the last bearing is followed by the first
    number = np.concatenate([number, number[:, :1]], axis=1)
    triangles = _triangles(np.concatenate([seen, seen[:, :1]], axis=1), number, _touching(wall))
    colour = np.full((int(seen.sum()), 4), 255, np.uint8)
    colour[:, :3] = _linear(scale_colours())[levels(wall.shape[seen], limit)]
    return _grid(wall, wall.bearing, wall.shape)[seen], colour, triangles


def _photographed(wall: Unrolled, photo: Photo) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, bytes]]:
    """Yield vertices, triangles, places in the picture, and the picture (PNG) of each stretch of wall."""
    middle, touching = (wall.start + wall.end) / 2, _touching(wall)
    # a picture ends at a group, where the next one takes over
    step = photo.cell * _PICTURE
    stretch = np.floor((middle - middle[0]) / step).astype(int)
    for first in np.flatnonzero(np.diff(stretch, prepend=-1)):
        last = min(int(np.searchsorted(stretch, stretch[first], "right")), middle.size - 1)
        rows = slice(int(first), last + 1)
        # the seam stands twice, at both ends of the picture
        shape = np.concatenate([wall.shape[rows], wall.shape[rows, :1]], axis=1)
        bearing = np.append(wall.bearing, 2 * np.pi)
        seen = np.isfinite(shape)
        number = np.cumsum(seen).reshape(seen.shape).astype(np.uint32) - 1
        triangles = _triangles(seen, number, touching[first:last])
        low, high, picture = photo.piece(middle[first], middle[last])
        along = np.broadcast_to(((middle[rows] - low) / (high - low))[:, None], shape.shape)
        around = np.broadcast_to((bearing - photo.bearing) / (2 * np.pi) + 0.5 / picture.shape[0], shape.shape)
        places = np.stack([along[seen], around[seen]], axis=-1).astype(np.float32)
        yield _grid(wall, bearing, shape, rows)[seen], triangles, places, rgb_png(picture)


def _touching(wall: Unrolled) -> np.ndarray:
    """Whether each group of stations is followed by the next without a gap."""
    return wall.start[1:] <= wall.end[:-1] + 1e-9


def _grid(wall: Unrolled, bearing: np.ndarray, shape: np.ndarray, rows: slice = slice(None)) -> np.ndarray:
    radius = wall.circle_diameter / 2 + shape
    grid = np.empty((*shape.shape, 3), np.float32)
    grid[..., 0] = ((wall.start + wall.end) / 2)[rows, None]
    grid[..., 1] = radius * np.sin(bearing)
    grid[..., 2] = radius * np.cos(bearing)
    return grid


def _triangles(seen: np.ndarray, number: np.ndarray, touching: np.ndarray) -> np.ndarray:
    """Return triangles (m, 3) between vertices that are seen, from each bearing to the next in the list."""
    here, there = slice(None, -1), slice(1, None)
    first = seen[here, :-1] & seen[there, :-1] & seen[here, 1:] & touching[:, None]
    second = seen[here, 1:] & seen[there, :-1] & seen[there, 1:] & touching[:, None]
    a, b, c, d = number[here, :-1], number[there, :-1], number[here, 1:], number[there, 1:]
    return np.concatenate(
        (np.stack([a[first], b[first], c[first]], axis=1), np.stack([c[second], b[second], d[second]], axis=1))
    )


def _linear(srgb: np.ndarray) -> np.ndarray:
    """Return sRGB colours as the linear ones that glTF asks of vertices (IEC 61966-2-1)."""
    share = srgb / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return np.rint(linear * 255.0).astype(np.uint8)
