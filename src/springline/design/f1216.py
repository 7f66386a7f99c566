"""ASTM F1216 appendix X1: gravity liners in partially and fully deteriorated pipes, equations X1.1 to X1.4.

Everything in SI: pressures and moduli in Pa, lengths in m, ovality q as a fraction. The appendix prints some
empirical constants twice, for inch-pound and for SI units, and the pairs differ by up to 0.7 percent; `constants`
says which pair is meant. D is the mean inside diameter of the existing pipe, which is the liner's outside diameter,
and DR = D/t. Ranges that the appendix gives as advice (DR, q, R_w) are not refused here; `liner.design_liner` warns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import choice, finite, positive, require
from springline.geometry.sections import reduction_factor

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

EDITIONS = ("2007b", "before-2007b")
"""F1216-07b and later hold the ovality factor inside the root of X1.3; earlier editions multiply the root by it."""

CONVENTIONS = ("outer", "mean")
"""Diameter that a thickness refers to: the standard's outer one, or a fixed mean one as in the dissertation."""

CONSTANTS = ("inch-pound", "si")

POISSON = ("-1 < poisson <= 0.5", "plastics have 0.3 to 0.4")
"""Range of Poisson's ratio, and how to mend what lies outside; what cannot be pressed together has 0.5."""

FOOT = 0.3048
PSI = 6894.757293168361
"""Pascals in a pound-force per square inch."""

SUPPORT_DECAY = {"inch-pound": 0.065 / FOOT, "si": 0.213}
"""Exponent of B' per metre of cover: 0.065 per foot, or 0.213 per metre."""

LEAST_STIFFNESS = {"inch-pound": 0.093 * PSI, "si": 0.00064e6}
"""Least E I/D^3 of X1.4 [Pa]: 0.093 psi, or 0.00064 MPa."""

WATER_PER_METRE = {"inch-pound": 0.433 * PSI / FOOT, "si": 0.00981e6}
"""Pressure of a metre of water [Pa]: 0.433 psi per foot, or 0.00981 MPa per metre."""

LEAST_BUOYANCY = 0.67
"""R_w is never taken below this."""


def ovality_factor(ovality: ArrayLike) -> Array:
    """Return the ovality reduction factor C.

    Args:
        ovality: q as a fraction, from 0 and below 1: (mean - min)/mean or (max - mean)/mean of the inside diameter.

    Returns:
        ((1 - q)/(1 + q)^2)^3.

    Raises:
        ParameterError: q is negative, or 1 and more.

    Source: ASTM F1216 X1.1; (1.1)-(1.3).

    >>> round(float(ovality_factor(0.02)), 6)
    0.835752
    """
    q = finite("ovality", ovality)
    require(np.isnan(q) | ((q >= 0) & (q < 1)), "ovality", q, "0 <= ovality < 1", "2 % is 0.02")
    return reduction_factor(q)


def buckling_pressure(
    dimension_ratio: ArrayLike,
    *,
    modulus: ArrayLike,
    poisson: ArrayLike = 0.3,
    factor: ArrayLike = 1.0,
    enhancement: ArrayLike = 7.0,
    safety: ArrayLike = 2.0,
) -> Array:
    """Return the groundwater pressure that a liner carries, X1.1.

    Args:
        dimension_ratio: DR = D/t, above 1.
        modulus: Long-term flexural modulus of the liner [Pa].
        poisson: Poisson's ratio.
        factor: Ovality factor C.
        enhancement: K of the surrounding pipe; 7 is the appendix's minimum where the pipe supports the liner fully.
        safety: N.

    Returns:
        2 K E C / ((1 - nu^2) N (DR - 1)^3) [Pa].

    Raises:
        ParameterError: A value is out of range.

    Source: ASTM F1216 X1.1; (1.2).

    >>> psi = 6894.757293168361
    >>> round(float(buckling_pressure(33.49390739, modulus=72500 * psi, poisson=0.35) / psi), 2)
    16.86
    """
    ratio = _ratio(dimension_ratio)
    return _stiffness(modulus, poisson, factor, enhancement) / (positive("safety", safety) * (ratio - 1.0) ** 3)


