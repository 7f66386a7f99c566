"""The mean section of a stretch of pipe from rings about its axis, with an honest sigma.

A depth camera or a scanner inside a pipe does not err independently from point to point: whole patches of wall lie a
little too near or too far. Counting every reading would state a sigma many times too small. Here the scatter of
patches, beyond that of their readings, says how many readings are worth one.

What the readings cannot tell is stated as a prior, never as data: an unseen half can hide an ovality, so the ovality
has a prior about the circle while much is unseen; and the sensor may err alike along the whole stretch, so each
sector of bearing may depart from the ellipse by a common amount. Both widen the sigma of the diameter where the arc
seen is short, and vanish where the whole circumference is seen. The diameter itself has no prior.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import InputError
from springline.geometry.axis._rows import row_median

if TYPE_CHECKING:
    from numpy.typing import NDArray

OVALITY_PRIOR = 0.002
"""One-sigma of oval_cos and of oval_sin, in radii, while a third of the circumference or more is unseen in one piece.
EN 1401-1 lets a new pipe be out of round by 0.024 of its diameter, which is an amplitude of 0.012 radii."""
UNSEEN = 2.0 * np.pi / 3.0
"""Unseen arc [rad] below which the prior fades, with the fourth power of the arc."""
COMMON_PRIOR = 0.0015
"""One-sigma of the departure that a sector keeps along the whole stretch, in radii."""

SECTORS = 24
"""Sectors of bearing that may each err alike along the stretch."""
_PATCH = (0.3, np.radians(10.0))
"""Length [radii] and width [rad] of the smallest patches whose scatter is compared with that of their readings."""
_GROWTH = (1, 2, 3)
"""Patches so many times longer and wider are compared too, as errors may be alike over more than one patch."""
_FEWEST_PATCHES = 30
_GATE = 0.15
"""Readings further from the typical radius than this, in radii, are not of the wall."""
TUKEY = 4.685
"""Readings further off than this many robust sigmas do not count; 95 % efficient under normal noise."""
_LEAST_SCATTER = 2e-4
_ENOUGH = 60
_LEAST = 24
"""Readings from which the scatter at one distance is told; more stations are drawn in until there are so many."""
_STEPS = 60
_POWERS = np.array([0, 0, 0, 1, 1, 0, 0])
"""Power of the distance along the axis in the columns of the model: only the centre's slope has one."""


@dataclass(frozen=True)
class PooledSection:
    """The common section of rings about one axis; an ellipse as in `conventions.SECTION_PARAMETERS`.

    Attributes:
        mean_radius: Half sum of the semi-axes [m].
        oval_cos: Half their difference times cos of twice the major axis's bearing [m].
        oval_sin: The same times sin [m].
        centre: (2,) centre (y, z) at `middle`, about the rings' axis [m].
        slope: (2,) how the centre moves along the axis, dy/dx and dz/dx [1].
        covariance: (7, 7) of mean_radius, centre y, z, slope y, z, oval_cos, oval_sin [m, 1].
        middle: Distance to which `centre` refers [m].
        scatter: (ring,) robust one-sigma of a reading about the section [m].
        alike: How many neighbouring readings err alike, so count as one.
        patches: How many patches of wall the section stands on, each weighed by how good it is.
        unseen: The longest arc in one piece that was hardly seen [rad].
    """

    mean_radius: float
    oval_cos: float
    oval_sin: float
    centre: NDArray[np.float64]
    slope: NDArray[np.float64]
    covariance: NDArray[np.float64]
    middle: float
    scatter: NDArray[np.float64]
    alike: float
    patches: float
    unseen: float

    @property
    def diameter(self) -> float:
        """Diameter of the circle of equal area [m]."""
        return 2.0 * float(np.sqrt(self.mean_radius**2 - self.oval_cos**2 - self.oval_sin**2))

    @property
    def diameter_sigma(self) -> float:
        """One-sigma of `diameter` from the fit alone, without the sensor's scale [m]."""
        slope = np.array([self.mean_radius, -self.oval_cos, -self.oval_sin]) * 4.0 / self.diameter
        rows = [0, 5, 6]
        return float(np.sqrt(slope @ self.covariance[np.ix_(rows, rows)] @ slope))


