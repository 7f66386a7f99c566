"""Tables that authorities ask for: the measures of a reach, and a laser profile by the foot."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from ..results import Results
from ..tables import write_csv
from ..units import unit

if TYPE_CHECKING:
    from pathlib import Path

    from ...survey import Survey

_FOOT = 0.3048
_LIMIT = 0.05


def write_reach(survey: Survey, path: Path) -> None:
    """Write one row for the reach: least, mean and largest height, width, inner perimeter and ovality.

    What German federal works ask for before a reach is lined; the columns' names are ours. Height and width are the
    vertical and horizontal chords of the fitted section, ovality is (max - mean)/mean with the polar mean. Stations
    flagged as not speaking for the pipe are left out and counted.

    Args:
        survey: A finished survey.
        path: Where to write: comma, point, UTF-8.
    """
    results = Results(survey)
    columns: dict[str, object] = {
        "reach": str(survey.attrs.get("name") or ""),
        "date": str(survey.attrs.get("date") or ""),
        "length_m": results.length,
        "stations": float(results.stations),
    }
    decimals = {"length_m": 3, "stations": 0, "stations_used": 0}
    measures = (
        ("height", "diameter_y", "mm", 1e3, 1),
        ("width", "diameter_x", "mm", 1e3, 1),
        ("inner_perimeter", "perimeter", "mm", 1e3, 1),
        ("ovality_polar", "ovality_polar", "pct", 1e2, 2),
    )
    columns["stations_used"] = float(np.isfinite(results.judged("diameter_y")).sum())
    for name, variable, suffix, factor, places in measures:
        values = results.judged(variable) * factor
        known = values[np.isfinite(values)]
        for word, take in (("min", np.min), ("mean", np.mean), ("max", np.max)):
            column = f"{name}_{word}_{suffix}"
            columns[column] = float(take(known)) if known.size else np.nan
            decimals[column] = places
    write_csv(pd.DataFrame({name: [value] for name, value in columns.items()}), path, decimals)


def write_fdot(survey: Survey, path: Path) -> None:
    """Write the profile by the foot as FDOT Section 430 asks for it [ft, in].

    Each row stands for one foot: least and largest diameter, mean horizontal and vertical one, and the largest
    deflection in it with whether that is over 5 %, the limit of the Department's repair matrix. Deflection refers to
    Dref of the survey, not to the procedure's representative diameter; `--check fdot-430` judges by the latter.

    Args:
        survey: A finished survey.
        path: Where to write: comma, point, UTF-8.
    """
    results = Results(survey)
    inch, foot = unit("mm", "us").factor * 1e3, unit("m", "us").factor
    row_of = np.floor(results.chainage / _FOOT + 1e-9).astype(int)
    rows, first = np.unique(row_of, return_index=True)
    values = {name: results.judged(name) for name in ("diameter_min", "diameter_max", "diameter_x", "diameter_y")}
    deflection = results.judged("deflection")
    stops = np.append(first[1:], row_of.size)
    table = {
        "from_ft": rows.astype(float),
        "to_ft": rows + 1.0,
        "diameter_min_in": _of(np.min, values["diameter_min"], first, stops) * inch,
        "diameter_max_in": _of(np.max, values["diameter_max"], first, stops) * inch,
        "diameter_horizontal_in": _of(np.mean, values["diameter_x"], first, stops) * inch,
        "diameter_vertical_in": _of(np.mean, values["diameter_y"], first, stops) * inch,
        "deflection_pct": _of(np.max, deflection, first, stops) * 1e2,
        "deflection_at_ft": _where_largest(deflection, first, stops, results.chainage * foot),
    }
    frame = pd.DataFrame(table)
    over = frame["deflection_pct"].to_numpy()
    frame["over_5_pct"] = np.where(np.isfinite(over), np.where(over > 1e2 * _LIMIT, "yes", "no"), "")
    decimals = {name: 0 if name in ("from_ft", "to_ft") else 3 for name in table}
    write_csv(frame, path, decimals)


def _of(take: object, values: np.ndarray, starts: np.ndarray, stops: np.ndarray) -> np.ndarray:
    """Return a statistic of what is known in each piece; NaN where nothing is."""
    found = np.full(starts.size, np.nan)
    for k, (start, stop) in enumerate(zip(starts.tolist(), stops.tolist(), strict=True)):
        piece = values[start:stop]
        known = piece[np.isfinite(piece)]
        if known.size:
            found[k] = take(known)
    return found


def _where_largest(values: np.ndarray, starts: np.ndarray, stops: np.ndarray, place: np.ndarray) -> np.ndarray:
    found = np.full(starts.size, np.nan)
    for k, (start, stop) in enumerate(zip(starts.tolist(), stops.tolist(), strict=True)):
        piece = values[start:stop]
        if np.isfinite(piece).any():
            found[k] = place[start + int(np.nanargmax(piece))]
    return found
