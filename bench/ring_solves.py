"""How attitude and section from two or three rings degrade with small increments and 1 mm of noise.

A 300 mm pipe, 5 % oval; the robot stands at 5 degrees of pitch and 3 of yaw, and each ring is 360 rays cast on the wall
with noise, then fitted by an ellipse. The same rings go into the published systems (5.4, Appendix C) and into
`solve_rings`, from the same guess. `main` prints the tables and writes them into docs/gallery/ring-solves.md.
"""

from __future__ import annotations

from pathlib import Path
from textwrap import fill
from typing import NamedTuple

import numpy as np

from springline.geometry.fitting import fit_ellipses_to_ranges
from springline.geometry.robot import oblique_ellipse, ring_covariance, ring_cylinder, solve_rings
from springline.reproduce import published
from springline.reproduce.dogleg import solve

PAGE = Path(__file__).parents[1] / "docs" / "gallery" / "ring-solves.md"

PITCH, YAW, R1, R2 = 5.0, 3.0, 0.1575, 0.1425
"""Attitude of the first ring [degrees] and semi-axes [m]."""

FIRST = np.array([PITCH, YAW, 0.0])

NOISE, READINGS, TRIALS, SEED = 1e-3, 360, 100, 11
INCREMENTS = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 25.0)
"""Increment of pitch from the first to the last ring [degrees]; yaw grows half as much, an unknown roll a quarter."""

GUESS_ANGLE, GUESS_RADIUS = 4.0, 0.08
"""How far the guess is off: degrees in each angle, a share of the radius in r1 and in r2, of opposite signs."""

GOOD_ANGLE, GOOD_RADIUS = 1.0, 0.01
"""A solve is good when pitch and yaw are within a degree and both radii within a per cent."""

TITLE = "# Attitude and section from two or three rings"

HEAD = """
Made by `python -m bench ring_solves`; change it there.

Section 5.4 of the dissertation finds pitch, yaw and both semi-axes from two rings, and roll too from three, when
the increments of the angles between the rings are known. Its examples have exact rings and increments of 25° and
12.5°. Here the rings are noisy and the increments run down towards those of neighbouring rings: a robot that turns
a degree in a metre turns 0.01° between rings 10 mm apart.

A 300 mm pipe of 5 % ovality, pitch {pitch:g}° and yaw {yaw:g}° at the first ring, {readings} readings a ring with
{noise:g} mm of noise, {trials} trials a row. The increment is that of pitch from the first ring to the last; yaw
grows half as much, an unknown roll a quarter. Every solve starts {angle:g}° and {radius:g} % from the truth. A
solve is *good* when pitch and yaw are within 1° and both radii within 1 %. *Best possible* is the one-sigma that
all three numbers of each ring allow, to first order. *Published* is the system of Appendix C, *three numbers* is
`solve_rings` made to answer always, and *answered* is how often it does so by itself; its other replies are "not
observable" and "ambiguous".
"""

TAIL = """
The method is ill-posed on neighbouring rings. With {noise:g} mm of noise and {readings} readings a ring the pitch
is known to about {slope:.1f}° over the increment in degrees, however the equations are written: increments of
0.01°, as between rings 10 mm apart, leave {neighbours:.0f}°, which is to know nothing, and a degree of certainty
takes increments of {slope:.1f}°. No choice of equations mends that; only rings that lie far apart in attitude do,
or other knowledge, such as the rings' centres together with odometry and an inertial unit.

At increments of {small:g}° the published system is good in {bad} of the solves and three numbers per ring in
{bad_full}: where the rings know nothing an answer is luck, and `solve_rings` gives none. At {large:g}°, the size of
the text's own example, both are good in {best}.

With roll unknown the published system lags behind at every increment, because it is singular at its solution
(erratum 1): at 5° it is good in {five} of the solves against {five_full}, and at {large:g}° its median error of
pitch is still {roll:.1f} times as large.
"""


class Outcome(NamedTuple):
    """What became of many solves at one increment: angles in degrees, the rest shares of one."""

    increment: float
    expected_angle: float
    expected_radius: float
    published_angle: float
    published_good: float
    full_angle: float
    full_good: float
    answered: float
    covered: float


