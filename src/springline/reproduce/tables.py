"""Tables 3.1 to 3.5 beside the printed cells: what the author's arithmetic gives, and what the geometry gives.

Ovality q and the relative differences are percent here, as in the tables; everything else is as printed: C is a
number, pressure in psi, thickness in inches.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

from springline.design.f1216 import PSI, buckling_pressure, ovality_factor, thickness_buckling
from springline.errors import ParameterError
from springline.geometry.sections import hinged, ovality
from springline.geometry.sections.ellipses import mean_radius
from springline.reproduce.printed import ovality_as_printed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

TABLES = ("3.1", "3.2", "3.3", "3.4", "3.5")

ROUNDED_MEANS = np.array([10.0, 10.2454, 10.4821, 10.7107, 10.9317]) / 10.0
"""Mean polar radii of ellipses with r1/r2 = 1.00 to 1.20, as Appendix A lists them."""

LISTING_OFFSET = 1e-6
"""By how much the listing starts s1 below s02 or s01, to keep atan(0/0) away."""

REASONS = {
    "means": "Appendix A lists the mean radii with four decimals (1.02454, 1.04821, ...); the integral (3.19) itself, "
    "r1 r2 / agm(r1, r2), gives the last digit on the right.",
    "sign": "Erratum A1: (3.22) takes alpha counter-clockwise, but the top-left arc turns clockwise and the listing "
    "feeds it +alpha. The integral then belongs to no section; with -alpha it does.",
    "offset": "Appendix A starts s1 a millionth below its upper limit, which is enough to turn this rounding.",
}
"""Why a printed cell differs from the corrected one."""

DESIGN = {"modulus": 72500.0 * PSI, "poisson": 0.35, "enhancement": 7.0, "safety": 2.0}
INCH = 0.0254
_GROUPS = {"axes": "mean of the axes", "polar": "polar mean", "difference": "difference"}
_UNITS = {"q": " [%]", "C": "", "P": " [psi]", "t": " [in]"}
MEAN_DIAMETER, THICKNESS, PRESSURE = 8.0, 0.2462, 20.0


@dataclass(frozen=True)
class ReproducedTable:
    """One table: printed cells, the author's arithmetic and the corrected values, each (rows, columns).

    Attributes:
        number: As cited in the text, such as "3.4"; the table itself is headed `printed_as`.
        printed_as: Its printed number, which lost the chapter.
        caption: What it shows.
        row: What a row's name stands for.
        rows: The rows' names.
        columns: Quantity and method of each column.
        printed: The printed cells.
        published: What the author's arithmetic gives, its errors included.
        corrected: What the geometry gives.
        given: Severities that hold for the whole table.
    """

    number: str
    printed_as: str
    caption: str
    row: str
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    printed: tuple[tuple[str, ...], ...]
    published: Array
    corrected: Array
    given: Mapping[str, float]

    @cached_property
    def published_text(self) -> tuple[tuple[str, ...], ...]:
        """The author's arithmetic with the printed decimals."""
        return _rounded(self.published, self.printed)

    @cached_property
    def corrected_text(self) -> tuple[tuple[str, ...], ...]:
        """The corrected values with the printed decimals."""
        return _rounded(self.corrected, self.printed)

    @cached_property
    def matches_published(self) -> NDArray[np.bool_]:
        """Whether the author's arithmetic gives each printed cell to its last digit."""
        return np.array(self.published_text) == np.array(self.printed)

    @cached_property
    def matches_corrected(self) -> NDArray[np.bool_]:
        """Whether the corrected value rounds to each printed cell."""
        return np.array(self.corrected_text) == np.array(self.printed)

    @cached_property
    def reasons(self) -> tuple[str, ...]:
        """The keys of REASONS that apply to some cell."""
        rows, columns = range(len(self.rows)), range(len(self.columns))
        found = [self.reason(i, j) for i in rows for j in columns]
        return tuple(dict.fromkeys(key for key in found if key))

    @property
    def groups(self) -> tuple[tuple[str, int], ...]:
        """The headings over neighbouring columns, and how many each spans."""
        names = [column.split()[1] for column in self.columns]
        return tuple((_GROUPS[name], names.count(name)) for name in dict.fromkeys(names))

    @property
    def headings(self) -> tuple[str, ...]:
        """Symbol and unit of each column."""
        return tuple(
            f"{symbol}{_UNITS['q' if group == 'difference' else symbol]}"
            for symbol, group in (column.split() for column in self.columns)
        )

    def reason(self, row: int, column: int) -> str:
        """Return the key of REASONS for a cell that is printed otherwise than corrected, else an empty string."""
        if self.matches_corrected[row, column]:
            return ""
        if self.number == "3.1":
            return "means"
        return "offset" if self.columns[column].endswith("axes") else "sign"


