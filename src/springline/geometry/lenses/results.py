"""What the fit of a lens returns: the lens with its covariance and the evidence for it, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.lenses.models import image_radius

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses.lens import Lens

    Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LensCandidate:
    """One model fitted to the pairs.

    Attributes:
        lens: The fitted lens; a polynomial ends at the largest zenith it was fitted to.
        parameters: (p,) k [px], then k1 to k4 of a polynomial.
        covariance: (p, p) of `parameters`, widened by Student's t where the noise was estimated from few pairs.
        residuals: (n,) measured less modelled radius of the pairs used, in their order [px].
        residual_rms: Their rms [px].
        probability: Of this model against the other candidates, the polynomial one in fifty beforehand.
    """

    lens: Lens
    parameters: Array
    covariance: Array
    residuals: Array
    residual_rms: float
    probability: float

    @property
    def sigma(self) -> Array:
        """(p,) one-sigma of `parameters`."""
        return np.sqrt(np.diag(self.covariance))

    def radius_sigma(self, zenith: ArrayLike) -> Array:
        """Return the one-sigma [px] of the modelled radius at `zenith` [rad]; NaN beyond the lens's range."""
        zenith = np.asarray(zenith, dtype=float)
        k = self.parameters[0]
        if self.lens.model != "polynomial":
            slopes = image_radius(zenith, model=self.lens.model)[..., None]
        else:
            odd = [k * zenith ** (2 * i + 3) for i in range(len(self.parameters) - 1)]
            slopes = np.stack([self.lens.radius(zenith) / k, *odd], axis=-1)
        spread = np.sqrt(np.einsum("...i,ij,...j->...", slopes, self.covariance, slopes))
        return np.where(np.isnan(self.lens.radius(zenith)), np.nan, spread)


@dataclass(frozen=True, eq=False)
class LensFit:
    """The lens that the pairs speak for; falsy, with the `reason`, when they speak for none.

    Attributes:
        best: The chosen candidate, or None.
        candidates: Every model that could be fitted, most probable first, also when none was chosen.
        noise_sigma: One-sigma of a radius [px] about the most probable candidate; NaN without one.
        n_used: Pairs used.
        reason: Why there is no lens; empty when there is one.
    """

    best: LensCandidate | None
    candidates: tuple[LensCandidate, ...]
    noise_sigma: float
    n_used: int
    reason: str

    def __bool__(self) -> bool:
        return self.best is not None

    @property
    def lens(self) -> Lens | None:
        """The chosen lens, or None."""
        return self.best.lens if self.best else None