def steps_of(increment: float, rings: int, *, roll: bool) -> np.ndarray:
    """Return the increments (rings, 3) of pitch, yaw and roll from the first ring [degrees]."""
    return increment * np.linspace(0.0, 1.0, rings)[:, None] * [1.0, 0.5, 0.25 if roll else 0.0]


def measured(steps: np.ndarray, trials: int, rng: np.random.Generator) -> np.ndarray:
    """Return (trials, rings, 3) ellipses fitted to noisy rings: major and minor [m], bearing of the major [rad]."""
    phi = np.arange(READINGS) * 2 * np.pi / READINGS
    pose = np.radians(steps + FIRST)
    exact = ring_cylinder(phi, R1, R2, *pose.T[:, :, None])
    noisy = exact + rng.normal(0.0, NOISE, (trials, *exact.shape))
    fits = fit_ellipses_to_ranges(noisy.reshape(-1, READINGS), phi)
    return np.stack([fits.semi_major, fits.semi_minor, fits.axis_bearing], axis=-1).reshape(trials, len(steps), 3)


def full(rings: np.ndarray, steps: np.ndarray, *, roll: bool, always: bool):
    """Return what all three numbers of each ring tell; `always` takes any answer for one."""
    guess = np.radians(FIRST + GUESS_ANGLE)[: 3 if roll else 2]
    limits = {"angle_limit": np.inf, "radius_limit": np.inf} if always else {}
    covariance = ring_covariance(NOISE, READINGS)
    return solve_rings(rings, np.radians(steps), guess=guess, unknown_roll=roll, covariance=covariance, **limits)


def expected(steps: np.ndarray, *, roll: bool) -> tuple[float, float]:
    """Return one sigma of the pitch [degrees] and of r2 over itself, to first order."""
    rings = np.stack(oblique_ellipse(R1, R2, *np.radians(steps + FIRST).T), axis=-1)
    sigma = np.sqrt(np.diagonal(full(rings, steps, roll=roll, always=True).covariance))
    return float(np.degrees(sigma[0])), float(sigma[4] / R2)


def published_errors(rings: np.ndarray, steps: np.ndarray, *, roll: bool) -> np.ndarray:
    """Return (trials, 4): errors of pitch and yaw [degrees] and relative ones of the radii, by the published system.

    Lengths are scaled to a mean radius of 10, as in the text, and beta is made unsigned; with roll its sign is kept and
    turned round, without which the listing's equations have no solution.
    """
    scale = 20.0 / (R1 + R2)
    angles = FIRST[: 3 if roll else 2]
    truth = np.array([*angles, R1 * scale, R2 * scale])
    guess = np.array([*(angles + GUESS_ANGLE), *(truth[-2:] * (1.0 + GUESS_RADIUS * np.array([1.0, -1.0])))])
    # the equations take roll off beta, where a roll turns the measured axis the other way
    known = steps * [1.0, 1.0, -1.0]
    errors = []
    for trial in rings:
        ellipses = [
            published.Ring(a * scale, b * scale, np.degrees(c) if roll else abs(np.degrees(c))) for a, b, c in trial
        ]
        with np.errstate(all="ignore"):
            x = solve(published.system(ellipses, known, unknown_roll=roll), guess, most=60).x
        errors.append([*(x[:2] - truth[:2]), *(x[-2:] / truth[-2:] - 1.0)])
    return np.array(errors)


def full_errors(found) -> np.ndarray:
    """Return (trials, 4) errors of a RingsSolution, as `published_errors`; NaN where it gives no answer."""
    angles = np.degrees([found.pitch, found.yaw]) - [[PITCH], [YAW]]
    return np.stack([*angles, found.r1 / R1 - 1.0, found.r2 / R2 - 1.0], axis=-1)


def good(errors: np.ndarray) -> np.ndarray:
    """Return (trials,) whether each solve is good; a missing one is not."""
    return (np.abs(errors) <= [GOOD_ANGLE, GOOD_ANGLE, GOOD_RADIUS, GOOD_RADIUS]).all(axis=-1)


