"""Tables from which a lens is calibrated: pairs of zenith and radius, and sights of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError, InputError, nearest

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

PAIRS = ("zenith_deg", "radius_px")
"""Columns of pairs: angle to the optical axis, and distance from the principal point."""

SIGHTS = ("joint", "distance_m", "radius_px")
"""Columns of sights: which joint, the odometer then, and the image radius of its circle."""


def read_lens_table(path: Path, columns: tuple[str, ...]) -> dict[str, NDArray]:
    """Read the named columns of a CSV; `joint` as text, all others as numbers, an empty cell as NaN.

    Raises:
        InputError: The file or a column is missing or unknown, or a cell is no number; row and column named.
        FormatError: It is not a text table.
    """
    import pandas as pd

    if not path.is_file():
        raise InputError("no such file", where=path)
    try:
        table = pd.read_csv(path, dtype=str, keep_default_na=False, skipinitialspace=True, encoding="utf-8-sig")
    except (pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeDecodeError) as error:
        raise FormatError(f"it is not a text table: {error}", where=path, expected=", ".join(columns)) from None
    names = [str(name).strip() for name in table.columns]
    for name in columns:
        if name not in names:
            raise InputError(f"the column '{name}' is missing", where=path, expected=", ".join(columns))
    for name in names:
        if name not in columns:
            raise InputError(f"unknown column '{name}'{nearest(name, columns)}", where=path)
    table.columns = names
    return {name: table[name].to_numpy() if name == "joint" else _numbers(table[name], name, path) for name in columns}


def _numbers(cells, name: str, path: Path) -> NDArray[np.float64]:
    import pandas as pd

    text = cells.str.strip()
    values = pd.to_numeric(text, errors="coerce").to_numpy(np.float64)
    wrong = np.flatnonzero(np.isnan(values) & ~text.str.lower().isin(["", "nan"]).to_numpy())
    if wrong.size:
        raise InputError(
            f"the cell '{cells.iloc[wrong[0]]}' is not a number", where=f"{path}, row {wrong[0] + 2}, column {name}"
        )
    return values
