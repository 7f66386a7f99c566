"""Accuracy of the joint estimate beside every baseline, on one 50 m survey: rms over stations and five seeds.

A 300 mm pipe of 2 to 3 % ovality: a 22.5 degree bend of 5 D, a sag of 25 mm, joints kinked by 0.1 degree. Rings of
360 readings every 10 mm, 1 mm noise, 2 % outliers, a tenth of the arc under water; gyro bias 10 degrees per hour,
odometer scale 0.5 %, side-slip 0.3 degrees, ties of 10 mm at both ends, a minute of standstill at the start. A baseline
that gives no answer counts as having said "a round pipe of nominal diameter, no tilt".
"""

from __future__ import annotations

import contextlib
import time
from typing import NamedTuple

import numpy as np

from bench._joint import given, radii, true_axis, true_pose, true_radii
from springline.estimation import Inertial, JointEstimate, Rings, Ties, estimate_joint
from springline.estimation.start import first_axis
from springline.estimation.track import Track
from springline.geometry.robot import pitch_yaw_roll, section_from_ring, solve_rings
from springline.simulate import parse, simulate

SEEDS = range(1, 6)
NOMINAL = 0.15
SOME = 25
"""Every so many rings are solved by the two- and three-ring solves, which take their time."""

SCENARIO = """
name = "weave"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.008
start = [1000.0, 2000.0, 50.0]
seed = 11
run = [
    {{ kind = "straight", length = 20.0 }},
    {{ kind = "bend", radius = 1.5, angle_deg = 22.5, towards = "right" }},
    {{ kind = "straight", length = 30.0 }},
]
sag = [{{ chainage = 36.0, length = 12.0, depth = "25mm" }}]
joints = {{ spacing = 2.5, spacing_sigma = "8mm", gap = "4mm", kink_sigma_deg = 0.1 }}
water = [{{ depth = "7.3mm" }}]
[[pipe.section]]
shape = "mode"
mode = 1
s1 = {{ mean = 0.975, amplitude = 0.005, period = 9.0 }}
[robot]
length = 0.5
wheelbase = 0.3
offset_z = {{ amplitude = {side}, period = {period} }}
offset_y = {{ amplitude = 0.004, period = 4.3 }}
roll_deg = {{ amplitude = 3.0, period = 3.7 }}
side_slip_deg = {slip}
standstill = [{{ chainage = 0.25, duration = 60.0 }}]
[rings]
spacing = "10mm"
noise = "1mm"
outliers = 0.02
water_returns = 0.0
[inertial]
rate = 100.0
gyro_bias_deg_h = [10.0, -10.0, 10.0]
gyro_noise_deg_sqrt_h = {walk}
accel_bias = [0.005, -0.005, 0.005]
accel_noise = 0.0005
[odometer]
scale_error = 0.005
[ties]
chainages = [0.25, 50.3]
sigma = "10mm"
"""

CASES = {
    "weaving +-3 degrees, side-slip 0.3 degrees": {"side": 0.025, "period": 3.0, "slip": 0.3},
    "weaving +-3 degrees, no side-slip": {"side": 0.025, "period": 3.0, "slip": 0.0},
    "weaving +-10 degrees, side-slip 0.3 degrees": {"side": 0.056, "period": 2.0, "slip": 0.3},
}
BARS = (
    {
        "r1 mm": 0.05,
        "r2 mm": 0.05,
        "ovality pt": 0.022,
        "offset mm": 0.10,
        "roll deg": 0.1,
        "tilt deg": 0.25,
        "axis mm": 50,
    },
    {
        "r1 mm": 0.05,
        "r2 mm": 0.05,
        "ovality pt": 0.022,
        "offset mm": 0.10,
        "roll deg": 0.1,
        "tilt deg": 0.08,
        "axis mm": 50,
    },
    {
        "r1 mm": 0.06,
        "r2 mm": 0.06,
        "ovality pt": 0.03,
        "offset mm": 0.12,
        "roll deg": 0.1,
        "tilt deg": 0.25,
        "axis mm": 60,
    },
)


class Survey(NamedTuple):
    """What is measured, and what was true."""

    rings: Rings
    log: Inertial
    ties: Ties
    truth: object
    seconds: float


