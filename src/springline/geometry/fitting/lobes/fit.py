"""Lobes of a liner through the readings of rings, on a host that is known or fitted with them."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Unpack

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import choice, require

from .. import _batch
from .._judge import TOO_FEW
from .._refine import LOSS, SCORE, SLOPE
from ..options import FEWEST_SEARCHED, NOISE_MODELS, resolve
from ..shapes import finish, kernels
from ..shapes.arguments import places, spread
from ..shapes.readings import gathered
from ..shapes.solve import Solver
from .kernels import HOST, LOBE
from .results import NAMES, LobeFits, decided
from .scan import likely_lobes, widest_gaps
from .wall import ANGLES, DEFAULT_POWER, KINDS, POWERS, LobeWall

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..options import FitOptions, Resolved

    Array = NDArray[np.float64]

CHUNK = 128
"""Rings that one thread fits together."""

_STARTS = 2
"""Lobes that are followed up from each of the two hosts fitted without one."""

_FOLLOWED, _FOLLOW_TOLERANCE = 15, 0.1
_TOLERANCE = {kernels.TUKEY: 1e-3, kernels.PLAIN: 1e-6}
_SHALLOWEST, _DEEPEST = 0.01, 0.6
_WORTH_A_POWER = 12.0
_MOST_HIDDEN = 0.5
"""Share of a lobe's width that one gap may hide."""

_LENGTHS = np.array([True] * 5 + [False, False, True, False])


def fit_lobe(
    ranges: ArrayLike,
    bearings: ArrayLike,
    *,
    kind: str = "proposed",
    power: float | None = None,
    free_power: bool = False,
    host: ArrayLike | None = None,
    false_alarm: float = 1e-3,
    keep_residuals: bool = False,
    **options: Unpack[FitOptions],
) -> LobeFits:
    """Say of each ring whether its liner has left the host in a lobe, and fit the lobe.

    Frame: z to the right and y up, from the sensor; bearings from +z counter-clockwise. Every ring is fitted with the
    host alone and with a lobe at the likeliest places; a lobe is believed when twice the gain in log-likelihood is
    larger than in all but the share `false_alarm` of rings without one, readings erring independently. The readings
    are those of the liner's inner surface, so that the host is the liner's own shape where it lies against the pipe.
    What else bends the wall inward, a hinge or a deposit, may look like a lobe: the user says that there is a liner.

    Args:
        ranges: From the sensor to the wall, (ring, bearing) [m]; NaN = no return.
        bearings: (bearing,) or (ring, bearing) [rad].
        kind: "proposed", the published lobe (7.13, 7.23), or "smooth", which never leaves its host.
        power: Its power; 2 for the published lobe and 3 for the smooth one unless given.
        free_power: Whether the power is fitted too, from there.
        host: (3,) or (ring, 3) mean_radius, oval_cos and oval_sin of the host [m] where it is known, taken as exact;
            fitted with the lobe otherwise.
        false_alarm: How often a ring without a lobe may be said to show one.
        keep_residuals: Whether the distances of the readings to the liner come back.
        **options: `weights`, `robust`, `noise`, `least_arc`, `most_scatter`, `keep_weights` and `workers` of
            `FitOptions`; without `robust`, outliers make lobes.

    Returns:
        LobeFits.

    Raises:
        ParameterError: A shape, a name or an option does not fit, or the power is out of range.

    Source: (7.13) to (7.23) with errata A11 to A13 and A19 for the lobes; `evidence` for the false-alarm rate.

    >>> from springline.geometry.liners import lobed
    >>> bearings = np.radians(np.arange(360.0))
    >>> ring = lobed(0.15, 0.15, np.radians(30), 0.14).polar_radius(bearings)
    >>> ring += np.random.default_rng(0).normal(0.0, 3e-4, 360)
    >>> fits = fit_lobe(ring[None], bearings)
    >>> fits.lobed.tolist(), np.degrees(fits["half_angle"]).round(0).tolist(), fits["depth"].round(3).tolist()
    ([True], [30.0], [0.01])
    """
    chosen = resolve(options, {"geometric": -1})
    if chosen.noise == NOISE_MODELS["isotropic"]:
        raise ParameterError("noise is 'isotropic', whose bias is known for ellipses only", mend="give 'range'")
    task = _task(kind, power, free_power, false_alarm, chosen)
    (rings, points), take = _batch.ranges_source(ranges, bearings)
    weights = None if chosen.weights is None else spread("weights", chosen.weights, (rings, points))
    hosts = None if host is None else spread("host", host, (rings, HOST))
    where, status, used = places(ranges, bearings, options)
    found = _Found.empty(rings, points, keep=chosen.keep_weights, residuals=keep_residuals)
    found.status[:], found.used[:] = status, used

    def run(start: int) -> None:
        part = slice(start, start + CHUNK)
        z, y = take(part)
        some, own = (None if x is None else x[part] for x in (weights, hosts))
        _fit_chunk(task, z, y, some, where[:, part], own, found.part(part))

    with ThreadPoolExecutor(chosen.workers or _batch._cores()) as pool:
        list(pool.map(run, range(0, rings, CHUNK)))
    free = 2 + (HOST if host is None else 0)
    for covariance, size in ((found.host_covariance, free), (found.lobe_covariance, free + LOBE - 1 + free_power)):
        covariance *= _batch._widening(found.used, size, points, robust=chosen.robust)[:, None, None]
    return decided(
        LobeFits(
            parameters=found.host,
            covariance=found.host_covariance,
            residual_rms=found.rms,
            noise_sigma=found.noise,
            n_used=found.used,
            status=found.status,
            host_status=found.status,
            lobe_status=found.lobe_status,
            method=chosen.method,
            weights=found.weights,
            kind=task.kind,
            lobed=np.zeros(rings, bool),
            evidence=found.evidence,
            false_alarm=np.full(rings, np.nan),
            rate=false_alarm,
            power=task.power,
            host_known=host is not None,
            free_power=free_power,
            alternative=found.lobe,
            alternative_covariance=found.lobe_covariance,
            host=found.host,
            host_covariance=found.host_covariance,
            misfit=found.misfit,
            residuals=found.residuals,
        )
    )


