"""Surveys as Springline stores them: a zarr folder or a `.zarr.zip`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..survey import Survey, open_survey, save_survey

if TYPE_CHECKING:
    from pathlib import Path

    from .options import ReadOptions

_SENSED = ("points", "rings", "rings_rear")


def read_zarr(path: Path, options: ReadOptions) -> Survey:
    """Open a stored survey; the user's word on the kind of sensor wins over the stored one.

    Raises:
        FormatError: Not a zarr store, or damaged.
    """
    survey = open_survey(path)
    if options.sensor is None:
        return survey
    groups = {
        name: data.assign_attrs(sensor_kind=options.sensor) if name in _SENSED else data
        for name, data in ((name, survey.group(name)) for name in survey.groups)
    }
    return Survey(groups, survey.attrs)


def write_zarr(survey: Survey, path: Path) -> None:
    """Store a survey; nothing is lost."""
    save_survey(survey, path)