def thickness_buckling(
    pressure: ArrayLike,
    diameter: ArrayLike,
    *,
    modulus: ArrayLike,
    poisson: ArrayLike = 0.3,
    factor: ArrayLike = 1.0,
    enhancement: ArrayLike = 7.0,
    safety: ArrayLike = 2.0,
    convention: str = "outer",
) -> Array:
    """Return the liner thickness against groundwater pressure, X1.1 solved for t.

    Args:
        pressure: Groundwater pressure, measured from the invert [Pa].
        diameter: D [m]; under `mean` the liner's mean diameter D - t.
        modulus: Long-term flexural modulus [Pa].
        poisson: Poisson's ratio.
        factor: Ovality factor C.
        enhancement: K.
        safety: N.
        convention: `outer` as the standard, or `mean` as the dissertation's Table 1.1.

    Returns:
        Thickness [m]; 0 without pressure.

    Raises:
        ParameterError: A value is out of range or the convention unknown.

    Source: ASTM F1216 X1.1; errata A20: `mean` is thicker by about t/D.

    >>> inch, psi = 0.0254, 6894.757293168361
    >>> t = thickness_buckling(5.2 * psi, 48 * inch, modulus=125e3 * psi, factor=ovality_factor(0.02))
    >>> round(float(t / inch), 3)
    0.878
    """
    choice("convention", convention, CONVENTIONS)
    pressure, diameter = _pressure(pressure), positive("diameter", diameter)
    with np.errstate(divide="ignore"):
        slenderness = np.cbrt(
            _stiffness(modulus, poisson, factor, enhancement) / (pressure * positive("safety", safety))
        )
    return diameter / (slenderness + (1.0 if convention == "outer" else 0.0))


def thickness_oval_stress(
    pressure: ArrayLike, diameter: ArrayLike, *, ovality: ArrayLike, strength: ArrayLike, safety: ArrayLike = 2.0
) -> Array:
    """Return the liner thickness against bending stress in an oval pipe, X1.2 solved for t.

    Args:
        pressure: Groundwater pressure [Pa].
        diameter: D [m].
        ovality: q as a fraction, above 0: a round liner has no such limit.
        strength: Long-term flexural strength [Pa].
        safety: N.

    Returns:
        D/DR with DR from 1.5 q (1 + q) DR^2 - 0.5 (1 + q) DR = strength/(pressure safety) [m]; 0 without pressure.

    Raises:
        ParameterError: A value is out of range.

    Source: ASTM F1216 X1.2.

    >>> inch, psi = 0.0254, 6894.757293168361
    >>> t = thickness_oval_stress(5.2 * psi, 48 * inch, ovality=0.02, strength=4500 * psi)
    >>> round(float(t / inch), 3)
    0.376
    """
    pressure, diameter = _pressure(pressure), positive("diameter", diameter)
    q = finite("ovality", ovality)
    require(np.isnan(q) | ((q > 0) & (q < 1)), "ovality", q, "0 < ovality < 1", "a round liner has no X1.2 limit")
    with np.errstate(divide="ignore"):
        allowed = positive("strength", strength) / (pressure * positive("safety", safety))
    square, linear = 1.5 * q * (1.0 + q), 0.5 * (1.0 + q)
    return diameter * 2.0 * square / (linear + np.sqrt(linear * linear + 4.0 * square * allowed))


def buoyancy_factor(cover: ArrayLike, water: ArrayLike) -> Array:
    """Return the water buoyancy factor R_w.

    Args:
        cover: Height of soil above the top of the pipe [m].
        water: Height of water above the top of the pipe [m].

    Returns:
        1 - 0.33 water/cover, not below 0.67.

    Raises:
        ParameterError: The cover is not positive, or the water below the top (then give 0).

    Source: ASTM F1216 X1.3.

    >>> buoyancy_factor(4.0, np.array([0.0, 2.0, 8.0]))
    array([1.   , 0.835, 0.67 ])
    """
    cover, water = positive("cover", cover), _water(water)
    return np.maximum(1.0 - 0.33 * water / cover, LEAST_BUOYANCY)


def elastic_support(cover: ArrayLike, *, constants: str = "inch-pound") -> Array:
    """Return the coefficient of elastic support B'.

    Args:
        cover: Height of soil above the top of the pipe [m].
        constants: `inch-pound` or `si`.

    Returns:
        1/(1 + 4 exp(-0.065 H)) with H in feet, or 0.213 H in metres.

    Raises:
        ParameterError: The cover is not positive or the constants are unknown.

    Source: ASTM F1216 X1.3.

    >>> round(float(elastic_support(16 * 0.3048)), 6)
    0.414281
    """
    choice("constants", constants, CONSTANTS)
    return 1.0 / (1.0 + 4.0 * np.exp(-SUPPORT_DECAY[constants] * positive("cover", cover)))


def total_load(
    cover: ArrayLike,
    water: ArrayLike,
    *,
    unit_weight: ArrayLike,
    live_load: ArrayLike = 0.0,
    constants: str = "inch-pound",
) -> Array:
    """Return the total external pressure q_t on a fully deteriorated pipe.

    Args:
        cover: Height of soil above the top of the pipe [m].
        water: Height of water above the top of the pipe [m].
        unit_weight: Of the soil [N/m3].
        live_load: Surface load arriving at the pipe [Pa].
        constants: `inch-pound` or `si`: the printed weight of water.

    Returns:
        Water + R_w soil + live load [Pa].

    Raises:
        ParameterError: A value is out of range.

    Source: ASTM F1216 X1.3.

    >>> round(float(total_load(4.8768, 2.4384, unit_weight=18850.5) / 6894.757293168361), 2)
    14.6
    """
    choice("constants", constants, CONSTANTS)
    soil = positive("unit_weight", unit_weight, "give newtons per cubic metre") * positive("cover", cover)
    live = finite("live_load", live_load)
    require(~(live < 0), "live_load", live, "live_load >= 0", "give the pressure at the pipe")
    return WATER_PER_METRE[constants] * _water(water) + buoyancy_factor(cover, water) * soil + live


