"""Families of liners for fits, beside those of `springline.geometry.sections.families`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...conventions import CROWN
from ..sections.families import Family
from .chicurel import DEEPEST_K
from .hosts import host_polar
from .lined import chicurel_lobed, lined, lobed, smooth_lobed
from .lobes import Lobe
from .quasi_ellipse import LARGEST_D0, quasi_ellipse

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .lined import LinedSection

    Array = NDArray[np.float64]

_HOST = ("r1", "r2")
_LOBE = ("bearing", "phi", "oc")


def lobe_family(p: float = 2.0) -> Family:
    """Return the family of proposed lobes with power p, at any clock.

    >>> lobe_family().parameters
    ('r1', 'r2', 'bearing', 'phi', 'oc')
    """

    def build(r1: Array, r2: Array, bearing: Array, phi: Array, oc: Array) -> LinedSection:
        return lobed(r1, r2, phi, oc, p, bearing)

    return Family(f"lobe, p = {p:g}", _HOST + _LOBE, build, _lobe_limits)


def smooth_lobe_family(n: float = 3.0) -> Family:
    """Return the family of smooth lobes with power n, at any clock; n = 2 is Glock's.

    >>> smooth_lobe_family(2.0).name
    'smooth lobe, n = 2'
    """

    def build(r1: Array, r2: Array, bearing: Array, phi: Array, oc: Array) -> LinedSection:
        return smooth_lobed(r1, r2, phi, oc, n, bearing)

    return Family(f"smooth lobe, n = {n:g}", _HOST + _LOBE, build, _lobe_limits)


def two_lobe_family(p: float = 2.0) -> Family:
    """Return the family of two proposed lobes with power p, at the crown and at the invert.

    >>> two_lobe_family().parameters
    ('r1', 'r2', 'phi', 'oc', 'phi_invert', 'oc_invert')
    """

    def build(r1: Array, r2: Array, phi: Array, oc: Array, phi_invert: Array, oc_invert: Array) -> LinedSection:
        return lined(r1, r2, Lobe(phi, oc, p), Lobe(phi_invert, oc_invert, p, -CROWN))

    def limits(parameters: Array) -> tuple[Array, Array]:
        low, high = np.zeros_like(parameters), np.full_like(parameters, np.inf)
        high[..., 2], high[..., 4] = np.pi - parameters[..., 4], np.pi - parameters[..., 2]
        high[..., 3] = high[..., 5] = parameters[..., 1]
        return low, high

    return Family(f"two lobes, p = {p:g}", (*_HOST, "phi", "oc", "phi_invert", "oc_invert"), build, limits)


def _lobe_limits(parameters: Array) -> tuple[Array, Array]:
    low, high = np.zeros_like(parameters), np.full_like(parameters, np.inf)
    low[..., 2], high[..., 3] = -np.inf, np.pi
    high[..., 4] = host_polar(parameters[..., 2], parameters[..., 0], parameters[..., 1])[0]
    return low, high


def _chicurel_limits(parameters: Array) -> tuple[Array, Array]:
    low, high = np.zeros_like(parameters), np.full_like(parameters, np.inf)
    low[..., 2], high[..., 3] = -np.inf, DEEPEST_K
    return low, high


def _quasi_limits(parameters: Array) -> tuple[Array, Array]:
    r, d0 = parameters[..., 0], parameters[..., 1]
    return np.stack([d0 / LARGEST_D0, np.zeros_like(r)], axis=-1), np.stack(
        [np.full_like(r, np.inf), LARGEST_D0 * r], axis=-1
    )


FAMILIES = {
    "quasi-ellipse": Family("quasi-ellipse", ("r", "d0"), quasi_ellipse, _quasi_limits),
    "chicurel": Family(
        "chicurel",
        (*_HOST, "bearing", "k"),
        lambda r1, r2, bearing, k: chicurel_lobed(r1, r2, k, bearing),
        _chicurel_limits,
    ),
    "glock": smooth_lobe_family(2.0),
    "lobe": lobe_family(),
    "smooth lobe": smooth_lobe_family(),
    "two lobes": two_lobe_family(),
}
"""Liners by name; oc is limited by the host's radius at the lobe's centre, beyond which the lobe lies outside."""
