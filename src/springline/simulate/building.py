"""From a scenario to the pipe as built: cells, sections along them, and everything on the wall.

Runs, sags and joints are first laid end to end along the chainage and cut where anything changes; then a walker goes
along, placing each cell where the last one ended, stepping aside at a displaced joint and turning at a kinked one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import acos, radians, sqrt

import numpy as np

from ..conventions import bearing_from_clock
from . import pipes
from .centreline import Cell, Centreline, along, direction, level_frame
from .profiles import evaluate, is_constant
from .stretches import is_uniform, sections_at, stretches
from .wall import BED, DENT, DEPOSIT, WATER, Bump, Floor, Knots, Lateral, Lobe, Pipe, Roughness

KNOT_STEP = 0.02
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


def build_pipe(pipe: pipes.Pipe) -> Pipe:
    """Return the pipe as built."""
    from . import strewn

    laid = spans(pipe)
    length = laid[-1].end
    all_joints = joints(pipe)
    whole = stretches(pipe, length)
    cells = _walk(pipe, laid, all_joints, [one.start for one in whole])
    return Pipe(
        Centreline(cells),
        [_knots(pipe, cell, whole) for cell in cells],
        0.5 * pipe.diameter,
        bumps=[_bump(one, DENT) for one in pipe.dent] + [_bump(one, DEPOSIT) for one in strewn.deposits(pipe)],
        floors=[_floor(one, BED, length) for one in pipe.bed] + [_floor(one, WATER, length) for one in pipe.water],
        lobes=[
            Lobe(
                one.start, one.end, bearing_from_clock(one.clock_h), one.depth, radians(one.width_deg), one.power,
                one.ramp, varying=one.form == "varying",
            )
            for one in pipe.lobe
        ],
        laterals=[
            Lateral(
                one.chainage, bearing_from_clock(one.clock_h), 0.5 * one.diameter, radians(one.inclination_deg),
                one.protrusion, one.wall_thickness, one.length,
            )
            for one in strewn.laterals(pipe)
        ],
        roughness=Roughness()
        if pipe.roughness is None
        else Roughness(pipe.roughness.rms, pipe.roughness.along, pipe.roughness.around, pipe.seed),
        orders=tuple(harmonic.order for harmonic in pipe.harmonic),
    )  # fmt: skip


def _walk(pipe: pipes.Pipe, laid: list[Span], all_joints: list[pipes.Joint], breaks: list[float]) -> list[Cell]:
    """Return the cells: spans cut at joints' edges and at breaks, each placed where the last one ended."""
    length = laid[-1].end
    edges = {j.chainage + side * j.gap for j in all_joints for side in (-0.5, 0.5)}
    cuts = sorted({0.0, length, *(s.end for s in laid), *breaks, *edges})
    cuts = [a for a, b in zip(cuts, [*cuts[1:], np.inf], strict=True) if b - a > _LEAST and a < length] + [length]
    point, frame = np.array(pipe.start, float), level_frame(direction(radians(pipe.heading_deg), pipe.gradient))
    cells: list[Cell] = []
    run, inward = -1, frame[1]
    for start, end in pairwise(cuts):
        middle = 0.5 * (start + end)
        span = next(s for s in laid if s.start <= middle <= s.end)
        if span.run != run:
            run, inward = span.run, np.cos(span.towards) * frame[2] + np.sin(span.towards) * frame[1]
        gap = next((j for j in all_joints if abs(middle - j.chainage) < 0.5 * j.gap), None)
        at = float(np.arctan2(inward @ frame[1], inward @ frame[2]))
        cell = Cell(start, end - start, span.curvature, at, point, frame)
        if gap is not None:
            cell = replace(cell, groove=pipe.wall_thickness, joint=True)
        cells.append(cell)
        point, tangent = along(cell, cell.length)
        turn = span.curvature * cell.length
        inward = np.cos(turn) * inward - np.sin(turn) * frame[0]
        joint = next((j for j in all_joints if abs(j.chainage + 0.5 * j.gap - end) < 10.0 * _LEAST), None)
        if joint is not None:
            point, tangent, inward = _past(joint, point, tangent, inward)
        frame = level_frame(tangent)
    return cells


def _past(joint: pipes.Joint, point: np.ndarray, tangent: np.ndarray, inward: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return where the next pipe starts and points after a joint's offset and kink."""
    frame = level_frame(tangent)
    point = point + joint.offset_y * frame[1] + joint.offset_z * frame[2]
    turned = frame[0] + np.tan(radians(joint.kink_up_deg)) * frame[1] + np.tan(radians(joint.kink_right_deg)) * frame[2]
    turned = turned / sqrt(turned @ turned)
    inward = inward - (inward @ turned) * turned
    return point, turned, inward / sqrt(inward @ inward)


def _knots(pipe: pipes.Pipe, cell: Cell, whole: list[pipes.Stretch]) -> Knots:
    middle = cell.chainage + 0.5 * cell.length
    one = next(s for s in whole if s.start <= middle <= s.end)
    steady = is_uniform(one) and all(is_steady(harmonic) for harmonic in pipe.harmonic)
    count = 1 if steady else 1 + max(1, int(np.ceil(cell.length / KNOT_STEP)))
    at = np.linspace(cell.chainage, cell.end, count)
    return Knots(sections_at(pipe, one, at), harmonics_at(pipe, at))


def harmonics_at(pipe: pipes.Pipe, chainage: np.ndarray) -> np.ndarray:
    """Return cosine and sine amplitudes [m] (k, harmonics, 2) of the pipe's harmonics at chainages (k,)."""
    out = np.zeros((len(chainage), len(pipe.harmonic), 2))
    for k, harmonic in enumerate(pipe.harmonic):
        phase = harmonic.order * radians(harmonic.phase_deg)
        amplitude = evaluate(harmonic.amplitude, chainage)
        out[:, k, 0], out[:, k, 1] = amplitude * np.cos(phase), amplitude * np.sin(phase)
    return out


def is_steady(harmonic: pipes.Harmonic) -> bool:
    """Return whether a harmonic's amplitude is the same everywhere."""
    return is_constant(harmonic.amplitude)


def _bump(one: pipes.Patch, kind: int) -> Bump:
    return Bump(one.chainage, bearing_from_clock(one.clock_h), one.depth, one.length, radians(one.width_deg), kind)


def _floor(one: pipes.Level, kind: int, length: float) -> Floor:
    # A level without an end runs on beyond the pipe's, so that it does not fade out there.
    start = -10.0 * one.ramp if one.start is None else one.start
    end = length + 10.0 * one.ramp if one.end is None else one.end
    return Floor(start, end, one.depth, one.ramp, kind)