def thickness_fully_deteriorated(
    load: ArrayLike,
    diameter: ArrayLike,
    *,
    modulus: ArrayLike,
    soil_modulus: ArrayLike,
    cover: ArrayLike,
    water: ArrayLike,
    factor: ArrayLike = 1.0,
    safety: ArrayLike = 2.0,
    edition: str = "2007b",
    constants: str = "inch-pound",
) -> Array:
    """Return the liner thickness in a pipe that no longer carries its own loads, X1.3 solved for t.

    Args:
        load: Total external pressure q_t, see `total_load` [Pa].
        diameter: D [m].
        modulus: Long-term flexural modulus [Pa].
        soil_modulus: Modulus of soil reaction E'_s [Pa].
        cover: Height of soil above the top of the pipe [m].
        water: Height of water above the top of the pipe [m].
        factor: Ovality factor C.
        safety: N.
        edition: `2007b` (C inside the root) or `before-2007b` (C outside it, hence thicker).
        constants: `inch-pound` or `si`.

    Returns:
        Thickness [m] from q_t = (32 R_w B' E'_s C E I/D^3)^(1/2)/N with I = t^3/12.

    Raises:
        ParameterError: A value is out of range, or edition or constants are unknown.

    Source: ASTM F1216 X1.3; the change of 07b as errata E.

    >>> inch, psi, foot = 0.0254, 6894.757293168361, 0.3048
    >>> t = thickness_fully_deteriorated(14.9 * psi, 48 * inch, modulus=125e3 * psi, soil_modulus=1e3 * psi,
    ...                                  cover=16 * foot, water=8 * foot, factor=0.836)
    >>> round(float(t / inch), 2)
    1.01
    """
    choice("edition", edition, EDITIONS)
    needed = _pressure(load, "load") * positive("safety", safety)
    factor = positive("factor", factor, "see ovality_factor")
    support = (
        32.0
        * buoyancy_factor(cover, water)
        * elastic_support(cover, constants=constants)
        * positive("soil_modulus", soil_modulus, "give pascals")
        * positive("modulus", modulus, "give pascals")
    )
    inside, outside = (factor, 1.0) if edition == "2007b" else (1.0, factor)
    return positive("diameter", diameter) * np.cbrt(12.0 * (needed / outside) ** 2 / (support * inside))


def thickness_stiffness(diameter: ArrayLike, *, modulus: ArrayLike, constants: str = "inch-pound") -> Array:
    """Return the least liner thickness for handling and soil loads, X1.4 solved for t.

    Args:
        diameter: D [m].
        modulus: Initial flexural modulus [Pa].
        constants: `inch-pound` (0.093 psi) or `si` (0.00064 MPa).

    Returns:
        Thickness [m] at which E/(12 DR^3) reaches the least value.

    Raises:
        ParameterError: A value is out of range.

    Source: ASTM F1216 X1.4, for fully deteriorated pipes.

    >>> round(float(thickness_stiffness(48 * 0.0254, modulus=250e3 * 6894.757293168361) / 0.0254), 3)
    0.79
    """
    choice("constants", constants, CONSTANTS)
    modulus = positive("modulus", modulus, "give pascals")
    return positive("diameter", diameter) * np.cbrt(12.0 * LEAST_STIFFNESS[constants] / modulus)


def _stiffness(modulus: Array, poisson: Array, factor: Array, enhancement: Array) -> Array:
    poisson = finite("poisson", poisson)
    require(np.isnan(poisson) | ((poisson > -1) & (poisson <= 0.5)), "poisson", poisson, *POISSON)
    plate = positive("modulus", modulus, "give pascals") / (1.0 - poisson * poisson)
    return 2.0 * positive("enhancement", enhancement, "7 is the usual K") * plate * factor


def _ratio(value: Array) -> Array:
    value = finite("dimension_ratio", value)
    require(~(value <= 1), "dimension_ratio", value, "dimension_ratio > 1", "it is diameter over thickness")
    return value


def _pressure(value: Array, name: str = "pressure") -> Array:
    value = finite(name, value)
    require(~(value < 0), name, value, f"{name} >= 0", "give the external pressure in pascals")
    return value


def _water(value: Array) -> Array:
    value = finite("water", value)
    require(~(value < 0), "water", value, "water >= 0", "give 0 when the water stands below the top of the pipe")
    return value
