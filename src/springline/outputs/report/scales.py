"""Lengths as the report prints them: metric, or inches and feet, chosen once for the whole page."""

from __future__ import annotations

from dataclasses import dataclass
from math import log10
from typing import TYPE_CHECKING

from ..colours import nice_limit
from ..units import System, unit
from .texts import measured, number

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class Scale:
    """One printed unit of a quantity that is held in SI.

    Args:
        name: As headings say it.
        factor: Number in this unit of one SI unit.
        decimals: Decimals to show beyond those of the metric number.
    """

    name: str
    factor: float
    decimals: int = 0

    def number(self, value: float, decimals: int) -> str:
        """Return a value [SI] as text without its unit; `decimals` are those of the metric number."""
        return number(value * self.factor, max(decimals + self.decimals, 0))

    def text(self, value: float, decimals: int) -> str:
        """Return a value [SI] with its unit; `decimals` are those of the metric number."""
        return f"{self.number(value, decimals)}\u00a0{self.name}"

    def plain(self, value: float) -> str:
        """Return a stated size [SI], such as a nominal diameter, without digits that were never stated."""
        return f"{round(value * self.factor, 4 + min(self.decimals, 0)):g}\u00a0{self.name}"

    def limit(self, departures: np.ndarray) -> float:
        """Return a limit [SI], round in this unit, that all but the largest 0.2 % of the departures stay below."""
        within_decade = self.factor / 10.0 ** round(log10(self.factor))
        return nice_limit(departures * within_decade) / within_decade

    def measured(self, value: float, half: float, *, least: int = 0, most: int = 4) -> tuple[str, str]:
        """Return value and half interval [SI] as texts, to two significant digits of the half interval."""
        more = max(self.decimals, 0)
        return measured(value * self.factor, half * self.factor, least=least + more, most=most + more)


@dataclass(frozen=True)
class Scales:
    """The units of one report.

    Attributes:
        small: Of diameters, departures and thicknesses (mm or in).
        length: Of chainage, elevation and radii (m or ft).
        area: Of cross-sections (m² or ft²).
    """

    small: Scale
    length: Scale
    area: Scale


def make_scales(system: System) -> Scales:
    """Return the units of a report.

    >>> make_scales("us").small.text(0.3, 1), make_scales("si").length.text(22.957, 2)
    ('11.811\\xa0in', '22.96\\xa0m')
    >>> make_scales("us").small.plain(0.010), make_scales("si").small.plain(0.0085)
    ('0.3937\\xa0in', '8.5\\xa0mm')
    """

    def scale(metric: str, per_si: float) -> Scale:
        found = unit(metric, system)
        return Scale(found.name, per_si * found.factor, found.decimals)

    return Scales(scale("mm", 1e3), scale("m", 1.0), scale("m²", 1.0))
