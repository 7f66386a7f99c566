"""What a second ring scanner adds: the joint estimate of short simulated surveys with it and without.

Every run is another pipe, with biases, scale, side-slip and the mount of the rear scanner drawn anew from what the
estimator is told of them. Quantities of a station are pooled over the stations of all runs. Without an inertial log the
pipe is straight, as it is taken to be, and tilt is told in the robot's own upright. The table goes into
`docs/estimator.md`, between its marks. `SPRINGLINE_RUNS` says how many runs (default 20), `SPRINGLINE_FIRST` which seed
comes first.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from springline.estimation import (
    Inertial,
    JointEstimate,
    JointOptions,
    Rear,
    Rings,
    Ties,
    estimate_joint,
    pooled_harmonics,
)
from springline.geometry.fitting import fit_ellipses_to_ranges
from springline.simulate import parse, simulate

PAGE = Path(__file__).parents[1] / "docs" / "estimator.md"
MARKS = ("<!-- rear -->\n", "<!-- end of rear -->\n")
FRONT, REAR = 0.1, -0.3
"""Where the two scanners stand along the robot [m]."""
MOUNT = 2e-4
"""One-sigma of the direction between them [rad]: 0.08 mm over 0.4 m, as a calibration leaves it."""

SCENARIO = """
name = "two scanners"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.008
start = [1000.0, 2000.0, 50.0]
seed = {seed}
run = [{run}]
joints = {{ spacing = 2.5, spacing_sigma = "8mm", gap = "4mm", kink_sigma_deg = {kink} }}
[[pipe.section]]
shape = "mode"
mode = 1
s1 = {{ mean = 0.975, amplitude = 0.005, period = {period} }}
[robot]
length = 0.9
wheelbase = 0.3
offset_z = {{ amplitude = 0.025, period = 3.0 }}
offset_y = {{ amplitude = 0.004, period = 4.3 }}
roll_deg = {{ amplitude = {roll}, period = 3.7 }}
side_slip_deg = {slip}
standstill = [{{ chainage = 0.45, duration = 60.0 }}]
[rings]
spacing = "10mm"
noise = "1mm"
outliers = 0.02
position = [{front}, 0.0, 0.0]
[rings_rear]
spacing = "10mm"
noise = "1mm"
outliers = 0.02
position = [{rear}, {up}, {right}]
scale_error = {rear_scale}
[inertial]
rate = 50.0
gyro_bias_deg_h = [{gyro}]
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [{accel}]
accel_noise = 0.0005
[odometer]
scale_error = {scale}
[ties]
chainages = [0.45, 9.0]
sigma = "10mm"
"""
BENT = (
    '{ kind = "straight", length = 4.0 }, { kind = "bend", radius = 1.5, angle_deg = 22.5, towards = "right" }, '
    '{ kind = "straight", length = 5.4 }'
)
STRAIGHT = '{ kind = "straight", length = 10.0 }'
POSE = ("offset_y", "offset_z", "pitch", "yaw", "roll")
SHOWN = {
    **{name: (name, 1e3, "mm") for name in ("r1", "r2", "offset_y", "offset_z")},
    **{name: (name, np.degrees(1.0), "degrees") for name in ("pitch", "yaw", "roll", "slip up", "slip right")},
    **{name: (name, 1e3, "mm") for name in ("easting", "northing", "elevation")},
    "offset": ("offset, no log", 1e3, "mm"),
    "tilt": ("tilt, no log", np.degrees(1.0), "degrees"),
}
"""Name, factor and unit of what the table shows."""

Errors = dict[str, tuple[np.ndarray, np.ndarray]]
"""Errors and their sigma by quantity."""


def made(seed: int, *, straight: bool = False):
    """Return a simulated survey and the truth of its scalars."""
    rng, options = np.random.default_rng(seed), JointOptions()
    slip, scale = 0.3 * rng.standard_normal(), options.scale * rng.standard_normal()
    gyro, accel = 10.0 * rng.standard_normal(3), options.accel_bias * rng.standard_normal(3)
    up, right = (FRONT - REAR) * MOUNT * rng.standard_normal(2)
    text = SCENARIO.format(
        seed=seed,
        run=STRAIGHT if straight else BENT,
        kink=0.0 if straight else 0.1,
        roll=0.0 if straight else 3.0,
        slip=slip,
        scale=scale,
        period=rng.uniform(2.5, 9.0),
        gyro=", ".join(map(str, gyro)),
        accel=", ".join(map(str, accel)),
        front=FRONT,
        rear=REAR,
        up=up,
        right=right,
        rear_scale=0.0025 * rng.standard_normal(),
    )
    return simulate(parse(text), seed=seed), {"slip right": -np.tan(np.radians(slip)), "slip up": 0.0}


def given(survey) -> tuple[Rings, Inertial, Ties, Rear, dict]:
    """Return what the estimator is given, the rear scanner's place as it is thought to be."""
    both, shapes = {}, {}
    for name, place in (("rings", FRONT), ("rings_rear", REAR)):
        data = survey.group(name)
        ranges, bearings = data["range"].values, data["bearing"].values
        fits = fit_ellipses_to_ranges(ranges, bearings)
        shapes[name] = pooled_harmonics(ranges, bearings, fits.parameters)
        both[name] = Rings(
            data["distance"].values, fits.parameters, fits.covariance, data["time"].values, (place, 0.0, 0.0)
        )
    log = Inertial(*(survey.inertial[name].values for name in ("time", "gyro", "accel")))
    points = np.stack([survey.ties[name].values for name in ("easting", "northing", "elevation")], axis=1)
    ties = Ties(survey.ties["distance"].values, points, survey.ties["sigma"].values)
    rear = Rear(replace(both["rings_rear"], parameters=shapes["rings_rear"].parameters), MOUNT)
    return both["rings"], log, ties, rear, {"harmonics": shapes["rings"]}


