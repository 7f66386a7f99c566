"""Features seen in rings against simulated truth: how many are found, how well they are sized, and false alarms.

`python -m bench.ring_features SURVEYS [FIRST SEED]`. Four kinds of pipe, each drawn anew for every seed. `joints`:
rings every millimetre over open, stepped and kinked joints, dents and deposits, in 225 to 600 mm pipes of uneven wall.
`laterals`: a house connection every metre between joints, at 2, 5 or 10 mm, over water, with dropout, strays and
deposits as decoys. `coarse`: narrow joints, 0 to 6 mm, among rings 10 to 15 mm apart, by robots on a prescribed path
and on the wall itself. `nothing`: deformed pipes of modes 1 to 5 with rough wall and water, and no mark at all.
"""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any

import numpy as np

import springline as sl
from springline.config import Config
from springline.simulate.scenario import Scenario
from springline.stages.clean import clean
from springline.stages.detect import detect
from springline.stages.estimate import estimate
from springline.stages.features import features

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from springline.survey import Survey

KINDS = ("wall", "water", "bed", "deposit", "dent", "joint", "lateral", "nothing")
INWARD = ("dent", "deposit", "intrusion")
WITHIN = 0.06

Row = dict[str, Any]


def joints(seed: int) -> dict[str, Any]:
    """Return a pipe with four joints and three bumps, at 1 mm ring spacing."""
    rng = np.random.default_rng(seed)
    bore = float(rng.choice([0.225, 0.3, 0.4, 0.6]))
    listed, bumps = [], {"dent": [], "deposit": []}
    for k in range(4):
        at = 0.5 + 0.9 * k + rng.uniform(0.0, 0.1)
        dy, dz, up, right = rng.normal(0.0, [0.003, 0.003, 0.4, 0.4]).tolist()
        one = {"chainage": at, "gap": rng.uniform(0.003, 0.03), "offset_y": dy, "offset_z": dz}
        listed.append(one | {"kink_up_deg": up, "kink_right_deg": right})
        if k < 3:
            bump = {"chainage": at + 0.45 + rng.uniform(-0.05, 0.05), "clock_h": rng.uniform(0.5, 12.0)}
            bump |= {"depth": rng.uniform(0.01, 0.06) * bore, "length": rng.uniform(0.08, 0.3)}
            bumps[("dent", "deposit")[rng.integers(2)]].append(bump | {"width_deg": rng.uniform(20.0, 80.0)})
    pipe = {"diameter": bore, "wall_thickness": rng.uniform(0.006, 0.02), "seed": seed, "joint": listed, **bumps}
    pipe |= {"run": [{"kind": "straight", "length": 4.0}], "roughness": {"rms": rng.uniform(0.0, 0.0003)}}
    pipe["section"] = [{"shape": "mode", "mode": 1, "s1": rng.uniform(0.96, 1.0)}]
    sway = bore / 0.3 * rng.uniform(0.0, [0.01, 0.005])
    robot = {"length": max(0.3, bore), "wheelbase": max(0.25, bore), "half_span": bore / 6, "wheel_radius": 0.025}
    robot |= {"offset_z": {"amplitude": sway[0], "period": 2.3}, "offset_y": {"amplitude": sway[1], "period": 3.1}}
    robot |= {"pitch_deg": {"amplitude": rng.uniform(0.0, 0.6), "period": 1.7}, "yaw_deg": rng.uniform(-1.0, 1.0)}
    rings = {"spacing": 0.001, "noise": rng.uniform(0.0003, 0.001), "dropout": rng.uniform(0.0, 0.05)}
    rings["outliers"] = rng.uniform(0.0, 0.01)
    return {"name": "joints", "pipe": pipe, "robot": robot | {"start": 0.35, "end": 3.65}, "rings": rings}


def laterals(seed: int) -> dict[str, Any]:
    """Return 12 m with nine laterals, ten joints, and deposits as decoys."""
    rng = np.random.default_rng(seed)
    bore = float(rng.choice([0.2, 0.3, 0.45]))
    openings = []
    for k in range(9):
        clock = float(rng.choice([rng.uniform(0.5, 4.0), rng.uniform(8.0, 12.0)]))
        one = {"chainage": 1.0 + 1.1 * k + rng.uniform(-0.1, 0.1), "clock_h": clock}
        one |= {"diameter": rng.uniform(0.25, 0.7) * bore, "length": rng.uniform(0.3, 1.0)}
        openings.append(one | {"inclination_deg": float(rng.choice([0.0, 0.0, 30.0, 45.0]))})
    size = {"depth": 0.03 * bore, "length": 0.15, "width_deg": 50.0}
    decoys = [{"chainage": 1.3 + 2.2 * k, "clock_h": rng.uniform(4.0, 8.0)} | size for k in range(4)]
    pipe = {"diameter": bore, "wall_thickness": 0.01, "seed": seed, "lateral": openings, "deposit": decoys}
    pipe |= {"run": [{"kind": "straight", "length": 12.0}], "roughness": {"rms": 0.0002}}
    pipe["joints"] = {"spacing": 1.1, "first": 1.55, "gap": 0.012, "gap_sigma": 0.003, "offset_sigma": 0.001}
    pipe["section"] = [{"shape": "mode", "mode": int(rng.integers(1, 3)), "s1": rng.uniform(0.97, 1.0)}]
    if rng.random() < 0.6:
        pipe["water"] = [{"depth": rng.uniform(0.03, 0.1) * bore}]
    return {"name": "laterals", "pipe": pipe, "robot": _robot(), "rings": _scanner(rng, [0.002, 0.005, 0.01])}


