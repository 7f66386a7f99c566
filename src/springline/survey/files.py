"""Surveys on disk: zarr, as a folder or as one `.zarr.zip`; writing is atomic."""

from __future__ import annotations

import shutil
import tempfile
import time
import warnings
import zipfile
from collections import Counter
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..conventions import GROUPS, SOURCE_GROUPS
from ..errors import FormatError, InputError, OutputError
from .model import Survey

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

_RING_CHUNK = 2048
_DEFAULT_TICK = 1e-5
_FILL = -32768
_TRIES, _PAUSE = 40, 0.05  # s
_POSITIONS = ("chainage", "distance", "easting", "northing", "elevation", "time")


def save_survey(survey: Survey, path: str | Path, *, force: bool = False) -> Path:
    """Write a survey as a zarr folder, or as one file when `path` ends in `.zip`; whole or not at all.

    Ranges are stored as scaled integers with ticks no coarser than a tenth of the sensor's noise (`range_noise` of
    the rings), 10 micrometres when the noise is unknown.

    Args:
        survey: The survey.
        path: Where to write.
        force: Replace what stands there.

    Raises:
        OutputError: `path` exists without `force`, or the disk refuses (full, read-only, not permitted).
    """
    path = Path(path)
    with replacing_survey(path, force=force) as temporary:
        if path.suffix == ".zip":
            folder = temporary.with_suffix(".folder")
            _write_groups(survey, folder)
            _pack(folder, temporary)
        else:
            _write_groups(survey, temporary)
    return path


def _pack(folder: Path, archive: Path) -> None:
    """Zip a zarr folder; its chunks are compressed already, and zarr rewrites metadata, which a zip cannot."""
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as bundle:
        for file in sorted(p for p in folder.rglob("*") if p.is_file()):
            bundle.write(file, file.relative_to(folder).as_posix())


@dataclass(frozen=True)
class OwnFolder:
    """A folder that we write, told from others before it is replaced, such as a home folder named by mistake.

    Attributes:
        what: What it is, for the message.
        holds: Names by which it is told: all of one of these sets.
        alone: Whether nothing else may stand in it.
    """

    what: str
    holds: tuple[frozenset[str], ...]
    alone: bool = False

    @classmethod
    def of(cls, what: str, *names: str, alone: bool = False) -> OwnFolder:
        """Return a folder that is told by one set of names."""
        return cls(what, (frozenset(names),), alone)

    def check(self, path: Path, *, force: bool) -> None:
        """Refuse what stands at `path` without `force`, and with it what is no such folder.

        Raises:
            OutputError: As said.
        """
        _refuse_existing(path, force)
        if not path.exists():
            return
        if not path.is_dir():
            raise OutputError("it is a file, not a folder", where=path, mend="choose another folder")
        try:
            there = {one.name for one in path.iterdir()}
        except OSError as error:
            raise OutputError(f"cannot be looked into: {error.strerror or error}", where=path) from error
        if there and not any(there == own if self.alone else there >= own for own in self.holds):
            raise OutputError(
                f"it holds other files than those of {self.what}, and --force would remove them",
                where=path,
                mend="choose another folder",
            )


SURVEY_FOLDER = OwnFolder("a survey", (frozenset({"zarr.json"}), frozenset({".zgroup"}), frozenset({"survey.toml"})))


def _refuse_existing(path: Path, force: bool) -> None:
    if path.exists() and not force:
        raise OutputError("it exists already", where=path, mend="choose another name or pass --force")


@contextmanager
def replacing(path: Path, *, force: bool = False, own: OwnFolder | None = None) -> Iterator[Path]:
    """Yield a temporary sibling of `path` that takes its place when the block succeeds and vanishes when it fails.

    Args:
        path: Where to write.
        force: Replace what stands there.
        own: The folder that is written; a file when not given.

    Raises:
        OutputError: `path` exists without `force`, or is not such a folder or file; or the disk refuses.
    """
    if own is not None:
        own.check(path, force=force)
    else:
        _refuse_existing(path, force)
        if path.is_dir():
            raise OutputError("it is a folder, not a file", where=path, mend="choose another name")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        holder = Path(tempfile.mkdtemp(prefix=f".{path.name}-", dir=path.parent))
    except OSError as error:
        raise OutputError(f"cannot be written: {error.strerror or error}", where=path) from error
    try:
        yield holder / path.name
        if path.exists():
            path.rename(holder / "replaced")
        try:
            (holder / path.name).rename(path)
        except OSError:
            with suppress(OSError):
                (holder / "replaced").rename(path)
            raise
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        raise OutputError(
            f"cannot be written: {error.strerror or error}",
            where=path,
            mend="free some space or choose another disk",
        ) from error
    finally:
        _remove(holder)


