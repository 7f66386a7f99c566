"""What a second ring scanner adds: the joint estimate of short simulated surveys with it and without.

Every run is another pipe, with biases, scale, side-slip and the mount of the rear scanner drawn anew from what the
estimator is told of them. Quantities of a station are pooled over the stations of all runs. Without an inertial log the
pipe is straight, as it is taken to be, and tilt is told in the robot's own upright. The table goes into
`docs/estimator.md`, between its marks. `SPRINGLINE_RUNS` says how many runs (default 20), `SPRINGLINE_FIRST` which seed
comes first.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench import _joint
from bench._estimator_page import publish, seeds
from springline.estimation import Inertial, JointEstimate, JointOptions, Rear, Rings, Ties, estimate_joint
from springline.simulate import parse, simulate

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
    arrays = _joint.given(survey)
    behind = _joint.fitted(survey.rings_rear, (REAR, 0.0, 0.0))
    shape = _joint.shape_of(survey.rings_rear, behind)
    rear = Rear(replace(behind, parameters=shape.parameters), MOUNT)
    return *arrays, rear, {"harmonics": _joint.shape_of(survey.rings, arrays.rings)}


def off(found: JointEstimate, truth, scalars: dict[str, float]) -> Errors:
    """Return the errors of an estimate with a log."""
    out = _joint.of_stations(found, truth)
    for name, value in scalars.items():
        estimate, sigma = found.scalars[name.replace(" ", "_")]
        out[name] = (np.array([estimate - value]), np.array([sigma]))
    return out


def off_blind(found: JointEstimate, truth) -> Errors:
    """Return the errors of an estimate without a log: offset and tilt, up and right together."""
    error = found.pose[:, :4] - _joint.true_pose(truth)[:, :4]
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
    both = [run(seed) for seed in seeds(20)]
    publish("rear", table([one for one, _ in both], [two for _, two in both]))