@dataclass(frozen=True)
class _Task:
    kind: int
    power: float
    free_power: bool
    loss: int
    options: Resolved


def _task(kind: str, power: float | None, free_power: bool, false_alarm: float, options: Resolved) -> _Task:
    choice("kind", kind, tuple(KINDS))
    number = KINDS[kind]
    power = DEFAULT_POWER[number] if power is None else float(power)
    low, high = POWERS[number]
    require(
        low <= power <= high, "power", power, f"{low:g} <= power <= {high:g} for the {kind} lobe", "2 and 3 are usual"
    )
    require(0.0 < false_alarm < 1.0, "false_alarm", false_alarm, "0 < false_alarm < 1", "0.001 is usual")
    return _Task(number, power, free_power, kernels.TUKEY if options.robust else kernels.PLAIN, options)


@dataclass
class _Found:
    host: Array
    host_covariance: Array
    lobe: Array
    lobe_covariance: Array
    evidence: Array
    rms: Array
    noise: Array
    misfit: Array
    used: NDArray[np.int64]
    status: NDArray[np.uint8]
    lobe_status: NDArray[np.uint8]
    weights: NDArray[np.float32] | None
    residuals: NDArray[np.float32] | None

    @classmethod
    def empty(cls, rings: int, points: int, *, keep: bool, residuals: bool) -> _Found:
        size = len(NAMES)

        def unknown(*shape: int) -> Array:
            return np.full((rings, *shape), np.nan)

        return cls(
            unknown(size), unknown(size, size), unknown(size), unknown(size, size), *(unknown() for _ in range(4)),
            np.zeros(rings, np.int64), np.zeros(rings, np.uint8), np.full(rings, TOO_FEW, np.uint8),
            np.zeros((rings, points), np.float32) if keep else None,
            np.full((rings, points), np.nan, np.float32) if residuals else None,
        )  # fmt: skip

    def part(self, part: slice) -> _Found:
        return _Found(*(None if x is None else x[part] for x in vars(self).values()))


def _fit_chunk(
    task: _Task, z: Array, y: Array, weights: Array | None, where: Array, host: Array | None, found: _Found
) -> None:
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
    scale = _Scale(centre, size, unit_host, task)
    converged, starts = _without_lobe(task, bare, rows, (where[:, rows] - _about(centre[rows])) / size[rows, None])
    found.status[rows] = scale.write(bare, rows, converged, found.host, found.host_covariance)
    scale.describe(bare, rows, found)
    nulls = bare.unknowns[rows]
    found.lobe_status[rows] = _with_lobe(task, lobed, rows, starts, scale, found)
    found.evidence[rows] = _evidence(task, bare, lobed, rows, nulls)
    if task.free_power:
        worth = rows[(found.evidence[rows] > _WORTH_A_POWER) & (found.lobe_status[rows] == 0)]
        _with_power(task, lobed, worth, scale, found)
    better = rows[(found.lobe_status[rows] == 0) & (found.lobe[rows, 7] > 0.0)]
    scale.describe(lobed, better, found)


