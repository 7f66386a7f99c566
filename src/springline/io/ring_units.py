"""Units of ranges that a table's header leaves open, and the check against the nominal diameter."""

from __future__ import annotations

from math import log
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from .units import METRES

if TYPE_CHECKING:
    from pathlib import Path

    from .columns import Column
    from .options import ReadOptions

_NEAR = 3.0
_CLOSE = 1.5
# Centimetres must be stated: a nominal ten times too large would turn millimetres into them.
_GUESSED = ("m", "mm", "in", "ft")
_PLAUSIBLE_RADIUS = (0.01, 10.0)


def range_unit(
    ranges: np.ndarray, stated: Column, distance_unit: str | None, path: Path, options: ReadOptions
) -> tuple[str, str | None]:
    """Return the unit of a ring table's ranges, and the sentence that states it when it was not plainly stated.

    The column's own unit wins; then the user's; then the one that brings twice the median range nearest to the nominal
    diameter; then metres, where the distance is in metres and the ranges are those of a pipe.

    Args:
        ranges: In the file's unit.
        stated: The first reading's column, with the unit that the file states, if any.
        distance_unit: Unit that the file states for the distance, if any.
        path: The file, for messages.
        options: What the user states.

    Raises:
        InputError: The unit cannot be told.
    """
    if stated.unit:
        if options.unit and options.unit != stated.unit:
            return stated.unit, (
                f"{path.name}: the column '{stated.name}' is in {stated.unit}, as the file states, not {options.unit}."
            )
        return stated.unit, None
    if options.unit:
        return options.unit, None
    diameter = 2.0 * _median(ranges)
    nominal = options.nominal_diameter
    if nominal and diameter > 0:
        unit = min(_GUESSED, key=lambda u: abs(log(diameter * METRES[u] / nominal)))
        if 1 / _CLOSE <= diameter * METRES[unit] / nominal <= _CLOSE:
            return unit, (
                f"{path.name}: the column '{stated.name}' states no unit; taken as {unit}, as twice the median range "
                f"is then {diameter * METRES[unit]:.4g} m, nearest to the nominal {nominal:g} m (--unit overrules)."
            )
    elif distance_unit == "m" and _PLAUSIBLE_RADIUS[0] <= diameter / 2 <= _PLAUSIBLE_RADIUS[1]:
        return "m", (
            f"{path.name}: the column '{stated.name}' states no unit; taken as metres like the distance, so twice the "
            f"median range is {diameter:.4g} m (--unit overrules)."
        )
    raise InputError(
        f"the column '{stated.name}' states no unit, and twice its median range is {diameter:.4g}",
        where=path,
        expected=f"a unit in its name, such as {stated.name}_mm",
        mend="state it with --unit mm|cm|m|in|ft",
    )


def check_nominal(ranges: np.ndarray, nominal: float | None, path: Path) -> None:
    """Refuse ranges [m] whose doubled median is not within a factor of three of the nominal diameter [m].

    Raises:
        InputError: The two are further apart; a unit or the nominal is wrong.
    """
    if nominal is None:
        return
    diameter = 2.0 * _median(ranges)
    if not 1 / _NEAR <= diameter / nominal <= _NEAR:
        raise InputError(
            f"twice the median range is {diameter:.4g} m, far from the nominal diameter {nominal:g} m",
            where=path,
            expected=f"between {nominal / _NEAR:.3g} and {nominal * _NEAR:.3g} m",
            mend="state the right unit with --unit mm|cm|m|in|ft, or mend --nominal",
        )


def _median(ranges: np.ndarray) -> float:
    """Return the median of a sample of the finite ranges; NaN when there is none."""
    flat = ranges[:: max(1, ranges.shape[0] // 2000)]
    flat = flat[np.isfinite(flat)]
    if not flat.size:
        flat = ranges[np.isfinite(ranges)]
    return float(np.median(flat)) if flat.size else float("nan")
