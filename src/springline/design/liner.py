"""Liner thickness along a pipe: every check that applies, which one governs, its sigma, and what to be warned of."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from springline.design import f1216, f1216_pressure, glock
from springline.errors import ParameterError
from springline.geometry.checks import choice, finite, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

METHODS = ("f1216", "glock")
CONDITIONS = ("partially", "fully")

OVALITY_LIMIT = 0.10
"""F1216 is used for ovalities up to 10 percent."""

RATIO_LIMIT = 100.0
"""Largest DR that F1216 suggests."""

ENHANCEMENT_LEAST = 7.0

WARNINGS = {
    "ovality_over_10_percent": "the ovality exceeds 10 %, beyond which F1216 advises against its factors",
    "buoyancy_at_limit": "R_w would fall below 0.67 and was held there",
    "ratio_limit": "DR = 100 governs: the loads alone would allow a thinner liner",
    "hole_in_ring_tension": "the hole is too large to be spanned as a plate (X1.5): ring tension X1.7 was used",
    "enhancement_below_7": "K is below 7, the least that F1216 recommends with full support",
    "no_thickness": "no thickness up to a fifth of the diameter carries the pressure",
}
"""Remarks that a result may carry."""


@dataclass(frozen=True, kw_only=True)
class LinerDesign:
    """What a liner is made of, what loads it, and by which rule it is sized.

    Attributes:
        modulus: Long-term flexural modulus E_L [Pa].
        strength: Long-term flexural strength [Pa].
        water_pressure: Groundwater pressure measured from the invert [Pa].
        condition: `partially` or `fully` deteriorated.
        method: `f1216`, or `glock` in place of X1.1.
        poisson: Poisson's ratio.
        enhancement: K.
        safety: N.
        edition: F1216 edition, `2007b` (and later) or `before-2007b`.
        convention: `outer` (the standard) or `mean` (the dissertation) diameter in X1.1.
        constants: `inch-pound` or `si`: the printed pair of empirical constants.
        ratio_limit: Largest DR, inf for none.
        gap: Annular gap [m], for `glock`.
        short_modulus: Initial flexural modulus [Pa], for X1.4; the long-term one when not given.
        soil_modulus: Modulus of soil reaction [Pa], fully deteriorated only.
        cover: Soil above the top of the pipe [m], fully deteriorated only.
        water: Water above the top of the pipe [m], fully deteriorated only.
        unit_weight: Of the soil [N/m3], fully deteriorated only.
        live_load: At the pipe [Pa], fully deteriorated only.
        internal_pressure: Of a pressure pipe [Pa]; 0 for gravity.
        hole: Largest hole in the pipe's wall [m], partially deteriorated pressure pipe only.
        tensile_strength: Long-term tensile strength [Pa], pressure pipes only.

    >>> LinerDesign(modulus=1.7e9, strength=31e6, water_pressure=36e3).condition
    'partially'
    """

    modulus: float
    strength: float
    water_pressure: float
    condition: str = "partially"
    method: str = "f1216"
    poisson: float = 0.3
    enhancement: float = 7.0
    safety: float = 2.0
    edition: str = "2007b"
    convention: str = "outer"
    constants: str = "inch-pound"
    ratio_limit: float = RATIO_LIMIT
    gap: float = 0.0
    short_modulus: float | None = None
    soil_modulus: float | None = None
    cover: float | None = None
    water: float = 0.0
    unit_weight: float | None = None
    live_load: float = 0.0
    internal_pressure: float = 0.0
    hole: float = 0.0
    tensile_strength: float | None = None

    def __post_init__(self) -> None:
        choice("condition", self.condition, CONDITIONS)
        choice("method", self.method, METHODS)
        choice("edition", self.edition, f1216.EDITIONS)
        choice("convention", self.convention, f1216.CONVENTIONS)
        choice("constants", self.constants, f1216.CONSTANTS)
        for name, mend in (("safety", "2 is usual"), ("enhancement", "7 is the usual K")):
            value = getattr(self, name)
            require(np.asarray(0 < value < np.inf), name, value, f"{name} > 0", mend)
        require(np.asarray(-1 < self.poisson <= 0.5), "poisson", self.poisson, *f1216.POISSON)
        require(np.asarray(self.ratio_limit > 2), "ratio_limit", self.ratio_limit, "ratio_limit > 2", "100 is usual")
        if self.condition == "fully":
            self._need("soil_modulus", "cover", "unit_weight")
        if self.internal_pressure and (self.hole or self.condition == "fully"):
            self._need("tensile_strength")

    def _need(self, *names: str) -> None:
        missing = [name for name in names if getattr(self, name) is None]
        if missing:
            raise ParameterError(
                f"{', '.join(missing)} not given",
                where=f"a {self.condition} deteriorated {'pressure' if self.internal_pressure else 'gravity'} pipe",
                expected="all values that its equations hold",
            )


@dataclass(frozen=True)
class LinerResult:
    """Liner thickness at each station.

    Attributes:
        thickness: Required [m]; NaN where diameter or ovality is missing.
        sigma: One sigma from those of diameter and ovality [m], by the governing check's derivative.
        governing: Name of the check that asks for most; empty where the thickness is missing.
        checks: Thickness [m] that each check asks for, by name.
        dimension_ratio: DR, diameter over required thickness.
        warnings: For each of WARNINGS that occurs, at which stations.
    """

    thickness: np.ndarray
    sigma: np.ndarray
    governing: np.ndarray
    checks: dict[str, np.ndarray]
    dimension_ratio: np.ndarray
    warnings: dict[str, np.ndarray] = field(default_factory=dict)

    def worst(self) -> int:
        """Return the station that asks for the thickest liner."""
        if np.isnan(self.thickness).all():
            raise ParameterError("no station has a thickness", mend="check the diameters and ovalities given")
        return int(np.nanargmax(self.thickness))


def design_liner(
    design: LinerDesign,
    diameter: ArrayLike,
    ovality: ArrayLike,
    *,
    diameter_sigma: ArrayLike = 0.0,
    ovality_sigma: ArrayLike = 0.0,
    correlation: float = 0.0,
) -> LinerResult:
    """Return the required liner thickness at each station.

    Args:
        design: LinerDesign.
        diameter: Mean inside diameter of the existing pipe [m], by any of the four means.
        ovality: q as a fraction by the matching mean, broadcast; values just below 0 by noise count as 0.
        diameter_sigma: One sigma of `diameter` [m].
        ovality_sigma: One sigma of `ovality`.
        correlation: Between the errors of diameter and ovality.

    Returns:
        LinerResult of the broadcast shape.

    Raises:
        ParameterError: A value is out of range.

    Source: ASTM F1216 appendix X1, or `glock` in place of X1.1; delta method for the sigma.

    >>> inch, psi = 0.0254, 6894.757293168361
    >>> design = LinerDesign(modulus=125e3 * psi, strength=4500 * psi, water_pressure=5.2 * psi)
    >>> found = design_liner(design, 48 * inch, [0.0, 0.02], ovality_sigma=0.001)
    >>> (found.thickness / inch).round(3), (found.sigma / inch).round(4), found.governing.tolist()
    (array([0.828, 0.878]), array([0.0024, 0.0026]), ['X1.1', 'X1.1'])
    """
    diameter, q = np.broadcast_arrays(finite("diameter", diameter), finite("ovality", ovality))
    require(~(q < -0.01), "ovality", q, "ovality >= 0", "give (max - mean)/mean as a fraction")
    q = np.maximum(q, 0.0)
    checks, warnings = _checks(design, diameter, q)
    names = np.array(list(checks))
    table = np.stack(list(checks.values()))
    known = ~np.isnan(table).any(axis=0)
    first = np.argmax(np.where(np.isnan(table), -1.0, table), axis=0)
    thickness = np.where(known, np.take_along_axis(table, first[None], axis=0)[0], np.nan)
    slope_d, slope_q = (
        np.take_along_axis(slope, first[None], axis=0)[0] for slope in _slopes(design, diameter, q, names)
    )
    part_d = slope_d * finite("diameter_sigma", diameter_sigma)
    part_q = slope_q * finite("ovality_sigma", ovality_sigma)
    sigma = np.sqrt(part_d**2 + part_q**2 + 2.0 * correlation * part_d * part_q)
    governing = np.where(known, names[first], "")
    with np.errstate(divide="ignore"):
        ratio = diameter / thickness
    return LinerResult(thickness, np.where(known, sigma, np.nan), governing, checks, ratio, warnings)


def next_standard(thickness: ArrayLike, *, step: float = 0.0015, sizes: ArrayLike | None = None) -> Array:
    """Return the next thickness up that is made.

    Args:
        thickness: Required [m].
        step: Made in multiples of this [m]; 1.5 mm is a common step of felt tubes, ask the maker.
        sizes: Or the thicknesses that are made [m], in any order.

    Returns:
        Thickness [m], NaN where none is thick enough or the required one is missing.

    Raises:
        ParameterError: The step is not positive.

    >>> next_standard([0.0044, 0.0045, 0.00451]).round(4)
    array([0.0045, 0.0045, 0.006 ])
    """
    thickness = finite("thickness", thickness)
    if sizes is None:
        require(np.asarray(step > 0), "step", step, "step > 0", "give metres")
        # A millionth of a step is rounding, not thickness.
        return np.ceil(thickness / step - 1e-6) * step
    sizes = np.append(np.sort(np.asarray(sizes, dtype=float)), np.nan)
    place = np.searchsorted(sizes[:-1], thickness * (1 - 1e-9))
    return np.where(np.isnan(thickness), np.nan, sizes[place])


def _slopes(design: LinerDesign, diameter: Array, q: Array, names: Array) -> tuple[Array, Array]:
    """Return the derivative of every check by diameter and by ovality, one-sided at q = 0."""
    step = 1e-6 * diameter
    up, down = (_checks(design, diameter + sign * step, q)[0] for sign in (1.0, -1.0))
    by_diameter = np.stack([(up[name] - down[name]) / (2.0 * step) for name in names])
    low, high = np.maximum(q - 1e-6, 0.0), q + 1e-6
    up, down = _checks(design, diameter, high)[0], _checks(design, diameter, low)[0]
    by_ovality = np.stack([(up[name] - down[name]) / (high - low) for name in names])
    return by_diameter, by_ovality


def _checks(design: LinerDesign, diameter: Array, q: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the thickness by each check that applies, and the warnings."""
    checks, warnings = _groundwater(design, diameter, q)
    if design.condition == "fully":
        checks |= _fully(design, diameter, q)
        limit = f1216.buoyancy_factor(design.cover, design.water) <= f1216.LEAST_BUOYANCY
        warnings["buoyancy_at_limit"] = np.broadcast_to(limit, q.shape)
    if design.internal_pressure:
        more, tension = _internal(design, diameter)
        checks |= {name: np.broadcast_to(value, q.shape) for name, value in more.items()}
        warnings["hole_in_ring_tension"] = np.broadcast_to(tension, q.shape)
    if np.isfinite(design.ratio_limit):
        loads = np.max(list(checks.values()), axis=0)
        checks["DR limit"] = diameter / design.ratio_limit
        warnings["ratio_limit"] = checks["DR limit"] > loads
    warnings["ovality_over_10_percent"] = q > OVALITY_LIMIT
    return checks, {name: where for name, where in warnings.items() if np.any(where)}