def off(found: JointEstimate, truth, scalars: dict[str, float]) -> Errors:
    """Return the errors of an estimate with a log."""

    def here(name: str) -> np.ndarray:
        return np.interp(truth["ring_chainage"].values, truth["chainage"].values, truth[name].values)

    turn = np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]])
    spread = np.sqrt(np.einsum("ai,nij,aj->na", turn, found.section_covariance, turn))
    radii = found.section @ turn.T - 0.5 * np.stack([here("diameter_x"), here("diameter_y")], axis=1)
    out = {name: (radii[:, k], spread[:, k]) for k, name in enumerate(("r1", "r2"))}
    for k, name in enumerate(POSE):
        out[name] = (found.pose[:, k] - truth[name].values, found.pose_sigma[:, k])
    for k, name in enumerate(("easting", "northing", "elevation")):
        out[name] = (found.axis[:, k] - here(name), found.axis_sigma[:, k])
    for name, value in scalars.items():
        estimate, sigma = found.scalars[name.replace(" ", "_")]
        out[name] = (np.array([estimate - value]), np.array([sigma]))
    return out


def off_blind(found: JointEstimate, truth) -> Errors:
    """Return the errors of an estimate without a log: offset and tilt, up and right together."""
    error = found.pose[:, :4] - np.stack([truth[name].values for name in POSE[:4]], axis=1)
    sigma = found.pose_sigma[:, :4]
    return {
        "offset": (error[:, :2].ravel(), sigma[:, :2].ravel()),
        "tilt": (error[:, 2:].ravel(), sigma[:, 2:].ravel()),
    }


def run(seed: int) -> tuple[Errors, Errors]:
    """Return the errors with the front scanner alone, and with both."""
    survey, scalars = made(seed)
    rings, log, ties, rear, shape = given(survey)
    single, double = (
        off(estimate_joint(rings, log, ties, rear=one, **shape), survey.truth, scalars) for one in (None, rear)
    )
    survey, _ = made(seed, straight=True)
    rings, _, _, rear, shape = given(survey)
    blind = (off_blind(estimate_joint(rings, rear=one, **shape), survey.truth) for one in (None, rear))
    return single | next(blind), double | next(blind)


def pooled(parts: list[Errors], name: str) -> tuple[float, float]:
    """Return the rms of the errors, and the share of them within 1.96 sigma."""
    error, sigma = (np.concatenate([part[name][k] for part in parts]) for k in (0, 1))
    return float(np.sqrt(np.mean(error**2))), float(np.mean(np.abs(error) < 1.96 * sigma))


def table(single: list[Errors], double: list[Errors]) -> str:
    """Return the table as Markdown."""
    lines = ["| rms of error | one scanner | two | held by 95 %: one | two |", "|---|---|---|---|---|"]
    for name, (title, factor, unit) in SHOWN.items():
        (one, held_one), (two, held_two) = pooled(single, name), pooled(double, name)
        lines.append(
            f"| {title} [{unit}] | {factor * one:.4f} | {factor * two:.4f} | {held_one:.3f} | {held_two:.3f} |"
        )
    return "\n".join(lines) + f"\n\nOf {len(single)} runs.\n"


def main() -> None:
    """Print the table and put it into the page."""
    runs, first = (int(os.environ.get(f"SPRINGLINE_{name}", n)) for name, n in (("RUNS", 20), ("FIRST", 1)))
    both = [run(seed) for seed in range(first, first + runs)]
    text = table([one for one, _ in both], [two for _, two in both])
    print(text)
    page = PAGE.read_text(encoding="utf-8")
    between = re.compile(re.escape(MARKS[0]) + ".*?" + re.escape(MARKS[1]), re.DOTALL)
    PAGE.write_text(between.sub(lambda _: MARKS[0] + text + MARKS[1], page), encoding="utf-8")
