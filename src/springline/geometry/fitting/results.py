"""What a fit returns: estimates with their covariance, or a stated reason why there are none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.conventions import FIT_STATUS

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class _Fits:
    """Fits of many rings; the arrays run over rings.

    Attributes:
        parameters: (ring, parameter), in the order of `PARAMETERS` [m]; NaN where the fit failed.
        covariance: (ring, parameter, parameter) of `parameters` [m2], widened by Student's t for the readings left
            over, so that estimate +- 1.96 sigma is a 95 % interval however few the readings are; NaN when there are
            no more readings than parameters.
        residual_rms: (ring,) rms distance of the used readings to the fit [m].
        noise_sigma: (ring,) one-sigma of a reading about the fit [m], robust when the fit is.
        n_used: (ring,) readings that the fit stands on; those that could be used, where it failed.
        status: (ring,) flag of `springline.conventions.FIT_STATUS`, 0 when fitted.
        method: how it was fitted.
        weights: (ring, point) robust weight of each reading, in [0, 1], 0 for one rejected or missing; None unless
            asked for.
    """

    parameters: NDArray[np.float64]
    covariance: NDArray[np.float64]
    residual_rms: NDArray[np.float64]
    noise_sigma: NDArray[np.float64]
    n_used: NDArray[np.int64]
    status: NDArray[np.uint8]
    method: str
    weights: NDArray[np.float32] | None = None

    def __len__(self) -> int:
        return len(self.status)

    @property
    def fitted(self) -> NDArray[np.bool_]:
        """Whether each ring has a fit."""
        return self.status == 0

    @property
    def sigma(self) -> NDArray[np.float64]:
        """(ring, parameter) one-sigma of `parameters` [m]."""
        return np.sqrt(np.einsum("kii->ki", self.covariance))

    @property
    def centre_z(self) -> NDArray[np.float64]:
        """(ring,) centre, to the right of the readings' origin [m]."""
        return self.parameters[:, 0]

    @property
    def centre_y(self) -> NDArray[np.float64]:
        """(ring,) centre, above the readings' origin [m]."""
        return self.parameters[:, 1]

    def reason(self, ring: int) -> str:
        """Return why `ring` has no fit, or an empty string when it has one."""
        status = int(self.status[ring])
        return FIT_STATUS[status] if status else ""


@dataclass(frozen=True, eq=False)
class CircleFits(_Fits):
    """Circles of many rings; `parameters` are centre_z, centre_y, radius.

    >>> import numpy as np
    >>> from springline.geometry.fitting import fit_circles
    >>> bearings = np.radians(np.arange(0, 360, 10))
    >>> fits = fit_circles([2 + np.cos(bearings)], [np.sin(bearings)])
    >>> len(fits), fits.radius.round(6), fits.reason(0)
    (1, array([1.]), '')
    """

    @property
    def radius(self) -> NDArray[np.float64]:
        """(ring,) radius [m]."""
        return self.parameters[:, 2]

    def __getitem__(self, ring: int) -> CircleFit:
        return CircleFit(*_one(self, ring))


@dataclass(frozen=True, eq=False)
class EllipseFits(_Fits):
    """Ellipses of many rings; `parameters` are centre_z, centre_y, mean_radius, oval_cos, oval_sin.

    With semi-axes a >= b and the major axis at bearing phi: mean_radius = (a + b)/2 and (oval_cos, oval_sin) =
    (a - b)/2 (cos 2 phi, sin 2 phi). These stay regular at the circle, where phi has no meaning.
    """

    @property
    def mean_radius(self) -> NDArray[np.float64]:
        """(ring,) half sum of the semi-axes [m]."""
        return self.parameters[:, 2]

    @property
    def oval_cos(self) -> NDArray[np.float64]:
        """(ring,) half difference of the semi-axes times cos 2 phi [m]: positive when wider than high."""
        return self.parameters[:, 3]

    @property
    def oval_sin(self) -> NDArray[np.float64]:
        """(ring,) half difference of the semi-axes times sin 2 phi [m]."""
        return self.parameters[:, 4]

    @property
    def shape(self) -> NDArray[np.float64]:
        """(ring, 3) the parameters without the centre, in the order of `conventions.SECTION_PARAMETERS` [m]."""
        return self.parameters[:, 2:]

    @property
    def shape_covariance(self) -> NDArray[np.float64]:
        """(ring, 3, 3) covariance of `shape` [m2]."""
        return self.covariance[:, 2:, 2:]

    @property
    def semi_major(self) -> NDArray[np.float64]:
        """(ring,) semi-major axis [m]."""
        return self.mean_radius + np.hypot(self.oval_cos, self.oval_sin)

    @property
    def semi_minor(self) -> NDArray[np.float64]:
        """(ring,) semi-minor axis [m]."""
        return self.mean_radius - np.hypot(self.oval_cos, self.oval_sin)

    @property
    def axis_bearing(self) -> NDArray[np.float64]:
        """(ring,) bearing of the major axis [rad], in (-pi/2, pi/2]."""
        return axis_bearing(self.oval_cos, self.oval_sin)

    @property
    def semi_axes_sigma(self) -> NDArray[np.float64]:
        """(ring, 2) one-sigma of semi-major and semi-minor axis [m], to first order.

        At the circle the axes are the ends of a folded distribution; see `boundary.amplitude_interval` there.
        """
        half = np.hypot(self.oval_cos, self.oval_sin)
        safe = np.where(half > 0.0, half, 1.0)
        cos, sin = np.where(half > 0.0, self.oval_cos, 1.0) / safe, self.oval_sin / safe
        gradient = np.stack([np.ones_like(cos), cos, sin], axis=-1)[:, None, :] * np.array([[1, 1, 1], [1, -1, -1]])
        return np.sqrt(np.einsum("kai,kij,kaj->ka", gradient, self.shape_covariance, gradient))

    def __getitem__(self, ring: int) -> EllipseFit:
        return EllipseFit(*_one(self, ring))


