"""A lens: one model with its scale, and the viewing angle beyond which nothing is imaged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import choice, positive, require
from springline.geometry.lenses import models, polynomial

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

POLYNOMIAL = "polynomial"
LENS_MODELS = (*models.MODELS, POLYNOMIAL)
"""The five models of 2.7, and the polynomial fisheye."""


@dataclass(frozen=True)
class Lens:
    """A radially symmetric lens; angles in radians, image lengths in the unit of `k`, pixels as a rule.

    Attributes:
        model: One of `LENS_MODELS`.
        k: Scale [px].
        coefficients: k1 to k4 of the polynomial fisheye; none otherwise.
        view_angle: Full angle [rad] that is imaged, where the housing or the calibration ends before the model does;
            None leaves the model's own range.

    Raises:
        ParameterError: The model is unknown, a number is out of range, or coefficients are given to another model.

    Source: 2.7; for the polynomial, OpenCV's fisheye.

    >>> lens = Lens("equidistant", 300.0, view_angle=np.radians(150))
    >>> lens.radius(np.radians([60, 80])).round(3), float(np.degrees(lens.zenith(100.0)).round(3))
    (array([314.159,     nan]), 19.099)
    """

    model: str
    k: float
    coefficients: tuple[float, ...] = ()
    view_angle: float | None = None

    def __post_init__(self) -> None:
        choice("model", self.model, LENS_MODELS)
        require(np.isfinite(self.k), "k", self.k, "a finite k > 0", "give the lens scale in pixels")
        object.__setattr__(self, "k", float(positive("k", self.k, "give the lens scale in pixels")))
        object.__setattr__(self, "coefficients", tuple(float(c) for c in self.coefficients))
        if self.coefficients and self.model != POLYNOMIAL:
            raise ParameterError(
                f"the {self.model} model takes no coefficients, and {self.coefficients} were given",
                expected="coefficients only with model 'polynomial'",
                mend="drop them or change the model",
            )
        if self.view_angle is not None:
            view = float(positive("view_angle", self.view_angle, "give the full angle in radians"))
            object.__setattr__(self, "view_angle", view)
        polynomial.polynomial_limit(self.coefficients)

    @classmethod
    def of_view_angle(cls, model: str, view_angle: float, radius: float) -> Lens:
        """Return the lens of `model` that images half the `view_angle` [rad] at `radius` [px] and nothing beyond.

        >>> round(Lens.of_view_angle("sine", np.radians(120), 384.0).k, 3)
        443.405
        """
        k = models.scale_of_view_angle(view_angle, radius, model=model)
        return cls(model, float(k), view_angle=float(view_angle))

    @property
    def max_zenith(self) -> float:
        """Largest zenith [rad] that the lens images; the two open models stop just before it."""
        own = self._model_limit
        return own if self.view_angle is None else min(own, self.view_angle / 2.0)

    @property
    def max_radius(self) -> float:
        """Image radius at `max_zenith` [px]; infinite where an open model has no other end."""
        if self.model != POLYNOMIAL and not models.model_range(self.model)[1] and self.max_zenith >= self._model_limit:
            return np.inf
        return float(self.radius(self.max_zenith))

    def radius(self, zenith: ArrayLike) -> Array:
        """Return the image radius [px] of rays at `zenith` [rad]; NaN beyond `max_zenith`."""
        inside = self._seen(zenith)
        if self.model == POLYNOMIAL:
            return polynomial.polynomial_radius(inside, self.k, self.coefficients)
        return models.image_radius(inside, self.k, model=self.model)

    def slope(self, zenith: ArrayLike) -> Array:
        """Return the derivative of `radius` with respect to the zenith [px/rad]."""
        inside = self._seen(zenith)
        if self.model == POLYNOMIAL:
            return polynomial.polynomial_slope(inside, self.k, self.coefficients)
        return models.image_slope(inside, self.k, model=self.model)

    def zenith(self, radius: ArrayLike) -> Array:
        """Return the zenith [rad] of the rays that land at `radius` [px]; NaN where none does."""
        if self.model == POLYNOMIAL:
            found = polynomial.polynomial_zenith(radius, self.k, self.coefficients)
        else:
            found = models.zenith_of_radius(radius, self.k, model=self.model)
        # a radius computed at the very edge comes back a few rounding errors beyond it
        return np.where(found <= self.max_zenith * (1.0 + 1e-12), np.minimum(found, self.max_zenith), np.nan)

    @property
    def _model_limit(self) -> float:
        if self.model == POLYNOMIAL:
            return polynomial.polynomial_limit(self.coefficients)
        return models.model_range(self.model)[0]

    def _seen(self, zenith: ArrayLike) -> Array:
        angle = np.asarray(zenith, dtype=float)
        return angle if self.view_angle is None else np.where(angle <= self.view_angle / 2.0, angle, np.nan)
