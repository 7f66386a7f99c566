"""Figures 5.2 and 5.4: where the oblique ellipse has its axes, and its shape against pitch and yaw.

Angles in degrees.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.fitting import fit_ellipses_to_ranges
from springline.geometry.robot import axis, frame, oblique_ellipse, ring_cylinder
from springline.reproduce.drawing import BLUE, GREEN, INK, ORANGE, Key, Panel, sheet
from springline.reproduce.figure import Check, Figure, below

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

R1, R2 = 11.0, 10.0
"""Semi-axes throughout chapter 5."""

_FIXED = (0.0, 15.0, 30.0)
_COLOURS = (BLUE, ORANGE, GREEN)


def axes_on_z(pitch: float, yaw: float, r1: float = R1) -> tuple[float, float]:
    """Return w, the component on the pipe's z, of the major and of the minor axis, taken with v above zero.

    >>> [round(w, 4) for w in axes_on_z(45.0, 15.0)]
    [0.259, -0.9478]
    """
    p, h = np.radians([pitch, yaw])
    axes = frame(p, h)
    beta = float(oblique_ellipse(r1, R2, p, h).beta)
    found = []
    for turn in (beta, beta + np.pi / 2):
        direction = np.cos(turn) * axes[2] + np.sin(turn) * axes[1]
        found.append(float(direction[2] * (np.sign(direction[1]) or 1.0)))
    return found[0], found[1]


def larger_root_is_major(pitch: float, yaw: float, r1: float = R1) -> bool:
    """Return whether w of the major axis is the root of larger size, sqrt(x1) of the text."""
    major, minor = axes_on_z(pitch, yaw, r1)
    return abs(major) > abs(minor)


def extremes() -> Figure:
    """Return Figure 5.2."""
    panel = Panel(
        (-1, 1), (50, 125), width=470, height=300, x_label="w", y_label="f = (r1 r2 / radius)²", title="yaw 15°"
    )
    keys = []
    for pitch, colour in zip((0.0, 15.0, 30.0, 45.0), (INK, BLUE, GREEN, ORANGE), strict=True):
        a, b, c = axis(*np.radians([pitch, 15.0]))
        end = np.sqrt(a * a + b * b)
        w = end * np.cos(np.linspace(np.pi, 0.0, 241))
        panel.line(w, _f(w, a, b, c), colour)
        ends = np.array(axes_on_z(pitch, 15.0))
        panel.dots(ends[:1], _f(ends[:1], a, b, c), colour, size=8)
        panel.dots(ends[1:], _f(ends[1:], a, b, c), colour, size=8, hollow=True)
        keys.append(Key(f"pitch {pitch:g}°", colour))
    keys += [Key("major axis, smallest f", INK, dot=8), Key("minor axis, largest f", INK, dot=8, hollow=True)]
    why = "Erratum 13: the text has the two pairings exchanged. The 2 by 2 eigenproblem needs no pairing."
    checks = [
        Check(
            f"Root that is the major axis at pitch {pitch:g}°, yaw 15°",
            printed,
            found := "√x1" if larger_root_is_major(pitch, 15.0) else "√x2",
            found == printed,
            "" if found == printed else why,
        )
        for pitch, printed in ((15.0, "√x2"), (30.0, "√x2"), (45.0, "√x1"))
    ]
    other = "√x1" if larger_root_is_major(30.0, 15.0, 12.0) else "√x2"
    return Figure(
        "5.2",
        "Extremes of f against w, whose positions tell the axes of the oblique ellipse",
        sheet([[panel]], title="Figure 5.2", keys=keys),
        f"r1 = 11, r2 = 10. With the r1 = 12 that section 5.2.3 names, pitch 30° and yaw 15° has {other} for its major "
        "axis instead (erratum 16). Erratum 14: the printed f has a minus too many before B.",
        tuple(checks),
    )


def _f(w: ArrayLike, a: float, b: float, c: float) -> Array:
    """Return r1^2 v^2 + r2^2 w^2 with v from (5.11)."""
    w = np.asarray(w, float)
    square = a * a + b * b
    v = (-w * b * c + a * np.sqrt(np.maximum(square - w * w, 0.0))) / square
    return R1**2 * v * v + R2**2 * w * w


def shapes() -> Figure:
    """Return Figure 5.4."""
    moving = np.linspace(0.0, 30.0, 121)
    rows = []
    for name, other in (("pitch", "yaw"), ("yaw", "pitch")):
        radii = Panel((0, 30), (9.8, 13.8), width=330, height=190, x_label=f"{name} [°]", y_label="semi-axes")
        turn = Panel(
            (0, 30), (-4, 94), width=330, height=190, x_label=f"{name} [°]", y_label="β [°]", y_ticks=(0, 30, 60, 90)
        )
        for fixed, colour in zip(_FIXED, _COLOURS, strict=True):
            pose = (moving, fixed) if name == "pitch" else (fixed, moving)
            found = oblique_ellipse(R1, R2, *np.radians(np.broadcast_arrays(*pose)))
            beta = _unsigned(found.beta)
            # a jump is drawn as one, not as a slope
            beta[1:][np.abs(np.diff(beta)) > 45.0] = np.nan
            radii.line(moving, found.major, colour).line(moving, found.minor, colour, dash="5 3")
            turn.line(moving, beta, colour)
            dots = np.arange(0.0, 31.0, 3.0)
            fitted = _fitted(*((dots, fixed) if name == "pitch" else (fixed, dots)))
            for values in fitted[:2]:
                radii.dots(dots, values, colour, size=4)
            turn.dots(dots, fitted[2], colour, size=4)
        radii.title = turn.title = f"{other} 0°, 15°, 30°"
        rows.append([radii, turn])
    keys = [Key(f"{angle:g}°", colour) for angle, colour in zip(_FIXED, _COLOURS, strict=True)]
    keys += [Key("major", INK), Key("minor", INK, "5 3"), Key("ellipse fitted to rays", INK, dot=4)]
    return Figure(
        "5.4",
        "Semi-axes and angle of the oblique ellipse, and ellipses fitted to rays",
        sheet([*rows, _fields()], title="Figure 5.4", keys=keys),
        "r1 = 11 as in the rest of the chapter. Here β is unsigned as published; erratum 2: its sign is what tells "
        "(pitch, yaw) from (pitch, -yaw). The conversion from a conic printed in 5.2.3 mixes two conventions (erratum "
        "17); the fits here do not use it.",
        _shape_checks(),
    )


def fit_misfit() -> float:
    """Return how far ellipses fitted to rays lie from theory over the figure's poses: relative, and in radians."""
    pitch, yaw = (v.ravel() for v in np.meshgrid(np.arange(1.0, 31.0, 4.0), np.arange(2.0, 31.0, 4.0)))
    found = oblique_ellipse(R1, R2, *np.radians([pitch, yaw]))
    fitted = _fitted(pitch, yaw)
    off = [fitted[0] / found.major - 1, fitted[1] / found.minor - 1, np.radians(fitted[2] - _unsigned(found.beta))]
    return float(np.max(np.abs(off)))


