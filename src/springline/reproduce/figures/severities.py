"""Figures 3.4 to 3.12 and 3.14: which severities go together, the way a pipe takes through them, and the area lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from springline.geometry.sections import hinged, pathway, s1_limits, s2_of_s1
from springline.geometry.sections.ellipses import partner_axis
from springline.reproduce.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, SOFT, Key, Panel, ramp, sheet
from springline.reproduce.figure import Check, Figure

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

LOWER_PRINTED = ("0.463", "0.457", "0.440", "0.414", "0.378", "0.334", "0.283", "0.224", "0.158", "0.085")
"""Lower limits of s1 for s02 = 1, 0.9, ... 0.1, as listed under (3.14)."""

_FROZEN = np.round(np.arange(1.0, 0.05, -0.1), 1)
_LOSS = {"s02": 0.8, "s01": 0.6}
_MODES = {1: INK, 2: ORANGE, 3: BLUE, 4: GREEN, 5: PURPLE}


def lower_limits(*, rule: str) -> Array:
    """Return the lower limits of s1 for s02 = 1, 0.9, ... 0.1.

    >>> lower_limits(rule="exact")[:2].round(6).tolist()
    [0.463322, 0.457309]
    """
    return s1_limits(4, _FROZEN, rule=rule)[0]


def limit() -> Figure:
    """Return Figure 3.4."""
    s = np.linspace(-0.4, 1.0, 281)
    panel = Panel(
        (-0.4, 1.0), (2.8, 4.8), width=430, height=250, x_label="s1", y_label="-2 s1 + 3 + √(-5 s1² + 6 s1 + 3)"
    )
    panel.line(s, 3.0 * partner_axis(s, "ramanujan"), BLUE).line([-0.4, 1.0], [3 * np.sqrt(2)] * 2, SOFT, dash="5 3")
    roots = _limit_roots()
    panel.dots(roots, [3 * np.sqrt(2)] * 2, ORANGE, size=7)
    exact = float(s1_limits(3)[0])
    return Figure(
        "3.4",
        "Lower limit of the bottom's severity in mode 3",
        sheet([[panel]], title="Figure 3.4", keys=[Key("3 √2", SOFT, "5 3"), Key("roots", ORANGE, dot=7)]),
        "The limit has a closed form: s1 is the partner of the semi-axis √2 r (erratum A6).",
        (
            Check(
                "Roots", "-0.349049, 0.463431", f"{roots[0]:.6f}, {roots[1]:.6f}", _same(roots, (-0.349049, 0.463431))
            ),
            Check(
                "Lower limit of s1 in mode 3",
                "0.463431",
                f"{exact:.6f} with the exact perimeter",
                False,
                "Erratum A6: the limit of Ramanujan's first approximation, which is good to three digits here.",
            ),
        ),
    )


def _limit_roots() -> tuple[float, float]:
    def over(s: float) -> float:
        return float(partner_axis(s, "ramanujan")) - np.sqrt(2.0)

    return brentq(over, -0.379, 0.0), brentq(over, 0.2, 1.0)


def _same(found: tuple[float, ...], printed: tuple[float, ...], decimals: int = 6) -> bool:
    return bool(np.array_equal(np.round(found, decimals), printed))


def mode_three() -> Figure:
    """Return Figure 3.5."""
    low = float(s1_limits(3)[0])
    s1 = np.linspace(low, 1.0, 301)
    panel = Panel((0.4, 1.0), (0.0, 1.0), width=300, height=270, x_label="s1, bottom", y_label="s2, top")
    panel.line(s1, s2_of_s1(3, s1), BLUE).line([0.4, 1.0], [0.4, 1.0], SOFT, dash="2 3")
    near = np.linspace(0.9, 1.0, 201)
    top = s2_of_s1(3, near)
    slope = np.gradient(top, near)
    bow = np.max(np.abs(top - np.interp(near, near[[0, -1]], top[[0, -1]])))
    return Figure(
        "3.5",
        "Top and bottom severity of mode 3",
        sheet([[panel]], title="Figure 3.5", keys=[Key("mode 3", BLUE), Key("s2 = s1", SOFT, "2 3")]),
        "",
        (
            Check(
                "Nearly linear for s1 of 0.9 and above",
                "",
                f"slope {slope.min():.2f} to {slope.max():.2f}, off its chord by at most {bow:.4f}",
                bool(bow < 0.005),
            ),
        ),
    )


def mode_four() -> Figure:
    """Return Figure 3.7."""
    panel = Panel((0, 1), (0, 1), width=360, height=320, x_label="s1, bottom", y_label="s2, top", equal=True)
    panel.line([0, 1], [0, 1], SOFT, dash="2 3")
    colours = ramp(_FROZEN.size)[::-1]
    for frozen, low, colour in zip(_FROZEN, lower_limits(rule="exact"), colours, strict=True):
        s1 = np.linspace(low, frozen, 101)
        panel.line(s1, s2_of_s1(4, s1, frozen), colour)
    published, exact = (lower_limits(rule=rule) for rule in ("ramanujan", "exact"))
    agree = [f"{p:.3f}" == printed for p, printed in zip(published, LOWER_PRINTED, strict=True)]
    return Figure(
        "3.7",
        "Top and bottom severity of mode 4",
        sheet(
            [[panel]], title="Figure 3.7", keys=[Key(f"s02 = {f:g}", c) for f, c in zip(_FROZEN, colours, strict=True)]
        ),
        "Each line begins on the diagonal, where the top's hinges appear, and ends where its crown reaches O.",
        (
            Check(
                "Lower limits of s1 for s02 = 1, 0.9, ... 0.1",
                ", ".join(LOWER_PRINTED),
                f"{sum(agree)} of 10 by Ramanujan's first formula",
                all(agree),
            ),
            Check(
                "They are the limits of constant perimeter",
                "",
                "with the exact perimeter " + ", ".join(f"{v:.4f}" for v in exact),
                False,
                f"Erratum A6: off by up to {np.max(np.abs(exact - published)):.4f}, where the ellipse is flattest.",
            ),
        ),
    )


def mode_five_mild() -> Figure:
    """Return Figure 3.9 together with the pathway 3.11."""
    return _mode_five("3.11", 0.8)


def mode_five_severe() -> Figure:
    """Return Figure 3.10 together with the pathway 3.12."""
    return _mode_five("3.12", 0.5)


def _mode_five(number: str, s01: float) -> Figure:
    panel = Panel((0, 1), (0, 1), width=380, height=340, x_label="s1, bottom", y_label="s2, top", equal=True)
    panel.line([s01, 1.0], [s01, 1.0], ORANGE, dash="6 3", width=2.0)
    for s02 in np.round(np.arange(s01, 1.01, 0.1), 1):
        low = float(s1_limits(5, s02, s01)[0])
        s1 = np.unique(np.concatenate([np.linspace(max(low, 1e-9), s01, 121), np.linspace(s01, s02, 61)]))
        mode, s2 = pathway(s1, s02=s02, s01=s01)
        for wanted, colour in ((4, GREEN), (3, GREEN), (5, BLUE), (2, BLUE)):
            # a path's pieces meet, so that each takes the point before it along
            here = mode == wanted
            here[1:] |= here[:-1]
            panel.line(np.where(here, s1, np.nan), s2, colour)
    return Figure(
        number,
        f"Pathways of deformation when the bottom's hinges appear at s01 = {s01:g}",
        sheet(
            [[panel]],
            title=f"Figure {number}",
            keys=[
                Key("ellipse", ORANGE, "6 3"),
                Key("hinged above", GREEN),
                Key("hinged above and below", BLUE),
            ],
        ),
        f"One line for each s02 from {s01:g} to 1: it leaves the ellipse where the top's hinges appear. Its lower part "
        f"alone is Figure {'3.9' if s01 == 0.8 else '3.10'}.",
    )


def area_loss() -> Figure:
    """Return Figure 3.14."""
    panel = Panel((0.5, 1.0), (0, 40), width=430, height=280, x_label="s1", y_label="area loss [%]")
    for mode, colour in _MODES.items():
        low, high = (float(v) for v in s1_limits(mode, **_LOSS))
        s1 = np.linspace(max(low, 0.5), high, 101)
        panel.line(s1, 100 * lost(mode, s1), colour, dash="6 3" if mode > 3 else "")
    at_limit = [100 * float(lost(mode, 0.9)) for mode in (1, 2, 3)]
    reached = [brentq(lambda s, m=mode: float(lost(m, s)) - 0.03, 0.6, 0.99) for mode in (1, 2, 3)]
    flat = [100 * float(lost(mode, 0.5)) for mode in _MODES]
    return Figure(
        "3.14",
        "Area lost by mode",
        sheet(
            [[panel]],
            title="Figure 3.14",
            keys=[Key(f"mode {m}", c, "6 3" if m > 3 else "") for m, c in _MODES.items()],
        ),
        "s02 = 0.8 and s01 = 0.6, so that modes 4 and 5 exist from 0.8 and 0.6 down only. The listing has 0.9 and 0.7 "
        "and uses variables before they are set (errata B). At s1 = 0.5 the loss is "
        + ", ".join(f"{v:.1f}" for v in flat)
        + " % in modes 1 to 5.",
        (
            Check(
                "Less than 3 % in all modes for s1 of 0.9 and above",
                "3 %",
                "at 0.9 {:.2f}, {:.2f}, {:.2f} % in modes 1 to 3".format(*at_limit)
                + "; 3 % is reached at s1 = {:.4f}, {:.4f}, {:.4f}".format(*reached),
                max(at_limit) < 3.0,
            ),
        ),
    )


def lost(mode: int, s1: Array | float) -> Array:
    """Return the area lost against the circle, as a fraction, at the figure's s02 and s01.

    >>> round(100 * float(lost(2, 0.9)), 2)
    1.16
    """
    return hinged(mode, s1, **_LOSS).area_loss(1.0)
