"""Formats told by their content: first bytes, then the shape of the text."""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING

from ..errors import FormatError, InputError

if TYPE_CHECKING:
    from pathlib import Path

_MAGIC = (
    (b"ply\n", "ply"),
    (b"ply\r\n", "ply"),
    (b"\x89PNG\r\n\x1a\n", "depth"),
    (b"II*\0", "depth"),
    (b"MM\0*", "depth"),
    (b"LASF", "las"),
    (b"ASTM-E57", "e57"),
    (b"PAR1", "parquet"),
    (b"\x93NUMPY", "npy"),
)
_HEAD = 1 << 12
_BY_EXTENSION = {
    ".ply": "ply",
    ".pcd": "pcd",
    ".stl": "mesh",
    ".obj": "mesh",
    ".las": "las",
    ".laz": "las",
    ".e57": "e57",
}
"""Formats whose own reader tells best what is wrong with a damaged file."""


def sniff(path: Path) -> str | None:
    """Return the key of the format that a file or folder holds, or None.

    Raises:
        InputError: The file is empty or cannot be read, or the folder is no survey.
    """
    if path.is_dir():
        return _sniff_folder(path)
    try:
        with path.open("rb") as stream:
            head = stream.read(_HEAD)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=path) from None
    if not head.strip():
        raise InputError("the file is empty", where=path)
    for magic, key in _MAGIC:
        if head.startswith(magic):
            return key
    if head.startswith(b"PK"):
        return _sniff_zip(path)
    if (coded := _sniff_coded(head)) is not None:
        return coded
    if head.lstrip().startswith((b"# .PCD", b"VERSION ", b"# PCD")) and b"FIELDS" in head:
        return "pcd"
    return _sniff_mesh(path, head) or _sniff_text(path, head) or _BY_EXTENSION.get(path.suffix.lower())


def _sniff_folder(path: Path) -> str:
    if (path / "survey.toml").is_file():
        return "folder"
    if (path / "Conditions.csv").is_file():
        return "pacp"
    if (path / "zarr.json").is_file() or (path / ".zgroup").is_file() or path.suffix == ".zarr":
        return "zarr"
    raise InputError(
        "the folder is neither a survey folder (there is no survey.toml) nor a zarr store",
        where=path,
        mend="name the files in it",
    )


def _sniff_coded(head: bytes) -> str | None:
    """Return the key of a format of CCTV observations, told by its first lines."""
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip()
    if text.startswith(b"#A1=") or (text.startswith(b"#B") and b"#C=" in text):
        return "en13508"
    if text.startswith(b"<"):
        if b"<Identifikation" in text:
            return "isybau"
        return "m150" if b"<DATA" in text and b"<FD>" in text else None
    first = text.split(b"\n", 1)[0].lower()
    return "pacp" if b"pacp_code" in first and b"distance" in first else None


def _sniff_zip(path: Path) -> str | None:
    try:
        with zipfile.ZipFile(path) as bundle:
            names = bundle.namelist()
    except (zipfile.BadZipFile, OSError) as error:
        raise FormatError(f"the zip file is cut short or damaged: {error}", where=path, mend="copy it again") from None
    if names and all(name.endswith(".npy") for name in names):
        return "npy"
    return "zarr" if "zarr.json" in names or ".zgroup" in names else None


def _sniff_mesh(path: Path, head: bytes) -> str | None:
    size = path.stat().st_size
    if len(head) >= 84 and size == 84 + 50 * int.from_bytes(head[80:84], "little"):
        return "mesh"
    if head.lstrip().startswith(b"solid") and b"facet" in head:
        return "mesh"
    lines = [line for line in head.split(b"\n") if line.strip() and not line.lstrip().startswith(b"#")]
    words = {line.split()[0] for line in lines[:20]}
    obj = {b"v", b"vn", b"vt", b"vp", b"f", b"o", b"g", b"s", b"mtllib", b"usemtl"}
    return "mesh" if words and b"v" in {line.split()[0] for line in lines} and words <= obj else None


def _sniff_text(path: Path, head: bytes) -> str | None:
    from .rings import is_ring_table
    from .tables import open_table
    from .xyz import is_cloud_table

    if b"\0" in head:
        return None
    try:
        table = open_table(path)
    except FormatError:
        return None
    if is_ring_table(table.names):
        return "csv"
    return "xyz" if is_cloud_table(table) else None
