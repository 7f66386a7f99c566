"""PLY: polygon files with vertices, ascii or binary."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError
from .axes import CAMERA
from .cloud_export import points_of
from .clouds import RawCloud, cloud_survey, to_float
from .tables import parse_numbers

if TYPE_CHECKING:
    from ..survey import Survey
    from .options import ReadOptions

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_HEADER_LIMIT = 1 << 16
_STATEMENT = "springline metres, axes "
_ASSUMED = "springline assumed: "
_INTENSITY = ("intensity", "scalar_intensity", "reflectance", "scalar_reflectance")


@dataclass
class _Element:
    name: str
    count: int
    properties: list[tuple[str, str]] = field(default_factory=list)
    has_list: bool = False


@dataclass
class _Header:
    order: str
    elements: list[_Element]
    comments: list[str]
    size: int


def read_ply(path: Path, options: ReadOptions) -> Survey:
    """Read the vertices of a PLY file into `/points`.

    Unless the file was written by `write_ply`, its axes are taken as a camera's (y up, looking along -z) and its unit
    by `clouds.cloud_survey`.

    Raises:
        FormatError: The header is not PLY's, there are no x, y, z, or fewer vertices than the header promises.
    """
    data = path.read_bytes()
    header = _parse_header(data, path)
    vertices = _vertices(data, header, path)
    names = {name.lower(): name for name in vertices}
    missing = [axis for axis in "xyz" if axis not in names]
    if missing:
        raise FormatError(f"the vertices have no property {missing[0]}", where=path, expected="x, y and z")
    axes = next((c.removeprefix(_STATEMENT) for c in header.comments if c.startswith(_STATEMENT)), None)
    intensity = next((vertices[names[n]] for n in _INTENSITY if n in names), None)
    raw = RawCloud(
        np.column_stack([to_float(vertices[names[axis]]) for axis in "xyz"]),
        axes=axes or CAMERA,
        axes_stated=axes is not None,
        unit="m" if axes else None,
        intensity=intensity,
        time=vertices[names["time"]] if "time" in names else None,
        notes=tuple(c.removeprefix(_ASSUMED) for c in header.comments if c.startswith(_ASSUMED)),
    )
    return cloud_survey(raw, path, options)


def write_ply(survey: Survey, path: Path) -> None:
    """Write points as binary little-endian PLY with doubles in camera axes, which a comment in it states.

    The points are those of `cloud_export.points_of`; assumptions travel as comments.
    """
    points = points_of(survey, CAMERA)
    columns = {axis: (points.xyz[:, i], "<f8") for i, axis in enumerate("xyz")}
    if points.intensity is not None:
        columns["intensity"] = (points.intensity, "<f4")
    if points.time is not None:
        columns["time"] = (points.time, "<f8")
    fields = [(name, kind) for name, (_, kind) in columns.items()]
    vertices = np.empty(len(points.xyz), fields)
    for name, (values, _) in columns.items():
        vertices[name] = values
    kinds = {"<f8": "double", "<f4": "float"}
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment {_STATEMENT}{CAMERA}",
        *(f"comment {_ASSUMED}{sentence}" for sentence in survey.assumptions),
        f"element vertex {len(vertices)}",
        *(f"property {kinds[kind]} {name}" for name, kind in fields),
        "end_header",
    ]
    with path.open("wb") as stream:
        stream.write(("\n".join(lines) + "\n").encode("latin-1", "replace"))
        vertices.tofile(stream)


def _parse_header(data: bytes, path: Path) -> _Header:
    end = data.find(b"end_header", 0, _HEADER_LIMIT)
    newline = data.find(b"\n", end) if end >= 0 else -1
    if not data.startswith(b"ply") or newline < 0:
        raise FormatError("the header does not end", where=path, expected="a PLY header from 'ply' to 'end_header'")
    header = _Header("", [], [], newline + 1)
    order = None
    for number, line in enumerate(data[:end].decode("latin-1").splitlines(), 1):
        words = line.split()
        if not words or words[0] in ("ply", "obj_info"):
            continue
        try:
            if words[0] == "comment":
                header.comments.append(line.strip().removeprefix("comment").strip())
            elif words[0] == "format":
                order = _ORDERS[words[1]]
            elif words[0] == "element":
                header.elements.append(_Element(words[1], int(words[2])))
            elif words[0] == "property":
                element = header.elements[-1]
                element.has_list |= words[1] == "list"
                element.properties.append((words[-1], "" if words[1] == "list" else _TYPES[words[1]]))
            else:
                raise KeyError(words[0])
        except (KeyError, IndexError, ValueError):
            raise FormatError(f"the line '{line}' is not PLY's", where=f"{path}, line {number}") from None
    if order is None:
        raise FormatError("the header has no format line", where=path)
    header.order = order
    return header


def _vertices(data: bytes, header: _Header, path: Path) -> dict[str, np.ndarray]:
    names = [element.name for element in header.elements]
    if "vertex" not in names:
        raise FormatError("the header has no element 'vertex'", where=path, expected="a point cloud")
    position = names.index("vertex")
    before, vertex = header.elements[:position], header.elements[position]
    if vertex.has_list or any(e.has_list for e in before):
        raise FormatError(
            "a list stands in or before the vertices", where=path, mend="save it as a plain point cloud first"
        )
    last = position == len(names) - 1
    if header.order == "":
        return _ascii_vertices(data, header.size, sum(e.count for e in before), vertex, last, path)
    start = header.size + sum(e.count * np.dtype([(n, t) for n, t in e.properties]).itemsize for e in before)
    kind = np.dtype([(name, header.order + t) for name, t in vertex.properties])
    found = (len(data) - start) // kind.itemsize
    _check_count(found, vertex.count, last, path)
    records = np.frombuffer(data, kind, vertex.count, start)
    return {name: records[name] for name in kind.names or ()}


def _ascii_vertices(
    data: bytes, start: int, skip: int, vertex: _Element, last: bool, path: Path
) -> dict[str, np.ndarray]:
    lines = data[start:].split(b"\n")
    header_lines = data.count(b"\n", 0, start)
    body = lines[skip : skip + vertex.count]
    found = sum(1 for line in (lines[skip:] if last else body) if line.strip())
    _check_count(found, vertex.count, last, path)
    values = parse_numbers(
        b"\n".join(body) + b"\n",
        delimiter=" ",
        names=[name for name, _ in vertex.properties],
        where=path,
        first_row=header_lines + skip + 1,
    ).values
    return {name: values[:, i] for i, (name, _) in enumerate(vertex.properties)}


def _check_count(found: int, promised: int, last: bool, path: Path) -> None:
    if promised == 0:
        raise FormatError("the header promises 0 vertices", where=path, expected="at least one point")
    if found < promised:
        raise FormatError(
            f"the file is cut short: {max(found, 0)} of {promised} vertices are there",
            where=path,
            mend="copy or export it again",
        )
    if last and found > promised:
        raise FormatError(
            f"the header promises {promised} vertices but {found} are there", where=path, mend="export it again"
        )