def survey(case: dict[str, float], seed: int, walk: float = 0.1) -> Survey:
    """Return one simulated survey, its ellipses fitted."""
    made = simulate(parse(SCENARIO.format(**case, walk=walk)), seed=seed)
    start = time.perf_counter()
    arrays = given(made)
    return Survey(*arrays, made.truth, time.perf_counter() - start)


def true_values(truth) -> dict[str, np.ndarray]:
    """Return the truth abreast of every ring."""
    pose = true_pose(truth)
    return {
        "radii": true_radii(truth),
        "offset": pose[:, :2],
        "tilt": pose[:, 2:4],
        "roll": pose[:, 4],
        "axis": true_axis(truth),
    }


def of_joint(found: JointEstimate) -> dict[str, np.ndarray]:
    """Return what the joint estimate says in the same terms."""
    return {
        "radii": radii(found)[0],
        "offset": found.pose[:, :2],
        "tilt": found.pose[:, 2:4],
        "roll": found.pose[:, 4],
        "axis": found.axis,
    }


def of_rings(one: Survey, mean: int = 1) -> dict[str, np.ndarray]:
    """Return rings as they are, or their running mean over `mean` rings."""
    kernel = np.ones(mean) / mean
    count = np.convolve(np.ones(len(one.rings.distance)), kernel, "same")
    smooth = np.stack([np.convolve(v, kernel, "same") / count for v in np.nan_to_num(one.rings.parameters).T], axis=1)
    return {
        "radii": np.stack([smooth[:, 2] + smooth[:, 3], smooth[:, 2] - smooth[:, 3]], axis=1),
        "offset": -smooth[:, 1::-1],
    }


def attitude(one: Survey) -> np.ndarray:
    """Return pitch, yaw and roll (n, 3) by the inertial log against the way of the ring centres over half a metre."""
    track = Track(one.rings, one.log)
    marks = track.at(one.rings.distance, 0.0)
    axis = first_axis(one.rings, lambda distance: track.at(distance, 0.0))
    rows = np.arange(len(axis))
    way = axis[np.minimum(rows + 25, len(axis) - 1)] - axis[np.maximum(rows - 25, 0)]
    x = way / np.linalg.norm(way, axis=1, keepdims=True)
    y = np.array([0.0, 0.0, 1.0]) - x[:, 2:] * x
    y = y / np.linalg.norm(y, axis=1, keepdims=True)
    frames = np.stack([x, y, np.cross(x, y)], axis=1)
    return np.stack(pitch_yaw_roll(np.swapaxes(marks.axes, 1, 2) @ np.swapaxes(frames, 1, 2)), axis=1)


def ellipses(one: Survey) -> np.ndarray:
    """Return major, minor and beta (n, 3) of every ring."""
    _, _, mean, cos, sin = one.rings.parameters.T
    half = np.hypot(cos, sin)
    return np.stack([mean + half, mean - half, 0.5 * np.arctan2(sin, cos)], axis=1)


def of_known_attitude(one: Survey) -> dict[str, np.ndarray]:
    """Return every ring by itself, its attitude taken from the inertial log."""
    tilt = attitude(one)
    found = section_from_ring(*ellipses(one).T, *tilt.T)
    radii = np.stack([found.r1, found.r2], axis=1)
    return {"radii": np.where(np.isfinite(radii), radii, NOMINAL), "tilt": tilt[:, :2], "roll": tilt[:, 2]}


def of_solves(one: Survey, together: int, apart: int = 1) -> dict[str, np.ndarray]:
    """Return two- or three-ring solves of rings `apart`, increments by the gyro; NaN where none was tried."""
    tilt, shown = attitude(one), ellipses(one)
    out = {"radii": np.full((len(shown), 2), np.nan), "tilt": np.full((len(shown), 2), np.nan)}
    for first in range(0, len(shown) - together * apart, SOME):
        rows = first + apart * np.arange(together)
        out["radii"][first], out["tilt"][first] = NOMINAL, 0.0
        # A set that the solver cannot take counts as one without an answer.
        with contextlib.suppress(ValueError, np.linalg.LinAlgError):
            found = solve_rings(shown[rows], tilt[rows] - tilt[first], guess=tilt[first, :2], roll=tilt[first, 2])
            for name, values in (("radii", (found.r1, found.r2)), ("tilt", (found.pitch, found.yaw))):
                if np.isfinite(values).all():
                    out[name][first] = values
    return out


