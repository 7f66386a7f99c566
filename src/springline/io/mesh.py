"""OBJ and STL: the vertices of meshes, taken as a cloud."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError
from .axes import CAMERA
from .clouds import RawCloud, cloud_survey, to_float
from .tables import parse_numbers

if TYPE_CHECKING:
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


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
    return _tagged_lines(path, b"v")


def _stl(path: Path, head: bytes) -> np.ndarray:
    """Return the corners of all triangles, each once."""
    size = path.stat().st_size
    promised = int.from_bytes(head[80:84].ljust(4, b"\0"), "little")
    if head.lstrip().startswith(b"solid") and size != 84 + 50 * promised:
        with path.open("rb") as stream:
            stream.seek(max(0, size - 256))
            if b"endsolid" not in stream.read():
                raise FormatError("the file is cut short: 'endsolid' is not there", where=path, mend="export it again")
        return np.unique(_tagged_lines(path, b"vertex"), axis=0)
    if size < 84 + 50 * promised or promised == 0:
        raise FormatError(
            f"the file is cut short: {max(0, size - 84) // 50} of {promised} triangles are there",
            where=path,
            mend="copy or export it again",
        )
    corners = np.fromfile(path, _TRIANGLE, promised, offset=84)["corners"].reshape(-1, 3)
    return np.unique(to_float(corners), axis=0)


def _tagged_lines(path: Path, tag: bytes) -> np.ndarray:
    """Return x, y, z of the lines that begin with a tag."""
    lines = [line.strip() for line in path.read_bytes().split(b"\n")]
    rows = [i for i, line in enumerate(lines) if line.split(maxsplit=1)[:1] == [tag]]
    if not rows:
        raise FormatError("there is no vertex in it", where=path, expected=f"lines of '{tag.decode()} x y z'")
    width = len(lines[rows[0]].split()) - 1
    if width < 3:
        raise FormatError("a vertex has fewer than 3 coordinates", where=f"{path}, row {rows[0] + 1}")
    # Other lines are emptied, not dropped, so that a fault is named by its row.
    kept = set(rows)
    block = b"\n".join(line[len(tag) :] if i in kept else b"" for i, line in enumerate(lines)) + b"\n"
    names = ["x", "y", "z", *(str(k) for k in range(4, width + 1))]
    return parse_numbers(block, delimiter=" ", names=names, where=path, first_row=1).values[:, :3]
