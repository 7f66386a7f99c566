"""The lists of the layout: bends, sags, and angles at joints."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from ...conventions import clock_from_bearing
from .listings import LISTED, Table, degrees_text, placed_text
from .texts import SIGMAS_95, clock_text

if TYPE_CHECKING:
    from ..results import Results
    from .scales import Scale, Scales


def bends_table(results: Results, scales: Scales) -> Table:
    """Return the bends of the layout; without rows when there are none, or no layout."""
    length = scales.length
    data = _LayoutTable(results, "bend_start")
    clock = clock_from_bearing(data["bend_towards"])
    rows = tuple(
        (
            placed_text(data["bend_start"][k], data["bend_start_sigma"][k], scales),
            length.number(data["bend_length"][k], 2),
            degrees_text(data["bend_angle"][k], SIGMAS_95 * data["bend_angle_sigma"][k]),
            _around(length, data["bend_arc_radius"][k], data["bend_arc_radius_sigma"][k]),
            clock_text(float(clock[k])) if isfinite(clock[k]) else "–",
        )
        for k in range(data.count)
    )
    name = length.name
    return Table(
        (f"Begins at [{name}]", f"Length [{name}]", "Angle [°]", f"Radius [{name}]", "Towards"), rows, frozenset()
    )


def sags_table(results: Results, scales: Scales) -> Table:
    """Return the sags of the layout; without rows when there are none, or no layout."""
    small, length = scales.small, scales.length
    data = _LayoutTable(results, "sag_start")
    rows = tuple(
        (
            length.number(data["sag_start"][k], 2),
            length.number(data["sag_length"][k], 2),
            length.number(data["sag_lowest"][k], 2),
            _around(small, data["sag_depth"][k], data["sag_depth_sigma"][k]),
            _around(small, data["sag_ponding"][k], data["sag_ponding_sigma"][k]),
        )
        for k in range(data.count)
    )
    headings = (
        *(f"{word} [{length.name}]" for word in ("Begins at", "Length", "Deepest at")),
        *(f"{word} [{small.name}]" for word in ("Below the straight line", "Water that stands")),
    )
    return Table(headings, rows, frozenset())


def angles_table(results: Results, scales: Scales) -> Table:
    """Return the angles of the axis at joints; without rows when there are none, or no layout."""
    data = _LayoutTable(results, "joint_chainage")
    rows = tuple(
        (
            scales.length.number(data["joint_chainage"][k], 2),
            degrees_text(data["joint_up"][k], SIGMAS_95 * data["joint_up_sigma"][k]),
            degrees_text(data["joint_right"][k], SIGMAS_95 * data["joint_right_sigma"][k]),
        )
        for k in range(min(data.count, LISTED))
    )
    return Table((f"Joint at [{scales.length.name}]", "Upwards", "To the right"), rows, frozenset())


class _LayoutTable:
    """Columns of one of the lists in `/layout`, NaN where the survey does not have them."""

    def __init__(self, results: Results, first: str) -> None:
        has = results.survey.has("layout") and first in results.survey.layout
        self._data = results.survey.layout if has else None
        self.count = int(self._data[first].size) if has else 0

    def __getitem__(self, name: str) -> np.ndarray:
        if self._data is None or name not in self._data:
            return np.full(self.count, np.nan)
        return self._data[name].values


def _around(scale: Scale, value: float, sigma: float) -> str:
    shown, half = scale.measured(value, SIGMAS_95 * sigma, least=1, most=2)
    return shown if half == "–" else f"{shown} ± {half}"
