"""The stage itself: every candidate is sized by what its kind calls for, and placed on the pipe."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ...conventions import GROUPS
from ...survey import add_assumption
from .sizing import Sizer
from .wall import Wall

if TYPE_CHECKING:
    from ...config import Config
    from ...survey import Survey

_WORDS = ("kind", "source", "image")
_COUNTS = ("first_ring", "last_ring")


def features(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/features`: joints, laterals, dents, deposits and intrusions, sized, each with its sigma.

    What a candidate stands off is measured against the section that goes on along the pipe without it, about the
    sensor's place in the pipe. An inward patch that touches an opening is the end of a lateral that stands into the
    pipe; one in the lower third is taken for a deposit, a steep one for an intrusion, any other for a dent (6.5). What
    cannot be told is missing: the gap of a joint in which no ring stands, the depth of a lateral.

    Args:
        survey: With `/rings`, `/mask`, `/candidates`, `/pose` and `/section`.
        config: `detect.least_depth` and `detect.least_confidence`.

    Source: dissertation 6.5.
    """
    found = survey.candidates
    rows: list[dict[str, object]] = []
    by_rings = np.flatnonzero((found["source"].values == "rings") & (found["first_ring"].values >= 0))
    if len(by_rings):
        sizer = Sizer(Wall(survey), found, by_rings, config.detect)
        rows = [row for row in sizer.rows() if row["confidence"] >= config.detect.least_confidence]
    rows.sort(key=lambda row: row["chainage"])
    data = xr.Dataset({name: ("feature", values) for name, values in _columns(rows).items()})
    data.attrs = {"false_alarm": config.detect.false_alarm}
    if any(row["kind"] in ("dent", "deposit") for row in rows):
        survey = add_assumption(
            survey,
            "Whether a patch that stands inward is a dent or a deposit is told by where it lies: rings do not show it.",
        )
    return survey.with_group("features", data)


def _columns(rows: list[dict[str, object]]) -> dict[str, np.ndarray]:
    """Return the rows as columns of the contract; what a row does not say is NaN, empty or -1."""
    columns = {}
    for variable in GROUPS["features"].variables:
        name = variable.name
        if name in _WORDS:
            columns[name] = np.array([str(row.get(name, "")) for row in rows], dtype="U64")
        elif name in _COUNTS:
            columns[name] = np.array([int(row.get(name, -1)) for row in rows], np.int64)
        else:
            columns[name] = np.array([float(row.get(name, np.nan)) for row in rows], float)
    return columns
