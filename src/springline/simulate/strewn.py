"""What is strewn at random over a pipe beside what a scenario lists: laterals, deposits, cracks and stains.

All of it is drawn from the pipe's own seed, so that the same pipe can be surveyed many times.
"""

from __future__ import annotations

import numpy as np

from . import pipes
from .laying import joints, total_length

_SPARE = 0.02


def laterals(pipe: pipes.Pipe) -> list[pipes.Lateral]:
    """Return every lateral in order of chainage: those listed and the regular ones, which keep off the joints."""
    out = list(pipe.lateral)
    regular = pipe.laterals
    if regular is not None:
        rng = np.random.default_rng([pipe.seed, 2])
        first = regular.spacing if regular.first is None else regular.first
        at_joints = np.array([joint.chainage for joint in joints(pipe)])
        for nominal in np.arange(first, total_length(pipe) - 0.25 * regular.spacing, regular.spacing):
            shift = regular.spacing_sigma * float(np.clip(rng.standard_normal(), -2.0, 2.0))
            diameter, lean = float(rng.choice(regular.diameters)), float(rng.choice(regular.inclinations_deg))
            clock = float(rng.choice(regular.clocks_h)) + regular.clock_sigma_h * rng.standard_normal()
            reach = 0.5 * diameter / np.cos(np.radians(lean)) + _SPARE
            out.append(
                pipes.Lateral(
                    chainage=_clear(nominal + shift, at_joints, reach),
                    clock_h=float((clock - 1e-9) % 12.0 + 1e-9),
                    diameter=diameter,
                    inclination_deg=lean,
                    length=regular.length,
                )
            )
    return sorted(out, key=lambda one: one.chainage)


def _clear(chainage: float, at_joints: np.ndarray, reach: float) -> float:
    """Return the chainage moved off the nearest joint by `reach` [m]."""
    if not at_joints.size:
        return float(chainage)
    nearest = at_joints[np.argmin(np.abs(at_joints - chainage))]
    away = chainage - nearest
    return float(chainage if abs(away) >= reach else nearest + (reach if away >= 0.0 else -reach))


def deposits(pipe: pipes.Pipe) -> list[pipes.Patch]:
    """Return every attached deposit: those listed and those strewn."""
    rng, count, length = _strewn(pipe, "deposits", 3)
    radius = 0.5 * pipe.diameter
    strewn = (
        pipes.Patch(
            chainage=rng.uniform(0.0, length),
            clock_h=12.0 - rng.uniform(0.0, 11.9),
            depth=radius * rng.uniform(0.03, 0.12),
            length=radius * rng.uniform(0.3, 1.2),
            width_deg=rng.uniform(15.0, 50.0),
        )
        for _ in range(count)
    )
    return [*pipe.deposit, *strewn]


def cracks(pipe: pipes.Pipe) -> list[pipes.Crack]:
    """Return every crack: those listed and those strewn."""
    rng, count, length = _strewn(pipe, "cracks", 4)
    radius = 0.5 * pipe.diameter
    out = list(pipe.crack)
    for _ in range(count):
        along = rng.random() < 0.5
        out.append(
            pipes.Crack(
                chainage=rng.uniform(0.0, length),
                clock_h=12.0 - rng.uniform(0.0, 11.9),
                length=radius * rng.uniform(0.6, 3.0),
                direction_deg=float(np.clip((0.0 if along else 80.0) + 15.0 * rng.standard_normal(), -90.0, 90.0)),
                width=rng.uniform(0.001, 0.004),
            )
        )
    return out


def stains(pipe: pipes.Pipe) -> list[pipes.Stain]:
    """Return every stain: those listed and those strewn."""
    rng, count, length = _strewn(pipe, "stains", 5)
    radius = 0.5 * pipe.diameter
    strewn = (
        pipes.Stain(
            chainage=rng.uniform(0.0, length),
            clock_h=12.0 - rng.uniform(0.0, 11.9),
            length=radius * rng.uniform(0.2, 1.0),
            width_deg=rng.uniform(10.0, 60.0),
            darkness=rng.uniform(0.3, 0.75),
        )
        for _ in range(count)
    )
    return [*pipe.stain, *strewn]


def _strewn(pipe: pipes.Pipe, name: str, stream: int) -> tuple[np.random.Generator, int, float]:
    rng, length = np.random.default_rng([pipe.seed, stream]), total_length(pipe)
    return rng, int(rng.poisson(length * getattr(pipe.decoys, name))), length