def _groundwater(design: LinerDesign, diameter: Array, q: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return X1.1 (or Glock) and X1.2, and their warnings."""
    common = {"modulus": design.modulus, "poisson": design.poisson, "safety": design.safety}
    warnings = {}
    if design.method == "glock":
        name = "Glock"
        buckling = glock.thickness_glock(design.water_pressure, diameter, ovality=q, gap=design.gap, **common)
        warnings["no_thickness"] = np.isnan(buckling) & ~np.isnan(diameter + q)
    else:
        name = "X1.1"
        factor, shape = f1216.ovality_factor(q), {"enhancement": design.enhancement, "convention": design.convention}
        buckling = f1216.thickness_buckling(design.water_pressure, diameter, factor=factor, **shape, **common)
        warnings["enhancement_below_7"] = np.full(q.shape, design.enhancement < ENHANCEMENT_LEAST)
    # A round liner has no X1.2 limit; the smallest ovality that a float tells from it asks for next to nothing.
    oval = np.where(q > 0, q, 1e-12)
    stress = f1216.thickness_oval_stress(
        design.water_pressure, diameter, ovality=oval, strength=design.strength, safety=design.safety
    )
    return {name: buckling, "X1.2": np.where(q == 0, 0.0, stress)}, warnings


def _fully(design: LinerDesign, diameter: Array, q: Array) -> dict[str, Array]:
    load = f1216.total_load(
        design.cover,
        design.water,
        unit_weight=design.unit_weight,
        live_load=design.live_load,
        constants=design.constants,
    )
    soil = f1216.thickness_fully_deteriorated(
        load,
        diameter,
        modulus=design.modulus,
        soil_modulus=design.soil_modulus,
        cover=design.cover,
        water=design.water,
        factor=f1216.ovality_factor(q),
        safety=design.safety,
        edition=design.edition,
        constants=design.constants,
    )
    stiff = f1216.thickness_stiffness(
        diameter, modulus=design.short_modulus or design.modulus, constants=design.constants
    )
    return {"X1.3": soil, "X1.4": np.broadcast_to(stiff, q.shape)}


def _internal(design: LinerDesign, diameter: Array) -> tuple[dict[str, Array], Array]:
    """Return the check for internal pressure, and where a hole is too large for a plate."""
    pressure, safety = design.internal_pressure, design.safety
    if design.condition == "fully":
        tension = f1216_pressure.thickness_ring_tension(
            pressure, diameter, tensile_strength=design.tensile_strength, safety=safety
        )
        return {"X1.7": tension}, np.zeros(np.shape(diameter), dtype=bool)
    if not design.hole:
        return {}, np.zeros(np.shape(diameter), dtype=bool)
    plate = f1216_pressure.thickness_hole_span(
        pressure, diameter, hole=design.hole, strength=design.strength, safety=safety
    )
    tension = f1216_pressure.thickness_ring_tension(
        pressure, diameter, tensile_strength=design.tensile_strength, safety=safety
    )
    spans = f1216_pressure.spans_as_plate(plate, diameter, hole=design.hole)
    return {"X1.6": np.where(spans, plate, 0.0), "X1.7": np.where(spans, 0.0, tension)}, ~spans & ~np.isnan(diameter)
