"""The five lens models: image radius of a zenith angle, its inverse and slope, and where they are one-to-one.

Zenith is the angle [rad] between a ray and the optical axis; the image radius has the unit of `k`, pixels as a rule.
Each model is r = k g(zenith); outside the range where g rises, there is no value and NaN stands.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import choice, finite, positive

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

ROUNDING = 8.0 * np.finfo(float).eps
"""By how much a radius may exceed the largest one and still be taken for it."""


class _Model(NamedTuple):
    """g, its inverse and its slope; the largest zenith, and whether g is finite there."""

    shape: Callable[[Array], Array]
    inverse: Callable[[Array], Array]
    slope: Callable[[Array], Array]
    limit: float
    closed: bool


_MODELS = {
    "equidistant": _Model(lambda z: z, lambda q: q, lambda z: 1.0 + 0.0 * z, np.pi, True),
    "sine": _Model(np.sin, np.arcsin, np.cos, np.pi / 2, True),
    "equisolid": _Model(lambda z: np.sin(z / 2), lambda q: 2 * np.arcsin(q), lambda z: np.cos(z / 2) / 2, np.pi, True),
    "perspective": _Model(np.tan, np.arctan, lambda z: 1 / np.cos(z) ** 2, np.pi / 2, False),
    "stereographic": _Model(
        lambda z: np.tan(z / 2), lambda q: 2 * np.arctan(q), lambda z: 0.5 / np.cos(z / 2) ** 2, np.pi, False
    ),
}

MODELS = tuple(_MODELS)
"""Names of the five models: (2.1) equidistant, (2.2) sine, (2.3) equisolid, (2.4) perspective, (2.5) stereographic."""


def model_range(model: str) -> tuple[float, bool]:
    """Return the largest zenith [rad] up to which `model` is one-to-one, and whether it has a radius there.

    Source: 2.7 with erratum 28.

    >>> model_range("sine")[0] == np.pi / 2, model_range("stereographic")[1]
    (True, False)
    """
    found = _MODELS[choice("model", model, MODELS)]
    return found.limit, found.closed


def image_radius(zenith: ArrayLike, k: ArrayLike = 1.0, *, model: str) -> Array:
    """Return how far from the image centre a ray lands.

    Args:
        zenith: Angle between ray and optical axis [rad].
        k: Scale of the model [px], the usual focal length for equidistant, sine and perspective, twice that for
            equisolid and stereographic; broadcast against `zenith`.
        model: One of `MODELS`.

    Returns:
        Radius in the unit of `k`; NaN outside the model's one-to-one range.

    Raises:
        ParameterError: `model` is unknown or `k` is not above zero.

    Source: (2.1)-(2.5), erratum 28.

    >>> image_radius(np.radians([30, 90, 120]), 300.0, model="sine").round(6)
    array([150., 300.,  nan])
    """
    found = _MODELS[choice("model", model, MODELS)]
    zenith = _inside(finite("zenith", zenith), found)
    return positive("k", k, "give the lens scale in pixels") * found.shape(zenith)


def image_slope(zenith: ArrayLike, k: ArrayLike = 1.0, *, model: str) -> Array:
    """Return the derivative of `image_radius` with respect to the zenith [px/rad]; arguments as there.

    >>> float(image_slope(0.0, 300.0, model="equisolid"))
    150.0
    """
    found = _MODELS[choice("model", model, MODELS)]
    zenith = _inside(finite("zenith", zenith), found)
    return positive("k", k, "give the lens scale in pixels") * found.slope(zenith)


def zenith_of_radius(radius: ArrayLike, k: ArrayLike = 1.0, *, model: str) -> Array:
    """Return the zenith [rad] of the ray that lands at an image radius: the inverse of `image_radius`.

    Args:
        radius: Distance from the image centre, in the unit of `k`.
        k: Scale of the model [px].
        model: One of `MODELS`.

    Returns:
        Zenith [rad]; NaN where no ray lands.

    Raises:
        ParameterError: `model` is unknown or `k` is not above zero.

    Source: inverse of (2.1)-(2.5).

    >>> np.degrees(zenith_of_radius([150.0, 301.0], 300.0, model="sine")).round(6)
    array([30., nan])
    """
    found = _MODELS[choice("model", model, MODELS)]
    ratio = finite("radius", radius) / positive("k", k, "give the lens scale in pixels")
    largest = float(found.shape(np.float64(found.limit))) if found.closed else np.inf
    ratio = np.where((ratio > largest) & (ratio <= largest * (1.0 + ROUNDING)), largest, ratio)
    return found.inverse(np.where((ratio >= 0) & (ratio <= largest), ratio, np.nan))


def scale_of_view_angle(view_angle: ArrayLike, radius: ArrayLike, *, model: str) -> Array:
    """Return the scale k that lets a ray at half the viewing angle land `radius` from the image centre.

    Args:
        view_angle: Full viewing angle [rad].
        radius: Image radius at its edge [px].
        model: One of `MODELS`.

    Returns:
        k [px].

    Raises:
        ParameterError: `model` is unknown, `radius` is not above zero, or the model cannot image half the angle.

    Source: the scaling of appendix D (`k4`), with its doubled image radius of erratum 39 left to the caller.

    >>> round(float(scale_of_view_angle(np.radians(120), 384.0, model="sine")), 3)
    443.405
    """
    limit, closed = model_range(model)
    view = finite("view_angle", view_angle)
    inside = np.isnan(view) | ((view > 0) & ((view <= 2 * limit) if closed else (view < 2 * limit)))
    if not np.all(inside):
        wrong = float(view[~inside].ravel()[0])
        raise ParameterError(
            f"view_angle = {wrong:g} rad is out of range for the {model} model",
            expected=f"0 < view_angle {'<=' if closed else '<'} {2 * limit:g} rad",
            mend="give the full angle in radians, or choose a model that sees that far",
        )
    return positive("radius", radius, "give the image radius in pixels") / image_radius(view / 2, model=model)


def _inside(zenith: Array, found: _Model) -> Array:
    below = (zenith <= found.limit) if found.closed else (zenith < found.limit)
    return np.where((zenith >= 0) & below, zenith, np.nan)
