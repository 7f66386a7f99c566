"""Figures 4.8 and 4.11 to 4.15: tori, the oblique shapes that a tilted ring cuts from them, and rays that confirm them.

The robot stands on the axis of an upward bend; shapes are seen in the ring plane after pitch and then yaw.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.bends import bend_ovality, bend_section, ring_bend, torus_quartic
from springline.geometry.robot import frame, yaw_after_pitch
from springline.reproduce.drawing import INK, Key, Panel, Solid, ramp, sheet
from springline.reproduce.figure import Check, Figure, below

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Shape = tuple[float, float]

RADIUS, SHARP, SMOOTH = 10.0, 20.0, 100.0
"""Radius of the pipe and of the two bends' axes, as in the text."""

_ALONE = (5.0, 10.0, 15.0, 20.0, 25.0)
_TOGETHER = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0)
_HALF_RAYS = 29
"""Rays over half a turn in Appendix B; each is followed both ways."""


def oblique_shape(bend_radius: float, pitch: float, yaw: float) -> tuple[Array, Array]:
    """Return z and y around the closed oblique shape of a circular bend; pitch and yaw in degrees.

    NaN where the ring plane misses the inner wall.
    """
    p, h = np.radians([pitch, yaw])
    reach = RADIUS / np.cos(yaw_after_pitch(p, h))
    z = reach * np.cos(np.linspace(0.0, np.pi, 181))
    # rounding may put an end a hair outside the wall
    z = np.clip(z, -reach * (1 - 1e-12), reach * (1 - 1e-12))
    inner = bend_section(z, bend_radius, RADIUS, RADIUS, p, h, wall=-1)
    outer = bend_section(z, bend_radius, RADIUS, RADIUS, p, h, wall=1)
    return np.concatenate([z, z[::-1]]), np.concatenate([inner, outer[::-1]])


def ray_misfit(bend_radius: float, pitch: float, yaw: float, *, rays: int = 2 * _HALF_RAYS) -> float:
    """Return how far ray-cast dots lie from the shape, at most; NaN where the plane misses the inner wall.

    >>> ray_misfit(20.0, 15.0, 30.0) < 1e-9
    True
    """
    if np.isnan(oblique_shape(bend_radius, pitch, yaw)[1]).any():
        return float("nan")
    z, y = _dots(bend_radius, pitch, yaw, rays)
    p, h = np.radians([pitch, yaw])
    walls = [bend_section(z, bend_radius, RADIUS, RADIUS, p, h, wall=wall) for wall in (1, -1)]
    return float(np.max(np.min(np.abs(np.stack(walls) - y), axis=0)))


def rays_lost(bend_radius: float, pitch: float, yaw: float) -> int:
    """Return for how many rays of Appendix B its rule, two real roots nearer than 20, picks anything but two.

    >>> rays_lost(100.0, 5.0, 15.0), rays_lost(20.0, 30.0, 15.0) > 0
    (0, True)
    """
    p, h = np.radians([pitch, yaw])
    axes = frame(p, h)
    phi = np.arange(_HALF_RAYS)[:, None] * np.pi / _HALF_RAYS
    directions = np.cos(phi) * axes[2] + np.sin(phi) * axes[1]
    quartics = torus_quartic([0.0, -bend_radius, 0.0], directions, bend_radius, RADIUS, RADIUS)
    roots = np.stack([np.roots(coefficients) for coefficients in quartics])
    picked = (np.abs(roots.imag) < 1e-6) & (np.abs(roots.real) < 20.0)
    return int(np.sum(picked.sum(axis=1) != 2))


def _dots(bend_radius: float, pitch: float, yaw: float, rays: int) -> tuple[Array, Array]:
    phi = np.arange(rays) * 2 * np.pi / rays
    p, h = np.radians([pitch, yaw])
    radius = ring_bend(phi, bend_radius, RADIUS, RADIUS, p, h, order="pitch_yaw")
    return radius * np.cos(phi), radius * np.sin(phi)


