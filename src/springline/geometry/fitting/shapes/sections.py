"""Any listed section through the readings of rings: robust, batched, within its limits, with covariance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Unpack

import numpy as np

from .. import _batch
from .._judge import TOO_FEW
from ..options import FEWEST_SEARCHED, NOISE_MODELS
from . import finish, kernels
from .arguments import places, resolved, spread
from .models import model_of
from .readings import gathered
from .results import SectionFits
from .solve import Solver
from .start import ranked_starts
from .walls import ChainWall

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..options import FitOptions, Resolved
    from .models import Model

    Array = NDArray[np.float64]

CHUNK = 128
"""Rings that one thread fits together: few enough that their derivatives stay in its cache."""

STARTS = 2
"""Starts that are followed up; the better one is kept."""

_FOLLOWED, _FOLLOW_TOLERANCE = 15, 0.1
TOLERANCE = {kernels.TUKEY: 1e-3, kernels.PLAIN: 1e-7}
"""Length of the last step in sigmas of the unknowns."""


def fit_section(
    ranges: ArrayLike,
    bearings: ArrayLike,
    family: str,
    *,
    turn: ArrayLike = 0.0,
    free_turn: bool = False,
    **options: Unpack[FitOptions],
) -> SectionFits:
    """Return the section of one family that fits each ring best.

    Frame: z to the right and y up, from the sensor; bearings from +z counter-clockwise. Readings err along their rays
    (`noise = "range"`, the default) or along the wall's normal ("orthogonal"); distances are taken to first order in
    the slope of the wall. Outliers are rejected (Tukey's bisquare, with a scale of its own that outliers do not widen).

    Args:
        ranges: From the sensor to the wall, (ring, bearing) [m]; NaN = no return.
        bearings: (bearing,) or (ring, bearing) [rad].
        family: Name in `springline.geometry.sections.FAMILIES`: mode 1 to mode 5, egg, horseshoe, loaf, arch, box, ...
        turn: Turn of the section about O, counter-clockwise [rad], a number or one per ring; pi hangs it upside down.
        free_turn: Whether the turn is fitted too, from the one given; it should be within some 20 degrees of the truth.
        **options: `weights`, `robust`, `noise`, `least_arc`, `most_scatter`, `keep_weights` and `workers` of
            `FitOptions`.

    Returns:
        SectionFits, of which the failed ones say why.

    Raises:
        ParameterError: A shape, a name or an option does not fit.

    Source: dissertation 2.9.1 (distances minimised), 3.1 to 3.3 and errata E (the shapes).

    >>> from springline.geometry.sections import egg
    >>> bearings = np.radians(np.arange(0.0, 360.0, 2.0))
    >>> noise = np.random.default_rng(0).normal(0.0, 1e-3, bearings.size)
    >>> fits = fit_section((egg(0.6, 0.9, 0.15).polar_radius(bearings) + noise)[None], bearings, "egg")
    >>> fits.names, fits.shape.round(2).tolist()
    (('centre_z', 'centre_y', 'width', 'height', 'invert_radius'), [[0.6, 0.9, 0.15]])
    """
    chosen = resolved(options)
    (rings, points), take = _batch.ranges_source(ranges, bearings)
    model, turn = model_of(family), np.array(spread("turn", turn, (rings,)))
    weights = spread("weights", chosen.weights, (rings, points))
    where, status, used = places(ranges, bearings, options)
    size = 2 + len(model.parameters) + free_turn
    found = _Found.empty(rings, points, size, len(model.limits), keep=chosen.keep_weights)
    found.status[:], found.n_used[:] = status, used

    def run(part: slice) -> None:
        z, y = take(part)
        some = None if weights is None else weights[part]
        _fit_chunk(model, z, y, some, where[:, part, :3], turn[part], free_turn, chosen, found.part(part))

    _batch.in_chunks(run, rings, CHUNK, chosen.workers)
    found.covariance *= _batch.widening(found.n_used, size, points, robust=chosen.robust)[:, None, None]
    return SectionFits(
        **vars(found),
        method=chosen.method,
        family=family,
        names=("centre_z", "centre_y", *model.parameters, *(("turn",) if free_turn else ())),
        turn=found.parameters[:, -1] if free_turn else turn,
        limits=model.limits,
    )


@dataclass
class _Found:
    """What was found, by ring; names as in `SectionFits`."""

    parameters: Array
    covariance: Array
    residual_rms: Array
    noise_sigma: Array
    n_used: NDArray[np.int64]
    status: NDArray[np.uint8]
    at_limit: NDArray[np.bool_]
    misfit: Array
    weights: NDArray[np.float32] | None

    @classmethod
    def empty(cls, rings: int, points: int, size: int, limits: int, *, keep: bool) -> _Found:
        nan = np.full(rings, np.nan)
        return cls(
            parameters=np.full((rings, size), np.nan),
            covariance=np.full((rings, size, size), np.nan),
            residual_rms=nan,
            noise_sigma=nan.copy(),
            n_used=np.zeros(rings, np.int64),
            status=np.zeros(rings, np.uint8),
            at_limit=np.zeros((rings, limits), bool),
            misfit=nan.copy(),
            weights=np.zeros((rings, points), np.float32) if keep else None,
        )

    def part(self, part: slice) -> _Found:
        return _Found(*(None if x is None else x[part] for x in vars(self).values()))


def _fit_chunk(
    model: Model,
    z: Array,
    y: Array,
    weights: Array | None,
    where: Array,
    turn: Array,
    turning: bool,
    options: Resolved,
    found: _Found,
) -> None:
    hopeful = found.status == 0
    where = np.where(hopeful[:, None], where, (0.0, 0.0, 1.0))
    centre, size = where[0, :, :2], where[0, :, 2]
    along = options.noise == NOISE_MODELS["range"]
    readings = gathered(z, y, weights, centre, size, along=along)
    solver = Solver(ChainWall(model), readings, turn, turning=turning)
    few = hopeful & (readings.counts < solver.size)
    found.status[few] = TOO_FEW
    hopeful &= ~few
    robust = hopeful & (readings.counts >= FEWEST_SEARCHED * solver.size) & options.robust
    for kind, rows in ((kernels.TUKEY, np.flatnonzero(robust)), (kernels.PLAIN, np.flatnonzero(hopeful & ~robust))):
        if rows.size:
            about = (where - np.append(centre, np.zeros((len(centre), 1)), axis=1)) / size[:, None]
            start = _follow(model, solver, rows, about, turn)
            converged = solver.run(rows, start, kind, tolerance=TOLERANCE[kind])
            _report(model, solver, rows, kind, converged, centre, size, options, found)


def _follow(model: Model, solver: Solver, rows: NDArray[np.int64], where: Array, turn: Array) -> Array:
    """Return the unknowns (R, P) that the nearest starts lead to under a loss that lets no reading go."""
    starts = ranked_starts(model, solver.readings, where, turn, STARTS)
    best, least = np.empty((rows.size, solver.size)), np.full(rows.size, np.inf)
    for start in starts:
        unknowns = np.zeros((rows.size, solver.size))
        unknowns[:, : start.shape[1]] = start[rows]
        solver.run(rows, unknowns, kernels.CAUCHY, tolerance=_FOLLOW_TOLERANCE, most=_FOLLOWED)
        misfit = kernels.misfits(rows, solver.readings.counts, solver.side, solver.residual)
        better = misfit < least
        best[better], least[better] = solver.unknowns[rows[better]], misfit[better]
    return best


def _report(
    model: Model,
    solver: Solver,
    rows: NDArray[np.int64],
    kind: int,
    converged: NDArray[np.bool_],
    centre: Array,
    size: Array,
    options: Resolved,
    found: _Found,
) -> None:
    """Write what the solver found for some rings into the results, in the unit of the readings."""
    unknowns, count = solver.unknowns[rows], len(model.parameters)
    near = (unknowns - solver.floor < finish.AT_LIMIT) | (solver.ceiling - unknowns < finish.AT_LIMIT)
    inverse, determined = finish.covariance(solver.information(rows), near)
    if kind == kernels.TUKEY:
        most = np.maximum(finish.MOST_LEVERAGE, 2.0 * solver.size / solver.readings.counts[rows])
        determined &= finish.leverage(solver, rows, inverse) <= most
    inverse *= solver.variance(rows, kind)[:, None, None]
    status = finish.statuses(solver, rows, converged, determined, options.least_arc, options.most_scatter)
    found.status[rows] = status
    rms, misfit = np.empty(rows.size), np.empty(rows.size)
    finish.residual_statistics(rows, solver.residuals(), solver.omega, solver.readings.counts, rms, misfit)
    found.n_used[rows] = (solver.omega[rows] > 0.0).sum(axis=1)
    good = status == 0
    rows, unknowns, inverse, unit = rows[good], unknowns[good], inverse[good], size[rows[good]]
    turn_matrix = np.eye(solver.size)
    turn_matrix[2 : 2 + count, 2 : 2 + count] = model.matrix
    by = turn_matrix * _units(model, solver.size, unit)[:, :, None]
    parameters = unknowns @ turn_matrix.T
    parameters[:, 2 : 2 + count] += model.offset
    parameters *= _units(model, solver.size, unit)
    parameters[:, :2] += centre[rows]
    if solver.turning:
        parameters[:, -1] += solver.fixed_turn[rows]
    found.parameters[rows] = parameters
    found.covariance[rows] = _propagated(by, inverse)
    found.residual_rms[rows], found.noise_sigma[rows] = rms[good] * unit, solver.sigma[rows] * unit
    found.misfit[rows] = misfit[good]
    found.at_limit[rows] = near[good][:, 2 : 2 + count]
    if found.weights is not None:
        readings = solver.readings
        row, column = np.nonzero(np.arange(readings.z.shape[1]) < readings.counts[rows, None])
        ring = rows[row]
        robust = solver.omega[ring, column] / readings.prior[ring, column]
        found.weights[ring, readings.index[ring, column]] = robust


def _units(model: Model, size: int, unit: Array) -> Array:
    """Return (R, P) the factor by which each unknown, or parameter, grows with the unit of length."""
    lengths = np.zeros(size, bool)
    lengths[:2], lengths[2 : 2 + len(model.lengths)] = True, model.lengths
    return np.where(lengths, unit[:, None], 1.0)


def _propagated(by: Array, inverse: Array) -> Array:
    """Return by @ inverse @ by^T, NaN for what hangs on nothing but unknowns held at their limits."""
    spread = by @ np.nan_to_num(inverse) @ np.swapaxes(by, 1, 2)
    silent = np.einsum("rii->ri", spread) == 0.0
    return np.where(silent[:, :, None] | silent[:, None, :], np.nan, spread)
