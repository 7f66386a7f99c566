"""Runs, sags and joints laid end to end along the chainage, before anything is placed in space."""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, radians

import numpy as np

from ..conventions import bearing_from_clock
from . import pipes

_LEAST = 1e-9


@dataclass(frozen=True)
class Span:
    """A stretch of constant curvature; `towards` is the bearing of its centre where its run begins."""

    start: float
    length: float
    curvature: float = 0.0
    towards: float = 0.0
    run: int = 0

    @property
    def end(self) -> float:
        """Chainage at its end [m]."""
        return self.start + self.length


TOWARDS = {"right": 0.0, "up": 0.5 * np.pi, "left": np.pi, "down": 1.5 * np.pi}


def spans(pipe: pipes.Pipe) -> list[Span]:
    """Return the pipe's runs, sags cut into them, end to end from chainage 0."""
    out: list[Span] = []
    here = 0.0
    for run in pipe.run:
        if isinstance(run, pipes.Bend):
            at = TOWARDS[run.towards] if isinstance(run.towards, str) else bearing_from_clock(run.towards)
            length = run.radius * radians(run.angle_deg)
            out.append(Span(here, length, 1.0 / run.radius, at, len(out)))
            here += length
            continue
        end = here + run.length
        for sag in sorted(pipe.sag, key=lambda sag: sag.chainage):
            first = sag.chainage - 0.5 * sag.length
            if not here - _LEAST <= first <= end:
                continue
            if first > here + _LEAST:
                out.append(Span(here, first - here, run=len(out)))
            down, up = TOWARDS["down"], TOWARDS["up"]
            if sag.depth < 0.0:
                down, up = up, down
            bend = _sag_curvature(sag.length, abs(sag.depth))
            here = first
            for share, at in ((0.25, down), (0.5, up), (0.25, down)):
                out.append(Span(here, share * sag.length, bend, at, len(out)))
                here = out[-1].end
        if end > here + _LEAST:
            out.append(Span(here, end - here, run=len(out)))
            here = end
    return out


def _sag_curvature(length: float, depth: float) -> float:
    """Return the curvature of arcs of length/4, length/2, length/4, alternately curved, that dip by `depth`.

    Each quarter turns by k length/4 and drops (1 - cos)/k; two quarters make the depth. Solved for k by iteration.
    """
    k = 16.0 * depth / length**2
    for _ in range(50):
        turn = acos(max(-1.0, 1.0 - 0.5 * k * depth))
        k = 4.0 * turn / length
    return k


def total_length(pipe: pipes.Pipe) -> float:
    """Return the pipe's length [m] along its axis."""
    return spans(pipe)[-1].end


def joints(pipe: pipes.Pipe) -> list[pipes.Joint]:
    """Return every joint in order: those listed, and the regular ones with their random part drawn."""
    listed = list(pipe.joint)
    regular = pipe.joints
    if regular is None:
        return sorted(listed, key=lambda joint: joint.chainage)
    rng = np.random.default_rng([pipe.seed, 1])
    end = total_length(pipe)
    first = regular.spacing if regular.first is None else regular.first
    out = listed
    for nominal in np.arange(first, end - 0.25 * regular.spacing, regular.spacing):
        shift, gap, dy, dz, up, right = rng.standard_normal(6)
        if any(abs(joint.chainage - nominal) < 0.25 * regular.spacing for joint in listed):
            continue
        out = [
            *out,
            pipes.Joint(
                chainage=float(nominal + regular.spacing_sigma * np.clip(shift, -3.0, 3.0)),
                gap=max(0.0, regular.gap + regular.gap_sigma * gap),
                offset_y=regular.offset_sigma * dy,
                offset_z=regular.offset_sigma * dz,
                kink_up_deg=regular.kink_sigma_deg * up,
                kink_right_deg=regular.kink_sigma_deg * right,
            ),
        ]
    return sorted(out, key=lambda joint: joint.chainage)
