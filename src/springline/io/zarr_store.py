"""Surveys as Springline stores them: a zarr folder or a `.zarr.zip`."""

from __future__ import annotations

import zipfile
import zlib
from typing import TYPE_CHECKING

from ..errors import FormatError
from ..survey import Survey, open_survey, save_survey
from . import clouds, ring_units

if TYPE_CHECKING:
    from pathlib import Path

    from .options import ReadOptions

_SENSED = ("points", "rings", "rings_rear")


def read_zarr(path: Path, options: ReadOptions) -> Survey:
    """Open a stored survey; the user's word on the kind of sensor wins over the stored one.

    Raises:
        FormatError: Not a zarr store, or damaged.
        InputError: Its rings or points are far from the nominal diameter that the user states.
    """
    if path.is_file():
        _check_zip(path)
    survey = _with_folder(open_survey(path), path)
    _check_nominal(survey, options.nominal_diameter, path)
    if options.sensor is None:
        return survey
    groups = {
        name: data.assign_attrs(sensor_kind=options.sensor) if name in _SENSED else data
        for name, data in ((name, survey.group(name)) for name in survey.groups)
    }
    return Survey(groups, survey.attrs)


def _with_folder(survey: Survey, path: Path) -> Survey:
    """Return the survey with the folder that its frames' paths start from: where the file lies, unless it says so."""
    if not survey.has("frames") or "folder" in survey.frames.attrs:
        return survey
    groups = {name: survey.group(name) for name in survey.groups}
    groups["frames"] = groups["frames"].assign_attrs(folder=str(path.resolve().parent))
    return Survey(groups, survey.attrs)


def _check_nominal(survey: Survey, nominal: float | None, path: Path) -> None:
    if nominal is None:
        return
    if survey.has("rings"):
        ring_units.check_nominal(survey.rings["range"].values, nominal, path)
    elif survey.has("points"):
        x, y, z = (survey.points[axis].values for axis in "xyz")
        clouds.check_nominal(x, y, z, nominal, path)


def _check_zip(path: Path) -> None:
    """Compare check sums first: what zarr says of a damaged zip goes to stderr from its own threads."""
    try:
        with zipfile.ZipFile(path) as bundle:
            damaged = bundle.testzip()
    except (zipfile.BadZipFile, zlib.error, OSError, ValueError, NotImplementedError, RuntimeError) as error:
        raise FormatError(f"the zip file is cut short or damaged: {error}", where=path, mend="copy it again") from None
    if damaged:
        raise FormatError(f"the zip file is damaged at '{damaged}'", where=path, mend="copy it again")


def write_zarr(survey: Survey, path: Path) -> None:
    """Store a survey; nothing is lost."""
    save_survey(survey, path)
