"""What a change can be: pipes do not heal, so what shrinks by itself is taken for an error of measurement."""

from __future__ import annotations

from dataclasses import dataclass

CHANGE, ERROR, UNCLEAR = "change", "measurement error", "unclear"


@dataclass(frozen=True)
class Quantity:
    """A quantity that is compared.

    Attributes:
        words: What tables call it.
        factor: From its own unit to `unit`.
        unit: Edge unit.
        grows: 1 or -1 where it can only rise or fall by itself; 0 where both happen.
        why: Why the other way is taken for an error.
    """

    words: str
    factor: float
    unit: str
    grows: int = 0
    why: str = ""


_DEGREES = 180.0 / 3.141592653589793

QUANTITIES = {
    "patch": Quantity("wall, local", 1e3, "mm"),
    "scale": Quantity("all diameters alike", 1e2, "%"),
    "diameter_mean": Quantity("mean diameter", 1e3, "mm"),
    "diameter_x": Quantity("horizontal diameter", 1e3, "mm"),
    "diameter_y": Quantity("vertical diameter", 1e3, "mm"),
    "diameter_max": Quantity("largest diameter", 1e3, "mm"),
    "diameter_min": Quantity("smallest diameter", 1e3, "mm"),
    "ovality": Quantity("ovality", 1e2, "%", 1, "a loaded pipe does not become rounder by itself"),
    "mode": Quantity("section mode", 1.0, ""),
    "gradient": Quantity("gradient", 1e2, "%"),
    "elevation": Quantity("elevation", 1e3, "mm"),
    "easting": Quantity("easting", 1e3, "mm"),
    "northing": Quantity("northing", 1e3, "mm"),
    "joint gap": Quantity("joint gap", 1e3, "mm", 1, "a joint does not close by itself"),
    "joint step": Quantity("joint step", 1e3, "mm", 1, "a displaced joint does not go back by itself"),
    "joint kink": Quantity("joint angle", _DEGREES, "deg", 1, "a joint does not straighten by itself"),
    "bend angle": Quantity("angle of bend", _DEGREES, "deg"),
    "lateral size": Quantity("bore of lateral", 1e3, "mm", -1, "a lateral does not grow by itself"),
    "lateral bearing": Quantity("place of lateral round the pipe", _DEGREES, "deg", 2, "a lateral does not wander"),
    "lateral protrusion": Quantity("protrusion of lateral", 1e3, "mm", 1, "a lateral is not drawn back by itself"),
    "dent depth": Quantity("depth of dent", 1e3, "mm", -1, "a dent does not spring back by itself"),
    "deposit depth": Quantity("depth of deposit", 1e3, "mm"),
    "intrusion depth": Quantity("depth of intrusion", 1e3, "mm"),
    "found": Quantity("found in one inspection alone", 1.0, ""),
}
"""Everything that is compared, by the key of `Change.quantity`. Depth is negative inward, so a dent grows downward."""


def verdict(quantity: str, change: float, *, works: bool, wall_thickness: float = float("nan")) -> tuple[str, str]:
    """Return whether a significant change is taken as one, and why not.

    Args:
        quantity: Key of `QUANTITIES`.
        change: B less A, in the quantity's own unit.
        works: Whether the pipe was cleaned, repaired or lined in between.
        wall_thickness: Of the pipe [m]; NaN = not known.

    >>> verdict("ovality", -0.01, works=False)[0], verdict("ovality", 0.01, works=False)[0]
    ('measurement error', 'change')
    """
    kind = QUANTITIES[quantity]
    if quantity == "patch" and change > wall_thickness:
        return ERROR, "more wall would be gone than there is"
    if works or not kind.grows:
        return CHANGE, ""
    if kind.grows == 2:
        return ERROR, kind.why
    return (CHANGE, "") if change * kind.grows > 0 else (ERROR, kind.why)
