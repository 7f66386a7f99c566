"""The built-in survey: 30 m of 300 mm pipe, small enough to ship, with everything in it that the main job must meet.

python -m springline.simulate.builtin OUT.zarr.zip
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from .attitude import in_pipe
from .cast import cast_rays, radius_of_wall
from .centreline import Cell, Centreline, direction, level_frame
from .sections import ellipse_major, mode
from .wall import DENT as DENT_HIT
from .wall import HIT_KINDS, JOINT, WATER, Bump, Floor, Knots, Lateral, Pipe, Roughness, build
from .wall import LATERAL as LATERAL_HIT

if TYPE_CHECKING:
    from ..survey import Survey

LENGTH, RADIUS, WALL_THICKNESS = 30.0, 0.15, 0.0085
NOISE, TICK = 0.0005, 5e-5
SPACING, BEARINGS = 0.015, 360
JOINTS = (3.0, 6.0, 9.0, 12.0, 15.0, 18.0, 21.0, 24.0, 27.0)
OPEN_JOINT, OPEN_GAP, OPEN_STEP = 15.0, 0.040, 0.006
JOINT_GAP = 0.006
DENT = Bump(chainage=20.4, bearing=np.radians(60.0), depth=0.018, length=0.5, width=np.radians(70.0))
LATERAL = Lateral(chainage=10.5, bearing=np.radians(30.0), radius=0.05, length=0.8)
WATER_DEPTH, WATER_RETURNS = 0.022, 0.6
OUTLIERS, DROPOUT, SCALE_ERROR, ODOMETER_SCALE = 0.01, 0.02, 0.0, 0.003


def severity(chainage: np.ndarray | float) -> np.ndarray:
    """Return the severity s1 of the mode 1 ellipse along the pipe: sound at first, worst near 23 m.

    >>> bool(severity(0.0) > 0.99 > 0.955 > severity(23.0) > 0.94)
    True
    """
    s = np.asarray(chainage, float)
    return 0.995 - 0.045 * np.exp(-(((s - 23.0) / 5.0) ** 2)) - 0.006 * (1.0 + np.sin(2.0 * np.pi * s / 7.0)) / 2.0


def pipe() -> Pipe:
    """Return the pipe: straight, falling by 1 %, heading north-east, jointed every 3 m."""
    cells: list[Cell] = []
    frame = level_frame(direction(np.radians(45.0), -0.01))
    point, chainage = np.zeros(3), 0.0
    for joint in (*JOINTS, LENGTH):
        gap = {OPEN_JOINT: OPEN_GAP, LENGTH: 0.0}.get(joint, JOINT_GAP)
        length = joint - 0.5 * gap - chainage
        cells.append(Cell(chainage, length, 0.0, 0.0, point, frame))
        point, chainage = point + length * frame[0], chainage + length
        if gap:
            cells.append(Cell(chainage, gap, 0.0, 0.0, point, frame, groove=WALL_THICKNESS, joint=True))
            step = OPEN_STEP if joint == OPEN_JOINT else 0.0
            point, chainage = point + gap * frame[0] - step * frame[1], chainage + gap
    knots = [
        Knots(
            [
                mode(1, RADIUS, float(severity(s)))
                for s in np.linspace(c.chainage, c.end, 1 + max(1, round(c.length / 0.05)))
            ]
        )
        for c in cells
    ]
    return Pipe(
        Centreline(cells),
        knots,
        RADIUS,
        bumps=[DENT],
        floors=[Floor(-1.0, LENGTH + 1.0, WATER_DEPTH, ramp=0.1, kind=WATER)],
        laterals=[LATERAL],
        roughness=Roughness(rms=0.0002, along=0.02, around=0.02, seed=3),
    )


def pose(chainage: np.ndarray) -> dict[str, np.ndarray]:
    """Return offsets [m] and attitude [rad] of a robot that weaves and points where it goes."""
    u, v = 2.0 * np.pi / 5.3, 2.0 * np.pi / 8.1
    return {
        "offset_y": 0.004 + 0.003 * np.sin(v * chainage + 1.0),
        "offset_z": 0.012 * np.sin(u * chainage),
        "pitch": np.arctan(0.003 * v * np.cos(v * chainage + 1.0)) + np.radians(0.4) * np.sin(3.1 * chainage),
        "yaw": np.arctan(0.012 * u * np.cos(u * chainage)) + np.radians(0.3),
        "roll": np.radians(2.0) * np.sin(u * chainage + 0.6),
    }


def survey(seed: int = 2026) -> Survey:
    """Return the built-in survey, always the same for one seed."""
    from ..survey import Survey

    rng = np.random.default_rng(seed)
    built = pipe()
    wall, axis = build(built), built.centreline
    distance = np.arange(0.05, (LENGTH - 0.05) * (1.0 + ODOMETER_SCALE), SPACING)
    chainage = distance / (1.0 + ODOMETER_SCALE)
    point, frame = axis.at(chainage)
    here = pose(chainage)
    origin = point + here["offset_y"][:, None] * frame[:, 1] + here["offset_z"][:, None] * frame[:, 2]
    robot = in_pipe(here["pitch"], here["yaw"], here["roll"]) @ frame
    bearing = np.arange(BEARINGS) * (2.0 * np.pi / BEARINGS)
    rays = np.cos(bearing)[:, None] * robot[:, None, 2] + np.sin(bearing)[:, None] * robot[:, None, 1]
    true, kind, _ = cast_rays(wall, origin, axis.find(origin, chainage), rays, 3.0)
    stations = np.arange(0.0, LENGTH + 0.025, 0.05)
    theta = np.arange(360) * (2.0 * np.pi / 360)
    s1 = severity(stations)
    rings = xr.Dataset(
        {
            "range": (("ring", "bearing"), _readings(true, kind, rng).astype(np.float32)),
            "bearing": ("bearing", bearing),
            "distance": ("ring", distance),
            "time": ("ring", 5.0 + chainage / 0.1),
        },
        attrs={
            "referred_to": "sensor",
            "distance_source": "odometer",
            "sensor_kind": "ring-laser",
            "bearing_zero": "right",
            "bearing_sense": "ccw",
            "bearing_assumed": 0,
            "range_noise": NOISE,
        },
    )
    truth = xr.Dataset(
        {
            "ring_chainage": ("ring", chainage),
            **{name: ("ring", value) for name, value in here.items()},
            "hit": (("ring", "bearing"), kind),
            "chainage": ("station", stations),
            "s1": ("station", s1),
            "semi_major": ("station", np.array([ellipse_major(RADIUS, s) for s in s1])),
            "semi_minor": ("station", s1 * RADIUS),
            "wall_bearing": ("wall_bearing", theta),
            "wall_radius": (
                ("station", "wall_bearing"),
                radius_of_wall(wall, axis.index(stations), stations, theta).astype(np.float32),
            ),
            **_features(),
        },
        attrs={"hit_kinds": " ".join(HIT_KINDS), "odometer_scale": ODOMETER_SCALE, "range_scale": SCALE_ERROR},
    )
    attrs = {
        "name": "Built-in survey: manhole A to manhole B",
        "nominal_diameter": 2.0 * RADIUS,
        "wall_thickness": WALL_THICKNESS,
        "material": "PVC-U",
        "direction": "downstream",
        "date": "2026-01-15",
        "equipment": "simulated ring laser",
    }
    return Survey({"rings": rings, "truth": truth}, attrs)


def _readings(true: np.ndarray, kind: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return what the scanner reports: noise, outliers, dropouts, and water that often swallows the light."""
    reading = true + NOISE * rng.standard_normal(true.shape)
    stray = rng.random(true.shape) < OUTLIERS
    reading[stray] *= rng.uniform(0.5, 1.3, int(stray.sum()))
    lost = rng.random(true.shape) < DROPOUT
    lost |= (kind == WATER) & (rng.random(true.shape) > WATER_RETURNS)
    reading[lost] = np.nan
    return np.round(reading / TICK) * TICK


def _features() -> dict[str, tuple[str, list]]:
    """Return what stands on the wall; its kind by the code that a ray which meets it has."""
    rows = [(JOINT, s, np.nan, np.nan, OPEN_GAP if s == OPEN_JOINT else JOINT_GAP, WALL_THICKNESS) for s in JOINTS]
    rows.append((LATERAL_HIT, LATERAL.chainage, LATERAL.bearing, 2 * LATERAL.radius, 2 * LATERAL.radius, np.nan))
    rows.append((DENT_HIT, DENT.chainage, DENT.bearing, DENT.width * RADIUS, DENT.length, -DENT.depth))
    rows.sort(key=lambda row: row[1])
    names = ("kind", "chainage", "bearing", "size", "length", "depth")
    return {f"feature_{n}": ("feature", [row[k] for row in rows]) for k, n in enumerate(names)}


def main(path: str | Path) -> None:
    """Write the built-in survey to `path`."""
    from ..survey import save_survey

    save_survey(survey(), path, force=True)


if __name__ == "__main__":
    main(sys.argv[1])
