"""Search for a pipe in a cloud: cylinders through pairs of oriented points, ranked by the wall that they explain.

Schnabel's random-sample cylinder (two points with normals), made scale-free: normals are taken at three sizes of
neighbourhood and the score counts cells of wall in units of the radius, so no unit, density or diameter is needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.axis._support import support
from springline.geometry.axis.cylinder import WINDOW, Cylinder, refine

if TYPE_CHECKING:
    from numpy.typing import NDArray

_THINNED = 60_000
_SAMPLE = 600_000
_SEEDS, _PAIRS = (3000, 12000), (6, 16)
"""Oriented points and partners of each: of a first search, and of a harder one."""
_REACH, _FAR = 256, 0.3
"""Nearest oriented points among which a partner is drawn, and the share of pairs drawn from all."""
_MOST = 12_000
"""Hypotheses that are scored at most, drawn at random."""
_NEIGHBOURS = (16, 64, 256)
_SCREEN = 4000
"""Points on which every hypothesis is scored; the best are scored on all the thinned points."""
_SHORTLIST, _FINALISTS = (80, 300), (16, 60)
_LEAST_ARC = 10, 6
"""Sectors of 6 degrees that must show wall, of a first search and of a harder one."""
_CLEAR_SHARE, _CLEAR_SCORE = 2.0 / 3.0, 100.0
_FACING, _ALONG = 0.9, 0.35
"""Cosines that tell a wall that faces the axis, and a surface that runs along it."""
_COARSE, _FINE = 0.08, 0.04
"""Half thickness of the wall while searching and while judging, in radii."""


@dataclass(frozen=True)
class Found:
    """The best cylinder of a search.

    Attributes:
        cylinder: It.
        score: Cells of wall (0.15 radii by 6 degrees) times `share`, over six radii of its length.
        share: Wall among the cells in which points lie, in [0, 1]: near 1 in a clean pipe.
        spread: One-sigma of the radius's logarithm among the cylinders that explain at least half as much: near 0
            when the points leave no choice.
    """

    cylinder: Cylinder
    score: float
    share: float
    spread: float

    @property
    def clear(self) -> bool:
        """Whether there is no doubt which points are of the wall."""
        return self.share >= _CLEAR_SHARE and self.score >= _CLEAR_SCORE


def find_cylinder(
    points: NDArray[np.float64], *, looking: bool = False, hard: bool = False, seed: int = 0
) -> Found | None:
    """Return the cylinder that explains the most wall, or None when no two oriented points make one.

    Args:
        points: (point, 3) in any frame and unit.
        looking: Whether a sensor at the origin, inside the pipe, took the points looking along +x: then only cylinders
            that hold the origin, run within 60 degrees of +x and are no wider than four times the distance to the
            nearest points are considered.
        hard: Whether to search harder, for clouds of which little is wall.
        seed: Of the random sample; the same points and seed give the same cylinder.

    Source: Schnabel, Wahl, Klein, Efficient RANSAC for point-cloud shape detection (2007), section 4.1, for the
    cylinder of two oriented points.

    >>> s, t = np.meshgrid(np.linspace(0, 2, 60), np.linspace(0, 2 * np.pi, 60))
    >>> wall = np.column_stack([s.ravel(), 0.2 * np.sin(t.ravel()), 0.2 * np.cos(t.ravel())])
    >>> found = find_cylinder(wall)
    >>> round(found.cylinder.radius, 3), np.abs(found.cylinder.direction).round(3)
    (0.2, array([1., 0., 0.]))
    """
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(seed)
    points = thin(points, _THINNED, rng)
    if len(points) < 4 * _NEIGHBOURS[0]:
        return None
    tree = cKDTree(points)
    seeds = points[rng.choice(len(points), min(_SEEDS[hard], len(points)), replace=False)]
    hypotheses = [
        _hypotheses(seeds, _normals(points, tree, seeds, k), _PAIRS[hard], rng)
        for k in _NEIGHBOURS
        if k <= len(points) // 4
    ]
    cylinders = tuple(np.concatenate(part) for part in zip(*hypotheses, strict=True))
    if looking:
        widest = 4.0 * float(np.quantile(np.linalg.norm(points, axis=1), 0.02))
        cylinders = _take(cylinders, _looks_through(*cylinders, widest))
    drawn = rng.permutation(len(cylinders[2]))[:_MOST]
    cylinders = _take(cylinders, drawn)
    for sample, count in ((points[rng.permutation(len(points))[:_SCREEN]], _SHORTLIST), (points, _FINALISTS)):
        score, _ = _score(sample, cylinders, _COARSE, _LEAST_ARC[hard])
        cylinders = _take(cylinders, np.argsort(-score, kind="stable")[: count[hard]])
    refined = [refine(points, Cylinder(*one)) for one in zip(*cylinders, strict=True)]
    refined = [one for one in refined if one is not None]
    if not refined:
        return None
    cylinders = tuple(np.array([getattr(one, name) for one in refined]) for name in ("point", "direction", "radius"))
    score, share = _score(points, cylinders, _FINE, _LEAST_ARC[hard])
    if looking:
        score = np.where(_looks_through(*cylinders, widest), score, 0.0)
    best = int(np.argmax(score))
    if not score[best] > 0.0:
        return None
    found = Found(refined[best], float(score[best]), float(share[best]), 0.0)
    if not found.clear and (oval := refine(points, found.cylinder, oval=True)):
        found_oval = Found(oval, *judge(points, oval), 0.0)
        if found_oval.clear:
            return found_oval
    rivals = np.where(score >= 0.5 * score[best], score, 0.0)
    spread = np.sqrt(np.average(np.log(cylinders[2] / cylinders[2][best]) ** 2, weights=rivals))
    return replace(found, spread=float(spread))


def judge(points: NDArray[np.float64], cylinder: Cylinder) -> tuple[float, float]:
    """Return the score and the share of a cylinder, as in `Found`.

    Args:
        points: (point, 3), evenly spread over the surface.
        cylinder: It.
    """
    arrays = cylinder.point[None], cylinder.direction[None], np.array([cylinder.radius]), cylinder.oval[None]
    score, share = _score(points, arrays, _FINE, 0)
    return float(score[0]), float(share[0])


def side_walls(points: NDArray[np.float64], cylinder: Cylinder, *, seed: int = 0) -> float:
    """Return the share of smooth surface near a cylinder that runs along it and yet is not its wall.

    Near 0 in a pipe, however noisy: there, what is not wall is an end or noise. A duct or a room has side walls.

    Args:
        points: (point, 3), evenly spread over the surface.
        cylinder: It.
        seed: Of the sample.
    """
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(seed)
    seeds = points[rng.choice(len(points), min(_SEEDS[0], len(points)), replace=False)]
    normals = _normals(points, cKDTree(points), seeds, min(_NEIGHBOURS[1], len(points)))
    offset = seeds - cylinder.point
    along = offset @ cylinder.direction
    radial = offset - along[:, None] * cylinder.direction
    rho = np.linalg.norm(radial, axis=1)
    near = (np.abs(along) < WINDOW * cylinder.radius) & (rho < 2.0 * cylinder.radius) & np.isfinite(normals[:, 0])
    faces = np.abs(np.einsum("ij,ij->i", normals, radial)) > _FACING * rho
    wall = faces & (np.abs(rho / cylinder.radius - 1.0) < _COARSE)
    side = near & ~wall & (np.abs(normals @ cylinder.direction) < _ALONG)
    return float(side.sum() / max(1, near.sum()))


def thin(points: NDArray[np.float64], count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return about `count` of the points, one per cube of a lattice, so that they are even over the surface.

    Args:
        points: (point, 3); fewer than `count` come back as they are.
        count: How many at most.
        rng: Draws the first sample from very large clouds.
    """
    if len(points) > _SAMPLE:
        points = points[np.sort(rng.choice(len(points), _SAMPLE, replace=False))]
    if len(points) <= count:
        return points
    low, high = np.quantile(points, (0.02, 0.98), axis=0)
    size = float(np.max(high - low)) / np.sqrt(count)
    kept = points
    for _ in range(8):
        index = np.floor((points - points.min(axis=0)) / size).astype(np.int64)
        # Cells further than 2^20 from the corner share a key with others: stray points only.
        key = (index[:, 0] << 42) ^ (index[:, 1] << 21) ^ index[:, 2]
        first = np.unique(key, return_index=True)[1]
        kept = points[np.sort(first)]
        if 0.7 * count <= len(kept) <= count:
            break
        size *= np.sqrt(len(kept) / (0.85 * count))
    return kept[:: -(-len(kept) // count)]


def _normals(points: NDArray, tree, seeds: NDArray, k: int) -> NDArray[np.float64]:
    """Return the unit normal at each seed from its k neighbours; NaN where they do not lie in a sheet."""
    near = points[tree.query(seeds, k=k)[1]]
    near = near - near.mean(axis=1, keepdims=True)
    spread, directions = np.linalg.eigh(np.einsum("nki,nkj->nij", near, near))
    normals = directions[:, :, 0]
    sheet = spread[:, 0] < 0.15 * spread[:, 1]
    return np.where(sheet[:, None], normals, np.nan)


def _hypotheses(
    seeds: NDArray, normals: NDArray, pairs: int, rng: np.random.Generator
) -> tuple[NDArray, NDArray, NDArray]:
    """Return centres, directions and radii of the cylinders through pairs of oriented points."""
    from scipy.spatial import cKDTree

    good = np.isfinite(normals[:, 0])
    seeds, normals = seeds[good], normals[good]
    if len(seeds) < 2:
        return np.empty((0, 3)), np.empty((0, 3)), np.empty(0)
    reach = min(len(seeds), _REACH)
    neighbours = cKDTree(seeds).query(seeds, k=reach)[1]
    # Partners near and far alike: a pair is best about a radius apart, and the radius is not known.
    rank = np.minimum((reach ** rng.random((len(seeds), pairs))).astype(np.int64), reach - 1)
    first = np.repeat(np.arange(len(seeds)), pairs)
    second = np.take_along_axis(neighbours, rank, axis=1).ravel()
    far = rng.random(len(second)) < _FAR
    second[far] = rng.integers(0, len(seeds), int(far.sum()))
    axis = np.cross(normals[first], normals[second])
    size = np.linalg.norm(axis, axis=1)
    keep = size > 0.2
    first, second, axis = first[keep], second[keep], axis[keep] / size[keep, None]
    step = seeds[second] - seeds[first]
    # Both normals run through the axis: solve p + a m = q + b n in the plane across the axis.
    across_first, across_second = np.cross(axis, normals[first]), np.cross(axis, normals[second])
    scale = np.einsum("ij,ij->i", normals[first], across_second)
    a = np.einsum("ij,ij->i", step, across_second) / scale
    b = np.einsum("ij,ij->i", step, across_first) / scale
    radius = 0.5 * (np.abs(a) + np.abs(b))
    centre = seeds[first] + a[:, None] * normals[first]
    centre += 0.5 * np.einsum("ij,ij->i", step, axis)[:, None] * axis
    even = np.abs(np.abs(a) - np.abs(b)) < 0.2 * radius
    return centre[even], axis[even], radius[even]


def _looks_through(centres: NDArray, directions: NDArray, radii: NDArray, widest: float) -> NDArray[np.bool_]:
    """Whether each cylinder holds the origin, runs within 60 degrees of +x and is no wider than `widest`."""
    holds = np.linalg.norm(np.cross(centres, directions), axis=1) < radii
    return holds & (np.abs(directions[:, 0]) > 0.5) & (2.0 * radii <= widest)


def _take(cylinders: tuple[NDArray, ...], which: NDArray) -> tuple[NDArray, ...]:
    return tuple(part[which] for part in cylinders)


def _score(
    points: NDArray, cylinders: tuple[NDArray, ...], tolerance: float, least_arc: int
) -> tuple[NDArray, NDArray]:
    """Return the scores and the shares of cylinders: centres, directions, radii, and ovals unless circular."""
    score, share = np.empty(len(cylinders[2])), np.empty(len(cylinders[2]))
    if len(cylinders) == 3:
        cylinders = (*cylinders, np.zeros_like(cylinders[1]))
    arrays = (np.ascontiguousarray(array, dtype=np.float64) for array in (points, *cylinders))
    support(*arrays, WINDOW, tolerance, least_arc, score, share)
    return score, share