def coarse(seed: int) -> dict[str, Any]:
    """Return a pipe with ten joints of 0 to 6 mm, stepped and kinked, at 10 to 15 mm ring spacing."""
    rng = np.random.default_rng(seed)
    bore = float(rng.choice([0.225, 0.3, 0.4, 0.6]))
    listed = []
    for k in range(10):
        dy, dz, up, right = rng.normal(0.0, [0.003, 0.003, 0.4, 0.4]).tolist()
        one = {"chainage": 0.9 + k + rng.uniform(0.0, 0.1), "gap": rng.uniform(0.0, 0.006)}
        listed.append(one | {"offset_y": dy, "offset_z": dz, "kink_up_deg": up, "kink_right_deg": right})
    pipe = {"diameter": bore, "wall_thickness": rng.uniform(0.006, 0.02), "seed": seed, "joint": listed}
    pipe |= {"run": [{"kind": "straight", "length": 11.0}], "roughness": {"rms": rng.uniform(0.0, 0.0003)}}
    pipe["section"] = [{"shape": "mode", "mode": 1, "s1": rng.uniform(0.96, 1.0)}]
    robot = {"length": max(0.3, bore), "wheelbase": max(0.25, bore), "half_span": bore / 6, "wheel_radius": 0.025}
    robot |= {"path": ("prescribed", "kinematic")[seed % 2], "start": 0.35, "end": 10.65}
    if robot["path"] == "prescribed":
        sway = bore / 0.3 * rng.uniform(0.0, [0.01, 0.005])
        robot |= {"offset_z": {"amplitude": sway[0], "period": 2.3}, "offset_y": {"amplitude": sway[1], "period": 3.1}}
    robot |= {"pitch_deg": {"amplitude": rng.uniform(0.0, 0.6), "period": 1.7}, "yaw_deg": rng.uniform(-1.0, 1.0)}
    rings = {"spacing": rng.uniform(0.010, 0.015), "noise": rng.uniform(0.0003, 0.001)}
    rings |= {"dropout": rng.uniform(0.0, 0.05), "outliers": rng.uniform(0.0, 0.01)}
    return {"name": "coarse", "pipe": pipe, "robot": robot, "rings": rings}


def nothing(seed: int) -> dict[str, Any]:
    """Return 20 m of deformed, rough pipe, with or without water, that has no mark on it."""
    rng = np.random.default_rng(seed)
    bore, mode = float(rng.choice([0.2, 0.3, 0.45])), int(rng.integers(1, 6))
    section = {"shape": "mode", "mode": mode, "s1": rng.uniform(0.95, 0.985)}
    if mode >= 4:
        section["s02"] = rng.uniform(0.99, 0.999)
    if mode == 5:
        section["s01"] = rng.uniform(0.985, 0.998)
    rough = {"rms": rng.uniform(0.0, 0.0005), "along": rng.uniform(0.01, 0.05), "around": rng.uniform(0.01, 0.05)}
    pipe = {"diameter": bore, "wall_thickness": 0.01, "seed": seed, "section": [section], "roughness": rough}
    pipe["run"] = [{"kind": "straight", "length": 20.0}]
    if rng.random() < 0.6:
        pipe["water"] = [{"depth": rng.uniform(0.03, 0.1) * bore, "start": rng.uniform(0.0, 8.0)}]
    return {"name": "nothing", "pipe": pipe, "robot": _robot(), "rings": _scanner(rng, [0.005, 0.01, 0.02])}


def _robot() -> dict[str, Any]:
    return {
        "length": 0.4, "wheelbase": 0.3, "half_span": 0.03, "wheel_radius": 0.02, "yaw_deg": 0.3,
        "offset_z": {"amplitude": 0.012, "period": 2.3}, "offset_y": {"amplitude": 0.004, "period": 1.6},
        "pitch_deg": {"amplitude": 0.4, "period": 1.7}, "roll_deg": {"amplitude": 2.0, "period": 4.0},
    }  # fmt: skip


