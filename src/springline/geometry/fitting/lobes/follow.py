"""The rings of a chunk: hosts alone, lobes at the likeliest places, and what the lobe gains over none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._judge import TOO_FEW
from .._refine import LOSS, SCORE, SLOPE
from ..options import FEWEST_SEARCHED, NOISE_MODELS
from ..shapes import finish, kernels
from ..shapes.readings import gathered
from ..shapes.solve import Solver
from .kernels import HOST
from .report import Scale
from .scan import likely_lobes, widest_gaps
from .wall import ANGLES, LobeWall

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .report import Found, Task

    Array = NDArray[np.float64]

_STARTS = 2
"""Lobes that are followed up from each of the two hosts fitted without one."""

_FOLLOWED, _FOLLOW_TOLERANCE = 15, 0.1
_TOLERANCE = {kernels.TUKEY: 1e-3, kernels.PLAIN: 1e-6}
_SHALLOWEST, _DEEPEST = 0.01, 0.6
_WORTH_A_POWER = 12.0

_MOST_HIDDEN = 0.5
"""Share of a lobe's width that one gap may hide."""


def fit_chunk(
    task: Task, z: Array, y: Array, weights: Array | None, where: Array, host: Array | None, found: Found
) -> None:
    """Fit hosts and lobes to some rings.

    Args:
        task: What is looked for.
        z, y: (N, M) readings from the sensor [m]; NaN = no return.
        weights: (N, M) relative inverse variances, or None.
        where: (2, N, 5) ellipses to start from [m].
        host: (N, 3) hosts [m], where they are known.
        found: Where the results go.
    """
    hopeful = found.status == 0
    where = np.where(hopeful[:, None], where, (0.0, 0.0, 1.0, 0.0, 0.0))
    centre, size = where[0, :, :2], where[0, :, 2]
    readings = gathered(z, y, weights, centre, size, along=task.options.noise == NOISE_MODELS["range"])
    unit_host = None if host is None else host / size[:, None]
    power, still = np.full(len(size), task.power), np.zeros(len(size))
    walls = [LobeWall(task.kind, power, unit_host, lobed=lobed) for lobed in (False, True)]
    bare, lobed = (Solver(wall, readings, still, turning=False) for wall in walls)
    few = hopeful & (readings.counts < FEWEST_SEARCHED * lobed.size)
    found.status[few] = TOO_FEW
    rows = np.flatnonzero(hopeful & ~few)
    if not rows.size:
        return
    scale = Scale(centre, size, unit_host, task)
    converged, starts = without_lobe(task, bare, rows, (where[:, rows] - _about(centre[rows])) / size[rows, None])
    found.status[rows] = scale.write(bare, rows, converged, found.host, found.host_covariance)
    scale.describe(bare, rows, found)
    nulls = bare.unknowns[rows]
    found.lobe_status[rows] = with_lobe(task, lobed, rows, starts, scale, found)
    found.evidence[rows] = evidence(task, bare, lobed, rows, nulls)
    if task.free_power:
        worth = rows[(found.evidence[rows] > _WORTH_A_POWER) & (found.lobe_status[rows] == 0)]
        with_power(task, lobed, worth, scale, found)
    better = rows[(found.lobe_status[rows] == 0) & (found.lobe[rows, 7] > 0.0)]
    scale.describe(lobed, better, found)


def _about(centre: Array) -> Array:
    return np.append(centre, np.zeros((len(centre), HOST)), axis=1)


def without_lobe(
    task: Task, bare: Solver, rows: NDArray[np.int64], where: Array
) -> tuple[NDArray[np.bool_], list[Array]]:
    """Bring the hosts alone to rest; return which converged, and unknowns (R, P) from which lobes may be found.

    Lobes are looked for twice: about the host that every reading pulls at, deep ones, and about the one that lets go of
    outliers, shallow ones.
    """
    starts, best, least = [], np.empty((rows.size, bare.size)), np.full(rows.size, np.inf)
    for kind, place in zip((kernels.CAUCHY, task.loss), where, strict=True):
        bare.run(rows, place[:, : bare.size], kind, tolerance=_FOLLOW_TOLERANCE)
        unknowns = bare.unknowns[rows]
        clip = kind == task.loss
        for lobe in likely_lobes(bare, rows, host_known=bare.size == 2, wanted=_STARTS, clip=clip):
            lobe[:, 2] = np.clip(lobe[:, 2], _SHALLOWEST, _DEEPEST)
            starts.append(np.concatenate([unknowns, lobe], axis=1))
        misfit = kernels.misfits(rows, bare.readings.counts, bare.side, bare.residual)
        better = misfit < least
        best[better], least[better] = unknowns[better], misfit[better]
    return bare.run(rows, best, task.loss, tolerance=_TOLERANCE[task.loss]), starts


