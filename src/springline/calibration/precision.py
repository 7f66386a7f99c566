"""How precise a method is, from repeated results of several laboratories on several materials (ASTM E691, E177).

A laboratory is whatever was changed between sessions (device, operator, day); a material is a reference pipe. Units are
those of the results.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

LIMIT = 1.96 * np.sqrt(2.0)
"""Limits over standard deviations: what two results differ by at most, 95 times in 100 (E177); printed as 2.8."""
SIGNIFICANCE = 0.005
"""Share of consistent cells beyond the critical values of h and k."""
FEWEST_LABORATORIES = 6
"""What the practice asks for at least."""
FEWEST_MEASURES = 4
"""Measured diameters whose mean is a reference (FDOT laser profiling, 1.1.2)."""


@dataclass(frozen=True, eq=False)
class PrecisionStudy:
    """The statistics of a study; arrays over materials (m,) or laboratories and materials (p, m); NaN = not known.

    Attributes:
        laboratories: Names (p).
        materials: Names (m).
        count: Results of each cell (p, m).
        cell_mean: Their averages (p, m).
        cell_deviation: Their standard deviations (p, m).
        h: Between-laboratory consistency (p, m).
        k: Within-laboratory consistency (p, m).
        h_critical: Of each material (m,).
        k_critical: Of each material (m,).
        mean: Average of the cell averages (m,).
        mean_deviation: Standard deviation of the cell averages, s_x (m,).
        repeatability: Standard deviation s_r (m,).
        reproducibility: Standard deviation s_R (m,).
        freedom: Degrees of freedom of s_r (m,).
        reference: Mean of the measures of each material (m,).
        reference_sigma: Its one-sigma (m,).
        bias: mean less reference (m,).
        bias_sigma: Its one-sigma (m,).
        bias_half_width: Half of the bias's 95 % interval (m,).
    """

    laboratories: tuple[str, ...]
    materials: tuple[str, ...]
    count: NDArray[np.int64]
    cell_mean: Array
    cell_deviation: Array
    h: Array
    k: Array
    h_critical: Array
    k_critical: Array
    mean: Array
    mean_deviation: Array
    repeatability: Array
    reproducibility: Array
    freedom: Array
    reference: Array
    reference_sigma: Array
    bias: Array
    bias_sigma: Array
    bias_half_width: Array

    @property
    def repeatability_limit(self) -> Array:
        """(m,) what two results of one laboratory differ by at most, 95 times in 100: r."""
        return LIMIT * self.repeatability

    @property
    def reproducibility_limit(self) -> Array:
        """(m,) what results of two laboratories differ by at most, 95 times in 100: R."""
        return LIMIT * self.reproducibility

    @property
    def flagged(self) -> NDArray[np.bool_]:
        """(p, m) cells whose |h| or k is beyond its critical value: look for a cause, then decide."""
        with np.errstate(invalid="ignore"):
            return (np.abs(self.h) > self.h_critical) | (self.k > self.k_critical)

    def repeatability_interval(self) -> tuple[Array, Array]:
        """Return the 95 % interval (m,), (m,) of s_r from its degrees of freedom."""
        from scipy.stats import chi2

        with np.errstate(divide="ignore", invalid="ignore"):
            low = self.repeatability * np.sqrt(self.freedom / chi2.ppf(0.975, self.freedom))
            high = self.repeatability * np.sqrt(self.freedom / chi2.ppf(0.025, self.freedom))
        return low, high


def study_precision(
    laboratory: Sequence[str],
    material: Sequence[str],
    result: ArrayLike,
    *,
    reference: dict[str, Sequence[float]] | None = None,
) -> PrecisionStudy:
    """Return the precision statistics of test results, and their bias against references.

    Args:
        laboratory: Of each result (n).
        material: Of each result (n).
        result: Test results (n,), all in one unit.
        reference: Measures of the true value of each material by name; at least four each, whose mean counts.

    Returns:
        PrecisionStudy. With one laboratory h, s_x and s_R are NaN, with one result per cell k and s_r. Cells need not
        hold equally many results: s_r pools them by their degrees of freedom and s_R takes their effective number.

    Raises:
        InputError: Nothing to study, a result that is not a number, a reference of an unknown material or with fewer
            than four measures.

    Source: ASTM E691, section 15 (cell statistics, s_r, s_R no less than s_r, h, k and their critical values at 0.5 %);
    ASTM E177 (limits, bias); unequal cells by ISO 5725-2.

    >>> found = study_precision(["a", "a", "b", "b"], ["1"] * 4, [10.0, 12.0, 13.0, 13.0])
    >>> found.mean, found.repeatability, found.reproducibility.round(6)
    (array([12.]), array([1.]), array([1.581139]))
    """
    result = np.asarray(result, float)
    if not len(result) == len(laboratory) == len(material) or not len(result):
        raise InputError(
            f"{len(result)} results of {len(laboratory)} laboratories and {len(material)} materials are given",
            expected="one laboratory and one material for each result, and at least one result",
        )
    if bad := np.flatnonzero(~np.isfinite(result)).tolist():
        raise InputError(f"the result {bad[0] + 1} is {result[bad[0]]}", expected="a finite number")
    laboratories, materials = tuple(dict.fromkeys(laboratory)), tuple(dict.fromkeys(material))
    shape = len(laboratories), len(materials)
    cell = np.array([laboratories.index(a) for a in laboratory]) * shape[1]
    cell += np.array([materials.index(b) for b in material])
    count = np.bincount(cell, minlength=shape[0] * shape[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.bincount(cell, result, count.size) / count
        square = np.bincount(cell, (result - mean[cell]) ** 2, count.size)
        deviation = np.sqrt(square / np.where(count > 1, count - 1, np.nan))
    return _statistics(
        laboratories,
        materials,
        *(one.reshape(shape) for one in (count, mean, deviation)),
        *_references(materials, reference or {}),
    )


def _references(materials: tuple[str, ...], reference: dict[str, Sequence[float]]) -> tuple[Array, Array]:
    value, sigma = np.full(len(materials), np.nan), np.full(len(materials), np.nan)
    for name, measures in reference.items():
        if name not in materials:
            raise InputError(f"a reference is given for '{name}', of which there is no result", where="reference")
        measures = np.asarray(measures, float)
        if measures.size < FEWEST_MEASURES or not np.isfinite(measures).all():
            raise InputError(
                f"'{name}' has {measures.size} measures",
                where="reference",
                expected=f"at least {FEWEST_MEASURES} numbers",
            )
        k = materials.index(name)
        value[k], sigma[k] = measures.mean(), measures.std(ddof=1) / np.sqrt(measures.size)
    return value, sigma


def _statistics(
    laboratories: tuple[str, ...],
    materials: tuple[str, ...],
    count: NDArray[np.int64],
    mean: Array,
    deviation: Array,
    reference: Array,
    reference_sigma: Array,
) -> PrecisionStudy:
    from scipy.stats import t as student

    present = count > 0
    taking_part = present.sum(axis=0)
    whole = np.where(present, mean, 0.0).sum(axis=0) / taking_part
    off = mean - whole
    freedom = np.where(present, count - 1, 0).sum(axis=0).astype(float)
    with np.errstate(divide="ignore", invalid="ignore"):
        several = np.where(taking_part > 1, taking_part - 1, np.nan)
        between = np.sqrt(np.nansum(off**2, axis=0) / several)
        spread = np.nansum(deviation**2 * (count - 1), axis=0)
        within = np.sqrt(np.where(freedom > 0, spread / freedom, np.nan))
        number = count.sum(axis=0)
        effective = (number - (count**2).sum(axis=0) / number) / several
        both = np.sqrt(between**2 + within**2 * (1.0 - 1.0 / effective))
        reproducibility = np.fmax(both, np.where(np.isnan(both), np.nan, within))
        h, k = off / between, deviation / within
        bias = whole - reference
        own = np.where(taking_part > 1, between / np.sqrt(taking_part), within / np.sqrt(number))
        bias_sigma = np.hypot(own, reference_sigma)
        own_freedom = np.where(taking_part > 1, taking_part - 1, freedom)
        half_width = student.ppf(0.975, np.where(own_freedom > 0, own_freedom, np.nan)) * bias_sigma
    return PrecisionStudy(
        laboratories, materials, count, mean, deviation, h, k,
        *_critical(taking_part, np.where(present.any(axis=0), number / taking_part, np.nan)),
        whole, between, within, reproducibility, freedom,
        reference, reference_sigma, bias, bias_sigma, half_width,
    )  # fmt: skip


def _critical(laboratories: NDArray[np.int64], results: Array) -> tuple[Array, Array]:
    """Return the critical values of |h| and k, as the practice derives them from Student's t and from F."""
    from scipy.stats import f, t

    p = np.where(laboratories > 2, laboratories, np.nan).astype(float)
    quantile = t.ppf(1.0 - 0.5 * SIGNIFICANCE, p - 2.0)
    h = (p - 1.0) * quantile / np.sqrt(p * (quantile**2 + p - 2.0))
    n = np.where(results > 1.0, results, np.nan)
    p = np.where(laboratories > 1, laboratories, np.nan).astype(float)
    ratio = f.ppf(1.0 - SIGNIFICANCE, n - 1.0, (p - 1.0) * (n - 1.0))
    return h, np.sqrt(p / (1.0 + (p - 1.0) / ratio))
