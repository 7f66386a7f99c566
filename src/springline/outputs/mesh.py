"""The pipe's wall as a coloured mesh in binary glTF 2.0.

glTF is right-handed with y up, as the pipe frame is, so the axes are the same: x along the pipe in the direction of
travel (the chainage), y up to the crown, z to the right; metres. The pipe is drawn straight.
"""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING

import numpy as np

from .. import __version__
from .colours import levels, nice_limit, scale_colours

if TYPE_CHECKING:
    from pathlib import Path

    from .unroll import Unrolled

_VERTICES = 600_000
_FLOAT, _UBYTE, _UINT = 5126, 5121, 5125


def write_glb(wall: Unrolled, path: Path, *, name: str, vertices: int = _VERTICES) -> None:
    """Write the wall as `.glb`, coloured by its departure from a circle; what was not seen stays a hole.

    About 40 bytes a vertex: 24 MB at most by default, whatever the length of the survey.

    Args:
        wall: The unrolled wall.
        path: Where to write.
        name: Name of the mesh, such as the asset's.
        vertices: Largest number of cells that become vertices; neighbouring groups are joined to stay below it.
    """
    wall = joined(wall, vertices)
    limit = nice_limit(wall.shape)
    position, colour, triangles = surface(wall, limit)
    path.write_bytes(_glb(position, colour, triangles, name, limit, wall.circle_diameter))


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
    radius = wall.circle_diameter / 2 + wall.shape
    grid = np.empty((*wall.shape.shape, 3), np.float32)
    grid[..., 0] = ((wall.start + wall.end) / 2)[:, None]
    grid[..., 1] = radius * np.sin(wall.bearing)
    grid[..., 2] = radius * np.cos(wall.bearing)
    number = np.cumsum(seen).reshape(seen.shape).astype(np.uint32) - 1
    joined = wall.start[1:] <= wall.end[:-1] + 1e-9
    here, there = slice(None, -1), slice(1, None)
    around = np.roll(seen, -1, axis=1)
    next_number = np.roll(number, -1, axis=1)
    first = seen[here] & seen[there] & around[here] & joined[:, None]
    second = around[here] & seen[there] & around[there] & joined[:, None]
    triangles = np.concatenate(
        (
            np.stack([number[here][first], number[there][first], next_number[here][first]], axis=1),
            np.stack([next_number[here][second], number[there][second], next_number[there][second]], axis=1),
        )
    )
    colour = np.full((int(seen.sum()), 4), 255, np.uint8)
    colour[:, :3] = _linear(scale_colours())[levels(wall.shape[seen], limit)]
    return grid[seen], colour, triangles


def _linear(srgb: np.ndarray) -> np.ndarray:
    """Return sRGB colours as the linear ones that glTF asks of vertices (IEC 61966-2-1)."""
    share = srgb / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return np.rint(linear * 255.0).astype(np.uint8)


def _glb(
    position: np.ndarray, colour: np.ndarray, triangles: np.ndarray, name: str, limit: float, diameter: float
) -> bytes:
    parts = (position.tobytes(), colour.tobytes(), triangles.tobytes())
    sizes = [len(part) for part in parts]
    extras = {
        "unit": "m",
        "axes": "x along the pipe in the direction of travel, y up to the crown, z to the right",
        "colour": f"departure from a circle of {diameter * 1e3:.2f} mm: red-brown {-limit * 1e3:g} mm (inward), "
        f"pale 0, blue {limit * 1e3:g} mm (outward)",
    }
    document = {
        "asset": {"version": "2.0", "generator": f"Springline {__version__}", "extras": extras},
        "scene": 0,
        "scenes": [{"nodes": [0] if len(position) else []}],
        "nodes": [{"mesh": 0, "name": name}],
        "meshes": [
            {
                "name": name,
                "primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0}],
            }
        ],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}}],
        "buffers": [{"byteLength": sum(sizes)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": sum(sizes[:k]), "byteLength": sizes[k], "target": target}
            for k, target in enumerate((34962, 34962, 34963))
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": _FLOAT,
                "count": len(position),
                "type": "VEC3",
                "min": position.min(axis=0).tolist() if len(position) else [0, 0, 0],
                "max": position.max(axis=0).tolist() if len(position) else [0, 0, 0],
            },
            {"bufferView": 1, "componentType": _UBYTE, "normalized": True, "count": len(colour), "type": "VEC4"},
            {"bufferView": 2, "componentType": _UINT, "count": triangles.size, "type": "SCALAR"},
        ],
    }
    if not triangles.size:
        # glTF allows no empty buffer: without a wall the scene is empty.
        for key in ("nodes", "meshes", "materials", "buffers", "bufferViews", "accessors"):
            del document[key]
        document["scenes"] = [{"name": "no wall was seen"}]
        parts, sizes = (), []
    text = json.dumps(document, ensure_ascii=True, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if parts:
        chunks += struct.pack("<II", sum(sizes), 0x004E4942) + b"".join(parts)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
