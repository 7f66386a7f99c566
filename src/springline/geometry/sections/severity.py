"""Severities of the hinged sections: which go together, how far each may go, and the way a pipe takes through them.

A half section is two mirror-image quarter arcs. A quarter arc is a quarter of the constant-perimeter ellipse of
severity s0, frozen rigid, then swung so that its crown end comes to the height s r, s <= s0. The bottom half is
(s01, s1), the top half (s02, s2), and s2 follows because both halves share the springline:

    mode 1  s02 = s01 = s1     an ellipse                    mode 4  s01 = s1    elliptical hinges over an ellipse
    mode 2  s02 = s01 = 1      circular hinges               mode 5              elliptical hinges above and below
    mode 3  s02 = 1, s01 = s1  circular hinges over an ellipse

so that every mode is mode 5 with some severities equal. In modes 3 to 5 the top is the half whose arcs froze at the
milder ovality, s02 >= s01; a pipe hinged below is the same section turned over.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import TOLERANCE, between, choice

from ...errors import ParameterError
from .ellipses import RULES, Rule, partner_axis

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

MODES = (1, 2, 3, 4, 5)

_HIGHEST_LOWER = 0.4635  # just above the lower limit of mode 3, which no s02 exceeds


def chord(s0: ArrayLike, *, rule: Rule = "exact") -> Array:
    """Return the chord of a quarter arc of severity s0, in units of r: it stays when the arc swings.

    Source: (3.13).

    >>> round(float(chord(1.0)), 12)
    1.414213562373
    """
    s0 = between("s0", s0, 0.0, 1.0, bounds="(]")
    return np.hypot(partner_axis(s0, rule), s0)


def canonical(
    mode: ArrayLike, s1: ArrayLike, s02: ArrayLike = 1.0, s01: ArrayLike = 1.0, *, rule: Rule = "exact"
) -> tuple[Array, Array, Array]:
    """Return the severities (s1, s02, s01) of mode 5 that make the same section; they broadcast.

    Args:
        mode: 1 to 5; an array mixes modes.
        s1: Severity of the bottom half.
        s02: Frozen severity of the top arcs; read in modes 4 and 5 only.
        s01: Frozen severity of the bottom arcs; read in mode 5 only.
        rule: How the perimeter is reckoned.

    Raises:
        ParameterError: A severity lies outside its range for the given others; the message states the range.

    >>> [float(s) for s in canonical(3, 0.9)]
    [0.9, 1.0, 0.9]
    """
    low, high = s1_limits(mode, s02, s01, rule=rule)
    mode, s1, s02, s01, low, high = np.broadcast_arrays(mode, np.asarray(s1, float), s02, s01, low, high)
    given = _given(mode, s02, s01)
    between("s1", np.where(low > 0.0, np.nan, s1), 0.0, high, bounds="(]", given=given)
    between("s1", s1, low * (1.0 - TOLERANCE), high * (1.0 + TOLERANCE), given=given)
    s1 = np.clip(s1, low, high)
    top = np.where(mode == 1, s1, np.where(mode <= 3, 1.0, s02))
    bottom = np.where(mode == 2, 1.0, np.where(mode == 5, s01, s1))
    return s1, top, bottom


def s1_limits(
    mode: ArrayLike, s02: ArrayLike = 1.0, s01: ArrayLike = 1.0, *, rule: Rule = "exact"
) -> tuple[Array, Array]:
    """Return the lower and the upper limit of s1; at the lower one s2 = 0: the crown has come down to O.

    A lower limit of 0 does not belong to the range; any other limit does.

    Args:
        mode, s02, s01, rule: As for `canonical`.

    Raises:
        ParameterError: s02 outside (0, 1], or s01 above s02 or below the lower limit of mode 4 for that s02: from there
            on no s1 keeps both halves on one springline.

    Source: chapter 3.3.1 to 3.3.3 (3.9, 3.14, 3.15), in closed form after errata A6: the semi-major axis at the limit
    is the top's chord, so s1 is the partner of that axis.

    >>> [round(float(s), 6) for s in s1_limits(3, rule="ramanujan")], round(float(s1_limits(3)[0]), 6)
    ([0.463431, 1.0], 0.463322)
    """
    choice("rule", rule, RULES)
    mode = np.asarray(mode)
    if not np.isin(mode, MODES).all():
        raise ParameterError(f"mode = {mode} is unknown", expected="a mode from 1 to 5")
    mode, s02, s01 = np.broadcast_arrays(mode, np.asarray(s02, float), np.asarray(s01, float))
    s02 = between("s02", np.where(mode >= 4, s02, 1.0), 0.0, 1.0, bounds="(]", given={"mode": mode})
    most = np.where(mode == 5, s02, 1.0)
    s01 = between("s01", np.where(mode == 5, s01, 1.0), 0.0, most, bounds="(]", given=_given(mode, s02))
    low = np.zeros(mode.shape)
    for wanted in (3, 4, 5):
        here = mode == wanted
        if here.any():
            low[here] = _lower(wanted, s02[here], s01[here], rule)
    high = np.where(mode <= 3, 1.0, np.where(mode == 4, s02, s01))
    return low, high


def s2_of_s1(
    mode: ArrayLike, s1: ArrayLike, s02: ArrayLike = 1.0, s01: ArrayLike = 1.0, *, rule: Rule = "exact"
) -> Array:
    """Return the severity s2 of the top half that shares its springline with the bottom half.

    Args:
        mode, s1, s02, s01, rule: As for `canonical`.

    Raises:
        ParameterError: As for `canonical`.

    Source: (3.9), (3.14), (3.15).

    >>> round(float(s2_of_s1(4, 0.9, 0.95, rule="ramanujan")), 12)
    0.896062197557
    """
    return hinge_table(*canonical(mode, s1, s02, s01, rule=rule), rule=rule)[..., 11]


def hinge_table(s1: Array, s02: Array, s01: Array, *, rule: Rule) -> Array:
    """Return (..., 12): a, b, s, sin alpha, cos alpha of top and bottom, OA and s2, in units of r; unchecked."""
    from . import kernels

    s1, s02, s01 = (np.asarray(s, float) for s in np.broadcast_arrays(s1, s02, s01))
    out = np.empty((*s1.shape, 12))
    kernels.hinge_table(s1.ravel(), s02.ravel(), s01.ravel(), rule == "exact", out.reshape(-1, 12))
    return out


def pathway(
    s1: ArrayLike, *, s02: ArrayLike = 1.0, s01: ArrayLike = 1.0, rule: Rule = "exact"
) -> tuple[NDArray[np.int64], Array]:
    """Return the mode a pipe is in and its s2 as s1 falls: an ellipse, below s02 hinged above, below s01 all round.

    Args:
        s1: Severity of the bottom half, from 1 down to the lower limit of the last mode.
        s02: Severity at which the top hinges appear.
        s01: Severity at which the bottom hinges appear, at most s02.
        rule: How the perimeter is reckoned.

    Returns:
        mode and s2, each of the broadcast shape.

    Source: chapter 3.3.4, Figures 3.11 and 3.12.

    >>> mode, s2 = pathway([1.0, 0.92, 0.85, 0.7], s02=0.9, s01=0.8)
    >>> mode.tolist(), s2.round(4).tolist()
    ([1, 1, 4, 5], [1.0, 0.92, 0.8433, 0.6807])
    """
    s1, s02, s01 = np.broadcast_arrays(np.asarray(s1, float), s02, s01)
    top_is_circle = s02 == 1.0
    hinged = np.where(s1 >= s01, np.where(top_is_circle, 3, 4), np.where(top_is_circle & (s01 == 1.0), 2, 5))
    mode = np.where(s1 >= s02, 1, hinged)
    return mode, s2_of_s1(mode, s1, s02, s01, rule=rule)


def _lower(mode: int, s02: Array, s01: Array, rule: Rule) -> Array:
    """Return the lower limit of s1 of one of modes 3 to 5, and refuse bottom arcs that the top's chord cannot span."""
    square = partner_axis(s02, rule) ** 2 + s02**2
    if mode != 5:
        return partner_axis(np.sqrt(square), rule)
    doubtful = s01 < _HIGHEST_LOWER
    if doubtful.any():
        least = np.zeros(s01.shape)
        least[doubtful] = partner_axis(np.sqrt(square[doubtful]), rule)
        between("s01", s01, least * (1.0 - TOLERANCE), s02, given={"mode": 5, "s02": s02})
    return np.sqrt(np.maximum(partner_axis(s01, rule) ** 2 + s01**2 - square, 0.0))


def _given(mode: Array, s02: Array, s01: Array | None = None) -> dict[str, Array]:
    """Return the parameters to name in a message: those that the modes at hand read."""
    given = {"mode": mode}
    if np.any(mode >= 4):
        given["s02"] = s02
    if s01 is not None and np.any(mode == 5):
        given["s01"] = s01
    return given
