"""Figures 5.6 to 5.8: how the published systems of four and five unknowns are solved. Angles in degrees."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.robot import oblique_ellipse, solve_rings
from springline.reproduce import published
from springline.reproduce.dogleg import Solution, solve
from springline.reproduce.drawing import BLUE, ORANGE, Key, Panel, sheet
from springline.reproduce.figure import Check, Figure, below
from springline.reproduce.figures.oblique import R1, R2

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]
    Steps = tuple[tuple[float, float, float], ...]

TRUTH, STEPS = (15.0, 7.5), ((0.0, 0.0, 0.0), (25.0, 12.5, 0.0))
"""Pitch and yaw of the first ring, and increments of (pitch, yaw, roll), in the text's order."""

FIVE_TRUTH = (7.5, 15.0, 7.5, R1, R2)
FIVE_STEPS = ((0.0, 0.0, 0.0), (5.0, 10.0, 5.0), (7.5, 15.0, 7.5))
"""Appendix C's three rings: there the yaw is 15 degrees and the pitch 7.5 (erratum 9)."""

WILD, CLOSE, FIVE_GUESS = (25.0, 20.0, 12.0, 9.0), (20.0, 10.0, 12.0, 9.0), (10.0, 20.0, 10.0, 12.0, 9.0)
"""The published guesses of (pitch, yaw[, roll], r1, r2)."""


def rings_of(pitch: float, yaw: float, steps: Steps) -> list[published.Ring]:
    """Return the exact rings of a robot whose angles grow by `steps`, with unsigned beta."""
    return [published.ring(pitch + step[0], yaw + step[1], R1, R2) for step in steps]


def four_unknowns(
    guess: ArrayLike, *, truth: tuple[float, float] = TRUTH, steps: Steps = STEPS, tolerance: float = 1e-6
) -> Solution:
    """Return how the published system of four unknowns is solved from a guess of (pitch, yaw, r1, r2)."""
    return solve(published.system(rings_of(*truth, steps), steps), guess, tolerance=tolerance)


def false_roots(*, starts: int = 60, seed: int = 2) -> tuple[float, float]:
    """Return from which shares of random guesses the published system leads to the truth, and to a false exact root."""
    rng = np.random.default_rng(seed)
    guesses = np.concatenate([rng.uniform(2.0, 45.0, (starts, 2)), np.tile([12.0, 9.0], (starts, 1))], axis=1)
    with np.errstate(all="ignore"):
        found = [four_unknowns(guess) for guess in guesses]
    exact = np.array([one.converged and one.residual < 1e-4 for one in found])
    right = np.array([np.allclose(one.x, (*TRUTH, R1, R2), atol=0.01) for one in found])
    return float(np.mean(exact & right)), float(np.mean(exact & ~right))


def full_solution(guess: tuple[float, ...], *, truth: tuple[float, float] = TRUTH, steps: Steps = STEPS) -> Array:
    """Return (pitch, yaw, r1, r2) from all three numbers of each ring, with signed beta."""
    pose = np.radians(np.add([*truth, 0.0], steps))
    rings = np.stack(oblique_ellipse(R1, R2, *pose.T), axis=-1)
    found = solve_rings(rings, np.radians(steps), guess=np.radians(guess[:2]))
    return np.array([*np.degrees([found.pitch, found.yaw]), found.r1, found.r2], float)


def five_unknowns(*, consistent: bool) -> Solution:
    """Return how the published system of five unknowns is solved.

    Args:
        consistent: Add to each beta the roll that the equations take off; the listing's data leave it out.
    """
    return solve(_five(consistent), FIVE_GUESS)


def claimed_residual() -> float:
    """Return the largest of Appendix C's equations at its claimed root, over the squared radius of the ring.

    >>> round(claimed_residual(), 2)
    0.04
    """
    squares = [radius**2 for ring in rings_of(*FIVE_TRUTH[:2], FIVE_STEPS) for radius in ring[:2]]
    return float(np.max(np.abs(_five(consistent=False)(np.array(FIVE_TRUTH))) / squares[:-1]))


def singular_ratio() -> float:
    """Return the smallest over the largest singular value of the five-unknown system at its solution."""
    x, equations = np.array(FIVE_TRUTH), _five(consistent=True)
    step = 1e-5 * np.eye(5)
    slope = np.stack([(equations(x + d) - equations(x - d)) / 2e-5 for d in step], axis=-1)
    singular = np.linalg.svd(slope, compute_uv=False)
    return float(singular[-1] / singular[0])


def _five(consistent: bool) -> Callable[[Array], Array]:
    rings = rings_of(*FIVE_TRUTH[:2], FIVE_STEPS)
    if consistent:
        rings = [r._replace(beta=r.beta + FIVE_TRUTH[2] + step[2]) for r, step in zip(rings, FIVE_STEPS, strict=True)]
    return published.system(rings, FIVE_STEPS, unknown_roll=True)


