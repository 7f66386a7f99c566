"""Simulated repeat inspections with rings: one pipe, two robots that weave, roll and slip each in its own way."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np

import springline as sl
from springline.compare import KINDS, FeatureList, feature_list
from springline.simulate import parse, simulate

if TYPE_CHECKING:
    from springline.survey import Survey

_JOINT, _LATERAL = 5, 6
_SCENARIO = """
name = "pipe {seed}"
[pipe]
diameter = "300mm"
seed = {seed}
run = [{{ kind = "straight", length = {length} }}]
roughness = {{ rms = "{rms}mm" }}
joints = {{ spacing = 2.5, spacing_sigma = "8mm", gap = "8mm" }}
lateral = [{laterals}]
dent = [{dents}]
[robot]
from_end = {from_end}
start = {start}
offset_y = {{ amplitude = 0.003, period = 5.1 }}
yaw_deg = {{ amplitude = {yaw}, period = 3.3 }}
roll_deg = {{ mean = {roll}, amplitude = 2.0, period = 7.3, phase_deg = {phase} }}
[rings]
spacing = "{spacing}mm"
bearings = 360
noise = "{noise}mm"
[odometer]
scale_error = {scale}
{slips}
"""


@dataclass(frozen=True)
class Run:
    """One inspection and the truth about it: chainage along the pipe by its counter, and the features it listed."""

    result: Survey
    counter: np.ndarray
    true: np.ndarray
    features: FeatureList

    def at(self, true: np.ndarray) -> np.ndarray:
        """Return the counter's reading at true chainage; NaN where it was not."""
        order = np.argsort(self.true)
        return np.interp(true, self.true[order], self.counter[order], left=np.nan, right=np.nan)

    def place(self, counter: np.ndarray) -> np.ndarray:
        """Return the true chainage at a reading of the counter."""
        return np.interp(counter, self.counter, self.true)


def repeat(
    seed: int,
    *,
    length: float = 30.0,
    rms: float = 0.3,
    spacing: float = 10.0,
    noise: float = 1.0,
    slips: bool = True,
    other_end: bool | None = None,
    dents: str = "",
    lateral_every: float = 8.0,
) -> tuple[Run, Run]:
    """Return two inspections of one pipe; `dents` (TOML tables) are in the second alone."""
    rng = np.random.default_rng(seed)
    at = np.arange(2.0, length - 1.0, lateral_every) + rng.uniform(
        -1.0, 1.0, len(np.arange(2.0, length - 1.0, lateral_every))
    )
    clocks = rng.choice([2.0, 10.0, 11.0], at.size)
    laterals = ", ".join(
        f'{{ chainage = {x:.3f}, clock_h = {c}, diameter = "100mm" }}' for x, c in zip(at, clocks, strict=True)
    )
    turned = bool(rng.random() < 0.5) if other_end is None else other_end
    runs = []
    for epoch in range(2):
        slip = f"slip = [{{ chainage = {rng.uniform(4.0, length - 4.0):.3f}, extra = {rng.uniform(0.05, 0.2):.3f} }}]"
        from_end = bool(epoch and turned)
        text = _SCENARIO.format(
            seed=seed, length=length, rms=rms, spacing=spacing, noise=noise, laterals=laterals,
            dents=dents if epoch else "", from_end=str(from_end).lower(), start=round(0.3 + rng.uniform(0.0, 1.5), 3),
            yaw=rng.uniform(0.0, 1.5), roll=rng.uniform(-4.0, 4.0), phase=rng.uniform(0.0, 360.0),
            scale=rng.normal(0.0, 0.007), slips=slip if slips else "",
        )  # fmt: skip
        survey = simulate(parse(text), seed=10 * seed + epoch)
        counter, true = survey.rings["distance"].values, survey.truth["ring_chainage"].values
        true = length - true if from_end else true
        runs.append(Run(sl.inspect(survey), counter, true, _listed(rng, survey)))
    return runs[0], runs[1]


def _listed(rng: np.random.Generator, survey: Survey) -> FeatureList:
    """Return joints and laterals as a coder with 10 mm of noise lists them, one in ten missed."""
    counter, travelled = survey.rings["distance"].values, survey.truth["ring_chainage"].values
    kind = survey.truth["feature_kind"].values
    x, theta = survey.truth["feature_chainage"].values, survey.truth["feature_bearing"].values
    passed = (x > travelled[0]) & (x < travelled[-1])
    wanted = np.isin(kind, (_JOINT, _LATERAL)) & passed & (rng.random(x.size) > 0.1)
    places = np.interp(x[wanted], travelled, counter) + rng.normal(0.0, 0.01, wanted.sum())
    bearing = np.where(kind[wanted] == _LATERAL, theta[wanted], np.nan)
    rank = np.argsort(places)
    names = np.where(kind[wanted] == _JOINT, KINDS[0], KINDS[1])[rank]
    places = np.clip(places[rank], counter[0], counter[-1])
    return feature_list(places, names.astype(object), bearing=bearing[rank], extent=(counter[0], counter[-1]))


def off(found: object, a: Run, b: Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return error of the chainage in B [m], its sigma, and whether the relief placed it and nothing is flagged."""
    x = a.counter[20:-20:5]
    y = b.at(a.place(x))
    there = np.isfinite(y)
    place, sigma = found.at(x[there])
    fine = found.reliable(x[there]) & found.refined_at(x[there])
    return place - y[there], sigma, fine


def again(name: str, seed: int) -> tuple[Survey, Survey]:
    """Return two inspections of the pipe of a ready scenario: its robot sways and rolls in another phase, its odometer
    has another scale, its readings are others; the camera is left at home."""
    rng = np.random.default_rng(seed)
    text = (files("springline") / "simulate" / "scenarios" / f"{name}.toml").read_text(encoding="utf-8")
    text = re.sub(r"\[camera\]\n.*?(?=\n\[|\Z)", "", text, flags=re.DOTALL)
    if "[odometer]" not in text:
        text += "\n[odometer]\nscale_error = 0.0\n"
    if "roll_deg" not in text:
        text = text.replace("[robot]\n", "[robot]\nroll_deg = { mean = 0.0, amplitude = 2.0, period = 7.3 }\n")
    results = []
    for epoch in range(2):
        phase, scale, roll = rng.uniform(0.0, 360.0), rng.normal(0.0, 0.007), rng.uniform(-4.0, 4.0)
        own = re.sub(r"((?:offset_[yz]|\w+_deg) = \{ [^}]*period = [0-9.]+)", rf"\1, phase_deg = {phase:.1f}", text)
        own = re.sub(r"scale_error = [-0-9.]+", f"scale_error = {scale:.5f}", own)
        own = own.replace("mean = 0.0, amplitude = 2.0", f"mean = {roll:.2f}, amplitude = 2.0")
        results.append(sl.inspect(simulate(parse(own), seed=1000 * seed + epoch)))
    return results[0], results[1]
