"""Do the joint estimate's 95 % intervals hold the truth? Many short simulated surveys, every one another pipe.

Biases, scale, clock and the odometer's noise are drawn anew for each run by the priors that the estimator states; drawn
too are side-slip, the pipe's section, its joints and the place of its bend. Quantities of a station are pooled over the
stations of all runs; scalars of a survey over the runs. The table goes into `docs/estimator.md`, between its marks.
`SPRINGLINE_RUNS` says how many runs (default 200), `SPRINGLINE_FIRST` which seed comes first.
"""

from __future__ import annotations

import numpy as np

from bench import _joint
from bench._estimator_page import publish, seeds
from bench._joint import given, here, true_axis
from springline.estimation import JointEstimate, JointOptions, estimate_joint
from springline.simulate import parse, simulate

SCENARIO = """
name = "short"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.008
start = [1000.0, 2000.0, 50.0]
seed = {seed}
run = [
    {{ kind = "straight", length = {first} }},
    {{ kind = "bend", radius = 1.5, angle_deg = 22.5, towards = "right" }},
    {{ kind = "straight", length = {rest} }},
]
sag = [{{ chainage = 8.5, length = 5.0, depth = "25mm" }}]
joints = {{ spacing = 2.5, spacing_sigma = "8mm", gap = "4mm", kink_sigma_deg = 0.1 }}
water = [{{ depth = "7.3mm" }}]
[[pipe.section]]
shape = "mode"
mode = 1
s1 = {{ mean = 0.975, amplitude = 0.005, period = {period} }}
{harmonic}
[robot]
length = 0.5
wheelbase = 0.3
offset_z = {{ amplitude = 0.025, period = 3.0 }}
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
rate = 50.0
gyro_bias_deg_h = [{gyro}]
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [{accel}]
accel_noise = 0.0005
clock_offset = {clock}
[odometer]
scale_error = {scale}
noise = {noise}
[ties]
chainages = [0.25, 11.6]
sigma = "10mm"
"""
HARMONIC = "[[pipe.harmonic]]\norder = 3\namplitude = 0.0005\n"
SAG = (8.5, 5.0)
"""Middle and length of the sag [m]."""


def run(seed: int, *, harmonic: bool = False) -> tuple[dict[str, np.ndarray], dict[str, float], dict[str, float]]:
    """Return errors over sigma: of stations by quantity, of scalars by name; and the scalars' plain errors."""
    rng, options = np.random.default_rng(seed), JointOptions()
    scale, slip = options.scale * rng.standard_normal(), 0.3 * rng.standard_normal()
    clock, first = options.clock * rng.standard_normal(), rng.uniform(3.0, 5.0)
    gyro, accel = 10.0 * rng.standard_normal(3), options.accel_bias * rng.standard_normal(3)
    made = simulate(
        parse(
            SCENARIO.format(
                seed=seed,
                slip=slip,
                clock=clock,
                scale=scale,
                noise=options.along,
                first=first,
                rest=11.4 - first,
                gyro=", ".join(map(str, gyro)),
                accel=", ".join(map(str, accel)),
                period=rng.uniform(2.5, 9.0),
                harmonic=HARMONIC if harmonic else "",
            )
        ),
        seed=seed,
    )
    found = estimate(made)
    stations, axis = of_stations(found, made.truth), true_axis(made.truth)
    hour = np.radians(1.0) / 3600.0
    truth = {
        **{f"gyro_bias_{k}": v * hour for k, v in zip("xyz", gyro, strict=True)},
        **{f"accel_bias_{k}": v for k, v in zip("xyz", accel, strict=True)},
        "odometer_scale": 1.0 / (1.0 + scale) - 1.0,
        "slip_right": -np.tan(np.radians(slip)),
        "slip_up": 0.0,
        "clock_offset": clock,
    }
    off = {name: (found.scalars[name][0] - value, found.scalars[name][1]) for name, value in truth.items()}
    if len(found.bends) == 1:
        bend = found.bends[0]
        off["bend angle"] = (bend.angle - np.radians(22.5), bend.angle_sigma)
        off["bend radius"] = (bend.radius - 1.5, bend.radius_sigma)
        off["bend start"] = (bend.start + made.truth["ring_chainage"].values[0] - first, bend.start_sigma)
    off |= true_sag(found, made.truth, axis)
    return (
        stations,
        {name: error / sigma for name, (error, sigma) in off.items()},
        {name: error for name, (error, _) in off.items()},
    )


def estimate(made) -> JointEstimate:
    """Return the joint estimate of a simulated survey, as the product makes it."""
    arrays = given(made)
    return estimate_joint(*arrays, harmonics=_joint.shape_of(made.rings, arrays.rings))


def true_sag(found: JointEstimate, truth, axis: np.ndarray) -> dict[str, tuple[float, float]]:
    """Return the error and sigma of the depth of the sag that lies where one was made."""
    from springline.estimation.profile import _string

    at = truth["ring_chainage"].values
    mine = [s for s in found.sags if s.start + at[0] < SAG[0] < s.start + s.length + at[0]]
    if not mine:
        return {}
    invert = axis[:, 2] - 0.5 * here(truth, "diameter_y")
    corners = np.array(_string(at, invert))
    depth = float(np.max((np.interp(at, at[corners], invert[corners]) - invert)[np.abs(at - SAG[0]) < 0.5 * SAG[1]]))
    return {"sag depth": (mine[0].depth - depth, mine[0].depth_sigma)}


def of_stations(found: JointEstimate, truth) -> dict[str, np.ndarray]:
    """Return errors over sigma of every quantity of a station."""
    out = {name: error / sigma for name, (error, sigma) in _joint.of_stations(found, truth).items()}
    grade = found.direction_sigma[:, 1] / np.cos(found.direction[:, 1]) ** 2
    out["gradient"] = (found.gradient - here(truth, "gradient")) / grade
    # The first station's chainage is what it is counted from.
    at = truth["ring_chainage"].values
    out["chainage"] = (found.chainage - (at - at[0]))[1:] / found.chainage_sigma[1:]
    return out


def table(stations: dict[str, list[np.ndarray]], scalars: dict[str, list[float]], runs: int) -> str:
    """Return the table as Markdown."""
    lines = ["| quantity | held by 95 % | rms of error over sigma | of |", "|---|---|---|---|"]
    for name, parts in stations.items():
        one = np.concatenate(parts)
        lines.append(f"| {name} | {held(one):.3f} | {np.sqrt(np.mean(one**2)):.2f} | {runs} runs' stations |")
    for name, values in scalars.items():
        one = np.array(values)
        lines.append(f"| {name.replace('_', ' ')} | {held(one):.3f} | {np.sqrt(np.mean(one**2)):.2f} | {one.size} |")
    return "\n".join(lines) + "\n"


def held(ratio: np.ndarray) -> float:
    """Return the share of errors within 1.96 sigma."""
    return float(np.mean(np.abs(ratio) < 1.96))


def main() -> None:
    """Print the table and put it into the page."""
    runs = seeds(200)
    stations: dict[str, list[np.ndarray]] = {}
    scalars: dict[str, list[float]] = {}
    for seed in runs:
        one, some, _ = run(seed)
        for name, values in one.items():
            stations.setdefault(name, []).append(values)
        for name, value in some.items():
            scalars.setdefault(name, []).append(value)
    publish("coverage", table(stations, scalars, len(runs)))
