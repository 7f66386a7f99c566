"""What a back pass adds: section and centreline of 10 m pipes driven from both ends, joined and one by one.

Both passes lie between the same known points; every run is another pipe with another robot. `SPRINGLINE_RUNS` says how
many runs (default 10), `SPRINGLINE_FIRST` which seed comes first. The table goes into `docs/estimator.md`, between its
marks.
"""

from __future__ import annotations

import numpy as np

import springline as sl
from bench._estimator_page import publish, seeds
from bench._joint import AXES, here
from springline.geometry.measures import polar_radius
from springline.simulate import parse, simulate

SCENARIO = """
name = "two passes"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.008
start = [1000.0, 2000.0, 50.0]
seed = {seed}
run = [
    {{ kind = "straight", length = 5.0 }},
    {{ kind = "bend", radius = 1.5, angle_deg = 22.5, towards = "right" }},
    {{ kind = "straight", length = 5.0 }},
]
joints = {{ spacing = 2.5, gap = "4mm", kink_sigma_deg = 0.1 }}
[[pipe.section]]
shape = "mode"
mode = 1
s1 = {{ mean = 0.97, amplitude = 0.005, period = {period} }}
axis_deg = 20.0
[robot]
length = 0.5
wheelbase = 0.35
offset_z = {{ amplitude = 0.025, period = 3.0 }}
offset_y = {{ amplitude = 0.004, period = 4.3 }}
roll_deg = {{ amplitude = 3.0, period = 3.7 }}
side_slip_deg = {slip}
from_end = {back}
standstill = [{{ chainage = 0.25, duration = 60.0 }}]
[rings]
spacing = "10mm"
noise = "1mm"
outliers = 0.02
[inertial]
rate = 100.0
gyro_bias_deg_h = [10.0, -10.0, 10.0]
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [0.01, -0.01, 0.01]
accel_noise = 0.0005
[odometer]
scale_error = {scale}
noise = 0.002
[ties]
chainages = [0.25, 10.2]
sigma = "10mm"
"""
SHOWN = {
    **dict.fromkeys(("diameter_x", "diameter_y", *AXES), (1e3, "mm")),
    "gradient": (1e2, "%"),
}
"""Factor and unit of what the table shows."""


def passes(seed: int) -> tuple[sl.Survey, sl.Survey]:
    """Return an out and a back pass between the same known points."""
    rng = np.random.default_rng(seed)
    drawn = {
        "slip": 0.3 * rng.standard_normal(),
        "scale": 0.005 * rng.standard_normal(),
        "period": rng.uniform(2.5, 9.0),
    }
    out, back = (
        simulate(parse(SCENARIO.format(seed=seed, back=word, **drawn)), seed=2 * seed + k)
        for k, word in enumerate(("false", "true"))
    )
    return out, tied_alike(out, back)


def tied_alike(out: sl.Survey, back: sl.Survey) -> sl.Survey:
    """Return a back pass with the known points as the out pass has them: their errors are the same ones."""
    ties = back.ties.assign({name: ("tie", out.ties[name].values[::-1]) for name in AXES})
    return sl.Survey({name: back.group(name) for name in back.groups} | {"ties": ties}, back.attrs)


def errors(result: sl.Survey, truth) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return errors and sigma of two diameters [m], and of the centreline where there is one."""
    shape, spread = result.section["parameters"].values, result.section["covariance"].values
    found = {}
    for name, bearing, sign in (("diameter_x", 0.0, 1.0), ("diameter_y", np.pi / 2, -1.0)):
        sigma = 2.0 * np.sqrt(spread[:, 0, 0] + spread[:, 1, 1] + 2.0 * sign * spread[:, 0, 1])
        found[name] = (2.0 * polar_radius(shape, bearing) - here(truth, name), sigma)
    for name in (*AXES, "gradient") if result.has("layout") else ():
        found[name] = (result.layout[name].values - here(truth, name), result.layout[f"{name}_sigma"].values)
    return found


def main() -> None:
    """Print the table and put it into the page."""
    runs = seeds(10)
    alone, joined = [], []
    for seed in runs:
        out, back = passes(seed)
        alone.append(errors(sl.inspect(out), out.truth))
        joined.append(errors(sl.inspect(out, back=back), out.truth))
    lines = ["| rms of error | one pass | both | held by 95 %: one | both |", "|---|---|---|---|---|"]
    for name, (factor, unit) in SHOWN.items():
        cells = []
        for each in (alone, joined):
            error, sigma = (np.concatenate([one[name][k] for one in each]) for k in (0, 1))
            known = np.isfinite(error + sigma)
            cells.append(
                (factor * np.sqrt(np.mean(error[known] ** 2)), np.mean(np.abs(error) < 1.96 * sigma, where=known))
            )
        (one, held_one), (both, held_both) = cells
        lines.append(f"| {name} [{unit}] | {one:.3f} | {both:.3f} | {held_one:.3f} | {held_both:.3f} |")
    publish("passes", "\n".join(lines) + f"\n\nOf {len(runs)} runs.\n")
