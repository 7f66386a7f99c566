"""A survey written block by block, for one that does not fit in memory."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from .files import _pack, _write_groups, replacing_survey

if TYPE_CHECKING:
    from collections.abc import Iterable

    import xarray as xr

    from .model import Survey


def save_blocks(
    first: Survey, blocks: Iterable[dict[str, xr.Dataset]], path: str | Path, *, force: bool = False
) -> Path:
    """Write a survey whose groups come in blocks; whole or not at all.

    The first block decides how each variable is stored, so rings whose later ranges may be longer than its own state
    the longest that their sensor reports in the attribute `range_max`.

    Args:
        first: The survey's attributes and the first block of every group.
        blocks: Further blocks by group: every variable in them goes on along its first dim.
        path: A zarr folder, or one file when it ends in `.zip`.
        force: Replace what stands there.

    Raises:
        OutputError: `path` exists without `force`, or the disk refuses.
    """
    import zarr

    path = Path(path)
    with replacing_survey(path, force=force) as temporary:
        folder = temporary.with_suffix(".folder") if path.suffix == ".zip" else temporary
        _write_groups(first, folder)
        for block in blocks:
            for group, data in block.items():
                _append(folder, group, data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # consolidated metadata, as in files.py
            zarr.consolidate_metadata(folder)
        if path.suffix == ".zip":
            _pack(folder, temporary)
    return path


def _append(store: Path, group: str, data: xr.Dataset) -> None:
    by_dim: dict[str, list[str]] = {}
    for name, array in data.variables.items():
        if array.dims != (name,) and not (len(array.dims) == 1 and array.dims[0] == name):
            by_dim.setdefault(str(array.dims[0]), []).append(str(name))
    for dim, names in by_dim.items():
        data[names].drop_vars([c for c in data.coords if c not in names]).to_zarr(
            store,
            group=group,
            append_dim=dim,
            consolidated=False,
            zarr_format=3,
            safe_chunks=False,
            write_empty_chunks=True,
        )
