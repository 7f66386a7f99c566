"""Joints and laterals of rendered surveys against truth: by rings, by chosen frames with them, by frames alone.

The ready scenario `sewer` (201 m, 60 laterals, 200 joints, frames of 640 by 480 every 200 mm, rings every 10 mm whose
tilt and roll nothing tells) and the same with another pipe, another seed of what is strewn in it and of the noise.
Everything goes the way of a real survey: it is written, read and inspected; where only chosen frames are asked for,
frames are rendered when they are. Chainage is compared by the counter, whose own scale is off by 0.2 %. A joint at the
pipe's far end is the end itself and counts neither way.

    python -m bench imaging                               the ready scenario, all rows: about 12 minutes of one core
    python -m bench.imaging 219 --rows rings chosen       another pipe, two rows: about 90 s
    python -m bench.imaging 219 --folder DIR              its frames kept in DIR for the next time
"""

from __future__ import annotations

import argparse
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING
from unittest.mock import patch

import numpy as np

import springline as sl
from springline.config import Config, DetectConfig
from springline.geometry.camera import camera_at
from springline.geometry.robot import frame
from springline.imaging.frames import read_frame
from springline.imaging.reprojection import PosePrior
from springline.imaging.sightings import put_together
from springline.imaging.wall import marks_of_frame
from springline.pipeline import inspect
from springline.simulate import Footage, load, simulate
from springline.simulate.camera.writing import write_frames
from springline.simulate.truth import feature_table
from springline.stages.images import images
from springline.stages.images.alone import images_alone
from springline.stages.images.filmed import filmed
from springline.survey import Survey

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from springline.simulate.scenario import Scenario

READY = 17  # seed of the ready scenario's pipe
CODES = {"lateral": 6, "joint": 5}  # of the simulator's features
GIVEN = PosePrior(offset=0.003, turn=np.radians(0.3))
NEAR = 0.06  # m on the wall within which something found is what is there
ROWS = ("rings", "chosen", "every", "given", "alone")
NAMES = {
    "rings": "rings alone",
    "chosen": "rings, chosen frames",
    "every": "rings, every frame",
    "given": "every frame, pose to 3 mm and 0.3 degrees, no rings",
    "alone": "every frame, no scan at all",
}


def sewer(pipe_seed: int, *, inertial: bool = False) -> Scenario:
    """Return the ready scenario with another pipe, and with an inertial log like that of `weaving` where asked for."""
    scenario = load("sewer")
    changed = {"pipe": scenario.pipe.model_copy(update={"seed": pipe_seed})}
    if inertial:
        changed["inertial"] = load("weaving").inertial
    return scenario.model_copy(update=changed)


def rendered(scenario: Scenario, seed: int, folder: Path) -> Footage:
    """Write the survey with its frames into a folder, unless it stands there."""
    footage = Footage(scenario, seed)
    if not (folder / "survey.toml").exists():
        sl.write(simulate(scenario, seed), folder, format="folder")
        write_frames(footage, folder / "frames")
    return footage


@contextmanager
def as_asked(footage: Footage, read: bool) -> Iterator[None]:
    """Let frames be rendered when they are asked for, unless they are to be read."""

    def each_frame(names: Iterable[str], folder: str = ".") -> Iterator[tuple[int, np.ndarray]]:
        for index, name in enumerate(names):
            yield index, footage.image(int(Path(name).stem) - 1)[..., ::-1].copy()

    if read:
        yield
    else:
        with patch("springline.imaging.moving.each_frame", each_frame):
            yield


class Truth:
    """What is in the pipe, by the counter.

    Args:
        footage: Of the pipe.
    """

    def __init__(self, footage: Footage) -> None:
        world = footage.world
        table = feature_table(world)
        ahead = footage.camera.position[0]
        self.radius = 0.5 * world.scenario.pipe.diameter
        self.end = float(world.counter.reading(world.route.length - ahead)) + ahead
        x = world.counter.reading(table["chainage"] - ahead) + ahead
        self.kinds = {
            kind: tuple(values[table["kind"] == code] for values in (x, table["bearing"], table["size"]))
            for kind, code in CODES.items()
        }

    def errors(self, kind: str, found: list[tuple[float, float, float, float]]) -> tuple[np.ndarray, int, int]:
        """Return errors of chainage [m], bearing [rad] and size of what was found, and how much was false and missed.

        Args:
            kind: joint or lateral.
            found: Chainage, bearing, size and confidence of each.
        """
        x, bearing, size = self.kinds[kind]
        errors, false, used = [], 0, set()
        for one in sorted(found, key=lambda one: -one[3]):
            if kind == "joint" and abs(one[0] - self.end) < 0.1:
                continue
            turn = (one[1] - bearing + np.pi) % (2 * np.pi) - np.pi if kind == "lateral" else np.zeros(len(x))
            apart = np.hypot(one[0] - x, self.radius * turn)
            nearest = int(np.argmin(apart))
            if apart[nearest] < NEAR and nearest not in used:
                used.add(nearest)
                errors.append((one[0] - x[nearest], turn[nearest], one[2] / size[nearest] - 1.0))
            else:
                false += 1
        return np.array(errors).reshape(-1, 3), false, len(x) - len(used)


