"""What a search for a liner's lobe returns: whether there is one, its shape with covariance, or why nobody can say."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...liners import Lobe, SmoothLobe, lobe_protrusion
from ...measures import polar_radius
from ..results import _Fits
from ..shapes.finish import UNDETERMINED
from .evidence import false_alarm_rate
from .kernels import HOST, SMOOTH, lobed_radius

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

NAMES = ("centre_z", "centre_y", "mean_radius", "oval_cos", "oval_sin", "bearing", "half_angle", "depth", "power")
"""Names of the parameters: the host's as for ellipses, then the lobe's."""

_NODES = 24


@dataclass(frozen=True, eq=False, kw_only=True)
class LobeFits(_Fits):
    """Lobes of many rings; the arrays run over rings.

    `parameters` are those of `NAMES`: centre and host as for ellipses [m], the lobe's bearing in [0, 2 pi) and half
    angle [rad], its depth, which is the host's radius at its centre less the remaining radius (OC) [m], and its power.
    What was given has no variance. Without a lobe the lobe's are NaN and the host is that of the ring alone.

    Attributes:
        kind: Kind of lobe, a key of `wall.KINDS` by number.
        lobed: (ring,) whether the ring shows a lobe at the false-alarm rate asked for.
        evidence: (ring,) twice the log-likelihood by which the best lobe describes the ring better than none.
        false_alarm: (ring,) how often a ring without a lobe shows as much.
        rate: The false-alarm rate asked for.
        power: Power of the lobe that was looked for.
        free_power, host_known: Whether the power was fitted too, and whether the host was given.
        alternative: (ring, 9) parameters of the best lobe, whether it is believed or not.
        alternative_covariance: (ring, 9, 9) their covariance.
        host, host_covariance: The same of the host without a lobe.
        host_status, lobe_status: (ring,) flags of either fit.
        misfit: (ring,) as for `SectionFits`.
        residuals: (ring, point) distances of the readings to the liner, NaN where not used, or None unless asked for.
    """

    kind: int
    lobed: NDArray[np.bool_]
    evidence: Array
    false_alarm: Array
    rate: float
    power: float
    free_power: bool
    host_known: bool
    alternative: Array
    alternative_covariance: Array
    host: Array
    host_covariance: Array
    host_status: NDArray[np.uint8]
    lobe_status: NDArray[np.uint8]
    misfit: Array
    residuals: NDArray[np.float32] | None = None

    def __getitem__(self, name: str) -> Array:
        """Return (ring,) a parameter by its name."""
        return self.parameters[:, NAMES.index(name)]

    def sigma_of(self, name: str) -> Array:
        """Return (ring,) the one-sigma of a parameter by its name."""
        return self.sigma[:, NAMES.index(name)]

    @cached_property
    def remaining(self) -> tuple[Array, Array]:
        """Radius that is left at the lobe's centre, OC, and its one-sigma [m]."""
        return self._derived(lambda p: polar_radius(p[:, 2:5], p[:, 5]) - p[:, 7])

    @cached_property
    def gap_area(self) -> tuple[Array, Array]:
        """Area between host and lobe, and its one-sigma [m2]; where the lobe leaves its host it counts as negative."""
        return self._derived(self._gap)

    @cached_property
    def protrusion(self) -> Array:
        """Largest distance by which the fitted lobe lies outside its host [m]; above zero it is not a possible liner.

        Source: errata A4.
        """
        found = np.full(len(self), np.nan)
        rows = np.flatnonzero(self.lobed)
        if rows.size:
            p = self.parameters[rows]
            half = np.hypot(p[:, 3], p[:, 4])
            axis = 0.5 * np.arctan2(p[:, 4], p[:, 3])
            build = SmoothLobe if self.kind == SMOOTH else Lobe
            lobe = build(p[:, 6], polar_radius(p[:, 2:5], p[:, 5]) - p[:, 7], p[:, 8], bearing=p[:, 5] - axis)
            found[rows] = lobe_protrusion(lobe, p[:, 2] + half, p[:, 2] - half)
        return found

    def polar_radius(self, bearings: ArrayLike) -> Array:
        """Return (ring, bearing) the liner's radius about its centre at bearings (bearing,) [rad]; NaN where no fit."""
        theta = np.ascontiguousarray(np.broadcast_to(np.asarray(bearings, float), (len(self), np.size(bearings))))
        plain = polar_radius(self.parameters[:, None, 2:5], theta)
        rows = np.flatnonzero(self.lobed)
        plain[rows] = self._radius(self.parameters[rows], theta[rows])
        return plain

    def counted_less(self, inflation: ArrayLike) -> LobeFits:
        """Return the fits as they are when the readings tell less than their number says.

        Args:
            inflation: (ring,) by how much the variance of what is fitted grows, such as
                `geometry.deviation.correlation_inflation` of the residuals.
        """
        more = np.asarray(inflation, float)
        return decided(
            replace(
                self,
                evidence=self.evidence / more,
                alternative_covariance=self.alternative_covariance * more[:, None, None],
                host_covariance=self.host_covariance * more[:, None, None],
            )
        )

    def _gap(self, p: Array) -> Array:
        node, weight = np.polynomial.legendre.leggauss(_NODES)
        # the two sides meet in a kink when the power is small
        offset = 0.5 * np.concatenate([node - 1.0, node + 1.0]) * p[:, 6:7]
        theta = np.ascontiguousarray(p[:, 5:6] + offset)
        lost = polar_radius(p[:, None, 2:5], theta) ** 2 - self._radius(p, theta) ** 2
        return 0.25 * p[:, 6] * np.sum(np.tile(weight, 2) * lost, axis=1)

    def _radius(self, p: Array, theta: Array) -> Array:
        rows, points = theta.shape
        radius, slope = np.empty((rows, points)), np.empty((rows, points))
        numbers, none = np.ascontiguousarray(p[:, 2:]), np.empty((rows, 0, points))
        lobed_radius(np.arange(rows), self.kind, numbers, 0, theta, np.full(rows, points), radius, slope, none)
        return radius

    def _derived(self, of: Callable[[Array], Array]) -> tuple[Array, Array]:
        """Return a quantity of the rings with a lobe, and its one-sigma by its derivatives."""
        value, sigma = np.full(len(self), np.nan), np.full(len(self), np.nan)
        rows = np.flatnonzero(self.lobed)
        if rows.size:
            p, covariance = self.parameters[rows], self.covariance[rows]
            value[rows] = of(p)
            step = 1e-5 * np.maximum(np.sqrt(np.einsum("rii->ri", covariance)), 1e-9) + 1e-8
            gradient = np.stack(
                [(of(p + d) - of(p - d)) / (2 * step[:, k]) for k, d in enumerate(_one_by_one(step))], axis=-1
            )
            sigma[rows] = np.sqrt(np.einsum("ri,rij,rj->r", gradient, covariance, gradient))
        return value, sigma


