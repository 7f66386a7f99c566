"""Figures 3.16 to 3.18: what the mean diameter's definition does to ovality, buckling pressure and thickness."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.design.f1216 import PSI, buckling_pressure, ovality_factor, thickness_buckling
from springline.geometry.sections import ellipse
from springline.reproduce.drawing import BLUE, GREEN, INK, ORANGE, Key, Panel, sheet
from springline.reproduce.figure import Check, Figure
from springline.reproduce.tables import DESIGN, INCH, MEAN_DIAMETER, PRESSURE, THICKNESS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_RATIO = np.linspace(1.0, 1.2, 81)
_STYLE = {
    "axes": (INK, "", "mean of the axes (as the industry does)"),
    "polar": (BLUE, "", "polar mean (as published)"),
    "area": (GREEN, "5 3", "circle of equal area"),
    "caliper": (ORANGE, "2 3", "mean caliper"),
}


def ovalities(ratio: float) -> dict[str, tuple[float, float]]:
    """Return the ovality of an ellipse with r1/r2 = ratio by each mean, in percent: by its largest and its smallest.

    >>> [round(q, 2) for q in ovalities(1.2)["polar"]]
    [9.77, 8.52]
    """
    diameters = ellipse(ratio, 1.0).diameters
    return {
        mean: tuple(100.0 * float(diameters.ovality(mean, extreme=extreme)) for extreme in ("max", "min"))
        for mean in _STYLE
    }


def ovality_and_factor() -> Figure:
    """Return Figure 3.16."""
    size = {"width": 225, "height": 210, "x_label": "r1 / r2"}
    mean = Panel((1, 1.2), (1, 1.12), y_label="mean diameter / 2 r2", **size)
    q = Panel((1, 1.2), (0, 10), y_label="ovality q [%]", **size)
    factor = Panel((1, 1.2), (0.4, 1.0), y_label="factor C", **size)
    diameters = ellipse(_RATIO, 1.0).diameters
    for name, (colour, dash, _) in _STYLE.items():
        ovality = np.maximum(diameters.ovality(name), 0.0)
        mean.line(_RATIO, getattr(diameters, name) / 2.0, colour, dash=dash)
        q.line(_RATIO, 100 * ovality, colour, dash=dash)
        factor.line(_RATIO, ovality_factor(ovality), colour, dash=dash)
    at = ovalities(1.2)
    return Figure(
        "3.16",
        "Mean diameter, ovality and reduction factor of an ellipse",
        sheet([[mean, q, factor]], title="Figure 3.16", keys=_keys()),
        "Two more means are drawn. (3.16) and (3.19) are radii, named diameters (erratum A9), and (3.18) has a wrong "
        "prefactor: the mean radius is r1 r2 / agm(r1, r2) (erratum A8).",
        (
            Check(
                "The average underestimates the ovality",
                "",
                f"at r1/r2 = 1.2: {at['axes'][0]:.2f} % against {at['polar'][0]:.2f} % polar and "
                f"{at['caliper'][0]:.2f} % caliper; by the smallest diameter {at['axes'][1]:.2f} % against "
                f"{at['polar'][1]:.2f} %",
                False,
                "Erratum A2: only by the largest diameter and with the polar or the area mean. The accurate mean is "
                "one definition among several.",
            ),
        ),
    )


def critical_pressure() -> Figure:
    """Return Figure 3.17."""
    diameters = ellipse(_RATIO, 1.0).diameters
    panel = Panel((1, 1.2), (6, 18), width=380, height=240, x_label="r1 / r2", y_label="buckling pressure [psi]")
    for name, (colour, dash, _) in _STYLE.items():
        panel.line(_RATIO, _pressure(diameters.ovality(name)), colour, dash=dash)
    round_one = float(_pressure(0.0))
    spread = [float(_pressure(q / 100)) for pair in ovalities(1.2).values() for q in pair]
    return Figure(
        "3.17",
        "Buckling pressure by each mean",
        sheet([[panel]], title="Figure 3.17", keys=_keys()),
        "K = 7, E = 72500 psi, ν = 0.35, D = 8 in, t = 0.2462 in, N = 2. At r1/r2 = 1.2 the definitions of ovality "
        f"span {min(spread):.2f} to {max(spread):.2f} psi.",
        (
            Check("SDR - 1", "32.49", f"{MEAN_DIAMETER / THICKNESS:.2f}", round(MEAN_DIAMETER / THICKNESS, 2) == 32.49),
            Check("Pressure of the round pipe", "16.86 psi", f"{round_one:.2f} psi", round(round_one, 2) == 16.86),
        ),
    )


def thickness() -> Figure:
    """Return Figure 3.18."""
    diameters = ellipse(_RATIO, 1.0).diameters
    panel = Panel((1, 1.2), (0.25, 0.36), width=380, height=240, x_label="r1 / r2", y_label="thickness [in]")
    for name, (colour, dash, _) in _STYLE.items():
        panel.line(_RATIO, _thickness(diameters.ovality(name)), colour, dash=dash)
    mean, outer = (float(_thickness(0.0, convention)) for convention in ("mean", "outer"))
    return Figure(
        "3.18",
        "Liner thickness for 20 psi by each mean",
        sheet([[panel]], title="Figure 3.18", keys=_keys()),
        "For a fixed mean diameter of the liner, as published.",
        (
            Check("Thickness of the round pipe's liner", "0.2606 in", f"{mean:.4f} in", round(mean, 4) == 0.2606),
            Check(
                "It is that of ASTM F1216",
                "",
                f"{outer:.4f} in, {100 * (1 - outer / mean):.1f} % less, for a liner of that outer diameter",
                False,
                "Erratum A20: F1216 takes the host's inside diameter, and asks for the checks X1.2 to X1.4 too.",
            ),
        ),
    )


def _keys() -> list[Key]:
    return [Key(words, colour, dash) for colour, dash, words in _STYLE.values()]


def _pressure(ovality: Array | float) -> Array:
    factor = ovality_factor(np.maximum(ovality, 0.0))
    return buckling_pressure(MEAN_DIAMETER / THICKNESS + 1.0, factor=factor, **DESIGN) / PSI


def _thickness(ovality: Array | float, convention: str = "mean") -> Array:
    factor = ovality_factor(np.maximum(ovality, 0.0))
    t = thickness_buckling(PRESSURE * PSI, MEAN_DIAMETER * INCH, factor=factor, convention=convention, **DESIGN)
    return t / INCH