def outcome(increment: float, rings: int, *, roll: bool, trials: int = TRIALS) -> Outcome:
    """Return what becomes of `trials` solves at one increment."""
    rng = np.random.default_rng([SEED, rings, round(1000 * increment)])
    steps = steps_of(increment, rings, roll=roll)
    ellipses = measured(steps, trials, rng)
    old = published_errors(ellipses, steps, roll=roll)
    new = full_errors(full(ellipses, steps, roll=roll, always=True))
    stated = full(ellipses, steps, roll=roll, always=False)
    sigma = np.degrees(np.sqrt(stated.covariance[..., 0, 0]))
    held = np.abs(np.degrees(stated.pitch) - PITCH) <= 1.96 * sigma
    return Outcome(
        increment,
        *expected(steps, roll=roll),
        float(np.median(np.abs(old[:, 0]))),
        float(good(old).mean()),
        float(np.nanmedian(np.abs(new[:, 0]))),
        float(good(new).mean()),
        float(stated.solved.mean()),
        float(held[stated.solved].mean()) if stated.solved.any() else np.nan,
    )


def table(outcomes: list[Outcome]) -> str:
    """Return a Markdown table of outcomes.

    >>> print(table([Outcome(5.0, 0.578, 0.00141, 0.34, 0.57, 0.36, 0.9, 1.0, 0.95)]).splitlines()[-1])
    | 5° | 0.58° | 0.14 % | 0.34° | 57 % | 0.36° | 90 % | 100 % | 95 % |
    """
    heads = (
        "increment",
        "best possible, pitch",
        "best possible, r2",
        "published: median error of pitch",
        "published: good",
        "three numbers: median error of pitch",
        "three numbers: good",
        "answered",
        "of those, 95 % interval holds the pitch",
    )
    lines = [f"| {' | '.join(heads)} |", f"|{'---:|' * len(heads)}"]
    for o in outcomes:
        cells = (
            f"{o.increment:g}°",
            f"{o.expected_angle:.2g}°",
            f"{100 * o.expected_radius:.2g} %",
            f"{o.published_angle:.2g}°",
            _share(o.published_good),
            f"{o.full_angle:.2g}°",
            _share(o.full_good),
            _share(o.answered),
            _share(o.covered),
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def page(two: list[Outcome], three: list[Outcome]) -> str:
    """Return the gallery's page: both tables, and in words what they say."""
    small, large, large_roll = (
        next(o for o in rows if o.increment == d) for rows, d in ((two, 0.5), (two, 25.0), (three, 25.0))
    )
    middle = next(o for o in three if o.increment == 5.0)
    numbers = {"noise": 1e3 * NOISE, "readings": READINGS}
    head = HEAD.format(**numbers, pitch=PITCH, yaw=YAW, trials=TRIALS, angle=GUESS_ANGLE, radius=100 * GUESS_RADIUS)
    slope = small.expected_angle * small.increment
    tail = TAIL.format(
        **numbers,
        slope=slope,
        neighbours=slope / 0.01,
        small=small.increment,
        bad=_share(small.published_good),
        bad_full=_share(small.full_good),
        large=large.increment,
        best=_share(min(large.published_good, large.full_good)),
        five=_share(middle.published_good),
        five_full=_share(middle.full_good),
        roll=large_roll.published_angle / large_roll.full_angle,
    )
    parts = (
        TITLE,
        *_paragraphs(head),
        "## Two rings, roll known: four unknowns",
        table(two),
        "## Three rings, roll unknown: five unknowns",
        table(three),
        "## What it says",
        *_paragraphs(tail),
    )
    return "\n\n".join(parts) + "\n"


def main() -> None:
    two = [outcome(increment, 2, roll=False) for increment in INCREMENTS]
    three = [outcome(increment, 3, roll=True) for increment in INCREMENTS]
    text = page(two, three)
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(text, encoding="utf-8")
    print(text)


def _paragraphs(text: str) -> list[str]:
    return [fill(part, width=118, break_on_hyphens=False) for part in text.strip().split("\n\n")]


def _share(value: float) -> str:
    return "" if np.isnan(value) else f"{100 * value:.0f} %"


if __name__ == "__main__":
    main()