def _remove(holder: Path) -> None:
    """Remove a temporary folder: the store's own threads may still lay a file down in it after a request to end."""
    for _ in range(_TRIES):
        shutil.rmtree(holder, ignore_errors=True)
        if not holder.exists():
            return
        time.sleep(_PAUSE)


def replacing_survey(path: Path, *, force: bool) -> AbstractContextManager[Path]:
    """Return `replacing` for a zarr folder, or for one file when `path` ends in `.zip`."""
    return replacing(path, force=force, own=None if path.suffix == ".zip" else SURVEY_FOLDER)


def _write_groups(survey: Survey, store: Path) -> None:
    import zarr

    xr.Dataset(attrs={**survey.attrs, "chunks": "all"}).to_zarr(store, mode="w", consolidated=False, zarr_format=3)
    for name in survey.groups:
        data = _ticked(_described(name, survey.group(name)))
        data.to_zarr(
            store,
            group=name,
            mode="a",
            consolidated=False,
            zarr_format=3,
            encoding=_encoding(data, result=name not in SOURCE_GROUPS),
            safe_chunks=False,
            write_empty_chunks=True,
        )
    with warnings.catch_warnings():
        # Consolidated metadata spare readers a listing; zarr warns that the addition is not in its specification yet.
        warnings.simplefilter("ignore")
        zarr.consolidate_metadata(store)


def _described(group: str, data: xr.Dataset) -> xr.Dataset:
    """Return the data with unit and description from the one table on each variable."""
    listed = {v.name: v for v in GROUPS[group].variables}
    data = data.copy(deep=False)
    for name in data.variables:
        data[name].encoding = {}
        if data[name].dtype.kind == "U":
            # Text of any length is specified in zarr, text of fixed length is not.
            data[name] = data[name].astype(object)
        if str(name) in listed:
            data[name].attrs = {
                **data[name].attrs,
                "units": listed[str(name)].unit,
                "long_name": listed[str(name)].description,
            }
    return data


def _encoding(data: xr.Dataset, *, result: bool) -> dict[str, dict[str, Any]]:
    """Return how each variable is stored; results keep seven digits, which is finer than any of their sigmas."""
    from zarr.codecs import BloscCodec

    compressor = BloscCodec(cname="zstd", clevel=5, shuffle="bitshuffle")
    encoding: dict[str, dict[str, Any]] = {}
    for name, array in data.variables.items():
        one: dict[str, Any] = {}
        if array.dtype.kind in "fiub" and array.ndim:
            one["compressors"] = (compressor,)
            if array.dims[0] in ("ring", "station", "point"):
                one["chunks"] = (
                    min(_rows_per_chunk(array), array.shape[0]) or 1,
                    *(n or 1 for n in array.shape[1:]),
                )
        if result and array.dtype == np.float64 and name not in _POSITIONS:
            one["dtype"] = "float32"
        encoding[str(name)] = one
    return encoding


def _rows_per_chunk(array: xr.Variable) -> int:
    return _RING_CHUNK if array.ndim > 1 else 65536


def _ticked(data: xr.Dataset) -> xr.Dataset:
    """Return the data with ranges as scaled integers, made block by block: at once they would fill memory thrice."""
    if "range" not in data:
        return data
    array = data["range"].variable
    noise, reach = float(data.attrs.get("range_noise", np.nan)), float(data.attrs.get("range_max", 0.0))
    dtype, tick, fill = _ticks(array, noise, reach)
    if dtype is None:
        return data
    stored = np.empty(array.shape, dtype)
    for start in range(0, len(stored), _RING_CHUNK):
        block = array[start : start + _RING_CHUNK].values
        seen = np.isfinite(block)
        stored[start : start + _RING_CHUNK] = np.where(seen, np.rint(np.where(seen, block, 0.0) / tick), fill)
    return data.assign(range=(array.dims, stored, {**array.attrs, "scale_factor": tick, "_FillValue": fill}))


def _ticks(array: xr.Variable, noise: float, reach: float) -> tuple[str | None, float, int]:
    """Return type, tick [m] and fill value: int16 where the longest range fits, int32 otherwise, None beyond that."""
    tick = min(_DEFAULT_TICK, noise / 10) if noise > 0 else _DEFAULT_TICK
    longest = max((float(np.nanmax(np.abs(block), initial=0.0)) for block in _blocks(array)), default=0.0)
    longest = max(longest, reach)
    if longest / tick < -_FILL - 1:
        return "int16", float(np.float32(tick)), _FILL
    if noise > 0 and longest / (noise / 10) < -_FILL - 1:
        return "int16", float(np.float32(noise / 10)), _FILL
    if longest / tick < 2**31 - 2:
        return "int32", tick, -(2**31)
    return None, 0.0, 0


