"""How surely side-slip is told from the section: what would be read from it, had the robot weaved elsewhere.

A slip of s makes rings of a robot that weaves by w wider by radius x w x s/2, in mean radius and in ovality. A section
that itself swells and shrinks as slowly as the robot weaves looks alike, and more so than its random walk from knot to
knot has it. So the weave is laid along the pipe at other places, where no slip can answer to it: what slip is read
there is read by chance.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .factors.section import by_perimeter
from .states import OFFSET, SECTION

if TYPE_CHECKING:
    from .problem import Problem
    from .states import State

_PLACES = 16
"""At how many places round the survey the weave is laid."""
_TREND = 2
"""Degree of the polynomial along the survey that slip is never taken for."""
_HARDLY = 0.5
"""Share of what the equations say of slip from which on it is left as it is, and only its sigma widened."""
_SIGNS = np.array([[1.0, -1.0], [1.0, 1.0]])
"""How mean radius and oval_cos change with a slip up and one to the right."""


def slip_variance(problem: Problem, state: State, scales: dict[str, np.ndarray], stated: np.ndarray) -> np.ndarray:
    """Return the variance (2,) of the slip up and to the right once the section's own slow change is counted [rad2].

    Args:
        problem: The survey's factors; with a rear scanner, which tells slip by pairs of rings, nothing is added.
        state: The estimate.
        scales: Factor name to its groups' noise over the stated one.
        stated: The variance (2,) that the equations state.
    """
    if problem.track is None or problem.rear is not None or len(state.knots) <= _PLACES:
        return stated
    read, power = _by_chance(state, problem.step, scales.get("section", np.ones(3)))
    # Along the wider weave the section tells all, across it as much less as the weave is smaller; gravity, the track
    # and ties tell the rest.
    most = int(np.argmax(power))
    told = max(1.0 / stated[most] - 1.0 / problem.options.slip**2, 0.0) * power / max(power[most], 1e-12)
    told = np.minimum(told, 1.0 / stated)
    by_section = np.minimum(told, 1.0 / np.maximum(read, 1e-18))
    return 1.0 / (1.0 / stated - told + by_section)


def slip_prior(slip: float, stated: np.ndarray, counted: np.ndarray) -> np.ndarray | None:
    """Return the one-sigma (2,) of a prior of slip that weighs against the equations as it should against the section.

    Equations that are too sure of slip draw it away from its prior; a prior that is tighter by as much holds it. None
    where that is not much.

    Args:
        slip: One-sigma of the prior [rad].
        stated: The variance (2,) that the equations state with it [rad2].
        counted: What it is in truth (2,) [rad2], as of `slip_variance`.
    """
    told, worth = (np.maximum(1.0 / variance - 1.0 / slip**2, 1e-9 / slip**2) for variance in (stated, counted))
    share = np.minimum(worth / told, 1.0)
    return None if (share > _HARDLY).all() else slip * np.sqrt(share)


def _by_chance(state: State, step: float, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mean squares of the slips read where the weave is laid elsewhere (2,), and its power up and right (2,).

    Perimeter and ovality count by how little they walk, as they do in the estimate.
    """
    weave = np.diff(state.knots[:, OFFSET], axis=0) / step
    section = by_perimeter(state.knots)[0][:-1, :2]
    along = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, len(weave)), _TREND)
    weave, section = (v - along @ np.linalg.lstsq(along, v, rcond=None)[0] for v in (weave, section))
    weight = scale[:2] ** -2.0
    seen = section @ (_SIGNS * weight / weight.sum()).T
    shifts = np.round(np.arange(1, _PLACES) * len(weave) / _PLACES).astype(int)
    laid = np.stack([np.roll(weave, shift, axis=0) for shift in shifts])
    power = np.maximum(np.sum(weave**2, axis=0), 1e-12)
    radius = float(np.median(state.knots[:, SECTION.start]))
    read = 2.0 / radius * np.einsum("snk,nk->sk", laid, seen) / power
    # What is in step with the weave was taken for slip already; the rest is half of what chance brings.
    return 2.0 * np.mean(read**2, axis=0), power
