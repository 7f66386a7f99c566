"""OBJ and STL: the vertices of meshes, taken as a cloud."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError
from .axes import CAMERA
from .clouds import RawCloud, cloud_survey
from .tables import parse_numbers

if TYPE_CHECKING:
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions


def read_mesh(path: Path, options: ReadOptions) -> Survey:
    """Read the vertices of an OBJ or STL file into `/points`; the axes are taken as a camera's unless stated.

    Raises:
        FormatError: There is no vertex, or the file is cut short.
    """
    with path.open("rb") as stream:
        head = stream.read(84)
    solid = head.lstrip().startswith(b"solid") or path.suffix.lower() == ".stl" or b"\0" in head
    xyz = _stl(path, head) if solid else _obj(path)
    note = f"{path.name}: the mesh's vertices are taken as the cloud; its faces are not used."
    return cloud_survey(RawCloud(xyz, axes=CAMERA, notes=(note,)), path, options)


def _obj(path: Path) -> np.ndarray:
    lines = path.read_bytes().splitlines()
    rows = [i for i, line in enumerate(lines) if line[:2] in (b"v ", b"v\t")]
    if not rows:
        raise FormatError("there is no vertex in it", where=path, expected="lines of 'v x y z'")
    width = len(lines[rows[0]].split()) - 1
    if width < 3:
        raise FormatError("a vertex has fewer than 3 coordinates", where=f"{path}, row {rows[0] + 1}")
    # Other lines are emptied, not dropped, so that a fault is named by its row.
    kept = dict.fromkeys(rows)
    block = b"\n".join(line[2:] if i in kept else b"" for i, line in enumerate(lines)) + b"\n"
    names = ("x", "y", "z", "4", "5", "6", "7")[:width]
    return parse_numbers(block, delimiter=" ", names=names, where=path, first_row=1).values[:, :3]


def _stl(path: Path, head: bytes) -> np.ndarray:
    import trimesh

    size = path.stat().st_size
    promised = int.from_bytes(head[80:84].ljust(4, b"\0"), "little")
    text = head.lstrip().startswith(b"solid") and size != 84 + 50 * promised
    if not text and size < 84 + 50 * promised:
        raise FormatError(
            f"the file is cut short: {max(0, size - 84) // 50} of {promised} triangles are there",
            where=path,
            mend="copy or export it again",
        )
    if text and b"endsolid" not in path.read_bytes()[-256:]:
        raise FormatError("the file is cut short: 'endsolid' is not there", where=path, mend="copy or export it again")
    try:
        mesh = trimesh.load_mesh(path, file_type="stl")
    except (ValueError, IndexError, KeyError) as error:
        raise FormatError(f"not an STL mesh: {error}", where=path) from None
    return np.asarray(mesh.vertices, np.float64)
