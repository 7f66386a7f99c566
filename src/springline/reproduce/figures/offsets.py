"""Figures 4.1, 4.4 and 4.6: uneven coverage, and how far the origin leaves the pipe's axis. Lengths over r."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from springline.geometry.robot import offset_deformation, offset_pitch, ring_cylinder
from springline.reproduce.drawing import BLUE, GREEN, INK, ORANGE, SOFT, Key, Panel, departures, sheet
from springline.reproduce.figure import Check, Figure

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_RAYS = 36
_LENGTHS, _WHEELS = (1.0, 1.5, 2.0, 4.0), (0.1, 0.2, 0.3, 0.4)


def least_half_span(s: float) -> float:
    """Return the least half-span of the wheels, over r, with which the robot of 4.1.1 passes a pipe of severity s.

    >>> round(least_half_span(0.4), 3)
    0.653
    """

    def room(w: float) -> float:
        return float(offset_deformation(s, half_span=w)) - s

    return brentq(room, 0.0, 0.999) if room(0.0) > 0.0 else 0.0


def sinking_half_span(s: float) -> float:
    """Return the half-span, over r, from which on the origin sinks below the deformed pipe's centre.

    >>> round(sinking_half_span(0.9), 3)
    0.765
    """
    return brentq(lambda w: float(offset_deformation(s, half_span=w)), 0.1, 0.9999)


def coverage() -> Figure:
    """Return Figure 4.1."""
    circle = np.radians(np.arange(361.0))
    panels = []
    for offset, title in ((0.0, "origin on the axis"), (0.5, "origin half a radius off the axis")):
        phi = np.arange(_RAYS) * 2 * np.pi / _RAYS
        radius = ring_cylinder(phi, 1.0, 1.0, 0.0, 0.0, offset=(-offset, 0.0))
        z, y = radius * np.cos(phi), radius * np.sin(phi) - offset
        panel = Panel((-1.1, 1.1), (-1.1, 1.1), width=230, height=230, title=title, equal=True, axes=False)
        panel.line(np.cos(circle), np.sin(circle), SOFT, width=1.0)
        for a, b in zip(z, y, strict=True):
            panel.line([0.0, a], [-offset, b], "#c9d1d9", width=0.7)
        panels.append(panel.dots(z, y, BLUE, size=5).dots([0.0], [-offset], ORANGE, size=7))
    spacing = Panel(
        (-90, 270),
        (0, 2),
        width=330,
        height=215,
        x_label="bearing of the reading [°]",
        y_label="spacing over even",
        x_ticks=range(-90, 271, 90),
    )
    shades = {0.25: GREEN, 0.5: BLUE, 0.75: ORANGE}
    for offset, colour in shades.items():
        spacing.line(np.linspace(-90, 270, 361), _spacing(offset), colour)
    near, far = _spacing(0.5)[[0, 180]]
    check = Check(
        "The wall near the origin is scanned more densely than the wall far from it",
        "",
        f"half a radius off, readings stand {near:.2f} of the even spacing apart at the nearest wall, {far:.2f} at "
        "the farthest",
        bool(near < 1.0 < far),
    )
    keys = [
        Key("reading", BLUE, dot=5),
        Key("origin", ORANGE, dot=7),
        *(Key(f"offset {e:g} r", colour) for e, colour in shades.items()),
    ]
    return Figure(
        "4.1",
        "Uneven coverage by a scanner off the axis",
        sheet([[*panels, spacing]], title="Figure 4.1", keys=keys),
        "Equal steps of bearing; the right panel adds how far neighbouring readings stand apart on the wall. Nearest "
        "and farthest differ by (1 + e)/(1 - e) for an offset of e radii.",
        (check,),
    )


def _spacing(offset: float) -> Array:
    """Return the spacing of readings over the even one, at bearings -90 to 270 degrees from an origin below O."""
    phi = np.radians(np.linspace(-90, 270, 361))
    step = 1e-5
    radius = [ring_cylinder(phi + h, 1.0, 1.0, 0.0, 0.0, offset=(-offset, 0.0)) for h in (-step, 0.0, step)]
    slope = (radius[2] - radius[0]) / (2 * step)
    return np.hypot(radius[1], slope)


def deformation_offset() -> Figure:
    """Return Figure 4.4."""
    s, w = np.linspace(0.0, 1.0, 201), np.linspace(0.0, 1.0, 201)
    field = _fitting(s[None, :], w[:, None])
    levels = [-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4]
    panel = Panel(
        (0, 1),
        (0, 1),
        width=430,
        height=330,
        x_label="severity s = r2 / r",
        y_label="half-span of the wheels w = W / r",
        title="offset of the origin over r; positive is above the centre",
    )
    # warm above the centre, as published
    panel.field(field, (-0.6, 0.6), departures()[::-1], levels=levels, bold=[0.0])
    for at in (0.3, 0.4):
        panel.dots([at], [least_half_span(at)], INK, size=7, hollow=True)
    panel.text(0.16, 0.42, "does not fit", SOFT, anchor="middle")
    sinking = [sinking_half_span(at) for at in (0.99, 0.9, 0.8)]
    least = [least_half_span(at) for at in (0.4, 0.3)]
    open_from = float(s[np.isfinite(field).all(axis=0)][0])
    checks = (
        Check("Least half-span that passes s = 0.4", "0.7", f"{least[0]:.3f}", False, "Erratum 25: read off a plot."),
        Check("Least half-span that passes s = 0.3", "0.85", f"{least[1]:.3f}", False, "Erratum 25: read off a plot."),
        Check(
            "Every span passes a pipe with s above 0.5",
            "0.5",
            f"from s = {open_from:.3f} on the map",
            abs(open_from - 0.5) < 0.01,
        ),
        Check(
            "Negative offsets exist for extremely large spans only",
            "",
            "from w = {:.3f}, {:.3f}, {:.3f} at s = 0.99, 0.9, 0.8".format(*sinking),
            False,
            "Erratum 25: they start at 1/sqrt(2) = 0.707 of the radius, a usual span.",
        ),
    )
    return Figure(
        "4.4",
        "Offset of the origin by the pipe's deformation and the wheels' span",
        sheet([[panel]], title="Figure 4.4", keys=[Key("least half-span at s = 0.3 and 0.4", dot=7, hollow=True)]),
        "W is half the span between left and right wheel. Grey: the origin would lie outside the pipe.",
        checks,
    )


def _fitting(s: Array, w: Array) -> Array:
    offset = offset_deformation(s, half_span=w)
    return np.where(np.abs(offset) <= s, offset, np.nan)


def pitch_offset() -> Figure:
    """Return Figure 4.6."""
    pitch = np.linspace(0.0, 30.0, 121)
    turn = np.radians(pitch)[None, :]
    size = {"width": 175, "height": 140}
    top, bottom = [], []
    for length in _LENGTHS:
        wheel = np.linspace(0.0, 0.25, 101)
        panel = Panel((0, 30), (0, 0.25), title=f"l = {length:g}", y_label="r_w" if not top else "", **size)
        top.append(_offsets(panel, offset_pitch(turn, length=length, height=1.0 - wheel[:, None])))
    for wheel in _WHEELS:
        length = np.linspace(4.0 * wheel, 2.0, 101)
        panel = Panel(
            (0, 30),
            (4.0 * wheel, 2.0),
            title=f"r_w = {wheel:g}",
            x_label="pitch [°]",
            y_label="l" if not bottom else "",
            **size,
        )
        bottom.append(_offsets(panel, offset_pitch(turn, length=length[:, None], height=1.0 - wheel)))
    small, large = (float(np.ptp(_over_wheels(at))) for at in (5.0, 30.0))
    bow = [_bow(length) for length in (1.0, 4.0)]
    checks = (
        Check(
            "The longer the robot, the more nearly the offset grows in proportion to pitch, whatever its wheels",
            "",
            f"largest departure from a straight line, over the largest offset inside the pipe: {100 * bow[0]:.1f} % "
            f"for l = 1, {100 * bow[1]:.1f} % for l = 4 (r_w = 0.25)",
            bow[1] < bow[0],
        ),
        Check(
            "At small pitch the offset varies little with the wheels' radius",
            "",
            f"r_w from 0.1 to 0.4 changes it by {small:.4f} r at 5° and {large:.3f} r at 30°",
            small < 0.002,
        ),
    )
    return Figure(
        "4.6",
        "Offset of the origin by pitch, for robots of length l and wheels of radius r_w",
        sheet([top, bottom], title="Figure 4.6"),
        "The formula is exact: l sin(p) - h (1 - cos(p)). Erratum 26: the text's h = 1 - r_w is that of wheels without "
        "span; with the half-span of 4.1.1 it is √(1 - w²) - r_w. l is signed, and the listing drops the negative "
        "offsets of a robot that noses down ahead of its pivot. Values over 1 leave the pipe (grey).",
        checks,
    )


def _offsets(panel: Panel, offset: Array) -> Panel:
    return panel.field(
        np.where((offset >= 0.0) & (offset <= 1.0), offset, np.nan), (0.0, 1.0), levels=[0.1, 0.2, 0.4, 0.6, 0.8]
    )


def _over_wheels(degrees: float) -> Array:
    return offset_pitch(np.radians(degrees), length=2.0, height=1.0 - np.array(_WHEELS))


def _bow(length: float) -> float:
    """Return by how much the offset departs from a straight line, over its largest value inside the pipe."""
    pitch = np.radians(np.linspace(0.0, 30.0, 301))
    offset = offset_pitch(pitch, length=length, height=0.75)
    offset = offset[offset <= 1.0]
    line = np.linspace(0.0, offset[-1], offset.size)
    return float(np.max(np.abs(offset - line)) / offset[-1])