def errors(said: dict[str, np.ndarray], true: dict[str, np.ndarray]) -> dict[str, float]:
    """Return mean squares of the errors, by the names of the table."""
    out = {}
    if "radii" in said:
        error = said["radii"] - true["radii"]
        out["r1 mm"], out["r2 mm"] = 1e6 * np.nanmean(error**2, axis=0)
        oval = [np.abs(r[:, 0] - r[:, 1]) / (r[:, 0] + r[:, 1]) for r in (said["radii"], true["radii"])]
        out["ovality pt"] = 1e4 * np.nanmean((oval[0] - oval[1]) ** 2)
    for name, key, unit in (
        ("offset mm", "offset", 1e3),
        ("roll deg", "roll", 180 / np.pi),
        ("tilt deg", "tilt", 180 / np.pi),
    ):
        if key in said:
            out[name] = unit**2 * np.nanmean((said[key] - true[key]) ** 2)
    if "axis" in said:
        out["axis mm"] = 1e6 * np.nanmean(np.sum((said["axis"] - true["axis"]) ** 2, axis=1))
    return out


def covered(found: JointEstimate, true: dict[str, np.ndarray]) -> np.ndarray:
    """Return the share of stations at which 1.96 sigma hold offset, tilt, roll, r1 and r2, axis."""
    said, sigma = of_joint(found), found.pose_sigma
    pairs = (
        (said["offset"] - true["offset"], sigma[:, :2]),
        (said["tilt"] - true["tilt"], sigma[:, 2:4]),
        (said["roll"] - true["roll"], sigma[:, 4]),
        (said["radii"] - true["radii"], radii(found)[1]),
        (said["axis"] - true["axis"], found.axis_sigma),
    )
    return np.array([np.mean(np.abs(error) < 1.96 * spread) for error, spread in pairs])


def print_case(name: str, case: dict[str, float], bar: dict[str, float]) -> None:
    """Print one case's table."""
    sums: dict[str, list[dict[str, float]]] = {}
    cover, bends, seconds, count = [], [], [], 0
    for seed in SEEDS:
        one = survey(case, seed)
        true = true_values(one.truth)
        start = time.perf_counter()
        found = estimate_joint(one.rings, one.log, one.ties)
        seconds.append(time.perf_counter() - start + one.seconds)
        count = len(one.rings.distance)
        cover.append(covered(found, true))
        bends.append([(np.degrees(b.angle), b.radius) for b in found.bends])
        answers = {
            "joint estimate": of_joint(found),
            "no correction": of_rings(one),
            "running mean of 51": of_rings(one, 51),
            "known inertial attitude": of_known_attitude(one),
            "two rings": of_solves(one, 2),
            "three rings": of_solves(one, 3),
        }
        for method, said in answers.items():
            sums.setdefault(method, []).append(errors(said, true))
    print(f"\n{name}: {count} rings, {len(SEEDS)} seeds, {1e3 * min(seconds) / count:.2f} s per 1,000 rings with fits")
    print(f"{'':<26}" + "".join(f"{column:>12}" for column in bar))
    for method, rows in sums.items():
        cells = (np.sqrt(np.mean([row[c] for row in rows])) if c in rows[0] else np.nan for c in bar)
        print(f"{method:<26}" + "".join(" " * 12 if np.isnan(v) else f"{v:>12.4g}" for v in cells))
    print(f"{'wanted at most':<26}" + "".join(f"{value:>12.4g}" for value in bar.values()))
    print(
        "95 % hold: offset {:.3f}, tilt {:.3f}, roll {:.3f}, radii {:.3f}, axis {:.3f}".format(*np.mean(cover, axis=0))
    )
    print("bends (22.5 degrees, 1.5 m):", "; ".join(" ".join(f"{a:.2f}/{r:.3f}" for a, r in one) for one in bends))


def main() -> None:
    """Print the table of every case."""
    for (name, case), bar in zip(CASES.items(), BARS, strict=True):
        print_case(name, case, bar)
