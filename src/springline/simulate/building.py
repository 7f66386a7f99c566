"""From a scenario to the pipe as built: cells, sections along them, and everything on the wall.

Runs, sags and joints are first laid end to end along the chainage and cut where anything changes; then a walker goes
along, placing each cell where the last one ended, stepping aside at a displaced joint and turning at a kinked one.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import radians, sqrt

import numpy as np

from ..conventions import bearing_from_clock
from . import pipes, strewn
from .centreline import Cell, Centreline, along, direction, level_frame
from .laying import Span, joints, spans
from .profiles import evaluate, is_constant
from .stretches import is_uniform, sections_at, stretches
from .wall import BED, DENT, DEPOSIT, WATER, Bump, Floor, Knots, Lateral, Lobe, Pipe, Roughness

KNOT_STEP = 0.02
_LEAST = 1e-9


def build_pipe(pipe: pipes.Pipe) -> Pipe:
    """Return the pipe as built."""
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
