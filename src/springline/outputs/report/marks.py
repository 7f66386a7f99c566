"""Where features are marked on the maps, with labels only where they do not lie on one another."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

    from .profiles import Axis

_DIGIT, _HIGH = 0.012, 0.11


@dataclass(frozen=True)
class Mark:
    """One feature on a map.

    Attributes:
        left: Share of the map's width.
        top: Share of its height; None for what goes all the way round, such as a joint.
        label: Its number in the list; empty where another label stands already.
    """

    left: float
    top: float | None
    label: str


def make_marks(features: pd.DataFrame, axis: Axis) -> tuple[Mark, ...]:
    """Return the marks of the features on maps over a chainage axis.

    Args:
        features: Rows of `features.csv`.
        axis: The chainage axis of the maps [m].
    """
    rows = [
        (k, axis.share(float(row.chainage_m)), ((6.0 - row.clock_h) / 12.0) % 1.0 if isfinite(row.clock_h) else None)
        for k, row in enumerate(features.itertuples(), 1)
        if isfinite(row.chainage_m)
    ]
    wide = _DIGIT * (1 + len(str(len(features))))
    labelled: list[tuple[float, float]] = []
    marks = []
    # What has a place on the wall is labelled before what goes all the way round.
    for k, left, top in sorted(rows, key=lambda row: (row[2] is None, row[0])):
        at = (left, 0.0 if top is None else top)
        free = all(abs(at[0] - x) > wide or abs(at[1] - y) > _HIGH for x, y in labelled)
        if free:
            labelled.append(at)
        marks.append(Mark(left, top, str(k) if free else ""))
    return tuple(marks)
