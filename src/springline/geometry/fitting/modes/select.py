"""From rings to modes: the public side of mode selection."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from springline.errors import ParameterError
from springline.geometry.fitting.ellipses import fit_ellipses_to_ranges
from springline.geometry.fitting.modes.evidence import CLASS_COUNT, likely_section, posterior, workspace
from springline.geometry.fitting.modes.statistics import (
    LOOSE,
    fill_design,
    neighbour_noise,
    quadratic_form,
    reject_outliers,
    shift_and_size,
)
from springline.geometry.fitting.modes.table import half_table

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.fitting.results import EllipseFits

CLASSES = ("circle", "1", "2", "3", "4", "5")
"""Names of the classes, in the order of `ModeSelection.probability`."""

_UPSIDE_DOWN = {6: 3, 7: 4, 8: 5}
_ROUNDS = 3
_NEAR = 4e-3
_CHUNK = 256
_SEVERITIES = np.array([0, 1, 1, 1, 2, 3])
"""Free severities of the circle and of modes 1 to 5."""


@dataclass(frozen=True)
class ModePrior:
    """What is believed before a ring is seen.

    The circle and the five modes are equally likely; within a mode s1 is uniform from `lowest_s1` to 1, and given s1
    the frozen severities are uniform over what is valid.
    """

    lowest_s1: float = 0.75
    """Smallest s1; milder than 25 % deflection, beyond which pipes count as collapsed."""
    upside_down: float = 0.1
    """Share of modes 3 to 5 that hang the other way up, hinged at the invert first."""
    turn_sigma: float = 0.01
    """One-sigma of the turn of the section about the pipe's axis [rad]; shifts and size are free."""
    least_noise: float = 3e-4
    """Smallest one-sigma of a reading that is believed, over the radius: no real pipe follows a mode closer."""


@dataclass(frozen=True, eq=False)
class ModeSelection:
    """Modes of many rings; the arrays run over rings.

    Attributes:
        mode: 0 the circle, 1 to 5 the modes, -1 undecided.
        probability: (ring, 6) posterior of `CLASSES`, upright and upside down together; NaN without a fit.
        inverted: Whether the chosen mode hangs upside down.
        severities: (ring, 4) s1, s2, s02, s01 of the likeliest class, posterior means; NaN without a fit.
        covariance_diagonal: (ring, 4) their variances.
        radius: (ring,) radius of the undeformed pipe [m].
        centre: (ring, 2) O of the section, z and y [m], in the readings' frame.
        noise: (ring,) one-sigma of a reading [m].
        misfit: (ring,) about 1 when a mode describes the ring. The larger of two: chi-square per spare degree of
            freedom by which the likeliest section fits worse than a free symmetric shape, and the variance about that
            shape over the variance between neighbouring readings.
        bic: (ring, 6) Bayesian information criterion of `CLASSES`, over a common constant: the baseline, which counts
            parameters and forgets that modes meet at their limits; inf for a class that is far off.
        reason: why a ring is undecided; empty otherwise.
    """

    mode: NDArray[np.int8]
    probability: NDArray[np.float64]
    inverted: NDArray[np.bool_]
    severities: NDArray[np.float64]
    covariance_diagonal: NDArray[np.float64]
    radius: NDArray[np.float64]
    centre: NDArray[np.float64]
    noise: NDArray[np.float64]
    misfit: NDArray[np.float64]
    bic: NDArray[np.float64]
    reason: tuple[str, ...]

    @property
    def sigma(self) -> NDArray[np.float64]:
        """(ring, 4) one-sigma of `severities`."""
        return np.sqrt(self.covariance_diagonal)