@dataclass(frozen=True, eq=False)
class _Fit:
    """The fit of one ring: falsy, with its reason, when it failed. Attributes as in the fits of many rings."""

    parameters: NDArray[np.float64]
    covariance: NDArray[np.float64]
    residual_rms: float
    noise_sigma: float
    n_used: int
    status: int
    method: str
    weights: NDArray[np.float32] | None = None

    def __bool__(self) -> bool:
        return self.status == 0

    @property
    def reason(self) -> str:
        """Why there is no fit, or an empty string."""
        return FIT_STATUS[self.status] if self.status else ""

    @property
    def sigma(self) -> NDArray[np.float64]:
        """One-sigma of `parameters` [m]."""
        return np.sqrt(np.diagonal(self.covariance))

    @property
    def centre_z(self) -> float:
        """Centre, to the right of the readings' origin [m]."""
        return float(self.parameters[0])

    @property
    def centre_y(self) -> float:
        """Centre, above the readings' origin [m]."""
        return float(self.parameters[1])


@dataclass(frozen=True, eq=False)
class CircleFit(_Fit):
    """One circle; `parameters` are centre_z, centre_y, radius."""

    @property
    def radius(self) -> float:
        """Radius [m]."""
        return float(self.parameters[2])


@dataclass(frozen=True, eq=False)
class EllipseFit(_Fit):
    """One ellipse; `parameters` are centre_z, centre_y, mean_radius, oval_cos, oval_sin."""

    @property
    def mean_radius(self) -> float:
        """Half sum of the semi-axes [m]."""
        return float(self.parameters[2])

    @property
    def oval_cos(self) -> float:
        """Half difference of the semi-axes times cos 2 phi [m]."""
        return float(self.parameters[3])

    @property
    def oval_sin(self) -> float:
        """Half difference of the semi-axes times sin 2 phi [m]."""
        return float(self.parameters[4])

    @property
    def semi_major(self) -> float:
        """Semi-major axis [m]."""
        return self.mean_radius + float(np.hypot(self.oval_cos, self.oval_sin))

    @property
    def semi_minor(self) -> float:
        """Semi-minor axis [m]."""
        return self.mean_radius - float(np.hypot(self.oval_cos, self.oval_sin))

    @property
    def axis_bearing(self) -> float:
        """Bearing of the major axis [rad], in (-pi/2, pi/2]."""
        return float(axis_bearing(self.parameters[3], self.parameters[4]))


def axis_bearing(oval_cos, oval_sin):
    """Return the bearing [rad], in (-pi/2, pi/2], of the major axis; 0 for a circle.

    >>> import numpy as np
    >>> axis_bearing(np.array([-1.0, 0.0]), np.array([-0.0, 1.0])) / np.pi
    array([0.5 , 0.25])
    """
    # adding zero turns -0.0 into 0.0, so that a vertical axis is +pi/2 and never -pi/2
    return 0.5 * np.arctan2(np.asarray(oval_sin) + 0.0, oval_cos)


def _one(fits: _Fits, ring: int) -> tuple:
    weights = None if fits.weights is None else fits.weights[ring]
    return (
        fits.parameters[ring],
        fits.covariance[ring],
        float(fits.residual_rms[ring]),
        float(fits.noise_sigma[ring]),
        int(fits.n_used[ring]),
        int(fits.status[ring]),
        fits.method,
        weights,
    )