def with_lobe(
    task: Task, lobed: Solver, rows: NDArray[np.int64], starts: list[Array], scale: Scale, found: Found
) -> NDArray[np.uint8]:
    """Follow the starts, bring the best of them to rest and write what was found; return the flags (R,).

    The first of them are deep, and readings that are fine beside their depth would count as outliers until the lobe has
    been brought to them by least squares.
    """
    best, least = np.empty((rows.size, lobed.size)), np.full(rows.size, np.inf)
    for number, start in enumerate(starts):
        known = np.zeros(rows.size, bool)
        for earlier in starts[:number]:
            known |= _alike(start, earlier)
        new = np.flatnonzero(~known)
        begin = start[new]
        if number < _STARTS:
            lobed.run(rows[new], begin, kernels.PLAIN, tolerance=_FOLLOW_TOLERANCE, most=_FOLLOWED)
            begin = lobed.unknowns[rows[new]]
        lobed.run(rows[new], begin, kernels.CAUCHY, tolerance=_FOLLOW_TOLERANCE, most=_FOLLOWED)
        misfit = kernels.misfits(rows[new], lobed.readings.counts, lobed.side, lobed.residual)
        better = new[misfit < least[new]]
        best[better], least[better] = lobed.unknowns[rows[better]], misfit[misfit < least[new]]
    converged = lobed.run(rows, best, task.loss, tolerance=_TOLERANCE[task.loss])
    status = scale.write(lobed, rows, converged, found.lobe, found.lobe_covariance)
    readings, gaps = lobed.readings, np.empty(rows.size)
    widest_gaps(rows, readings.z, readings.y, lobed.omega, readings.counts, lobed.unknowns, gaps)
    widest = lobed.unknowns[rows, -2] > ANGLES[1] - finish.AT_LIMIT
    return np.where((status == 0) & ((gaps > _MOST_HIDDEN) | widest), finish.UNDETERMINED, status)


def _alike(one: Array, other: Array) -> NDArray[np.bool_]:
    """Return (R,) which starts (R, P) lead to the same lobe."""
    apart = np.abs((one[:, -3] - other[:, -3] + np.pi) % (2 * np.pi) - np.pi)
    return (apart < 0.2 * one[:, -2]) & (np.abs(np.log(one[:, -2] / other[:, -2])) < 0.3)


def evidence(task: Task, bare: Solver, lobed: Solver, rows: NDArray[np.int64], nulls: Array) -> Array:
    """Return (R,) twice the log-likelihood gained by the lobe, at the noise that the readings have about it.

    A robust loss is brought to the scale of a chi-square by the mean of psi' over that of psi^2, which is about 1 but
    where readings are finer than any noise that is believed.
    """
    sums = lobed.sums[rows]
    factor = sums[:, SLOPE] / np.maximum(sums[:, SCORE], 0.5 * sums[:, SLOPE])
    least = np.full(rows.size, np.inf)
    for start in (nulls, lobed.unknowns[rows, : bare.size]):
        bare.run(rows, start, task.loss, tolerance=_TOLERANCE[task.loss], sigma=lobed.sigma[rows])
        least = np.minimum(least, bare.sums[rows, LOSS])
    return np.maximum(2.0 * (least - sums[:, LOSS]) * factor, 0.0)


def with_power(task: Task, lobed: Solver, rows: NDArray[np.int64], scale: Scale, found: Found) -> None:
    """Free the power of the lobes that are worth it; where that determines nothing, it has no sigma."""
    found.lobe_covariance[:, 8, :] = found.lobe_covariance[:, :, 8] = np.nan
    if not rows.size:
        return
    power, still = np.full(len(lobed.side), task.power), np.zeros(len(lobed.side))
    wall = LobeWall(task.kind, power, scale.host, free_power=True)
    free = Solver(wall, lobed.readings, still, turning=False)
    start = np.append(lobed.unknowns[rows], power[rows, None], axis=1)
    converged = free.run(rows, start, task.loss, tolerance=_TOLERANCE[task.loss])
    lobe, covariance = found.lobe.copy(), found.lobe_covariance.copy()
    good = rows[scale.write(free, rows, converged, lobe, covariance) == 0]
    found.lobe[good], found.lobe_covariance[good] = lobe[good], covariance[good]
