"""One table of formats: what each is called, holds and needs; the guess by content, and its overruling."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING

from ..errors import FormatError, InputError, listed, nearest

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from ..survey import Survey

_CLOUD = frozenset(("nominal_diameter", "format", "unit", "axes", "sensor", "name"))
_RINGS = frozenset(("nominal_diameter", "format", "unit", "bearing_zero", "bearing_sense", "sensor", "name"))
_DEPTH = frozenset(("nominal_diameter", "format", "intrinsics", "depth_unit", "axes", "sensor", "name"))
_STORED = frozenset(("nominal_diameter", "format", "sensor", "name"))
_CODED = frozenset(("format", "name"))
_LIBRARIES = {"depth": ("PIL",), "las": ("laspy", "lazrs"), "e57": ("pye57",), "parquet": ("pyarrow",)}
_TABLE = (("rings",), ("distance", "time", "bearing", "range"))
_PARTS = ("rings", "rings_rear", "inertial", "ties", "frames", "calibration")


@dataclass(frozen=True)
class Format:
    """One format.

    Args:
        key: What `format=` and `--format` call it.
        title: For people.
        extensions: By habit, with the dot; the first one is written.
        holds: clouds, rings, depth images or surveys.
        reader: "module:function" in this package, or None.
        writer: "module:function" in this package, or None.
        extra: Optional dependency that it needs, or None.
        options: Names of the `ReadOptions` that mean something to it.
        groups: Groups that its writer can write; a cloud format writes the first of them that is there.
        variables: Variables of those groups that it holds; all when empty.
    """

    key: str
    title: str
    extensions: tuple[str, ...]
    holds: str
    reader: str | None
    writer: str | None
    extra: str | None = None
    options: frozenset[str] = field(default=_CLOUD, repr=False)
    groups: tuple[str, ...] = ("points", "rings")
    variables: tuple[str, ...] = ()

    @property
    def libraries(self) -> tuple[str, ...]:
        """Modules of the optional dependency that it needs."""
        return _LIBRARIES.get(self.extra or "", ())

    @property
    def holds_all(self) -> bool:
        """Whether a survey written in it loses nothing."""
        return self.key == "zarr"

    def read_function(self) -> Callable[..., Survey]:
        """Return the function that reads it: (path, options) -> Survey."""
        return _load(self.reader)

    def write_function(self) -> Callable[..., None]:
        """Return the function that writes it: (survey, path) -> None."""
        return _load(self.writer)


FORMATS = {
    f.key: f
    for f in (
        Format("ply", "PLY vertices, ascii or binary", (".ply",), "clouds", "ply:read_ply", "ply:write_ply"),
        Format("pcd", "PCD, ascii, binary or compressed", (".pcd",), "clouds", "pcd:read_pcd", None),
        Format("las", "LAS, and LAZ compressed", (".las", ".laz"), "clouds", "las:read_las", "las:write_las", "las"),
        Format("e57", "E57 terrestrial scans", (".e57",), "clouds", "e57:read_e57", None, "e57"),
        Format("mesh", "vertices of OBJ and STL meshes", (".obj", ".stl"), "clouds", "mesh:read_mesh", None),
        Format("npy", "numpy arrays: a cloud, or rings", (".npy", ".npz"), "clouds or rings",
               "numpy_files:read_numpy", None, None, _CLOUD | _RINGS),
        Format("xyz", "text with x, y, z", (".xyz", ".asc", ".txt", ".csv"), "clouds", "xyz:read_xyz", None),
        Format("depth", "16-bit depth image with intrinsics", (".png", ".tif", ".tiff"), "depth images",
               "depth:read_depth", None, "depth", _DEPTH),
        Format("csv", "ring table as text, wide or long", (".csv", ".tsv", ".txt"), "rings",
               "ring_csv:read_ring_csv", "ring_csv:write_ring_csv", None, _RINGS, *_TABLE),
        Format("parquet", "ring table as Parquet, wide or long", (".parquet", ".pq"), "rings",
               "ring_parquet:read_ring_parquet", "ring_parquet:write_ring_parquet", "parquet", _RINGS, *_TABLE),
        Format("en13508", "EN 13508-2 exchange text", (".en13508.txt",), "observations", "en13508:read_en13508", None,
               None, _CODED),
        Format("isybau", "ISYBAU XML: condition data", (".isybau.xml",), "observations", "isybau:read_isybau", None,
               None, _CODED),
        Format("m150", "DWA-M 150 XML, type B", (".m150.xml",), "observations", "m150:read_m150", None, None, _CODED),
        Format("pacp", "PACP tables as CSV", (".pacp",), "observations", "pacp:read_pacp", None, None,
               _CODED | {"unit"}),
        Format("folder", "survey folder: survey.toml beside its tables", ("",), "surveys",
               "survey_folder:read_folder", "folder_writer:write_folder", None, _RINGS, _PARTS),
        Format("zarr", "Springline's own store, a folder or one .zip", (".zarr", ".zarr.zip", ".zip"), "surveys",
               "zarr_store:read_zarr", "zarr_store:write_zarr", None, _STORED, ()),
    )
}  # fmt: skip
"""All formats by key."""


def by_key(key: str, *, where: str = "format") -> Format:
    """Return the format called `key`, which may also be a file extension that only one format has.

    Args:
        key: The key or extension.
        where: What to name in messages.

    Raises:
        InputError: There is none of that name.
    """
    wanted = key.lower().removeprefix(".")
    if wanted in FORMATS:
        return FORMATS[wanted]
    found = [f for f in FORMATS.values() if f".{wanted}" in f.extensions]
    if len(found) == 1:
        return found[0]
    raise InputError(
        f"the format '{key}' is unknown{nearest(wanted, FORMATS)}", where=where, expected=", ".join(FORMATS)
    )


def require_there(path: Path) -> None:
    """Raise an `InputError` unless there is a file or a folder at `path`; a pipe would be waited for."""
    if not path.exists():
        raise InputError("no such file", where=path, mend="check the path")
    if not (path.is_file() or path.is_dir()):
        raise InputError(
            "neither a file nor a folder", where=path, expected="a file", mend="save what comes in there to a file"
        )


def guess(path: Path) -> Format:
    """Return the format of an input by its content.

    Raises:
        InputError: There is nothing at `path`, or it is empty.
        FormatError: The content is none of a known format.
    """
    from .sniff import sniff

    require_there(path)
    key = sniff(path)
    if key is None:
        _explain_table(path)
        raise FormatError(
            "the format is not known",
            where=path,
            expected=f"one of {', '.join(FORMATS)}",
            mend="say which with --format, or see: springline formats",
        )
    return FORMATS[key]


def _explain_table(path: Path) -> None:
    """Raise what is wrong with a text table; return when it is none."""
    from .tables import open_table

    try:
        names = open_table(path).names
    except FormatError:
        return
    if names:
        raise FormatError(
            f"the columns {listed(names, 6, ', ')} are neither those of a ring table nor of a cloud",
            where=path,
            expected="distance_m, r_0, r_1, ... or distance_m, bearing_deg, radius_m or x, y, z",
            mend="rename the columns, or say the format with --format",
        )


def _load(place: str | None) -> Callable:
    if place is None:
        raise InputError("the format cannot be used that way", where="format", mend="see: springline formats")
    module, name = place.split(":")
    return getattr(import_module(f".{module}", __package__), name)
