"""Close-fit buckling after Glock (1977), for oval hosts and with an annular gap: an alternative to F1216 X1.1.

A thin elastic liner, free of friction, in a rigid host under outside water pressure buckles in one lobe
w = w0 cos^2(pi s/2l). Its energy per length is that of bending in the lobe, of the uniform thrust that the lobe
relieves, and of the water's work,

    U = D w0^2 pi^4/(8 l^3) + E* t/(2P) (w0 l/R - pi^2 w0^2/(8 l) - 2 pi g)^2 - p w0 l,    D = E* t^3/12,

with E* = E/(1 - nu^2), P the perimeter, R the host's radius of curvature at the lobe and g the gap all round.
Its greatest equilibrium pressure without a gap is 0.455 E* t^2.2/(P^0.4 R^1.8): in a circle 1.003 E* (t/D)^2.2,
which is Glock's. The host's flattest place, R = a^2/b of an ellipse, then gives the knock-down for ovality (the form
that Thépot 2000 uses for egg shapes), and the gap's term that for looseness.

Limits: rigid host, linear elasticity, small rotations (t/D up to about 0.03), no friction, one lobe at the worst
place, gap and ovality acting together as their product. Creep enters through a long-term modulus. No K: the host's
support is what the theory describes.

Sources: Glock, Der Stahlbau 46 (1977) 212-217; Omara, Guice, Straughan, Akl, J. Transp. Eng. 123 (1997), who found it
to agree best with tests of close-fit liners; Thépot, Trenchless Technol. Res. 15 (2000) 25-41.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.design.f1216 import POISSON
from springline.geometry.checks import finite, positive, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

_FREE = (2.4 - np.sqrt(2.16)) / 0.45
"""pi^2 w0 R/l^2 at the greatest pressure without a gap: the root of 0.225 y^2 - 2.4 y + 4."""

_LOOSE = (10.0 - np.sqrt(30.0)) / 1.75
"""The same with a gap without bound."""

_FREE_STRAIN = _FREE - _FREE**2 / 8.0
_PRESSURE = (5.0 * np.pi**2 / 3.0) ** 0.6 * np.pi**-0.8 * 12.0**-0.6 * _FREE_STRAIN**0.4 * (1.0 - _FREE / 10.0)
"""0.455, the coefficient of E* t^2.2/(P^0.4 R^1.8)."""


def glock_pressure(
    thickness: ArrayLike,
    diameter: ArrayLike,
    *,
    modulus: ArrayLike,
    poisson: ArrayLike = 0.3,
    ovality: ArrayLike = 0.0,
    gap: ArrayLike = 0.0,
) -> Array:
    """Return the outside pressure at which a close-fit liner buckles.

    Args:
        thickness: t [m].
        diameter: Inside diameter of the host (mean of its axes) [m]; the theory's own is the liner's, D - t.
        modulus: Long-term flexural modulus [Pa].
        poisson: Poisson's ratio.
        ovality: q as a fraction, (max - mean)/mean with the mean of the axes.
        gap: Annular gap between liner and host, all round [m].

    Returns:
        Critical pressure [Pa], without a safety factor.

    Raises:
        ParameterError: A value is out of range.

    Source: see the module.

    >>> p = glock_pressure(0.006, 0.306, modulus=1.5e9)
    >>> round(float(p / (1.5e9 / 0.91 * 0.02**2.2)), 3)
    1.003
    """
    thickness, diameter = positive("thickness", thickness), positive("diameter", diameter)
    require(~(thickness >= diameter / 2), "thickness", thickness, "thickness < diameter/2", "give metres for both")
    poisson = finite("poisson", poisson)
    require(np.isnan(poisson) | ((poisson > -1) & (poisson <= 0.5)), "poisson", poisson, *POISSON)
    plate = positive("modulus", modulus, "give pascals") / (1.0 - poisson**2)
    radius = (diameter - thickness) / 2.0
    perimeter, curved = 2.0 * np.pi * radius / perimeter_factor(ovality), radius / flattening_factor(ovality)
    close = _PRESSURE * plate * thickness**2.2 / (perimeter**0.4 * curved**1.8)
    return close * gap_factor(_slack(gap, thickness, perimeter, curved))


def flattening_factor(ovality: ArrayLike) -> Array:
    """Return the mean radius over the radius of curvature at the flattest place, (1 - q)/(1 + q)^2, of an ellipse.

    >>> round(float(flattening_factor(0.05)), 6)
    0.861678
    """
    q = finite("ovality", ovality)
    require(np.isnan(q) | ((q >= 0) & (q < 1)), "ovality", q, "0 <= ovality < 1", "2 % is 0.02")
    return (1.0 - q) / (1.0 + q) ** 2


def perimeter_factor(ovality: ArrayLike) -> Array:
    """Return the perimeter of the circle of the mean of the axes over that of the ellipse.

    >>> round(float(perimeter_factor(0.05)), 6)
    0.999375
    """
    from scipy.special import ellipe

    q = finite("ovality", ovality)
    return np.pi / (2.0 * (1.0 + q) * ellipe(4.0 * q / (1.0 + q) ** 2))


def ovality_knockdown(ovality: ArrayLike) -> Array:
    """Return the buckling pressure in an oval host over that in a round one of equal mean of the axes.

    Args:
        ovality: q as a fraction.

    Returns:
        ((1 - q)/(1 + q)^2)^1.8 times a perimeter term near 1; F1216 takes the power 3.

    Raises:
        ParameterError: q is negative, or 1 and more.

    >>> round(float(ovality_knockdown(0.05)), 4)
    0.7647
    """
    return flattening_factor(ovality) ** 1.8 * perimeter_factor(ovality) ** 0.4


def gap_knockdown(thickness: ArrayLike, diameter: ArrayLike, *, gap: ArrayLike, ovality: ArrayLike = 0.0) -> Array:
    """Return the buckling pressure with a gap over that without, at equal ovality.

    Args:
        thickness: t [m].
        diameter: Inside diameter of the host [m].
        gap: Annular gap all round [m].
        ovality: q as a fraction.

    Returns:
        Factor in (0, 1]; it depends on the modulus in no way.

    Raises:
        ParameterError: A value is out of range.

    >>> gap_knockdown(0.006, 0.3, gap=np.array([0.0, 0.0003, 0.0015])).round(3)
    array([1.   , 0.877, 0.58 ])
    """
    thickness, diameter = positive("thickness", thickness), positive("diameter", diameter)
    radius = (diameter - thickness) / 2.0
    perimeter, curved = 2.0 * np.pi * radius / perimeter_factor(ovality), radius / flattening_factor(ovality)
    return gap_factor(_slack(gap, thickness, perimeter, curved))


def gap_factor(slack: ArrayLike) -> Array:
    """Return the reduction by a gap as a function of the dimensionless slack 2 pi^3 g R^2/l1^3.

    Args:
        slack: As `_slack` makes it, from 0.

    Returns:
        Greatest equilibrium pressure over that at no slack.

    >>> float(gap_factor(0.0))
    1.0
    """
    slack = np.asarray(slack, dtype=float)
    # Slack rises with the rise y of the lobe at its greatest pressure, from no slack to without bound.
    low, high = np.full(slack.shape, _FREE), np.full(slack.shape, _LOOSE)
    for _ in range(52):
        middle = (low + high) / 2.0
        over = _at_greatest(middle)[1] > slack
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    factor = _at_greatest(low)[0] / _at_greatest(_FREE)[0]
    return np.where(slack == 0.0, 1.0, np.where(np.isnan(slack), np.nan, factor))


def thickness_glock(
    pressure: ArrayLike,
    diameter: ArrayLike,
    *,
    modulus: ArrayLike,
    poisson: ArrayLike = 0.3,
    ovality: ArrayLike = 0.0,
    gap: ArrayLike = 0.0,
    safety: ArrayLike = 2.0,
) -> Array:
    """Return the thickness of a close-fit liner against outside water pressure.

    Args:
        pressure: Groundwater pressure [Pa].
        diameter: Inside diameter of the host [m].
        modulus: Long-term flexural modulus [Pa].
        poisson: Poisson's ratio.
        ovality: q as a fraction.
        gap: Annular gap all round [m].
        safety: Safety factor on the pressure.

    Returns:
        Thickness [m] at which `glock_pressure` is `safety` times `pressure`; 0 without pressure, NaN where even a
        wall of a fifth of the diameter does not suffice.

    Raises:
        ParameterError: A value is out of range.

    Source: see the module.

    >>> t = thickness_glock(50e3, 0.3, modulus=1.5e9, ovality=0.02)
    >>> round(float(glock_pressure(t, 0.3, modulus=1.5e9, ovality=0.02)), 1)
    100000.0
    """
    pressure = finite("pressure", pressure)
    require(~(pressure < 0), "pressure", pressure, "pressure >= 0", "give the external pressure in pascals")
    needed = pressure * positive("safety", safety)
    diameter = positive("diameter", diameter)
    if not np.any(gap):
        # Without a gap the pressure is a power of t/(D - t).
        unit = glock_pressure(diameter / 2.02, diameter, modulus=modulus, poisson=poisson, ovality=ovality)
        slender = (needed / unit) ** (1.0 / 2.2) / 1.02
        return np.where(slender <= 0.25, diameter * slender / (1.0 + slender), np.nan)
    shape = np.broadcast_shapes(needed.shape, diameter.shape, *(np.shape(v) for v in (modulus, poisson, ovality, gap)))
    low, high = np.log(np.broadcast_to(1e-5 * diameter, shape)), np.log(np.broadcast_to(0.2 * diameter, shape))

    def carried(log_thickness):
        return glock_pressure(
            np.exp(log_thickness), diameter, modulus=modulus, poisson=poisson, ovality=ovality, gap=gap
        )

    enough = carried(high) >= needed
    for _ in range(50):
        middle = (low + high) / 2.0
        over = carried(middle) >= needed
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    return np.where(needed == 0, 0.0, np.where(enough, np.exp(high), np.nan))


def _slack(gap: Array, thickness: Array, perimeter: Array, curved: Array) -> Array:
    """Return 2 pi g (pi R)^2/l1^3 with l1^5 = 5 D pi^4 R^2/(3 E* t/P), the lobe's own scale of length."""
    gap = finite("gap", gap)
    require(~(gap < 0), "gap", gap, "gap >= 0", "give the annular gap in metres")
    length = (5.0 / 36.0 * thickness**2 * perimeter * np.pi**4 * curved**2) ** 0.2
    return 2.0 * np.pi * gap * (np.pi * curved) ** 2 / length**3


def _at_greatest(rise: Array) -> tuple[Array, Array]:
    """Return relative pressure and slack of the lobe whose greatest equilibrium pressure has y = pi^2 w0 R/l^2.

    With l relative to l1, equilibrium is (y - y^2/8) l^3 - slack = 1/l^2 and the pressure (1 - y/10)/l^2; at its
    greatest dp/dl = 0, which gives l explicitly.
    """
    strain = rise - rise**2 / 8.0
    shortness = 10.0 * (1.0 - rise / 10.0) * (1.0 - rise / 4.0) - 1.5 * strain
    with np.errstate(divide="ignore"):
        length = shortness**-0.2
    return (1.0 - rise / 10.0) / length**2, strain * length**3 - length**-2.0
