"""Figures 7.3, 7.5, 7.6 and 7.10 to 7.12: shapes of liners, and what is claimed of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.liners import (
    Conformity,
    Lobe,
    chicurel_height,
    chicurel_protrusion,
    confined_oc,
    conformity,
    conserving_oc,
    host_arc,
    lobe_arc,
    lobed,
    quasi_ellipse,
)
from springline.geometry.sections import ellipse
from springline.reproduce.drawing import BLUE, GREEN, INK, ORANGE, SOFT, Key, Panel, sheet
from springline.reproduce.figure import Check, Figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

R1, R2 = 12.0, 10.0
"""The host's semi-axes in Figures 7.10 to 7.12."""

_TURN = np.radians(np.linspace(0.0, 360.0, 721))
_COLOURS = (BLUE, ORANGE, GREEN)
_CHORDS = {11: GREEN, 13: ORANGE, 15: BLUE}


def quasi() -> Figure:
    """Return Figure 7.3."""
    liner, oval = quasi_ellipse(10.0, 1.0), ellipse(11.0, 9.0)
    panel = Panel((-12, 12), (-11, 11), width=360, height=330, x_label="z", y_label="y", equal=True)
    panel.line(10 * np.cos(_TURN), 10 * np.sin(_TURN), SOFT, dash="2 3")
    panel.line(*oval.contour(_TURN), ORANGE, dash="6 3").line(*liner.contour(_TURN), BLUE)
    apart = (liner.polar_radius(_TURN) - oval.polar_radius(_TURN)) / 10.0
    worst = int(np.argmax(np.abs(apart[:181])))
    close = Panel(
        (0, 90),
        (0, 0.8),
        width=330,
        height=220,
        x_label="bearing [°]",
        y_label="quasi-ellipse less ellipse [% of r]",
        x_ticks=range(0, 91, 15),
    )
    close.line(np.degrees(_TURN[:181]), 100 * apart[:181], BLUE)
    length = [100 * (float(s.perimeter) / (20 * np.pi) - 1) for s in (liner, oval)]
    area = [100 * (float(s.area) / (100 * np.pi) - 1) for s in (liner, oval)]
    return Figure(
        "7.3",
        "Quasi-ellipse and ellipse for d0 = r / 10",
        sheet(
            [[panel, close]],
            title="Figure 7.3",
            keys=[Key("circle", SOFT, "2 3"), Key("quasi-ellipse", BLUE), Key("ellipse", ORANGE, "6 3")],
        ),
        f"Perimeter {length[0]:+.2f} % (ellipse {length[1]:+.2f} %), area {area[0]:+.3f} % (ellipse {area[1]:+.2f} %) "
        "against the circle.",
        (
            Check(
                "It separates slightly from the ellipse",
                "",
                f"by {100 * abs(apart[worst]):.2f} % of r at most, at a bearing of {np.degrees(_TURN[worst]):.0f}°",
                bool(np.abs(apart).max() < 0.01),
            ),
        ),
    )


def chicurel() -> Figure:
    """Return Figure 7.5."""
    panel = Panel((-10.5, 10.5), (-1, 10.8), width=440, height=250, x_label="z", y_label="y", equal=True)
    panel.line(10 * np.cos(_TURN), 10 * np.sin(_TURN), SOFT, dash="2 3")
    close = Panel(
        (0, 0.12),
        (-0.1, 0.25),
        width=330,
        height=250,
        x_label="place along the chord, z / l",
        y_label="outside the host [% of r]",
    )
    close.line([0, 0.12], [0, 0], SOFT, width=1.0)
    for chord in range(1, 16, 2):
        k = chord / 20.0
        z = np.linspace(0.0, chord, 801)
        y = chicurel_height(z, k, 10.0) + 10.0 * np.sqrt(1 - k * k)
        panel.line(z - chord / 2, y, INK, width=1.2)
        if chord >= 11:
            close.line(z / chord, 10.0 * (np.hypot(z - chord / 2, y) - 10.0), _CHORDS[chord])
    outside = [float(chicurel_protrusion(k)[0]) for k in (0.25, 0.5, 0.75, 0.9)]
    return Figure(
        "7.5",
        "Lobes by Chicurel's equation, chords 1 to 15 in a circle of radius 10",
        sheet(
            [[panel, close]],
            title="Figure 7.5",
            keys=[Key("host", SOFT, "2 3"), Key("lobe", INK), *(Key(f"chord {c}", v) for c, v in _CHORDS.items())],
        ),
        "The root of (7.8) is the one in (π, 3π/2); the other is the unbuckled arc (erratum A18).",
        (
            Check(
                "Every lobe leaves its host near the edges",
                "",
                "by {:.1e}, {:.1e}, {:.1e} and {:.1e} of the radius at k = 0.25, 0.5, 0.75 and 0.9".format(*outside),
                min(outside) > 0.0,
            ),
        ),
    )


