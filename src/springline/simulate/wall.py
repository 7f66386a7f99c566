"""The true wall as plain arrays, ready for the ray-casting kernel.

The wall's radius about the axis at chainage s and bearing theta is that of the section at s (blended between section
knots), plus harmonics, the groove of an open joint and roughness; then lobes, dents and attached deposits push it
inwards, and beds of sediment and water cut it off at a level. Laterals are tubes in the Earth frame.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .centreline import Centreline
from .sections import PIECE, Section

WALL, WATER, BED, DEPOSIT, DENT, JOINT, LATERAL, NOTHING = range(8)
HIT_KINDS = ("wall", "water", "bed", "deposit", "dent", "joint", "lateral", "nothing")
"""What a ray met, by its code."""

BUMP, FLOOR, LOBE, VARYING_LOBE = range(4)


class Wall(NamedTuple):
    """Arrays of the wall; see `build` for what stands where."""

    cells: np.ndarray
    knots: np.ndarray
    pieces: np.ndarray
    orders: np.ndarray
    harmonics: np.ndarray
    features: np.ndarray
    feature_from: np.ndarray
    feature_of: np.ndarray
    laterals: np.ndarray
    roughness: np.ndarray
    seed: np.uint64


@dataclass(frozen=True)
class Knots:
    """Sections of one cell at equal steps of chainage, (knots, n, 7): one knot = constant along the cell."""

    sections: Section
    harmonics: np.ndarray | None = None
    """Cosine and sine amplitudes [m], (knots, orders, 2)."""


@dataclass(frozen=True)
class Bump:
    """A dent or an attached deposit, deepest in its middle and gone, with its slope, at its edges.

    `depth` [m] is inward; `length` [m] and `width` [rad] are whole extents.
    """

    chainage: float
    bearing: float
    depth: float
    length: float
    width: float
    kind: int = DENT


@dataclass(frozen=True)
class Floor:
    """Water or a bed of sediment: level, `depth` [m] above the invert, with smooth `ramp` [m] at both ends."""

    start: float
    end: float
    depth: float
    ramp: float
    kind: int = WATER


@dataclass(frozen=True)
class Lobe:
    """A liner's lobe: the wall drawn inwards by depth cos^power over `width` [rad], with `ramp` [m] at both ends."""

    start: float
    end: float
    bearing: float
    depth: float
    width: float
    power: float
    ramp: float
    varying: bool = False
    """Whether it is the varying-amplitude lobe, `depth` then being the host's radius less that at its middle."""


@dataclass(frozen=True)
class Lateral:
    """A round connection: a tube whose axis meets the wall at `chainage` and `bearing`.

    `lean` [rad] tips it forward along travel, `protrusion` [m] is how far its end stands into the pipe, `wall` [m] its
    own thickness, `length` [m] how far it can be seen into.
    """

    chainage: float
    bearing: float
    radius: float
    lean: float = 0.0
    protrusion: float = 0.0
    wall: float = 0.005
    length: float = 1.0


@dataclass(frozen=True)
class Roughness:
    """A stationary random relief of the wall of `rms` [m] and correlation lengths [m] along and around."""

    rms: float = 0.0
    along: float = 0.02
    around: float = 0.02
    seed: int = 0


@dataclass
class Pipe:
    """A pipe as built: its axis, the sections along each cell and everything on its wall."""

    centreline: Centreline
    knots: list[Knots]
    radius: float
    bumps: list[Bump] = field(default_factory=list)
    floors: list[Floor] = field(default_factory=list)
    lobes: list[Lobe] = field(default_factory=list)
    laterals: list[Lateral] = field(default_factory=list)
    roughness: Roughness = field(default_factory=Roughness)
    orders: tuple[int, ...] = ()


def build(pipe: Pipe) -> Wall:
    """Return the arrays of a pipe's wall.

    `cells` holds per row: origin 0-2, frame 3-11, chainage 12, length 13, curvature 14, inward y and z 15-16, groove
    17, knot step 18, bounds on closing speed 19 and 25, end plane 20-23, joint flag 24. `knots` holds first knot and
    count per cell; `pieces` (knot, piece, 7) the sections, padded with pieces that start at infinity.
    """
    cells = pipe.centreline.cells
    counts = [len(k.sections.pieces) for k in pipe.knots]
    firsts = np.cumsum([0, *counts[:-1]])
    pieces = np.full((sum(counts), max(k.sections.pieces.shape[1] for k in pipe.knots), PIECE), np.inf)
    for first, knots in zip(firsts, pipe.knots, strict=True):
        count, width = knots.sections.pieces.shape[:2]
        pieces[first : first + count, :width] = knots.sections.pieces
    none = (np.zeros((count, len(pipe.orders), 2)) for count in counts)
    harmonics = [n if k.harmonics is None else k.harmonics for k, n in zip(pipe.knots, none, strict=True)]
    features = _features(pipe)
    starts, members = [0], []
    for cell in cells:
        near = [
            k
            for k, row in enumerate(features)
            if row[1] < cell.end and row[2] > cell.chainage and (row[0] == FLOOR or not cell.joint)
        ]
        members.extend(near)
        starts.append(len(members))
    table = np.zeros((len(cells), 26))
    for k, (cell, count) in enumerate(zip(cells, counts, strict=True)):
        table[k, :12] = [*cell.origin, *cell.frame.ravel()]
        table[k, 12:17] = [
            cell.chainage, cell.length, cell.curvature, np.sin(cell.towards), np.cos(cell.towards),
        ]  # fmt: skip
        table[k, 17:19] = cell.groove, cell.length / max(count - 1, 1)
        table[k, 20:24] = pipe.centreline.planes[k]
        table[k, 24] = cell.joint
    table[:, [19, 25]] = _slopes(pipe, features, starts, members)
    return Wall(
        table,
        np.column_stack([firsts, counts]).astype(np.int64),
        pieces,
        np.array(pipe.orders, np.float64),
        np.concatenate(harmonics),
        features,
        np.array(starts, np.int64),
        np.array(members, np.int64),
        _laterals(pipe),
        np.array(
            [
                pipe.roughness.rms,
                pipe.roughness.along,
                max(4.0, np.round(2.0 * np.pi * pipe.radius / pipe.roughness.around)),
            ]
        ),
        np.uint64(pipe.roughness.seed),
    )


