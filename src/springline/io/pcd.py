"""PCD: point cloud files, ascii, binary or compressed (version 0.7)."""

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

_HEADER_LIMIT = 1 << 14
_KINDS = {"F": "f", "U": "u", "I": "i"}
_NEEDED = ("FIELDS", "SIZE", "TYPE", "POINTS", "DATA")


def read_pcd(path: Path, options: ReadOptions) -> Survey:
    """Read the x, y, z (and intensity) of a PCD file into `/points`; the axes are taken as a camera's unless stated.

    Raises:
        FormatError: The header is not PCD's, there are no x, y, z, or fewer points than the header promises.
    """
    data = path.read_bytes()
    header, start, lines = _header(data, path)
    kind, count = _layout(header, path)
    form = header["DATA"][0].lower()
    if form == "ascii":
        fields = _ascii(data, start, lines, kind, count, path)
    elif form in ("binary", "binary_compressed"):
        fields = (_binary if form == "binary" else _compressed)(data, start, kind, count, path)
    else:
        raise FormatError(f"DATA {form} is unknown", where=path, expected="ascii, binary or binary_compressed")
    missing = [axis for axis in "xyz" if axis not in fields]
    if missing:
        raise FormatError(f"the points have no field {missing[0]}", where=path, expected="x, y and z")
    xyz = np.column_stack([to_float(fields[axis]) for axis in "xyz"])
    return cloud_survey(RawCloud(xyz, axes=CAMERA, intensity=fields.get("intensity")), path, options)


def _header(data: bytes, path: Path) -> tuple[dict[str, list[str]], int, int]:
    """Return the header's words by key, the byte at which the data begin, and the number of header lines."""
    header: dict[str, list[str]] = {}
    start = lines = 0
    while "DATA" not in header:
        end = data.find(b"\n", start, _HEADER_LIMIT)
        if end < 0:
            raise FormatError("the header does not end", where=path, expected="a PCD header that ends with DATA")
        key, *words = data[start:end].decode("latin-1").split() or [""]
        if key and not key.startswith("#"):
            header[key.upper()] = words
        start, lines = end + 1, lines + 1
    missing = [key for key in _NEEDED if not header.get(key)]
    if missing:
        raise FormatError(f"the header has no {missing[0]}", where=path, expected=", ".join(_NEEDED))
    return header, start, lines


def _layout(header: dict[str, list[str]], path: Path) -> tuple[np.dtype, int]:
    names = header["FIELDS"]
    counts = header.get("COUNT", ["1"] * len(names))
    try:
        fields = [
            (f"{name}#{i}" if name == "_" else name, f"<{_KINDS[kind]}{int(size)}", (int(n),) if n != "1" else ())
            for i, (name, size, kind, n) in enumerate(zip(names, header["SIZE"], header["TYPE"], counts, strict=True))
        ]
        return np.dtype(fields), int(header["POINTS"][0])
    except (KeyError, ValueError, TypeError):
        raise FormatError("FIELDS, SIZE, TYPE and COUNT do not agree", where=path) from None


def _ascii(data: bytes, start: int, lines: int, kind: np.dtype, count: int, path: Path) -> dict[str, np.ndarray]:
    names: list[str] = []
    for name in kind.names or ():
        shape = kind[name].shape
        names += [f"{name}_{k}" for k in range(shape[0])] if shape else [name]
    values = parse_numbers(
        data[start:].rstrip() + b"\n", delimiter=" ", names=names, where=path, first_row=lines + 1
    ).values
    _check(len(values), count, path)
    return {name: values[:count, i] for i, name in enumerate(names)}


def _binary(data: bytes, start: int, kind: np.dtype, count: int, path: Path) -> dict[str, np.ndarray]:
    _check((len(data) - start) // kind.itemsize, count, path)
    records = np.frombuffer(data, kind, count, start)
    return {name: records[name] for name in kind.names or ()}


def _compressed(data: bytes, start: int, kind: np.dtype, count: int, path: Path) -> dict[str, np.ndarray]:
    """Unpack LZF, in which the fields follow one another, each for all points."""
    from .lzf import decompress

    packed, size = (int(n) for n in np.frombuffer(data[start : start + 8].ljust(8, b"\0"), "<u4"))
    body = np.frombuffer(data, np.uint8, offset=min(start + 8, len(data)))
    if body.size < packed or size != count * kind.itemsize:
        raise FormatError(
            f"the file is cut short: {body.size} of {packed} compressed bytes are there",
            where=path,
            mend="copy or export it again",
        )
    raw, filled = decompress(body[:packed], size)
    if filled != size:
        raise FormatError("the compressed points are damaged", where=path, mend="copy or export it again")
    fields, offset = {}, 0
    for name in kind.names or ():
        field = kind[name]
        fields[name] = np.frombuffer(raw, field.base, count * max(1, int(np.prod(field.shape))), offset)
        offset += count * field.itemsize
    return fields


def _check(found: int, promised: int, path: Path) -> None:
    if promised == 0:
        raise FormatError("the header promises 0 points", where=path, expected="at least one point")
    if found < promised:
        raise FormatError(
            f"the file is cut short: {found} of {promised} points are there", where=path, mend="copy or export it again"
        )