def _scanner(rng: np.random.Generator, spacings: list[float]) -> dict[str, float]:
    rings = {"spacing": float(rng.choice(spacings)), "noise": rng.uniform(0.0003, 0.0015)}
    return rings | {
        "dropout": rng.uniform(0.0, 0.15),
        "outliers": rng.uniform(0.0, 0.02),
        "water_returns": rng.uniform(0.1, 0.9),
    }


def surveyed(make: Callable[[int], dict[str, Any]], seed: int) -> Survey:
    """Return a simulated survey with its features, estimated ring by ring."""
    survey, config = sl.simulate(Scenario.model_validate(make(seed)), seed=seed), Config()
    for stage in (clean, detect, estimate, features):
        survey = stage(survey, config)
    return survey


def matched(survey: Survey) -> tuple[list[Row], list[Row]]:
    """Return a row for each true feature, with what was found of it (or None), and what was found that is not there."""
    truth, found = survey.truth, survey.features
    listed = [{str(v): found[v].values[k] for v in found.data_vars} for k in range(found.sizes["feature"])]
    at = np.interp(truth["feature_chainage"].values, truth["ring_chainage"].values, survey.rings["distance"].values)
    rows, used = [], set()
    names = [str(v) for v in truth.data_vars if str(v).startswith("feature_")]
    for k in range(truth.sizes["feature"]):
        one = {name.removeprefix("feature_"): float(truth[name].values[k]) for name in names}
        one |= {"kind": KINDS[int(one["kind"])], "chainage": float(at[k])}
        if one["kind"] in ("water", "bed"):
            continue
        alike = INWARD if one["kind"] in INWARD else (one["kind"],)
        near = [j for j, f in enumerate(listed) if f["kind"] in alike and abs(f["chainage"] - at[k]) < WITHIN]
        best = min(near, key=lambda j: abs(listed[j]["chainage"] - at[k]), default=None)
        used.add(best)
        rows.append({"true": one, "found": None if best is None else listed[best]})
    return rows, [f for j, f in enumerate(listed) if j not in used]


def errors(rows: Iterable[Row], kinds: tuple[str, ...], name: str, true: str) -> tuple[np.ndarray, np.ndarray]:
    """Return errors and stated one-sigmas of one quantity over the features that were found."""
    pairs = [
        (row["found"][name] - row["true"][true], row["found"][f"{name}_sigma"])
        for row in rows
        if row["found"] is not None and row["true"]["kind"] in kinds and np.isfinite(row["found"][name])
    ]
    error, sigma = np.array(pairs, float).reshape(-1, 2).T
    return (np.angle(np.exp(1j * error)) if name == "bearing" else error), sigma


def recall(rows: Iterable[Row], *kinds: str) -> tuple[int, int]:
    """Return how many of the true features of some kinds were found, and how many there are."""
    hits = [row["found"] is not None for row in rows if row["true"]["kind"] in kinds]
    return sum(hits), len(hits)


def study(make: Callable[[int], dict[str, Any]], seeds: Iterable[int]) -> tuple[list[Row], list[Row]]:
    """Return the rows of `matched` over several seeds."""
    rows, false = [], []
    for seed in seeds:
        more, wrong = matched(surveyed(make, seed))
        rows += more
        false += wrong
    return rows, false


_ASKED = (
    ("joint", ("joint",), (("size", "size"), ("step_y", "offset_y"), ("step_z", "offset_z"), ("chainage", "chainage"),
                           ("kink_up", "kink_up"), ("kink_right", "kink_right"))),
    ("bump", ("dent", "deposit"), (("depth", "depth"), ("chainage", "chainage"), ("bearing", "bearing"))),
    ("lateral", ("lateral",), (("size", "size"), ("chainage", "chainage"), ("bearing", "bearing"))),
)  # fmt: skip


def main() -> None:
    """Print recall, false alarms, root mean square errors and how often 95 % intervals hold."""
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    seeds, first = (*words, 20, 0)[:2] if len(words) != 1 else (words[0], 0)
    for make in (joints, laterals, coarse, nothing):
        start = time.process_time()
        rows, false = study(make, range(first, first + seeds))
        print(f"{make.__name__}: {seeds} surveys, {time.process_time() - start:.0f} s; false: {len(false)}")
        for one in false:
            print(f"   false {one['kind']} at {one['chainage']:.3f} m, depth {1e3 * one['depth']:.1f} mm")
        for title, kinds, quantities in _ASKED:
            if not recall(rows, *kinds)[1]:
                continue
            print("  {}: {} of {} found".format(title, *recall(rows, *kinds)))
            for name, true in quantities:
                error, sigma = errors(rows, kinds, name, true)
                held = np.mean(np.abs(error) < 1.96 * sigma)
                root, bias = np.sqrt(np.mean(error**2)), error.mean()
                text = f"    {name:10s} rms {1e3 * root:7.2f}e-3  mean {1e3 * bias:6.2f}e-3"
                print(f"{text}  95 % hold {100 * held:.1f} % of {len(error)}", flush=True)


if __name__ == "__main__":
    main()