def _features(pipe: Pipe) -> np.ndarray:
    """Return rows: form, first and last chainage, hit kind, then the form's own numbers."""
    rows = [
        (
            BUMP,
            b.chainage - 0.5 * b.length,
            b.chainage + 0.5 * b.length,
            b.kind,
            b.bearing,
            0.5 * b.width,
            b.depth,
            0,
            0,
        )
        for b in pipe.bumps
    ]
    rows += [
        (
            VARYING_LOBE if one.varying else LOBE,
            one.start,
            one.end,
            WALL,
            one.bearing,
            0.5 * one.width,
            one.depth,
            one.ramp,
            one.power,
        )
        for one in pipe.lobes
    ]
    rows += [(FLOOR, f.start, f.end, f.kind, 0, 0, f.depth, f.ramp, 0) for f in pipe.floors]
    return np.array(rows, float).reshape(-1, 9)


def _slopes(pipe: Pipe, features: np.ndarray, starts: list[int], members: list[int]) -> np.ndarray:
    """Return bounds (cells, 2) on how fast the gap to the wall closes: per metre sideways, and per metre ahead.

    Sideways it is the length of the gradient of h - rho in the section's plane, ahead the wall's slope along the pipe.
    """
    theta = np.linspace(0.0, 2.0 * np.pi, 721)
    cells = pipe.centreline.cells
    rough = 4.0 * pipe.roughness.rms / np.array([pipe.roughness.around, pipe.roughness.along])
    out = []
    for k, knots in enumerate(pipe.knots):
        stack = knots.sections.pieces
        radii = np.array([Section(one).radius(theta) for one in stack[:: max(1, len(stack) // 8)]])
        slope = rough.copy()
        slope[0] += float(np.max(np.abs(np.gradient(radii, theta, axis=1)) / radii))
        if len(stack) > 1:
            # The section may change fastest between the samples: twice what they show, and more where they show none.
            slope[1] += 2.0 * float(np.max(np.abs(np.diff(radii, axis=0)), initial=0.0)) / cells[k].length + 0.05
        if knots.harmonics is not None and knots.harmonics.size:
            size = np.abs(knots.harmonics).sum(axis=2).max(axis=0)
            slope[0] += float(np.sum(size * np.array(pipe.orders)) / pipe.radius)
        for n in members[starts[k] : starts[k + 1]]:
            slope += _slope(features[n], pipe.radius)
        out.append([1.02 * np.hypot(1.0, slope[0]), slope[1]])
    return np.array(out)


def _slope(row: np.ndarray, radius: float) -> np.ndarray:
    """Return the steepest slope around and along of one feature."""
    form, first, last, _, _, half, depth, ramp, power = row
    if form == FLOOR:
        return np.array([0.0, 1.5 * depth / ramp if ramp > 0.0 else 0.0])
    steep = 0.5 * np.pi * max(1.0, 0.5 * power) * depth
    reach = 0.5 * (last - first) if form == BUMP else ramp
    return np.array([steep / (half * (radius - depth)), steep / reach if reach > 0.0 else 0.0])


def _laterals(pipe: Pipe) -> np.ndarray:
    """Return rows by chainage: mouth 0-2, axis 3-5, radius, outer radius, first and last place on it, chainage."""
    rows = []
    for one in sorted(pipe.laterals, key=lambda lateral: lateral.chainage):
        point, frame = pipe.centreline.at(one.chainage)
        radial = np.cos(one.bearing) * frame[2] + np.sin(one.bearing) * frame[1]
        axis = np.cos(one.lean) * radial + np.sin(one.lean) * frame[0]
        k = int(pipe.centreline.index(one.chainage))
        stack, cell = pipe.knots[k].sections.pieces, pipe.centreline.cells[k]
        share = (one.chainage - cell.chainage) / cell.length
        section = Section(stack[round(share * (len(stack) - 1))])
        mouth = point + float(section.radius(one.bearing)) * radial
        rows.append([*mouth, *axis, one.radius, one.radius + one.wall, -one.protrusion, one.length, one.chainage])
    return np.array(rows, float).reshape(-1, 11)