def pool_sections(
    ranges: NDArray[np.floating],
    bearings: NDArray[np.floating],
    distance: NDArray[np.floating],
    radius: float | None = None,
) -> PooledSection:
    """Return the mean section of rings that were measured about one axis.

    Args:
        ranges: (ring, bearing) from the axis to the wall [m]; NaN = no return.
        bearings: (bearing,) at equal steps, from +z counter-clockwise [rad].
        distance: (ring,) position along the axis, at about equal steps [m].
        radius: About what it will be [m]; where ranges are densest when not given.

    Raises:
        InputError: Too little of the wall was seen for a section.

    Source: iteratively reweighted least squares with Tukey weights and Gaussian priors (ridge regression); section
    2.9.1 for the ellipse, here to first order in its ovality and its offset.

    >>> bearings = np.radians(np.arange(360.0))
    >>> pooled = pool_sections(np.full((30, 360), 0.15), bearings, 0.015 * np.arange(30))
    >>> round(pooled.diameter, 6)
    0.3
    """
    ranges = np.asarray(ranges, dtype=np.float64)
    seen = np.isfinite(ranges)
    if seen.sum() < _LEAST:
        raise _too_little(int(seen.sum()))
    typical = radius or _densest(ranges[seen])
    relative = np.where(np.abs(ranges / typical - 1.0) < _GATE, ranges / typical, np.nan)
    middle = float(np.average(distance, weights=np.isfinite(relative).sum(axis=1) + 1e-12))
    return _Pool(relative, np.asarray(bearings), (np.asarray(distance) - middle) / typical).solve(typical, middle)


def _densest(ranges: NDArray[np.float64]) -> float:
    """Return the median of the ranges that lie in the densest band about a third of its middle wide [m]."""
    ordered = np.sort(ranges)
    last = np.searchsorted(ordered, ordered * (1.0 + _GATE) / (1.0 - _GATE), side="right")
    first = int(np.argmax(last - np.arange(len(ordered))))
    return float(np.median(ordered[first : last[first]]))


def sector_of(bearings: NDArray[np.floating]) -> NDArray[np.int64]:
    """Return the sector, from 0, in which each bearing lies."""
    turn = np.mod(np.asarray(bearings), 2.0 * np.pi) * (SECTORS / (2.0 * np.pi))
    return np.minimum(turn.astype(np.int64), SECTORS - 1)


def _too_little(readings: int) -> InputError:
    return InputError(
        f"only {readings} readings of the wall were seen",
        where="section",
        expected=f"{_LEAST} or more, over a good part of the circumference",
        mend="take a scan that shows more of the wall",
    )