def listed(result: Survey) -> dict[str, list[tuple[float, float, float, float]]]:
    """Return what `/features` holds, by kind; chainage by the counter, where stations tell what it read."""
    features = result.features
    x = features["chainage"].values
    if result.has("section"):
        place, distance = (result.section[name].values for name in ("chainage", "distance"))
        beyond = x - np.clip(x, place[0], place[-1])
        x = np.interp(x, place, distance) + beyond + float(result.rings.attrs.get("position_x", 0.0))
    by_kind: dict[str, list[tuple[float, float, float, float]]] = {kind: [] for kind in CODES}
    rows = zip(x, *(features[name].values for name in ("bearing", "size", "confidence")), strict=True)
    for kind, row in zip(features["kind"].values.astype(str), rows, strict=True):
        if kind in by_kind:
            by_kind[kind].append(tuple(map(float, row)))
    return by_kind


def by_given_pose(survey: Survey, footage: Footage, seed: int) -> dict[str, list[tuple[float, float, float, float]]]:
    """Return what every frame shows, its true pose off by as much as `GIVEN` says."""
    film, truth, rng = filmed(survey), footage.truth(), np.random.default_rng(seed)
    radius = 0.5 * footage.world.scenario.pipe.diameter
    eyes = film.distance + footage.camera.position[0]
    marks = []
    for k, path in enumerate(film.paths):
        off, turn = rng.normal(0.0, GIVEN.offset, 2), rng.normal(0.0, GIVEN.turn, 3)
        y, z, *tilt = (float(truth[f"frame_{n}"][k]) for n in ("offset_y", "offset_z", "pitch", "yaw", "roll"))
        matrix = camera_at([eyes[k], y + off[0], z + off[1]], frame(*(np.array(tilt) + turn)))
        camera = film.cameras[k]
        seen = marks_of_frame(
            read_frame(Path(film.folder) / path), matrix, camera.lens, camera.centre, radius, radius, prior=GIVEN
        )
        marks += [(k, mark) for mark in seen.marks]
    sightings = [one for one in put_together(marks, eyes, radius) if one.probability >= 0.5]
    return {
        kind: [(o.x, o.bearing, 2 * o.radius, o.probability) for o in sightings if o.kind == kind] for kind in CODES
    }


def study(scenario: Scenario, seed: int, folder: Path, rows: tuple[str, ...]) -> None:
    """Print a table of one pipe."""
    written = folder.exists() or bool({"every", "given", "alone"} & set(rows))
    footage = rendered(scenario, seed, folder) if written else Footage(scenario, seed)
    truth, survey = Truth(footage), sl.read(folder) if written else simulate(scenario, seed)
    base = None
    if {"rings", "chosen", "every"} & set(rows):
        scan = {name: survey.group(name) for name in ("rings", "inertial") if survey.has(name)}
        base = inspect(Survey(scan, survey.attrs), Config())
    jointly = base is not None and np.isfinite(base.pose["roll"].values).any()
    pose = ", poses by the joint estimate" if jointly else ""
    print(f"\nPipe {scenario.pipe.seed}, noise {seed}, {len(footage)} frames{pose}\n")
    print("| by | kind | there | found | false | recall | precision | x, 95 % | clock, 95 % | size, 95 % | frames |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        start = time.process_time()
        with as_asked(footage, read=written):
            found, looked = _found(row, base, survey, footage, seed)
        spent = time.process_time() - start
        for kind in CODES:
            errors, false, missed = truth.errors(kind, found[kind])
            hit = len(errors)
            x, turn, size = np.percentile(np.abs(errors), 95, axis=0) if hit else (np.nan,) * 3
            places = f"{1e3 * x:.0f} mm | " + (
                f"{np.degrees(turn):.1f} degrees | {100 * size:.1f} %" if kind == "lateral" else "|"
            )
            print(
                f"| {NAMES[row]} | {kind}s | {hit + missed} | {hit} | {false} | {hit / (hit + missed):.3f} "
                f"| {hit / max(hit + false, 1):.3f} | {places} | {looked} |",
                flush=True,
            )
        print(f"<!-- {NAMES[row]}: {spent:.0f} s of processor time -->", flush=True)


def _found(row: str, base: Survey | None, survey: Survey, footage: Footage, seed: int):
    if row == "rings":
        return listed(base), "0 %"
    if row == "given":
        return by_given_pose(survey, footage, seed), "100 %"
    if row == "alone":
        alone = Survey({"frames": survey.frames, "calibration": survey.calibration}, survey.attrs)
        return listed(images_alone(alone, Config())), "100 %"
    filled = base.with_group("frames", survey.frames).with_group("calibration", survey.calibration)
    result = images(filled, Config(detect=DetectConfig(every_frame=row == "every")))
    told = [one for one in result.assumptions if "frames were looked at" in one]
    looked, _, of = told[0].split()[:3] if told else ("0", "", "1")
    return listed(result), f"{100 * int(looked) / int(of):.1f} %"


def main() -> None:
    """Print what stands in docs/imaging.md, of the ready scenario."""
    with tempfile.TemporaryDirectory() as folder:
        study(sewer(READY), 0, Path(folder) / "sewer", ROWS)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("pipe", type=int, nargs="?", default=READY, help="seed of the pipe")
    parser.add_argument("--noise", type=int, default=0, help="seed of the measurement")
    parser.add_argument("--folder", type=Path, help="where the survey is written, or stands")
    parser.add_argument("--rows", nargs="+", choices=ROWS, default=ROWS)
    parser.add_argument("--inertial", action="store_true", help="with an inertial log, so that poses are estimated")
    given = parser.parse_args()
    wanted = sewer(given.pipe, inertial=given.inertial)
    with tempfile.TemporaryDirectory() as temporary:
        study(wanted, given.noise, given.folder or Path(temporary) / "sewer", tuple(given.rows))