def _one_by_one(step: Array) -> list[Array]:
    return [np.where(np.arange(step.shape[1]) == k, step, 0.0) for k in range(step.shape[1])]


def decided(fits: LobeFits) -> LobeFits:
    """Return the fits with the verdict that their evidence gives: which rings show a lobe.

    A ring that shows one whose shape the readings do not determine has no fit.
    """
    free = 2 + (0 if fits.host_known else HOST) + 3 + fits.free_power
    rate = false_alarm_rate(
        np.nan_to_num(fits.evidence),
        fits.n_used - free,
        kind=fits.kind,
        power=fits.power,
        host_known=fits.host_known,
    )
    rate = np.where(np.isnan(fits.evidence), np.nan, rate)
    with np.errstate(invalid="ignore"):
        shown = rate <= fits.rate
        lobed = shown & (fits.lobe_status == 0) & (fits.alternative[:, 7] > 0.0)
    status = np.where(lobed, 0, np.where(shown, UNDETERMINED, fits.host_status)).astype(np.uint8)
    parameters = np.where(lobed[:, None], fits.alternative, fits.host)
    covariance = np.where(lobed[:, None, None], fits.alternative_covariance, fits.host_covariance)
    parameters[status != 0], covariance[status != 0] = np.nan, np.nan
    return replace(fits, lobed=lobed, false_alarm=rate, parameters=parameters, covariance=covariance, status=status)