class _Pool:
    """The least-squares problem, in units of the typical radius."""

    def __init__(self, radius: NDArray, bearings: NDArray, place: NDArray) -> None:
        self.radius, self.place = radius, place
        cos, sin = np.cos(bearings), np.sin(bearings)
        self.shape = np.stack([np.ones_like(cos), sin, cos, sin, cos, cos * cos - sin * sin, 2.0 * sin * cos])
        self.sectors = (sector_of(bearings) == np.arange(SECTORS)[:, None]).astype(float)
        step = float(np.median(np.abs(np.diff(place)))) if len(place) > 1 else 1.0
        rows = _PATCH[0] / step if step > 0 else 1.0
        columns = _PATCH[1] / (2.0 * np.pi) * len(bearings)
        self.edges = [
            (np.arange(0, len(place), max(1, round(k * rows))), np.arange(0, len(bearings), max(1, round(k * columns))))
            for k in _GROWTH
        ]

    def solve(self, typical: float, middle: float) -> PooledSection:
        unknown = np.zeros(7 + SECTORS)
        unknown[0] = 1.0
        scatter, alike, unseen = np.full(len(self.place), 0.01), 1.0, 0.0
        covariance = np.empty(0)
        for step in range(_STEPS):
            misfit = self.radius - self._model(unknown)
            if step % 3 == 0:
                scatter = _scatter(misfit)
            relative = np.nan_to_num(misfit / scatter[:, None], nan=np.inf)
            tukey = np.clip(1.0 - (relative / TUKEY) ** 2, 0.0, None) ** 2
            if step % 3 == 0:
                alike = self._alike(np.where(tukey > 0.0, relative, 0.0), tukey > 0.0)
            weight = tukey / (scatter[:, None] ** 2 * alike)
            unseen = _gap(self.sectors @ weight.sum(axis=0))
            before = unknown
            unknown, covariance = self._step(weight, unseen)
            if step > 6 and np.abs(unknown - before).max() < 1e-9:
                break
        return self._result(unknown, covariance, weight, scatter, alike, unseen, typical, middle)

    def _model(self, unknown: NDArray) -> NDArray:
        still = (unknown[:7] * (_POWERS == 0)) @ self.shape + unknown[7:] @ self.sectors
        moving = (unknown[:7] * (_POWERS == 1)) @ self.shape
        return still + self.place[:, None] * moving

    def _step(self, weight: NDArray, unseen: float) -> tuple[NDArray, NDArray]:
        """Return the unknowns and their covariance; sums over rings first, so that no design matrix is held."""
        value = np.nan_to_num(self.radius)
        powers = [self.place**k for k in range(3)]
        sums = np.stack([power @ weight for power in powers])
        targets = np.stack([power @ (weight * value) for power in powers[:2]])
        normal = np.zeros((7 + SECTORS, 7 + SECTORS))
        normal[:7, :7] = np.einsum("ib,jb,ijb->ij", self.shape, self.shape, sums[_POWERS[:, None] + _POWERS])
        normal[:7, 7:] = (self.shape * sums[_POWERS]) @ self.sectors.T
        normal[7:, :7] = normal[:7, 7:].T
        normal[7:, 7:] = np.diag(self.sectors @ sums[0])
        target = np.append((self.shape * targets[_POWERS]).sum(axis=1), self.sectors @ targets[0])
        oval = OVALITY_PRIOR * max(1.0, UNSEEN / unseen) ** 4
        normal[np.diag_indices(7 + SECTORS)] += np.repeat([0.0, oval**-2, COMMON_PRIOR**-2], [5, 2, SECTORS])
        # A start that sees almost nothing must fail as "too little", not as a singular matrix.
        slight = 1e-12 * (1.0 + normal[0, 0])
        normal[np.diag_indices(5)] += slight
        target[0] += slight
        covariance = np.linalg.inv(normal)
        return covariance @ target, covariance

    def _patches(self, values: NDArray, size: int = 0) -> NDArray:
        along, around = self.edges[size]
        return np.add.reduceat(np.add.reduceat(values, along, axis=0), around, axis=1)

    def _alike(self, relative: NDArray, used: NDArray) -> float:
        """Return the variance of patch sums over that of as many independent readings, at least one.

        A patch sees what errs alike with it only up to its edges, a loss that falls with its size: the root of the
        ratio is carried on from two sizes to a patch without edges.
        """
        small = self._ratio(relative, used, 0)
        for size in range(len(_GROWTH) - 1, 0, -1):
            large = self._ratio(relative, used, size)
            if np.isfinite(large) and large > small:
                grown = (_GROWTH[size] * np.sqrt(large) - np.sqrt(small)) / (_GROWTH[size] - 1)
                return max(1.0, float(grown**2))
        return max(1.0, small)

    def _ratio(self, relative: NDArray, used: NDArray, size: int) -> float:
        """Return the mean square of patch sums per reading; NaN when too few of the larger patches are seen."""
        count = self._patches(used.astype(float), size)
        enough = count >= 5
        if enough.sum() < (_FEWEST_PATCHES if size else 2):
            return float("nan") if size else float(count.max())
        return float(np.mean(self._patches(relative, size)[enough] ** 2 / count[enough]))

    def _result(self, unknown, covariance, weight, scatter, alike, unseen, typical, middle) -> PooledSection:
        from scipy.stats import t

        told = self._patches(weight)
        patches = float(told.sum() ** 2 / (told**2).sum())
        if patches <= 1.5:
            raise _too_little(int((weight > 0).sum()))
        # Few patches know their own scatter badly: Student's t widens the interval that 1.96 sigma stands for.
        widen = float(t.ppf(0.975, max(patches - 3.0, 1.0))) / 1.96
        units = np.array([typical, typical, typical, 1.0, 1.0, typical, typical])
        return PooledSection(
            mean_radius=float(unknown[0] * typical),
            oval_cos=float(unknown[5] * typical),
            oval_sin=float(unknown[6] * typical),
            centre=unknown[1:3] * typical,
            slope=unknown[3:5].copy(),
            covariance=covariance[:7, :7] * np.outer(units, units) * widen**2,
            middle=middle,
            scatter=scatter * typical,
            alike=alike,
            patches=patches,
            unseen=unseen,
        )


def _gap(told: NDArray) -> float:
    """Return the longest run of sectors that hardly tell anything [rad], at least one sector."""
    seen = np.flatnonzero(told > 0.1 * told.mean())
    if len(seen) == 0:
        return 2.0 * np.pi
    return float(np.diff(np.append(seen, seen[0] + SECTORS)).max()) * 2.0 * np.pi / SECTORS


def _scatter(misfit: NDArray) -> NDArray[np.float64]:
    """Return the robust one-sigma of the readings of each ring, from as many neighbours as it takes."""
    size = np.abs(misfit)
    count = np.isfinite(size).sum(axis=1)
    result = np.full(len(size), 1.4826 * float(np.nanmedian(size)))
    missing = np.ones(len(size), dtype=bool)
    for reach in (1, 3, 10):
        shifts = range(-reach, reach + 1)
        drawn = sum(_shifted(count, k, 0) for k in shifts)
        rows = np.flatnonzero(missing & (drawn >= _ENOUGH))
        if len(rows):
            near = np.concatenate([_shifted(size, k, np.nan)[rows] for k in shifts], axis=1)
            result[rows] = 1.4826 * row_median(near)
            missing[rows] = False
    return np.maximum(result, _LEAST_SCATTER)


def _shifted(values: NDArray, rows: int, fill: float) -> NDArray:
    """Return `values` moved by `rows` along the first axis, `fill` where nothing comes in."""
    moved = np.full_like(values, fill)
    if rows > 0:
        moved[rows:] = values[:-rows]
    elif rows < 0:
        moved[:rows] = values[-rows:]
    else:
        moved[:] = values
    return moved
