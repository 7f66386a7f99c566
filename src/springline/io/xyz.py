"""Clouds as text: XYZ, TXT, CSV with x, y, z."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError, InputError
from .axes import SURVEY
from .clouds import RawCloud, cloud_survey
from .columns import factor, parse_column
from .tables import TextTable, open_table
from .units import METRES

if TYPE_CHECKING:
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

_INTENSITY = ("intensity", "i", "reflectance", "scalar_intensity")


def is_cloud_table(table: TextTable) -> bool:
    """Whether a table has the columns x, y, z, or no header and three to eight columns."""
    if table.names:
        return {"x", "y", "z"} <= {parse_column(name).quantity for name in table.names}
    return 3 <= table.width <= 8


def read_xyz(path: Path, options: ReadOptions) -> Survey:
    """Read a cloud from text into `/points`: columns x, y, z by name, or the first three where there is no header.

    The axes are taken as a scanner's (z up, x forward) unless stated.

    Raises:
        FormatError: There are no columns x, y, z.
        InputError: A cell is not a number, a row has too many or too few cells, or no point is left.
    """
    table = open_table(path)
    if not is_cloud_table(table):
        raise FormatError("there are no columns x, y, z", where=path, expected="a header with x, y, z, or none at all")
    parts = [block.values for block in table.blocks()]
    if not parts or not sum(map(len, parts)):
        raise InputError("there are no rows", where=path, expected="at least one point")
    values = np.concatenate(parts)
    notes: tuple[str, ...] = ()
    if not table.names:
        if table.width > 3:
            notes = (f"{path.name}: there is no header; its first three columns are taken as x, y, z.",)
        return cloud_survey(RawCloud(values[:, :3], axes=SURVEY, notes=notes), path, options)
    columns = [parse_column(name) for name in table.names]
    at = {c.quantity: i for i, c in reversed(list(enumerate(columns)))}
    units = {columns[at[axis]].unit for axis in "xyz"}
    if len(units) > 1:
        raise InputError("x, y and z state different units", where=path, expected="one unit")
    unit = units.pop()
    named = next((u for u in METRES if unit and METRES[u] == factor(columns[at["x"]])), None)
    intensity = next((values[:, at[n]] for n in _INTENSITY if n in at), None)
    time = values[:, at["time"]] * factor(columns[at["time"]], "s") if "time" in at else None
    raw = RawCloud(values[:, [at["x"], at["y"], at["z"]]], axes=SURVEY, unit=named, intensity=intensity, time=time)
    return cloud_survey(raw, path, options)
