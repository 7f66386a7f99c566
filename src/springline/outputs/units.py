"""Units that people read: metric as everywhere inside, or inches and feet; tables and report convert here alone.

The foot is the international one, 0.3048 m exactly; coordinates become feet with all else, as their headings say.
Percent, degrees, clock hours and dimensionless numbers stay. Nothing is rounded here: `Unit.decimals` says how many
decimals a number needs more than in metric units to keep what it says.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from ..errors import ParameterError, nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

System = Literal["si", "us"]
"""Metric units, or inches and feet."""

SYSTEMS: tuple[System, ...] = ("si", "us")
"""The systems of units."""


@dataclass(frozen=True)
class Unit:
    """A unit as printed.

    Args:
        name: As headings say it, such as "in".
        factor: Number in this unit of one of the metric unit that it stands for.
        decimals: Decimals to show beyond those of the metric number; may be negative.
    """

    name: str
    factor: float = 1.0
    decimals: int = 0


_INCH, _FOOT = 0.0254, 0.3048
_US = {
    "mm": Unit("in", 1e-3 / _INCH, 2),
    "m": Unit("ft", 1.0 / _FOOT, 0),
    "m2": Unit("ft2", 1.0 / _FOOT**2, 0),
    "m²": Unit("ft²", 1.0 / _FOOT**2, 0),
}
_BRACKETS = re.compile(r"\[([^\[\]]+)\]")


def unit(metric: str, system: System) -> Unit:
    """Return the unit that stands for a metric one: mm, m, m2 and m² have another in `us`, all else stays.

    Args:
        metric: Name of the metric unit, such as "mm".
        system: "si" or "us".

    Raises:
        ParameterError: The system is unknown.

    >>> unit("mm", "us").name, round(300 * unit("mm", "us").factor, 3), unit("%", "us").name
    ('in', 11.811, '%')
    """
    if system not in SYSTEMS:
        raise ParameterError(f"'{system}' is unknown{nearest(system, SYSTEMS)}", where="units", expected="si or us")
    return _US.get(metric, Unit(metric)) if system == "us" else Unit(metric)


def heading(text: str, system: System) -> str:
    """Return a heading with its unit in brackets replaced.

    >>> heading("Largest diameter [mm]", "us")
    'Largest diameter [in]'
    """
    return _BRACKETS.sub(lambda found: f"[{unit(found[1], system).name}]", text)


def column(name: str, system: System) -> str:
    """Return the name of a table's column with the unit at its end replaced.

    >>> column("diameter_max_mm", "us"), column("diameter_max_clock_h", "us"), column("flags", "us")
    ('diameter_max_in', 'diameter_max_clock_h', 'flags')
    """
    stem, _, last = name.rpartition("_")
    return f"{stem}_{unit(last, system).name}" if stem else name


def converted(table: pd.DataFrame, decimals: Mapping[str, int], system: System) -> tuple[pd.DataFrame, dict[str, int]]:
    """Return a table of metric columns in a system of units, and the decimals of its columns.

    Args:
        table: Columns whose names end in their metric unit, such as `chainage_m`.
        decimals: Decimals by column; columns that are not named hold text and stay.
        system: "si" or "us".
    """
    table, shown = table.copy(), {}
    for name, places in decimals.items():
        found = unit(name.rpartition("_")[2], system)
        if name in table.columns:
            table[name] = table[name] * found.factor
        shown[column(name, system)] = places + found.decimals
    return table.rename(columns={name: column(name, system) for name in decimals}), shown