def select_modes(
    ranges: ArrayLike,
    bearings: ArrayLike,
    *,
    ellipses: EllipseFits | None = None,
    prior: ModePrior | None = None,
    least_probability: float = 0.9,
    most_misfit: float = 6.0,
    workers: int = 2,
) -> ModeSelection:
    """Choose the mode of each ring, or leave it undecided.

    Args:
        ranges: (ring, bearing) ranges [m]; NaN = no return. Outliers are rejected.
        bearings: (bearing,) [rad], from +z counter-clockwise; the crown must be up to within `prior.turn_sigma`.
        ellipses: Ellipses of the same rings, to start from; fitted here unless given.
        prior: What is believed before; `ModePrior()` unless given.
        least_probability: A class is named only when its posterior is at least this.
        most_misfit: A ring that no mode describes better than this is undecided, whatever its posterior.
        workers: Threads; the result does not depend on it.

    Raises:
        ParameterError: Shapes that do not fit each other, or a threshold out of range.

    Source: dissertation 3.3 for the modes; the posterior is our own.

    >>> from springline.geometry.sections import hinged
    >>> bearings = np.radians(np.arange(0.0, 360.0, 2.0))
    >>> noise = np.random.default_rng(1).normal(0.0, 0.0003, bearings.size)
    >>> found = select_modes((hinged(2, 0.9, r=0.15).polar_radius(bearings) + noise)[None], bearings)
    >>> int(found.mode[0]), round(float(found.severities[0, 0]), 2)
    (2, 0.9)
    """
    ranges, bearings = np.asarray(ranges), np.asarray(bearings, float)
    if ranges.ndim != 2 or bearings.shape != ranges.shape[1:]:
        raise ParameterError(
            f"ranges have shape {ranges.shape}, bearings {bearings.shape}", expected="(ring, bearing) and (bearing,)"
        )
    if not 0.5 <= least_probability < 1.0:
        raise ParameterError(f"least_probability is {least_probability}", expected="a value in [0.5, 1)")
    prior = prior or ModePrior()
    ellipses = ellipses or fit_ellipses_to_ranges(ranges, bearings)
    results = _Results.empty(len(ranges))
    chunks = [slice(i, i + _CHUNK) for i in range(0, len(ranges), _CHUNK)]

    def run(rows: slice) -> None:
        some = np.ascontiguousarray(ranges[rows], np.float64)
        _select_rings(
            some * np.cos(bearings), some * np.sin(bearings), ellipses.parameters[rows], prior, results.rows(rows)
        )

    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(run, chunks))
    return _decide(results, prior, least_probability, most_misfit)


@dataclass
class _Results:
    weights: NDArray[np.float64]
    moments: NDArray[np.float64]
    place: NDArray[np.float64]
    """centre z, centre y, radius, noise [m], misfit per spare degree of freedom, readings used."""
    closest: NDArray[np.float64]
    """Smallest misfit of each class, over a common constant."""

    @classmethod
    def empty(cls, rings: int) -> _Results:
        return cls(
            np.full((rings, CLASS_COUNT), np.nan),
            np.full((rings, CLASS_COUNT, 4, 2), np.nan),
            np.full((rings, 6), np.nan),
            np.full((rings, CLASS_COUNT), np.nan),
        )

    def rows(self, rows: slice) -> tuple[NDArray[np.float64], ...]:
        return self.weights[rows], self.moments[rows], self.place[rows], self.closest[rows]


def _select_rings(z, y, ellipses, prior: ModePrior, results) -> None:
    table = half_table(round(prior.lowest_s1 - 0.05, 3))
    edges = np.stack([table.elliptic, table.circular], axis=1)
    _rings_kernel(
        z, y, ellipses, table.shapes, table.swung, edges, table.severity, table.chord2, table.ellipse_severity,
        table.first, table.step, prior.lowest_s1, prior.turn_sigma, prior.least_noise, *results,
    )  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy")