def second_derivatives() -> Figure:
    """Return Figure 7.6."""
    k = np.linspace(0.01, 0.95, 189)
    w = np.sqrt(1.0 - k * k)
    lobe, circle, printed = -2.0 * (1.0 - w) / (k * k), -(w**-3.0), -(w ** (-2.0 / 3.0))
    panel = Panel((0, 1), (-6, 0), width=400, height=240, x_label="k", y_label="second derivative at the edge, times r")
    panel.line(k, lobe, BLUE).line(k, circle, ORANGE).line(k, printed, ORANGE, dash="2 3")
    return Figure(
        "7.6",
        "Second derivatives of Chicurel's lobe and of the circle at the lobe's edge",
        sheet(
            [[panel]],
            title="Figure 7.6",
            keys=[Key("lobe", BLUE), Key("circle", ORANGE), Key("circle as printed", ORANGE, "2 3")],
        ),
        "Erratum A11: the printed cube root stands for a power of 3/2, in (7.10), (7.11), (7.19) and (7.22).",
        (
            Check(
                "(7.11) has no solution",
                "",
                "2 w³ - w - 1 = (w - 1)(2 w² + 2 w + 1) is below zero for every k",
                bool(np.all(lobe > circle) and np.all(lobe > printed)),
            ),
        ),
    )


def angles() -> Figure:
    """Return Figure 7.10."""
    lobes = [Lobe(np.radians(phi), 8.0) for phi in (15.0, 30.0, 45.0)]
    stretch = ", ".join(f"{100 * stretch_of(lobe):+.1f}" for lobe in lobes)
    keeping = ", ".join(f"{float(conserving_oc(R1, R2, lobe.phi)):.3f}" for lobe in lobes)
    jump = float(np.max(np.abs(lobed(R1, R2, lobes[1].phi, 8.0).joints().curvature)))
    more = (
        Check(
            "Slope and curvature are continuous at the edges",
            "",
            f"slope is; curvature jumps by {jump:.3f} at φ = 30°",
            False,
            "Erratum A3: only the slope is matched. The smooth lobe r_e - depth cos³ matches both.",
        ),
        Check(
            "The liner keeps its length",
            "",
            f"the lobes are stretched by {stretch} % at φ = 15°, 30°, 45°",
            False,
            f"Erratum A5: chapter 3 insists on it, (7.13) does not ask for it. OC = {keeping} would keep it.",
        ),
    )
    return _family("7.10", "Lobes of different angle, OC = 8", lobes, ("φ = 15°", "φ = 30°", "φ = 45°"), more)


def depths() -> Figure:
    """Return Figure 7.11."""
    lobes = [Lobe(np.radians(30.0), oc) for oc in (6.0, 7.0, 8.0)]
    stretch = ", ".join(f"{100 * stretch_of(lobe):+.1f}" for lobe in lobes)
    more = (
        Check(
            "OC is the largest deflection",
            "6, 7, 8",
            "deflections of 4, 3, 2",
            False,
            "Erratum A21: OC is the radius that is left; the deflection is r2 - OC.",
        ),
        Check(
            "The liner keeps its length",
            "",
            f"the lobes are stretched by {stretch} % at OC = 6, 7, 8",
            False,
            "Erratum A5.",
        ),
    )
    return _family("7.11", "Lobes of different depth, φ = 30°", lobes, ("OC = 6", "OC = 7", "OC = 8"), more)


def powers() -> Figure:
    """Return Figure 7.12."""
    lobes = [Lobe(np.radians(30.0), 8.0, p) for p in (2.0, 4.0, 6.0)]
    return _family("7.12", "Lobes of different power, φ = 30°, OC = 8", lobes, ("p = 2", "p = 4", "p = 6"), ())


def stretch_of(lobe: Lobe) -> float:
    """Return a lobe's length over that of the host's arc behind it, less 1.

    >>> round(100 * stretch_of(Lobe(np.radians(15.0), 8.0)), 1)
    23.6
    """
    arc = host_arc(lobe.bearing - lobe.phi, lobe.bearing + lobe.phi, R1, R2)
    return float(lobe_arc(lobe, R1, R2) / arc - 1.0)


def _family(number: str, title: str, lobes: Sequence[Lobe], names: Sequence[str], more: tuple[Check, ...]) -> Figure:
    whole = Panel((-13, 13), (-11, 11), width=260, height=220, x_label="z", y_label="y", equal=True)
    close = Panel((-8.6, 8.6), (5.4, 10.6), width=470, height=142, x_label="z", equal=True)
    host = ellipse(R1, R2).contour(_TURN)
    found: list[Conformity] = []
    for panel in (whole, close):
        panel.line(*host, SOFT, dash="2 3")
    for lobe, colour in zip(lobes, _COLOURS, strict=True):
        liner = lobed(R1, R2, lobe.phi, lobe.oc, lobe.p)
        found.append(conformity(liner))
        for panel in (whole, close):
            panel.line(*liner.contour(_TURN), colour)
    room = min(float(confined_oc(R1, R2, lobe.phi, lobe.p)) - float(lobe.oc) for lobe in lobes)
    check = Check(
        "The lobes are well confined by the host",
        "",
        f"all {len(lobes)} are; OC could be {room:.2f} larger before one began outside",
        all(bool(one.inside) for one in found),
    )
    keys = [Key("host, 12 by 10", SOFT, "2 3"), *(Key(n, c) for n, c in zip(names, _COLOURS, strict=True))]
    return Figure(
        number,
        title,
        sheet([[whole, close]], title=f"Figure {number}", keys=keys),
        "Erratum A4: confined holds for these, not in general: a flat wide lobe on an ellipse begins outside it. "
        "Erratum A12: with a general power, |θ| is meant.",
        (check, *more),
    )
