"""The simulator's front door: a scenario in, a survey with its truth out, in memory or streamed to disk."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from importlib.metadata import version
from itertools import chain, islice
from operator import index
from pathlib import Path

import xarray as xr

from ..errors import ParameterError
from ..survey import Survey, add_assumption, save_blocks, save_survey
from ..survey.files import OwnFolder, replacing
from .camera import Footage
from .camera.outlines import outline_blocks
from .camera.writing import write_frames
from .depth import depth_cloud
from .inertial import inertial_blocks
from .reading import load
from .returning import returned, ways
from .rings import ring_blocks
from .scenario import Scenario
from .truth import pipe_truth, ties
from .world import World, set_up

_RETURN = 1 << 20
_FRAMES = OwnFolder("frames", (frozenset({"000001.jpg"}), frozenset({"000001.png"})))
"""What the seed of a way back is above that of the way out."""

Blocks = Iterator[dict[str, xr.Dataset]]

GROWING = ("ring", "ring_rear", "sample", "station", "outline", "outline_point")
"""Dims along which a survey comes in blocks; every other variable stands in one block alone."""


def simulate(scenario: str | Path | Scenario, seed: int = 0) -> Survey:
    """Return a simulated survey with its truth in `/truth`.

    Rays are cast on the true three-dimensional wall; noise, outliers and drift are drawn from `seed`, so that one
    scenario and one seed always give the same survey. What is random in the pipe itself (joints, roughness) has its
    own seed in the scenario: the same pipe can be surveyed many times. A camera's frames are listed in `/frames` and
    not made: `Footage(scenario, seed).image(k)` renders frame k, and `simulate_to` writes them all.

    Args:
        scenario: A TOML file, the name of a ready scenario (`scenarios()` lists them), or a `Scenario`.
        seed: Of the measurement's noise.

    Raises:
        InputError: There is no such scenario.
        ParameterError: The scenario is impossible; the message names key, line, value and valid range.

    >>> survey = simulate("reference-ring", seed=1)
    >>> survey.rings["range"].shape[1], survey.attrs["nominal_diameter"]
    (360, 0.3)
    """
    checked, seed = load(scenario), _whole(seed)
    if checked.robot.returns:
        out, back = ways(checked)
        return returned(out, seed, simulate(out, seed), simulate(back, seed + _RETURN))
    parts: dict[str, list[xr.Dataset]] = {}
    for block in blocks(set_up(checked, seed)):
        for name, data in block.items():
            parts.setdefault(name, []).append(data)
    return _described(Survey({name: _joined(each) for name, each in parts.items()}), checked, seed)


def simulate_to(
    path: str | Path,
    scenario: str | Path | Scenario,
    seed: int = 0,
    *,
    force: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write a simulated survey block by block: memory does not grow with the pipe's length.

    What is written is what `save_survey(simulate(scenario, seed), path)` would write; and, when the scenario has a
    camera, its frames, as pictures in a folder beside it (`frames_beside`).

    Args:
        path: A zarr folder, or a `.zarr.zip`; written whole or not at all.
        scenario: As for `simulate`.
        seed: As for `simulate`.
        force: Replace what stands at `path`.
        progress: Called after each block with the share of the way that is done, 0 to 1.

    Raises:
        OutputError: `path` exists without `force`, or the disk refuses.
    """
    checked, path, seed = load(scenario), Path(path), _whole(seed)
    if checked.robot.returns:
        save_survey(simulate(checked, seed), path, force=force)
        return path
    world = set_up(checked, seed)
    if checked.camera is None:
        return _stream(path, world, "frames", force, progress or _silent)
    beside = frames_beside(path)
    share = progress or _silent
    with replacing(beside, force=force, own=_FRAMES) as folder:
        write_frames(Footage(world), folder, progress=lambda done: share(0.9 * done))
        return _stream(path, world, beside.name, force, lambda done: share(0.9 + 0.1 * done))