def _rings_kernel(
    z, y, ellipses, shapes, table, edges, severity, chord2, least, first, step, lowest, turn_sigma, least_noise,
    weights, moments, place, closest,
):  # fmt: skip
    kinds, readings = shapes.shape[0], z.shape[1]
    design, half, value = np.empty((readings, kinds + LOOSE)), np.empty(readings, np.int64), np.empty(readings)
    weight, section = np.ones(readings), np.zeros(2 * kinds)
    work = workspace(table.shape[1] + 2, kinds)
    last = first + step * (table.shape[0] - 1)
    for ring in range(z.shape[0]):
        centre_z, centre_y, mean = ellipses[ring, 0], ellipses[ring, 1], ellipses[ring, 2]
        if not np.isfinite(mean):
            continue
        oval = np.hypot(ellipses[ring, 3], ellipses[ring, 4]) / mean
        # The radius of the circle of equal perimeter, to second order in the ovality.
        radius = mean * (1.0 + 0.25 * oval * oval)
        count = fill_design(z[ring], y[ring], centre_z, centre_y, radius, oval, shapes, design, half, value)
        if count < 2 * kinds + 16:
            continue
        weight[:] = 1.0
        noise, used, free = reject_outliers(design[:count], half[:count], value[:count], weight[:count])
        believed = max(noise, least_noise)
        low, high, stride = first, last, 8
        for turn in range(_ROUNDS):
            form, line, constant = quadratic_form(
                design[:count], half[:count], value[:count], weight[:count], believed, turn_sigma
            )
            likely, base = likely_section(low, high, stride, table, first, step, form, line, work, section)
            moved = shift_and_size(design[:count], half[:count], value[:count], weight[:count], section)
            centre_z += radius * moved[0]
            centre_y += radius * moved[1]
            radius *= 1.0 + moved[2]
            if turn < _ROUNDS - 1:
                fill_design(z[ring], y[ring], centre_z, centre_y, radius, oval, shapes, design, half, value)
                low, high, stride = max(likely - _NEAR, first), min(likely + _NEAR, last), 4
        best = posterior(
            likely, base, table, edges, severity, chord2, least, first, step, form, line, lowest, work,
            weights[ring], moments[ring], closest[ring],
        )  # fmt: skip
        place[ring, 0], place[ring, 1], place[ring, 2], place[ring, 3] = centre_z, centre_y, radius, noise * radius
        place[ring, 5] = used
        beyond_free = max(noise, least_noise) / max(neighbour_noise(value[:count]), least_noise)
        place[ring, 4] = max(
            (best + constant - free / (believed * believed)) / (2 * kinds - 4), beyond_free * beyond_free
        )


def _bic(results: _Results) -> NDArray[np.float64]:
    """Return misfit + parameters x log(readings) of the circle and modes 1 to 5, the better of both ways up."""
    both = results.closest[:, :6].copy()
    for down, up in _UPSIDE_DOWN.items():
        both[:, up] = np.minimum(both[:, up], results.closest[:, down])
    return both + _SEVERITIES * np.log(results.place[:, 5:6])


def _decide(results: _Results, prior: ModePrior, least_probability: float, most_misfit: float) -> ModeSelection:
    odds = results.weights * np.array([1.0] * 3 + [1.0 - prior.upside_down] * 3 + [prior.upside_down] * 3)
    with np.errstate(invalid="ignore", divide="ignore"):
        odds = odds / odds.sum(axis=1, keepdims=True)
        mean = results.moments[..., 0] / results.weights[..., None]
        variance = np.maximum(results.moments[..., 1] / results.weights[..., None] - mean**2, 0.0)
    probability = odds[:, :6].copy()
    for down, up in _UPSIDE_DOWN.items():
        probability[:, up] += odds[:, down]
    fitted = np.isfinite(probability).all(axis=1)
    best = np.where(fitted, np.nan_to_num(probability).argmax(axis=1), 0)
    rows = np.arange(len(best))
    down = np.where(best >= 3, best + 3, best)
    inverted = fitted & (best >= 3) & (odds[rows, down] > odds[rows, best])
    chosen = np.where(inverted, down, best)
    misfit = results.place[:, 4]
    clear = fitted & (probability[rows, best] >= least_probability) & (misfit <= most_misfit)
    reason = tuple(
        "" if c else "no section" if not f else "no mode describes it" if bad else "two modes are too close"
        for c, f, bad in zip(clear, fitted, misfit > most_misfit, strict=True)
    )
    return ModeSelection(
        mode=np.where(clear, best, -1).astype(np.int8),
        probability=np.where(fitted[:, None], probability, np.nan),
        inverted=inverted,
        severities=mean[rows, chosen],
        covariance_diagonal=variance[rows, chosen],
        radius=results.place[:, 2],
        centre=results.place[:, :2],
        noise=results.place[:, 3],
        misfit=misfit,
        bic=_bic(results),
        reason=reason,
    )
