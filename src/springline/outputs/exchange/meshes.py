"""The wall as a mesh: glTF, OBJ and PLY; metres, x along the pipe, y up to the crown, z to the right."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError
from ..colours import nice_limit
from ..mesh import joined, surface, write_glb
from ..results import Results
from ..unroll import unroll

if TYPE_CHECKING:
    from pathlib import Path

    from ...survey import Survey
    from ..unroll import Unrolled

_VERTICES = 600_000


def wall_of(survey: Survey, vertices: int = _VERTICES) -> Unrolled:
    """Return the wall of a finished survey with at most about so many cells.

    Raises:
        InputError: No wall was seen.
    """
    wall = joined(unroll(Results(survey)), vertices)
    if not np.isfinite(wall.shape).any():
        raise InputError("no wall was seen, so that there is no mesh", where=str(survey.attrs.get("name", "survey")))
    return wall


def write_gltf(survey: Survey, path: Path) -> None:
    """Write the wall as `.glb`."""
    write_glb(unroll(Results(survey)), path, name=str(survey.attrs.get("name") or "pipe"))


def write_obj(survey: Survey, path: Path) -> None:
    """Write the wall as OBJ; colours follow the coordinates of each vertex, linear, 0 to 1."""
    wall = wall_of(survey)
    position, colour, triangles = surface(wall, nice_limit(wall.shape))
    vertices = np.column_stack([position, colour[:, :3] / 255.0])
    with path.open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(f"# {_line(survey)}\n# metres; x along the pipe, y up to the crown, z to the right\n")
        np.savetxt(stream, vertices, fmt="v %.5f %.5f %.5f %.3f %.3f %.3f")
        np.savetxt(stream, triangles.astype(np.int64) + 1, fmt="f %d %d %d")


def write_ply_mesh(survey: Survey, path: Path) -> None:
    """Write the wall as binary PLY: vertices with colour and departure from the circle [m], and triangles."""
    wall = wall_of(survey)
    position, colour, triangles = surface(wall, nice_limit(wall.shape))
    seen = np.isfinite(wall.shape)
    vertex = np.empty(len(position), [
        ("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("red", "u1"), ("green", "u1"), ("blue", "u1"), ("departure", "<f4"),
    ])  # fmt: skip
    for k, name in enumerate("xyz"):
        vertex[name] = position[:, k]
    for k, name in enumerate(("red", "green", "blue")):
        vertex[name] = colour[:, k]
    vertex["departure"] = wall.shape[seen]
    face = np.empty(len(triangles), [("count", "u1"), ("vertices", "<i4", 3)])
    face["count"], face["vertices"] = 3, triangles
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"comment {_line(survey)}\n"
        "comment metres; x along the pipe, y up to the crown, z to the right; departure from a circle of "
        f"{wall.circle_diameter:.5f} m, outward positive\n"
        f"element vertex {len(vertex)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float departure\n"
        f"element face {len(face)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode("utf-8") + vertex.tobytes() + face.tobytes())


def _line(survey: Survey) -> str:
    """Return the asset's name on one line of letters that any reader takes."""
    name = " ".join(str(survey.attrs.get("name") or "pipe").split())
    return name.encode("ascii", "replace").decode()