def _whole(seed: int) -> int:
    """Return the seed as a plain whole number, as it is kept in the survey's provenance."""
    try:
        value = index(seed)
    except TypeError:
        value = -1
    if value < 0:
        raise ParameterError(f"{seed!r} is no seed", where="seed", expected="a whole number from 0 on")
    return value


def frames_beside(path: Path) -> Path:
    """Return the folder beside a zarr survey in which its frames lie.

    >>> frames_beside(Path("out/survey.zarr.zip")).as_posix()
    'out/survey-frames'
    """
    return path.with_name(path.name.removesuffix(".zip").removesuffix(".zarr") + "-frames")


def _silent(done: float) -> None:
    pass


def _stream(path: Path, world: World, frames_in: str, force: bool, progress: Callable[[float], None]) -> Path:
    stream = blocks(world, frames_in)
    first = next(stream)

    def rest() -> Blocks:
        for block in stream:
            yield block
            if "rings" in block:
                progress(float(block["rings"]["distance"][-1] / world.counter.reading(world.end)))

    return save_blocks(_described(Survey(first), world.scenario, world.seed), rest(), path, force=force)


def blocks(world: World, frames_in: str = "frames") -> Blocks:
    """Yield the survey's groups in blocks; the first holds a part of every group; frames lie in `frames_in`."""
    scenario = world.scenario
    stations = pipe_truth(world)
    truth = [next(stations)]
    first: dict[str, xr.Dataset] = {}
    known: Iterator[xr.Dataset] = stations
    if scenario.ties is not None:
        first["ties"], more = ties(world)
        truth.append(more)
    if scenario.camera is not None:
        footage = Footage(world)
        first["frames"] = footage.frames(frames_in)
        first["calibration"] = xr.Dataset(attrs={"lens": json.dumps({footage.camera.name: footage.lens_table()})})
        truth.append(footage.truth())
        outlines = outline_blocks(footage)
        truth += islice(outlines, 1)
        known = chain(stations, outlines)
    if scenario.depth_camera is not None:
        first["points"], more = depth_cloud(world)
        truth.append(more)
    streams = {name: ring_blocks(world, name) for name in ("rings", "rings_rear") if getattr(scenario, name)}
    if scenario.inertial is not None:
        streams["inertial"] = inertial_blocks(world)
    for name, stream in streams.items():
        first[name], more = next(stream)
        truth.append(more)
    yield first | {"truth": xr.merge(truth, combine_attrs="drop_conflicts")}
    for more in known:
        yield {"truth": more}
    for name, stream in streams.items():
        for data, more in stream:
            yield {name: data, "truth": more}


def _joined(parts: list[xr.Dataset]) -> xr.Dataset:
    """Return one dataset from blocks: growing variables end to end, the others from the block that has them."""
    seen: dict[str, list[xr.Variable]] = {}
    for part in parts:
        for name, variable in part.variables.items():
            seen.setdefault(str(name), []).append(variable)
    whole = {
        name: xr.Variable.concat(each, dim=each[0].dims[0]) if each[0].dims[0] in GROWING else each[0]
        for name, each in seen.items()
    }
    return xr.Dataset(whole, attrs=parts[0].attrs)


def _described(survey: Survey, scenario: Scenario, seed: int) -> Survey:
    pipe, robot = scenario.pipe, scenario.robot
    made = {"version": version("springline"), "scenario": scenario.name, "seed": seed, "inputs": []}
    downhill = (pipe.gradient <= 0.0) != robot.from_end
    survey = survey.with_attrs(
        name=scenario.name,
        nominal_diameter=pipe.diameter,
        wall_thickness=pipe.wall_thickness,
        material=pipe.material or None,
        direction="downstream" if downhill else "upstream",
        facing="backwards" if robot.backwards else None,
        date=scenario.date or None,
        equipment="simulated",
        provenance=json.dumps(made),
    )
    return add_assumption(survey, "The survey is simulated; its truth stands in /truth, which no stage reads.")