def table(number: str) -> ReproducedTable:
    """Return one of the dissertation's tables made again.

    Args:
        number: "3.1" to "3.5".

    Raises:
        ParameterError: There is no such table.

    Source: section 3.4.3 and Appendix A; errata A1, A8 and D.

    >>> found = table("3.4")
    >>> found.printed[-1][2], found.published_text[-1][2], found.corrected_text[-1][2]
    ('10.89', '10.89', '10.53')
    >>> int(found.matches_published.sum()), found.matches_published.size
    (36, 36)
    """
    if number not in TABLES:
        raise ParameterError(f"table {number!r} is not known", expected=f"one of {', '.join(TABLES)}")
    facts = _facts()[number]
    rows = tuple(cells[0] for cells in facts["cells"])
    of = _mode_one if number == "3.1" else _hinged_mode
    published, corrected = of(np.array(rows, float), facts)
    return ReproducedTable(
        number=number,
        printed_as=facts["printed_as"],
        caption=facts["caption"],
        row=facts["row"],
        rows=rows,
        columns=tuple(facts["columns"]),
        printed=tuple(tuple(cells[1:]) for cells in facts["cells"]),
        published=published,
        corrected=corrected,
        given={name: facts[name] for name in ("s02", "s01") if name in facts},
    )


def _facts() -> dict[str, Any]:
    return tomllib.loads(files(__package__).joinpath("data/tables.toml").read_text(encoding="utf-8"))


def _rounded(values: Array, printed: tuple[tuple[str, ...], ...]) -> tuple[tuple[str, ...], ...]:
    def cell(value: float, like: str) -> str:
        decimals = len(like.partition(".")[2])
        return f"{round(value, decimals) + 0.0:.{decimals}f}"

    return tuple(tuple(map(cell, row, likes)) for row, likes in zip(values, printed, strict=True))


def _mode_one(ratio: Array, facts: dict[str, Any]) -> tuple[Array, Array]:
    """Return (3.1) with the listed means and with the integral: r2 = 1, so that the ratio is the largest radius."""
    axes = (1.0 + ratio) / 2.0
    return tuple(_design_row(ratio, axes, polar) for polar in (ROUNDED_MEANS, mean_radius(ratio, 1.0)))


def _design_row(largest: Array, axes: Array, polar: Array) -> Array:
    parts, differences = [], []
    for mean in (axes, polar):
        q = np.maximum(ovality(largest, mean), 0.0)
        factor = ovality_factor(q)
        # the text's D_m/t is DR - 1
        ratio = MEAN_DIAMETER / THICKNESS + 1.0
        pressure = buckling_pressure(ratio, factor=factor, **DESIGN) / PSI
        thickness = thickness_buckling(PRESSURE * PSI, MEAN_DIAMETER * INCH, factor=factor, convention="mean", **DESIGN)
        parts += [100.0 * q, factor, pressure, thickness / INCH]
    # printed as magnitudes
    differences = [100.0 * np.abs(1.0 - parts[k + 4] / parts[k]) for k in (2, 3)]
    return np.stack([*parts, *differences], axis=-1)


def _hinged_mode(s: Array, facts: dict[str, Any]) -> tuple[Array, Array]:
    given = {name: facts[name] for name in ("s02", "s01") if name in facts}
    # modes 4 and 5 only: in modes 2 and 3 nothing is 0/0
    start = s - LISTING_OFFSET if given else s
    wrong = ovality_as_printed(facts["mode"], start, **given)
    diameters = hinged(facts["mode"], s, **given).diameters
    q = [diameters.ovality("axes"), diameters.ovality("polar")]
    right = [q[0], ovality_factor(np.maximum(q[0], 0.0)), q[1], ovality_factor(np.maximum(q[1], 0.0))]
    return _hinged_row(*wrong), _hinged_row(*right)


def _hinged_row(q_axes: Array, c_axes: Array, q_polar: Array, c_polar: Array) -> Array:
    same = q_axes <= 1e-12
    difference = np.where(same, 0.0, 1.0 - q_polar / np.where(same, 1.0, q_axes))
    columns = [100.0 * q_axes, c_axes, 100.0 * q_polar, c_polar, 100.0 * difference, 100.0 * (1.0 - c_polar / c_axes)]
    return np.stack(columns, axis=-1)