def tori() -> Figure:
    """Return Figure 4.8."""
    views, colour = [], (168, 200, 222)
    for bend_radius, level, title in ((SHARP, 90.0, "R = 20, r = 10, 90°"), (SMOOTH, 60.0, "R = 100, r = 10, 60°")):
        turn, around = np.meshgrid(np.radians(np.linspace(0.0, level, 31)), np.linspace(0, 2 * np.pi, 41))
        rho = bend_radius + RADIUS * np.cos(around)
        view = Solid(width=330, height=230, title=title, azimuth=60, elevation=28)
        views.append(view.surface(rho * np.sin(turn), -rho * np.cos(turn), RADIUS * np.sin(around), colour))
    printed, right = _torus_residuals()
    check = Check(
        "The elliptical torus (4.7) passes through its own wall (r1 = 12, r2 = 10, R = 20)",
        "0",
        f"as printed off by {printed:.2f} of its own terms; with 4 r2² R² on the right by less than {below(right)}",
        False,
        "Erratum 20: the right side is 4 r2² R² (1 - z²/r1²). The published verification uses r1 = r2, where the two "
        "agree.",
    )
    return Figure(
        "4.8", "Two bends", sheet([views], title="Figure 4.8"), "A sharp and a smooth bend, drawn open.", (check,)
    )


def _torus_residuals() -> tuple[float, float]:
    """Return the largest relative misfit of (4.7) on the wall of an elliptical torus, as printed and corrected."""
    r1, r2 = 12.0, 10.0
    around = np.linspace(0.0, 2 * np.pi, 73)
    z, rho = r1 * np.sin(around), SHARP + r2 * np.cos(around)
    left = (r2**2 * (z**2 / r1**2 - 1.0) - SHARP**2 + rho**2) ** 2
    residuals = [left - 4.0 * r**2 * SHARP**2 * (1.0 - z**2 / r1**2) for r in (r1, r2)]
    return tuple(float(np.max(np.abs(residual)) / left.max()) for residual in residuals)


def sharp_alone() -> Figure:
    """Return Figure 4.11."""
    return _alone("4.11", SHARP, "Oblique shapes in a sharp bend by pitch or yaw alone")


def smooth_alone() -> Figure:
    """Return Figure 4.12."""
    return _alone("4.12", SMOOTH, "Oblique shapes in a smooth bend by pitch or yaw alone")


def _alone(number: str, bend_radius: float, title: str) -> Figure:
    by_pitch, by_yaw = [(a, 0.0) for a in _ALONE], [(0.0, a) for a in _ALONE]
    fakes = [
        100 * float(bend_ovality(bend_radius, RADIUS, RADIUS, *np.radians(shape)).axes)
        for shape in (by_pitch[-1], by_yaw[-1])
    ]
    note = (
        "Erratum 22: the printed limits of y have their ends exchanged, and (4.9) loses the inner wall where "
        f"c = R sin(pitch) exceeds R - r. A round pipe shows here an ovality of {fakes[0]:.1f} % at 25° of pitch and "
        f"{fakes[1]:.1f} % at 25° of yaw (mean of the axes)."
    )
    return _shapes(number, bend_radius, title, ("pitch alone", by_pitch), ("yaw alone", by_yaw), note, ())


def sharp_together() -> Figure:
    """Return Figure 4.13."""
    return _together("4.13", SHARP, "Oblique shapes in a sharp bend by pitch and yaw together")


def smooth_together() -> Figure:
    """Return Figure 4.14."""
    return _together("4.14", SMOOTH, "Oblique shapes in a smooth bend by pitch and yaw together")


def _together(number: str, bend_radius: float, title: str) -> Figure:
    note = (
        "Left as in Appendix B, right the other way round. Erratum 22: inside the printed limits of z the radicand of "
        "(4.11) can be negative. "
    )
    checks = ()
    if bend_radius == SHARP:
        note += "At 30° of pitch, c = R sin(pitch) reaches R - r and the ring plane begins to miss the inner wall."
        missed = [a for a in _TOGETHER if np.isnan(oblique_shape(SHARP, a, 15.0)[1]).any()]
        checks = (
            Check(
                "Between its limits of z the shape (4.11) is real",
                "",
                f"at a yaw of 15° not at {', '.join(f'{a:g}°' for a in missed)} of pitch"
                if missed
                else "at all of them",
                not missed,
                "Erratum 22: (4.11) needs R sin(pitch) + z sin(yaw') below the inner wall's distance from the axis.",
            ),
        )
    return _shapes(
        number,
        bend_radius,
        title,
        ("pitch 15°, yaw as in the key", [(15.0, a) for a in _TOGETHER]),
        ("yaw 15°, pitch as in the key", [(a, 15.0) for a in _TOGETHER]),
        note,
        checks,
    )