def _about(centre: Array) -> Array:
    return np.append(centre, np.zeros((len(centre), HOST)), axis=1)


def _without_lobe(
    task: _Task, bare: Solver, rows: NDArray[np.int64], where: Array
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


def _with_lobe(
    task: _Task, lobed: Solver, rows: NDArray[np.int64], starts: list[Array], scale: _Scale, found: _Found
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


def _evidence(task: _Task, bare: Solver, lobed: Solver, rows: NDArray[np.int64], nulls: Array) -> Array:
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


def _with_power(task: _Task, lobed: Solver, rows: NDArray[np.int64], scale: _Scale, found: _Found) -> None:
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


@dataclass(frozen=True)
class _Scale:
    """From the solver's units to those of the readings."""

    centre: Array
    size: Array
    host: Array | None
    task: _Task

    def write(
        self,
        solver: Solver,
        rows: NDArray[np.int64],
        converged: NDArray[np.bool_],
        parameters: Array,
        covariance: Array,
    ) -> NDArray[np.uint8]:
        """Write parameters and covariance of the rings that are determined; return the flags (R,)."""
        unknowns = solver.unknowns[rows]
        near = (unknowns - solver.floor < finish.AT_LIMIT) | (solver.ceiling - unknowns < finish.AT_LIMIT)
        inverse, determined = finish.covariance(solver.information(rows), near)
        determined &= ~np.isnan(inverse).any(axis=(1, 2))
        if self.task.loss == kernels.TUKEY:
            most = np.maximum(finish.MOST_LEVERAGE, 2.0 * solver.size / solver.readings.counts[rows])
            determined &= finish.leverage(solver, rows, inverse) <= most
        inverse *= solver.variance(rows, self.task.loss)[:, None, None]
        options = self.task.options
        status = finish.statuses(solver, rows, converged, determined, options.least_arc, options.most_scatter)
        good = status == 0
        rows, unknowns, inverse, unit = rows[good], unknowns[good], inverse[good], self.size[rows[good]]
        where = np.r_[0:2, (2 + HOST if self.host is not None else 2) : 2 + HOST + LOBE][: solver.size]
        units = np.where(_LENGTHS, unit[:, None], 1.0)
        full = np.full((rows.size, len(NAMES)), np.nan)
        full[:, where] = unknowns
        if self.host is not None:
            full[:, 2 : 2 + HOST] = self.host[rows]
        if solver.size > 2 + HOST or (self.host is not None and solver.size > 2):
            full[:, 8] = np.where(np.isnan(full[:, 8]), self.task.power, full[:, 8])
        parameters[rows] = full * units
        parameters[rows, :2] += self.centre[rows]
        parameters[rows, 5] %= 2.0 * np.pi
        spread = np.where(np.isnan(full[:, :, None] + full[:, None, :]), np.nan, 0.0)
        spread[:, where[:, None], where] = inverse * units[:, where, None] * units[:, None, where]
        covariance[rows] = spread
        return status

    def describe(self, solver: Solver, rows: NDArray[np.int64], found: _Found) -> None:
        """Write noise, misfit and weights of some rings."""
        unit, readings = self.size[rows], solver.readings
        rms, misfit = np.empty(rows.size), np.empty(rows.size)
        residuals = solver.residuals()
        finish.residual_statistics(rows, residuals, solver.omega, readings.counts, rms, misfit)
        found.rms[rows], found.misfit[rows], found.noise[rows] = rms * unit, misfit, solver.sigma[rows] * unit
        found.used[rows] = (solver.omega[rows] > 0.0).sum(axis=1)
        row, column = np.nonzero(np.arange(readings.z.shape[1]) < readings.counts[rows, None])
        ring = rows[row]
        given = readings.index[ring, column]
        if found.weights is not None:
            found.weights[ring, given] = solver.omega[ring, column] / readings.prior[ring, column]
        if found.residuals is not None:
            found.residuals[ring, given] = residuals[ring, column] * self.size[ring]