def wild_guess() -> Figure:
    """Return Figure 5.6."""
    false = four_unknowns((5.6, 51.0, 6.9, 10.4), tolerance=1e-9)
    opposite = ((0.0, 0.0, 0.0), (25.0, -12.5, 0.0))
    wrong = four_unknowns((20.0, -10.0, 12.0, 9.0), truth=(15.0, -7.5), steps=opposite)
    right = full_solution((20.0, -10.0), truth=(15.0, -7.5), steps=opposite)
    to_truth, to_false = false_roots()
    more = (
        Check(
            "What solves the equations is the pose",
            "",
            f"({_numbers(false.x)}) solves the same rings, residual below {below(false.residual)}; of random guesses "
            f"{100 * to_truth:.0f} % lead to the truth, {100 * to_false:.0f} % to another exact solution",
            False,
            "Erratum 1: only two of a ring's three numbers are used. With the third there is one root, found from both "
            f"guesses: ({_numbers(full_solution(WILD))}).",
        ),
        Check(
            "It works whatever the signs of pitch and yaw",
            "",
            f"for (15, -7.5, 11, 10) and steps of 25° and -12.5° it returns ({_numbers(wrong.x)}), residual below "
            f"{below(wrong.residual)}",
            False,
            f"Erratum 2: β is made unsigned. With its sign the same rings give ({_numbers(right)}).",
        ),
    )
    why = "The count depends on the solver and its settings, which are not stated."
    return _convergence("5.6", "Convergence from the wild guess (25°, 20°, 12, 9)", WILD, 25, why, more)


def close_guess() -> Figure:
    """Return Figure 5.7."""
    return _convergence("5.7", "Convergence from the close guess (20°, 10°, 12, 9)", CLOSE, 6, "", ())


def _convergence(
    number: str, title: str, guess: tuple[float, ...], printed: int, why: str, more: tuple[Check, ...]
) -> Figure:
    found = four_unknowns(guess)
    count = len(found.steps)
    arrived = bool(np.allclose(found.x, (*TRUTH, R1, R2), atol=1e-4))
    checks = (
        Check("The solver arrives at (15, 7.5, 11, 10)", "", f"({_numbers(found.x)})", arrived),
        Check("Iterations", str(printed), str(count), count == printed, "" if count == printed else why),
    )
    return Figure(
        number,
        title,
        _progress(number, {"as published": (found, BLUE)}),
        "Powell's dogleg on the published system in Appendix C's form, with angles in degrees and a first trust region "
        "of 1, until the gradient is below 1e-6.",
        (*checks, *more),
    )


def five_guess() -> Figure:
    """Return Figure 5.8."""
    listed, consistent = five_unknowns(consistent=False), five_unknowns(consistent=True)
    count, rate = len(consistent.steps), consistent.steps[-2] / consistent.steps[-4]
    checks = (
        Check(
            "The listing's system has the solution (15, 7.5, 7.5, 11, 10)",
            "0",
            f"its equations are off by up to {claimed_residual():.2f} of r² there; the solver ends after "
            f"{len(listed.steps)} iterations at a residual of {listed.residual:.2f}",
            False,
            "Erratum 8: the listing makes its rings without roll and takes roll off their β.",
        ),
        Check(
            "Iterations",
            "13",
            f"{count} with rings that have the roll in their β",
            count == 13,
            "The listing as printed does not converge, so that the published data cannot be the listing's.",
        ),
        Check(
            "Three rings determine five unknowns",
            "",
            f"singular at the solution, where the smallest singular value is below {below(singular_ratio())} of the "
            f"largest; steps shrink only {1 / np.sqrt(rate):.1f} times an iteration",
            False,
            "Erratum 1: along its axes the ring form is stationary, so that roll has no first-order effect on the two "
            "equations a ring is given. With all three, two rings give five unknowns.",
        ),
    )
    return Figure(
        "5.8",
        "Convergence with roll unknown, from (10°, 20°, 10°, 12, 9)",
        _progress("5.8", {"roll in the rings": (consistent, BLUE), "listing as printed": (listed, ORANGE)}),
        "Order of Appendix C: yaw 15°, pitch 7.5°. Straight lines on these axes are linear convergence: the mark of a "
        "singular system.",
        checks,
    )


def _progress(number: str, runs: dict[str, tuple[Solution, str]]) -> str:
    most = max(len(run.steps) for run, _ in runs.values())
    end = min(most, 30) + 0.5
    steps = Panel((0, end), (-8.5, 2.5), width=370, height=230, x_label="iteration", y_label="log10 of the step's norm")
    slope = Panel((0, end), (-12, 5), width=370, height=230, x_label="iteration", y_label="log10 of the optimality")
    for run, colour in runs.values():
        for panel, values, first in ((steps, run.steps, 1), (slope, run.optimality, 0)):
            at = np.arange(first, first + len(values))
            shown = at <= end
            size = np.log10(np.maximum(values, 1e-300))
            panel.line(at[shown], size[shown], colour).dots(at[shown], size[shown], colour, size=6)
    keys = [Key(name, colour, dot=6) for name, (_, colour) in runs.items()]
    return sheet([[steps, slope]], title=f"Figure {number}", keys=keys if len(keys) > 1 else ())


def _numbers(values: ArrayLike) -> str:
    return ", ".join(f"{round(float(v), 2) + 0.0:g}" for v in np.asarray(values))
