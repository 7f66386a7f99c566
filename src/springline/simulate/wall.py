"""The true wall as plain arrays, ready for the ray-casting kernel.

The wall's radius about the axis at chainage s and bearing theta is that of the section at s (blended between section
knots), plus harmonics, the groove of an open joint and roughness; then lobes, dents and attached deposits push it
inwards, and beds of sediment and water cut it off at a level. Laterals are tubes in the Earth frame.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .centreline import Cell, Centreline
from .sections import PIECE, Section

WALL, WATER, BED, DEPOSIT, DENT, JOINT, LATERAL, NOTHING, CRACK, STAIN = range(10)
HIT_KINDS = ("wall", "water", "bed", "deposit", "dent", "joint", "lateral", "nothing", "crack", "stain")
"""What a ray met, by its code; cracks and stains are on the wall, and a camera alone sees them."""

BUMP, FLOOR, LOBE, VARYING_LOBE = range(4)


CELL = np.dtype(
    [
        ("origin", "f8", 3),
        ("x", "f8", 3),
        ("y", "f8", 3),
        ("z", "f8", 3),
        ("chainage", "f8"),
        ("curvature", "f8"),
        ("inward_y", "f8"),
        ("inward_z", "f8"),
        ("groove", "f8"),
        ("gap", "?"),
        ("plane", "f8", 4),
        ("first", "i8"),
        ("count", "i8"),
        ("step", "f8"),
        ("around", "f8"),
        ("ahead", "f8"),
    ]
)
"""One cell: start and frame, curvature and where its centre lies, groove and whether it is a joint's gap, the plane
that ends it, its section knots (first, count, step), and bounds on how fast the wall comes closer (around, ahead)."""

FEATURE = np.dtype(
    [("form", "i8"), ("first", "f8"), ("last", "f8"), ("kind", "u1")]
    + [(name, "f8") for name in ("bearing", "half", "depth", "ramp", "power")]
)
"""One feature: its form, chainages at which it begins and ends, what a ray that meets it is told, and its shape."""

TUBE = np.dtype(
    [("mouth", "f8", 3), ("axis", "f8", 3)] + [(name, "f8") for name in ("inner", "outer", "start", "end", "chainage")]
)
"""One lateral: middle of its mouth, unit axis outwards, radii, and where along its axis it starts and ends."""

RELIEF = np.dtype([("rms", "f8"), ("along", "f8"), ("around", "f8"), ("seed", "u8")])
"""The roughness: rms, lattice step along the pipe, lattice points around it, seed."""


class Wall(NamedTuple):
    """Arrays of the wall, as the kernels read them: records of the types above, and sections piece by piece."""

    cells: np.ndarray
    pieces: np.ndarray
    orders: np.ndarray
    harmonics: np.ndarray
    features: np.ndarray
    feature_from: np.ndarray
    feature_of: np.ndarray
    laterals: np.ndarray
    roughness: np.ndarray


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

    `pieces` (knots, pieces, 7) holds the sections of all cells' knots, padded with pieces that start at infinity;
    `harmonics` (knots, orders, 2) their Fourier amplitudes. `feature_of` lists the features of each cell, those of cell
    k from `feature_from[k]` to `feature_from[k + 1]`.
    """
    counts = np.array([len(k.sections.pieces) for k in pipe.knots])
    firsts = np.cumsum(counts) - counts
    pieces = np.full((counts.sum(), max(k.sections.pieces.shape[1] for k in pipe.knots), PIECE), np.inf)
    harmonics = np.zeros((counts.sum(), len(pipe.orders), 2))
    for first, knots in zip(firsts, pipe.knots, strict=True):
        count, width = knots.sections.pieces.shape[:2]
        pieces[first : first + count, :width] = knots.sections.pieces
        if knots.harmonics is not None:
            harmonics[first : first + count] = knots.harmonics
    features = _features(pipe)
    members = [_near(features, cell) for cell in pipe.centreline.cells]
    return Wall(
        _cells(pipe, firsts, counts, features, members),
        pieces,
        np.array(pipe.orders, np.float64),
        harmonics,
        features,
        np.concatenate([[0], np.cumsum([len(m) for m in members])]).astype(np.int64),
        np.concatenate(members).astype(np.int64),
        _laterals(pipe),
        _relief(pipe),
    )