def _blocks(array: xr.Variable) -> Iterator[np.ndarray]:
    for start in range(0, array.shape[0], _RING_CHUNK):
        yield np.where(np.isfinite(b := array[start : start + _RING_CHUNK].values), b, 0.0)


def open_survey(path: str | Path) -> Survey:
    """Open a survey written by `save_survey`, whole: damage shows here and not in the middle of a run.

    Args:
        path: A zarr folder, or a `.zarr.zip`.

    Raises:
        InputError: There is no such file.
        FormatError: It is not a zarr store, or it is damaged.
    """
    path = Path(path)
    if not path.exists():
        raise InputError("no such file", where=path)
    try:
        groups, attrs = _read_groups(path)
    except (OSError, ValueError, KeyError, RuntimeError, zipfile.BadZipFile) as error:
        raise FormatError(
            f"cannot be opened as a zarr survey: {error}",
            where=path,
            expected="a complete zarr folder or .zarr.zip",
        ) from error
    known = {name: data for name, data in groups.items() if name in GROUPS}
    if not known:
        raise FormatError("no group of the data contract stands in it", where=path, expected="/rings or /points")
    return Survey(known, attrs)


def _empty_texts(name: str, data: xr.Dataset) -> xr.Dataset:
    """Return a group whose text variables without an element are texts: empty ones come back from zarr as numbers."""
    texts = {v.name for v in GROUPS[name].variables if v.dtype == "str"} if name in GROUPS else set()
    empty = [v for v in texts if v in data and data[v].size == 0 and data[v].dtype.kind != "U"]
    return data.assign({v: (data[v].dims, np.empty(data[v].shape, "<U1"), data[v].attrs) for v in empty})


def _read_groups(path: Path) -> tuple[dict[str, xr.Dataset], dict[str, Any]]:
    import zarr
    from zarr.storage import LocalStore, ZipStore

    store: Any = ZipStore(path, mode="r") if path.is_file() else LocalStore(path, read_only=True)
    root = zarr.open_group(store, mode="r")
    groups, attrs = {}, dict(root.attrs)
    stored = _stored_names(path) if attrs.get("chunks") == "all" else None
    for name in sorted(name for name, _ in root.groups()):
        data = xr.open_zarr(store, group=name, consolidated=False, chunks=None)
        if "range" in data:
            data = data.assign(range=(data["range"].dims, _ranges(root[f"{name}/range"]), data["range"].attrs))
        data = data.load()
        text = {key: array for key, array in data.variables.items() if array.dtype.kind in "OT"}
        groups[name] = data.assign(
            {key: (array.dims, array.values.astype(object).astype(str), array.attrs) for key, array in text.items()}
        )
        groups[name] = _empty_texts(name, groups[name])
        if stored is not None:
            _check_chunks(root[name], stored)
    return groups, attrs


def _stored_names(path: Path) -> Counter[str]:
    """Return how many chunks each array has; zarr's own count fails in a zip when one name begins another."""
    if path.is_file():
        with zipfile.ZipFile(path) as bundle:
            names = bundle.namelist()
    else:
        names = [p.relative_to(path).as_posix() for p in path.rglob("*") if p.is_file()]
    return Counter(name.split("/c/")[0].removesuffix("/c") for name in names if "/c/" in name or name.endswith("/c"))


def _check_chunks(group: Any, stored: Counter[str]) -> None:
    """Raise when a chunk is missing, which zarr would read as if there had been no return."""
    for name, array in group.arrays():
        if missing := array.nchunks - stored[array.path]:
            raise ValueError(f"{missing} of {array.nchunks} chunks of '{name}' are missing")


def _ranges(stored: Any) -> np.ndarray:
    """Return ranges [m] as float32, decoded block by block: at once they would pass through float64."""
    values = np.empty(stored.shape, np.float32)
    scale = np.float32(stored.attrs.get("scale_factor", 1.0))
    fill = stored.attrs.get("_FillValue")
    for start in range(0, stored.shape[0], _RING_CHUNK):
        raw = stored[start : start + _RING_CHUNK]
        block = raw * scale
        if fill is not None and raw.dtype.kind == "i":
            block[raw == fill] = np.nan
        values[start : start + _RING_CHUNK] = block
    return values
