"""Lobes of a liner through the readings of rings, on a host that is known or fitted with them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Unpack

import numpy as np

from springline.geometry.checks import choice, require

from .. import _batch
from ..shapes import kernels
from ..shapes.arguments import places, resolved, spread
from .follow import fit_chunk
from .kernels import HOST, LOBE
from .report import Found, Task
from .results import LobeFits, decided
from .wall import DEFAULT_POWER, KINDS, POWERS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..options import FitOptions, Resolved

    Array = NDArray[np.float64]

CHUNK = 128
"""Rings that one thread fits together."""


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
    chosen = resolved(options)
    task = _task(kind, power, free_power, false_alarm, chosen)
    (rings, points), take = _batch.ranges_source(ranges, bearings)
    weights, hosts = spread("weights", chosen.weights, (rings, points)), spread("host", host, (rings, HOST))
    where, status, used = places(ranges, bearings, options)
    found = Found.empty(rings, points, keep=chosen.keep_weights, residuals=keep_residuals)
    found.status[:], found.used[:] = status, used

    def run(part: slice) -> None:
        z, y = take(part)
        some, own = (None if x is None else x[part] for x in (weights, hosts))
        fit_chunk(task, z, y, some, where[:, part], own, found.part(part))

    _batch.in_chunks(run, rings, CHUNK, chosen.workers)
    free = 2 + (HOST if host is None else 0)
    for covariance, size in ((found.host_covariance, free), (found.lobe_covariance, free + LOBE - 1 + free_power)):
        covariance *= _batch.widening(found.used, size, points, robust=chosen.robust)[:, None, None]
    return decided(_undecided(found, task, false_alarm, host_known=host is not None))


def _undecided(found: Found, task: Task, rate: float, *, host_known: bool) -> LobeFits:
    """Return what was found before any lobe is believed."""
    rings = len(found.status)
    return LobeFits(
        parameters=found.host,
        covariance=found.host_covariance,
        residual_rms=found.rms,
        noise_sigma=found.noise,
        n_used=found.used,
        status=found.status,
        host_status=found.status,
        lobe_status=found.lobe_status,
        method=task.options.method,
        weights=found.weights,
        kind=task.kind,
        lobed=np.zeros(rings, bool),
        evidence=found.evidence,
        false_alarm=np.full(rings, np.nan),
        rate=rate,
        power=task.power,
        host_known=host_known,
        free_power=task.free_power,
        alternative=found.lobe,
        alternative_covariance=found.lobe_covariance,
        host=found.host,
        host_covariance=found.host_covariance,
        misfit=found.misfit,
        residuals=found.residuals,
    )


def _task(kind: str, power: float | None, free_power: bool, false_alarm: float, options: Resolved) -> Task:
    choice("kind", kind, tuple(KINDS))
    number = KINDS[kind]
    power = DEFAULT_POWER[number] if power is None else float(power)
    low, high = POWERS[number]
    require(
        low <= power <= high, "power", power, f"{low:g} <= power <= {high:g} for the {kind} lobe", "2 and 3 are usual"
    )
    require(0.0 < false_alarm < 1.0, "false_alarm", false_alarm, "0 < false_alarm < 1", "0.001 is usual")
    return Task(number, power, free_power, kernels.TUKEY if options.robust else kernels.PLAIN, options)
