"""Surveys as Springline stores them: a zarr folder or a `.zarr.zip`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import FormatError
from ..survey import Survey, open_survey, save_survey

if TYPE_CHECKING:
    from pathlib import Path

    from .options import ReadOptions

_ESSENTIAL = {"points": ("x", "y", "z"), "rings": ("range", "distance"), "rings_rear": ("range", "distance")}


def read_zarr(path: Path, options: ReadOptions) -> Survey:
    """Open a stored survey; the user's word on the kind of sensor wins over the stored one.

    Raises:
        FormatError: Not a zarr store, damaged, or a block of its coordinates, ranges or distances is not there.
    """
    survey = open_survey(path)
    _check_blocks(path)
    if options.sensor is None:
        return survey
    groups = {
        name: data.assign_attrs(sensor_kind=options.sensor) if name in _ESSENTIAL else data
        for name, data in ((name, survey.group(name)) for name in survey.groups)
    }
    return Survey(groups, survey.attrs)


def write_zarr(survey: Survey, path: Path) -> None:
    """Store a survey; nothing is lost."""
    save_survey(survey, path)


def _check_blocks(path: Path) -> None:
    """Refuse a store that lacks blocks: zarr would read them as its fill value, without a word."""
    import zarr
    from zarr.storage import LocalStore, ZipStore

    store: Any = ZipStore(path, mode="r") if path.is_file() else LocalStore(path, read_only=True)
    root = zarr.open_group(store, mode="r")
    for group, names in _ESSENTIAL.items():
        for name in names:
            array: Any = root.get(f"{group}/{name}")
            if array is not None and array.nchunks_initialized < array.nchunks:
                raise FormatError(
                    f"{array.nchunks - array.nchunks_initialized} of {array.nchunks} blocks of /{group} {name} "
                    "are not there",
                    where=path,
                    mend="copy it again, whole",
                )
    store.close()
