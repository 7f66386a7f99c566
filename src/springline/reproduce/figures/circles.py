"""Figures 2.34 and 2.36: circles fitted to noisy points, and what may happen to a contour that keeps its shape."""

from __future__ import annotations

import numpy as np

from springline.geometry.contours import dft, to_complex
from springline.geometry.fitting import fit_circle
from springline.geometry.openings import lateral_contour
from springline.reproduce.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, SOFT, Key, Panel, sheet
from springline.reproduce.figure import Check, Figure, below

_CENTRE, _RADIUS = (-2.0, 0.0), 10.0
_TURN = np.radians(np.linspace(0.0, 360.0, 181))
_METHODS = (("svd", "algebraic, unit norm (2.10)", ORANGE, "7 3"), ("kasa", "algebraic (2.12)", GREEN, "2 3"))


def fits() -> Figure:
    """Return Figure 2.34."""
    panels = []
    for title, reach in (("all round", 360.0), ("a quarter of it", 90.0)):
        points = noisy(reach)
        panel = Panel((-14, 10), (-12, 12), width=300, height=300, title=title, x_label="z", y_label="y", equal=True)
        panel.dots(points[:, 0], points[:, 1], SOFT, size=3.0)
        panel.line(*_circle(*_CENTRE, _RADIUS), INK, width=1.2)
        for method, _, colour, dash in _METHODS:
            panel.line(*_fitted(points, method), colour, dash=dash)
        panels.append(panel.line(*_fitted(points, "geometric"), BLUE, width=1.8))
    keys = [Key("true", INK), Key("geometric", BLUE)]
    keys += [Key(label, colour, dash) for _, label, colour, dash in _METHODS]
    return Figure(
        "2.34",
        "Circles fitted to points every 3° with 5 % noise",
        sheet([panels], title="Figure 2.34", keys=[*keys, Key("points", SOFT, dot=3)]),
        "Radius 10 about (-2, 0). All round, the fits can hardly be told apart; over an arc the algebraic ones come "
        "out small (erratum A17: that of unit norm also depends on where the origin lies).",
        _fit_checks(),
    )


def noisy(reach: float, seed: int = 34) -> np.ndarray:
    """Return points (n, 2) of an arc of `reach` degrees, every 3, with normal noise of 5 % of the radius."""
    rng = np.random.default_rng(seed)
    turn = np.radians(np.arange(0.0, reach, 3.0))
    radius = _RADIUS + rng.normal(0.0, 0.05 * _RADIUS, len(turn))
    return np.column_stack([_CENTRE[0] + radius * np.cos(turn), _CENTRE[1] + radius * np.sin(turn)])


def _fitted(points: np.ndarray, method: str) -> tuple[np.ndarray, np.ndarray]:
    found = fit_circle(points, method=method, robust=False, least_arc=0.0, most_scatter=np.inf)
    return _circle(found.centre_z, found.centre_y, found.radius)


def _circle(z: float, y: float, radius: float) -> tuple[np.ndarray, np.ndarray]:
    return z + radius * np.cos(_TURN), y + radius * np.sin(_TURN)


def _off(reach: float, method: str) -> float:
    """Root mean square error of the radius over forty draws."""
    options = {"method": method, "robust": False, "least_arc": 0.0, "most_scatter": np.inf}
    radii = [fit_circle(noisy(reach, seed), **options).radius for seed in range(40)]
    return float(np.sqrt(np.mean((np.array(radii) - _RADIUS) ** 2)))


def _fit_checks() -> tuple[Check, ...]:
    whole, arc = ({name: _off(reach, name) for name in ("geometric", "svd", "kasa")} for reach in (360.0, 90.0))
    return (
        Check(
            "All round, algebraic and geometric fits do not differ much",
            "",
            f"radius off by {whole['geometric']:.3f} (geometric), {whole['svd']:.3f} and {whole['kasa']:.3f}, rms",
            max(whole.values()) < 0.01 * _RADIUS,
        ),
        Check(
            "Over a part, geometric fitting is closer to the true circle",
            "",
            f"a quarter: off by {arc['geometric']:.2f} (geometric), {arc['svd']:.2f} and {arc['kasa']:.2f}, rms",
            arc["geometric"] < min(arc["svd"], arc["kasa"]),
            "At this noise the geometric fit of a quarter scatters more than the algebraic ones are biased.",
        ),
    )


def variations() -> Figure:
    """Return Figure 2.36."""
    turn = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    edge = to_complex(lateral_contour(turn, 10.0, 10.0, 6.0)[:, [2, 0]] * [1.0, 0.6])
    changed = {
        "moved": edge + (4.0 + 3.0j),
        "larger": 1.6 * edge,
        "turned": edge * np.exp(0.6j),
        "begun elsewhere": np.roll(edge, -50),
    }
    panels = []
    for (name, curve), colour in zip(changed.items(), (BLUE, ORANGE, GREEN, PURPLE), strict=True):
        panel = Panel((-11, 11), (-11, 11), width=190, height=190, title=name, equal=True)
        panel.line(edge.real, edge.imag, SOFT, closed=True, width=1.2).line(curve.real, curve.imag, colour, closed=True)
        panel.dots([edge.real[0]], [edge.imag[0]], SOFT, size=7).dots([curve.real[0]], [curve.imag[0]], colour, size=7)
        panels.append(panel)
    before = dft(edge)
    k = np.arange(len(edge))
    expected = {
        "moved: only f0 changes, by n times the way": before + np.where(k == 0, len(edge) * (4.0 + 3.0j), 0.0),
        "larger: all by one factor": 1.6 * before,
        "turned: all by one phase": before * np.exp(0.6j),
        "begun elsewhere: a phase that grows with k": before * np.exp(2j * np.pi * k * 50 / len(edge)),
    }
    checks = []
    for (name, wanted), curve in zip(expected.items(), changed.values(), strict=True):
        off = float(np.abs(dft(curve) - wanted).max() / np.abs(before).max())
        checks.append(Check(name, "", f"to within {below(max(off, 1e-13))} of the largest", off < 1e-12))
    return Figure(
        "2.36",
        "What may happen to a contour without its changing shape",
        sheet([panels], title="Figure 2.36", keys=[Key("before", SOFT), Key("first point", SOFT, dot=7)]),
        "The contour is a lateral's. What each change does to the transform is 2.9.2.",
        tuple(checks),
    )
