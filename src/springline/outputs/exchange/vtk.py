"""The wall for ParaView and other readers of VTK: an unstructured grid of triangles in XML (`.vtu`)."""

from __future__ import annotations

import base64
import struct
import xml.etree.ElementTree as ET
import zlib
from typing import TYPE_CHECKING

import numpy as np

from ...io.trees import document
from ..colours import nice_limit
from ..mesh import surface
from .meshes import wall_of

if TYPE_CHECKING:
    from pathlib import Path

    from ...survey import Survey

_TYPES = {"<f4": "Float32", "<f8": "Float64", "<i4": "Int32", "<i8": "Int64", "|u1": "UInt8"}
_TRIANGLE = 5


def write_vtu(survey: Survey, path: Path) -> None:
    """Write the wall [m], x along the pipe, y up to the crown, z to the right, as `.vtu`.

    Point data: `chainage_m`, `departure_mm` from the mean circle and `residual_mm` from the fitted section, outward
    positive.
    """
    wall = wall_of(survey)
    position, _, triangles = surface(wall, nice_limit(wall.shape))
    seen = np.isfinite(wall.shape)
    data = {
        "chainage_m": position[:, 0].astype("<f4"),
        "departure_mm": (wall.shape[seen] * 1e3).astype("<f4"),
        "residual_mm": (wall.surface[seen] * 1e3).astype("<f4"),
    }
    root = ET.Element(
        "VTKFile",
        {
            "type": "UnstructuredGrid",
            "version": "1.0",
            "byte_order": "LittleEndian",
            "header_type": "UInt64",
            "compressor": "vtkZLibDataCompressor",
        },
    )
    piece = ET.SubElement(
        ET.SubElement(root, "UnstructuredGrid"),
        "Piece",
        {"NumberOfPoints": str(len(position)), "NumberOfCells": str(len(triangles))},
    )
    _array(ET.SubElement(piece, "Points"), "Points", position.astype("<f4"))
    cells = ET.SubElement(piece, "Cells")
    _array(cells, "connectivity", triangles.astype("<i8").ravel())
    _array(cells, "offsets", 3 * np.arange(1, len(triangles) + 1, dtype="<i8"))
    _array(cells, "types", np.full(len(triangles), _TRIANGLE, "|u1"))
    values = ET.SubElement(piece, "PointData", {"Scalars": "departure_mm"})
    for name, array in data.items():
        _array(values, name, array)
    path.write_bytes(document(root))


def _array(parent: ET.Element, name: str, values: np.ndarray) -> None:
    raw = np.ascontiguousarray(values).tobytes()
    attributes = {"type": _TYPES[values.dtype.str], "Name": name, "format": "binary"}
    if values.ndim == 2:
        attributes["NumberOfComponents"] = str(values.shape[1])
    element = ET.SubElement(parent, "DataArray", attributes)
    packed = zlib.compress(raw, 6)
    # One block, none of it partial: how many, how long, the length of a partial one, how long when packed.
    header = struct.pack("<4Q", 1, len(raw), 0, len(packed))
    element.text = (base64.b64encode(header) + base64.b64encode(packed)).decode()