def _near(features: np.ndarray, cell: Cell) -> np.ndarray:
    """Return the features that stand in a cell; in a joint's gap, only water and beds go on."""
    there = (features["first"] < cell.end) & (features["last"] > cell.chainage)
    return np.flatnonzero(there & ((features["form"] == FLOOR) | (not cell.joint)))


def _cells(
    pipe: Pipe, firsts: np.ndarray, counts: np.ndarray, features: np.ndarray, members: list[np.ndarray]
) -> np.ndarray:
    rows = []
    for k, cell in enumerate(pipe.centreline.cells):
        inward = np.sin(cell.towards), np.cos(cell.towards)
        step = cell.length / max(counts[k] - 1, 1)
        bounds = _slopes(pipe, k, features[members[k]])
        place = (cell.origin, *cell.frame, cell.chainage, cell.curvature, *inward, cell.groove, cell.joint)
        rows.append((*place, pipe.centreline.planes[k], firsts[k], counts[k], step, *bounds))
    return np.array(rows, CELL)


def _features(pipe: Pipe) -> np.ndarray:
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
        (VARYING_LOBE if o.varying else LOBE, o.start, o.end, WALL, o.bearing, 0.5 * o.width, o.depth, o.ramp, o.power)
        for o in pipe.lobes
    ]
    rows += [(FLOOR, f.start, f.end, f.kind, 0, 0, f.depth, f.ramp, 0) for f in pipe.floors]
    return np.array(rows, FEATURE)


def _relief(pipe: Pipe) -> np.ndarray:
    rough = pipe.roughness
    around = max(4.0, np.round(2.0 * np.pi * pipe.radius / rough.around))
    return np.array([(rough.rms, rough.along, around, rough.seed)], RELIEF)


def _slopes(pipe: Pipe, k: int, features: np.ndarray) -> tuple[float, float]:
    """Return bounds on how fast the gap to cell k's wall closes: per metre sideways, and per metre ahead.

    Sideways it is the length of the gradient of h - rho in the section's plane, ahead the wall's slope along the pipe.
    """
    theta = np.linspace(0.0, 2.0 * np.pi, 721)
    rough, knots = pipe.roughness, pipe.knots[k]
    stack = knots.sections.pieces
    radii = np.array([Section(one).radius(theta) for one in stack[:: max(1, len(stack) // 8)]])
    around = 4.0 * rough.rms / rough.around + float(np.max(np.abs(np.gradient(radii, theta, axis=1)) / radii))
    ahead = 4.0 * rough.rms / rough.along
    if len(stack) > 1:
        # The section may change fastest between the samples: twice what they show, and more where they show none.
        length = pipe.centreline.cells[k].length
        ahead += 2.0 * float(np.max(np.abs(np.diff(radii, axis=0)), initial=0.0)) / length + 0.05
    if knots.harmonics is not None and knots.harmonics.size:
        size = np.abs(knots.harmonics).sum(axis=2).max(axis=0)
        around += float(np.sum(size * np.array(pipe.orders)) / pipe.radius)
    cell = pipe.centreline.cells[k]
    for row in features:
        depth, ramp = row["depth"], row["ramp"]
        level = row["first"] + ramp <= cell.chainage and row["last"] - ramp >= cell.end
        if row["form"] == FLOOR:
            ahead += 1.5 * depth / ramp if ramp > 0.0 and not level else 0.0
            continue
        steep = 0.5 * np.pi * max(1.0, 0.5 * row["power"]) * depth
        reach = 0.5 * (row["last"] - row["first"]) if row["form"] == BUMP else ramp
        around += steep / (row["half"] * (pipe.radius - depth))
        ahead += steep / reach if reach > 0.0 and (row["form"] == BUMP or not level) else 0.0
    return 1.02 * float(np.hypot(1.0, around)), float(ahead)


def _laterals(pipe: Pipe) -> np.ndarray:
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
        rows.append((mouth, axis, one.radius, one.radius + one.wall, -one.protrusion, one.length, one.chainage))
    return np.array(rows, TUBE)