def _shapes(
    number: str,
    bend_radius: float,
    title: str,
    left: tuple[str, list[Shape]],
    right: tuple[str, list[Shape]],
    note: str,
    checks: tuple[Check, ...],
) -> Figure:
    panels = [_panel(bend_radius, shapes, name) for name, shapes in (left, right)]
    angles = [max(shape) if 0.0 in shape else shape[1] for shape in left[1]]
    keys = [Key(f"{angle:g}°", colour) for angle, colour in zip(angles, ramp(len(angles)), strict=True)]
    worst = np.nanmax([ray_misfit(bend_radius, *shape) for shape in (*left[1], *right[1])])
    confirmed = Check(
        "The closed shapes are right",
        "",
        f"dots of rays cast on the torus lie within {below(worst)} of every whole one (pipe radius 10)",
        bool(worst < 1e-9),
    )
    return Figure(number, title, sheet([panels], title=f"Figure {number}", keys=keys), note, (confirmed, *checks))


def _panel(bend_radius: float, shapes: list[Shape], title: str) -> Panel:
    panel = Panel((-13, 13), (-12.5, 14.5), width=300, height=310, title=title, x_label="z", y_label="y", equal=True)
    for shape, colour in zip(shapes, ramp(len(shapes)), strict=True):
        panel.line(*oblique_shape(bend_radius, *shape), colour)
    return panel


def verification() -> Figure:
    """Return Figure 4.15."""
    cases = ((SMOOTH, "smooth bend, R = 100"), (SHARP, "sharp bend, R = 20"))
    panels = []
    for bend_radius, title in cases:
        shapes = [(a, 15.0) for a in _TOGETHER]
        panel = _panel(bend_radius, shapes, title)
        for shape, colour in zip(shapes, ramp(len(shapes)), strict=True):
            panel.dots(*_dots(bend_radius, *shape, 2 * _HALF_RAYS), colour, size=4)
        panels.append(panel)
    misfits = np.array([[ray_misfit(bend_radius, a, 15.0) for a in _TOGETHER] for bend_radius, _ in cases])
    worst = np.nanmax(misfits, axis=1)
    lost = [sum(rays_lost(bend_radius, a, 15.0) for a in _TOGETHER) for bend_radius, _ in cases]
    total = _HALF_RAYS * len(_TOGETHER)
    checks = (
        Check(
            "All laser dots match the derived shapes",
            "",
            f"within {below(worst[0])} in the smooth bend and {below(worst[1])} in the sharp one, wherever the ring "
            "plane meets the whole wall",
            bool(worst.max() < 1e-9),
        ),
        Check(
            "Real roots nearer than 20 are the two wanted hits (Appendix B)",
            "",
            f"on {lost[0]} of {total} rays they are not two in the smooth bend, on {lost[1]} in the sharp one",
            not any(lost),
            "Erratum 24: a bound on the distance is no rule. Each ray wants its smallest positive root forwards and "
            "its largest negative one backwards.",
        ),
    )
    keys = [Key(f"pitch {a:g}°", colour) for a, colour in zip(_TOGETHER, ramp(len(_TOGETHER)), strict=True)]
    keys.append(Key("laser dots", INK, dot=4))
    return Figure(
        "4.15",
        "Oblique shapes in a bend, confirmed by laser dots",
        sheet([panels], title="Figure 4.15", keys=keys),
        "Yaw 15°, pitch as in the key; 58 dots a ring, cast on the torus and not by the formula. The implicit roll of "
        "pitch before yaw is taken with its sign (erratum 12).",
        checks,
    )
