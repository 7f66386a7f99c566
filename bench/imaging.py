"""Joints and laterals of rendered surveys, found with lens and pose: recall, precision, place and size against truth.

Each survey is a 300 mm pipe with a joint every metre, a lateral every half metre, dirt, cracks, stains, deposits and
water, filmed every 100 mm at 640 by 480; the pose is known to 3 mm and 0.3 degrees. A joint found at the pipe's far
end is the end itself and counts neither way.
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np

from springline.geometry.camera import camera_at
from springline.geometry.lenses import Lens
from springline.geometry.robot import frame
from springline.imaging.reprojection import PosePrior
from springline.imaging.sightings import put_together
from springline.imaging.wall import marks_of_frame
from springline.simulate import Footage, parse, simulate

RADIUS = 0.15
CODES = {"joint": 5, "lateral": 6}  # of the simulator's features
PRIOR = PosePrior(offset=0.003, turn=math.radians(0.3))
SURE = 0.5


def scenario(seed: int, length: float) -> str:
    """The pipe as TOML: laterals of 100 to 160 mm at any clock above the water, some inclined."""
    rng = np.random.default_rng(seed)
    laterals = []
    for middle in np.arange(0.75, length - 0.6, 0.5):
        tilt = f", inclination_deg = {rng.choice([0.0, 0.0, 30.0, 45.0])}"
        clock = rng.uniform(-4.0, 4.0) % 12.0
        size = rng.uniform(100.0, 160.0)
        laterals.append(f'{{ chainage = {middle:.3f}, clock_h = {clock:.3f}, diameter = "{size:.0f}mm"{tilt} }}')
    return f"""
name = "filmed"
[pipe]
diameter = "300mm"
wall_thickness = "25mm"
seed = {seed}
run = [{{ kind = "straight", length = {length} }}]
joints = {{ spacing = 1.0, spacing_sigma = "5mm", gap = "8mm", gap_sigma = "3mm", offset_sigma = "2mm" }}
lateral = [{", ".join(laterals)}]
water = [{{ depth = "25mm" }}]
surface = {{ dirt = 0.15 }}
decoys = {{ cracks = 0.8, stains = 0.8, deposits = 0.5 }}
[robot]
length = 0.4
wheelbase = 0.3
offset_z = {{ amplitude = 0.01, period = 3.1 }}
pitch_deg = {{ amplitude = 0.8, period = 2.03 }}
yaw_deg = {{ amplitude = 1.0, period = 2.9 }}
[camera]
spacing = "100mm"
width = 640
height = 480
position = [0.2, 0.0, 0.0]
lens = {{ model = "equidistant", field_of_view_deg = 110.0 }}
"""


def filmed(seed: int, length: float) -> dict[str, object]:
    """Marks of every frame of one survey, the cameras' chainages, the truth, and the time that detection took."""
    made = parse(scenario(seed, length))
    footage, truth = Footage(made, seed=seed), simulate(made, seed=seed).truth
    lens = Lens(footage.lens.model, footage.lens.k)
    pose = footage.truth()
    rng = np.random.default_rng(seed)
    marks, spent = [], 0.0
    for k in range(len(footage)):
        picture = footage.image(k)[..., ::-1].copy()
        at = {
            name: float(pose[f"frame_{name}"][k])
            for name in ("chainage", "offset_y", "offset_z", "pitch", "yaw", "roll")
        }
        off, turn = rng.normal(0.0, PRIOR.offset, 2), rng.normal(0.0, PRIOR.turn, 3)
        tilt = np.array([at["pitch"], at["yaw"], at["roll"]]) + turn
        matrix = camera_at([at["chainage"], at["offset_y"] + off[0], at["offset_z"] + off[1]], frame(*tilt))
        start = time.process_time()
        marks += [
            (k, mark) for mark in marks_of_frame(picture, matrix, lens, footage.centre, RADIUS, RADIUS, prior=PRIOR)
        ]
        spent += time.process_time() - start
    eyes = pose["frame_chainage"].values
    return {"marks": marks, "eyes": eyes, "truth": truth, "spent": spent / len(footage), "length": length}


def compare(survey: dict[str, object], kind: str) -> tuple[list[tuple[float, float, float]], int, int]:
    """Errors (x [m], bearing [rad], size relative) of what was found, how much was false, how much missed."""
    truth = survey["truth"]
    chosen = truth["feature_kind"].values == CODES[kind]
    x, bearing, size = (truth[f"feature_{name}"].values[chosen] for name in ("chainage", "bearing", "size"))
    seen = (x > survey["eyes"][0] + 0.8 * RADIUS) & (x < survey["length"] - 0.05)
    found = [one for one in put_together(survey["marks"], survey["eyes"], RADIUS) if one.kind == kind]
    errors, false, used = [], 0, set()
    for one in found:
        if one.probability < SURE or (kind == "joint" and abs(one.x - survey["length"]) < 0.05):
            continue
        turn = (one.bearing - bearing + np.pi) % (2 * np.pi) - np.pi if kind == "lateral" else np.zeros(len(x))
        apart = np.hypot(one.x - x, RADIUS * turn)
        nearest = int(np.argmin(apart))
        if apart[nearest] < 0.06 and nearest not in used:
            used.add(nearest)
            relative = 2 * one.radius / size[nearest] - 1.0 if kind == "lateral" else math.nan
            errors.append((one.x - x[nearest], float(turn[nearest]), relative))
        else:
            false += 1
    return errors, false, len(set(np.flatnonzero(seen)) - used)


def main(surveys: int = 3, length: float = 10.0) -> None:
    """Print what stands in docs/imaging.md."""
    made = [filmed(seed, length) for seed in range(101, 101 + surveys)]
    print("| kind | there | found | false | recall | precision | x, 95 % | clock, 95 % | size, 95 % |")
    print("|---|---|---|---|---|---|---|---|---|")
    for kind in ("lateral", "joint"):
        parts = [compare(one, kind) for one in made]
        errors = np.array([error for part in parts for error in part[0]]).reshape(-1, 3)
        false, missed = sum(part[1] for part in parts), sum(part[2] for part in parts)
        hit = len(errors)
        x, turn, size = np.percentile(np.abs(errors), 95, axis=0)
        print(
            f"| {kind}s | {hit + missed} | {hit} | {false} | {hit / (hit + missed):.3f} | {hit / (hit + false):.3f} "
            f"| {1e3 * x:.0f} mm | {np.degrees(turn):.1f} degrees | {100 * size:.1f} % |"
        )
    print(f"\nDetection: {np.mean([one['spent'] for one in made]):.3f} s of processor time per frame")


if __name__ == "__main__":
    main(*(int(word) if word.isdigit() else float(word) for word in sys.argv[1:]))