def switch(r1: float) -> float:
    """Return the pitch [degrees] at which, without yaw, the axes exchange their roles: acos(r2/r1)."""
    return float(np.degrees(np.arccos(R2 / r1)))


def steepest_turn(yaw: float) -> float:
    """Return the largest change of beta over a twentieth of a degree of pitch, 0 to 30 [degrees]."""
    pitch = np.linspace(0.0, 30.0, 601)
    found = oblique_ellipse(R1, R2, *np.radians(np.broadcast_arrays(pitch, yaw)))
    return float(np.nanmax(np.abs(np.diff(_unsigned(found.beta)))))


def _shape_checks() -> tuple[Check, ...]:
    worst, jumps = fit_misfit(), [steepest_turn(yaw) for yaw in (0.0, 15.0)]
    ends = {
        name: oblique_ellipse(R1, R2, *np.radians(pose))
        for name, pose in (("pitch", (30.0, 0.0)), ("yaw", (0.0, 30.0)))
    }
    major, minor = ({k: float(getattr(e, which)) for k, e in ends.items()} for which in ("major", "minor"))
    return (
        Check("Fitted ellipses agree with theory", "", f"within {below(worst)}", worst < 1e-6),
        Check(
            "β rises steeply at acos(r2/r1)",
            "25°",
            f"{switch(11.0):.2f}° for r1 = 11",
            round(switch(11.0)) == 25,
            f"Rounded; with the r1 = 12 named above the figure it would be {switch(12.0):.2f}° (erratum 16).",
        ),
        Check(
            "β starts to increase dramatically there",
            "",
            f"a jump of {jumps[0]:.0f}° without yaw; at 15° of yaw at most {jumps[1]:.2f}° in 0.05° of pitch",
            False,
            "Erratum 16: the jump exists only at zero yaw; otherwise β passes 45° smoothly.",
        ),
        Check(
            "The major axis varies more with yaw, the minor one with pitch",
            "",
            f"at 30° the major axis is {major['yaw']:.2f} by yaw and {major['pitch']:.2f} by pitch, the minor one "
            f"{minor['yaw']:.2f} and {minor['pitch']:.2f}",
            major["yaw"] > major["pitch"] and minor["pitch"] > minor["yaw"],
        ),
    )


def _fields() -> list[Panel]:
    grid = np.linspace(0.0, 30.0, 121)
    found = oblique_ellipse(R1, R2, *np.radians(np.meshgrid(grid, grid)))
    panels = []
    for values, name, limits, levels in (
        (found.major, "major axis", (10.5, 14.0), [11.5, 12.0, 12.5, 13.0, 13.5]),
        (found.minor, "minor axis", (9.8, 11.4), [10.2, 10.4, 10.6, 10.8, 11.0]),
        (_unsigned(found.beta), "β [°]", (0.0, 95.0), [15, 30, 45]),
    ):
        panel = Panel((0, 30), (0, 30), width=205, height=190, title=name, x_label="pitch [°]", y_label="yaw [°]")
        panels.append(panel.field(values, limits, levels=levels))
    return panels


def _fitted(pitch: ArrayLike, yaw: ArrayLike) -> tuple[Array, Array, Array]:
    """Return major, minor and unsigned beta [degrees] of ellipses fitted to 72 rays of each ring."""
    pitch, yaw = (np.radians(v)[:, None] for v in np.broadcast_arrays(pitch, yaw))
    phi = np.radians(np.arange(0.0, 360.0, 5.0))
    fits = fit_ellipses_to_ranges(ring_cylinder(phi, R1, R2, pitch, yaw), phi, method="fitzgibbon")
    return fits.semi_major, fits.semi_minor, _unsigned(fits.axis_bearing)


def _unsigned(beta: ArrayLike) -> Array:
    return np.abs(np.degrees(beta))
