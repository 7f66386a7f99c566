"""How well edge points bear out an ellipse: a likelihood ratio against the clutter just beside it.

An ellipse is (column, row, semi-major, semi-minor, angle of the major axis from the columns towards the rows) in
working pixels. Walking round it, every other pixel is a sample: a hit where an edge point lies on the curve with the
right direction and sense, a miss otherwise. Along curves a few pixels inside and outside, the same count gives the rate
of chance hits in this very neighbourhood, so that texture, roots and lettering raise the bar for themselves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.imaging.edges import EdgeField

    Array = NDArray[np.float64]

_STEP = 2.0  # px between samples
_REACH = 1.5  # px that an edge point may lie off the curve
_COSINE = 0.92  # of the angle between edge and curve
_SEEN = 0.6  # share of a real edge's samples that are hits
_CHANCE = (0.04, 0.55)  # least and most chance rate believed
_BLACK, _LIT = 10.0, 30.0  # grey level where nothing can be seen, and levels above it where all can
_BLIND = 0.3  # weight of a miss in the black
_MOST_SAMPLES = 4000
_FEWEST_SAMPLES = 12


@dataclass(frozen=True)
class Support:
    """Evidence for one ellipse.

    Attributes:
        evidence: Logarithm of the likelihood ratio; -inf where too little of it lies inside the frame.
        coverage: Share of the samples inside the frame that are hits.
        chance: Chance rate beside it.
        samples: Samples inside the frame.
        hits: Per sample round the ellipse: number of its edge point + 1, 0 for a miss, -1 outside the frame.
    """

    evidence: float
    coverage: float
    chance: float
    samples: int
    hits: NDArray[np.int64]

    @property
    def points(self) -> NDArray[np.int64]:
        """Numbers of the edge points that were hit."""
        return np.unique(self.hits[self.hits > 0]) - 1


def support(field: EdgeField, ellipse: ArrayLike, sense: float, reach: float = _REACH) -> Support:
    """Return the evidence for an ellipse.

    Args:
        field: Edge field of the frame.
        ellipse: (5,) as above.
        sense: +1 where the light rises outwards, -1 where it falls, 0 where it may do either.
        reach: How far off an edge point may lie [px].

    Returns:
        Support.
    """
    hits = np.empty(_MOST_SAMPLES, np.int64)
    shape = np.asarray(ellipse, dtype=float)
    evidence, coverage, chance, count, samples = _evidence(
        field.points,
        field.index,
        field.grey,
        field.box,
        field.seen,
        shape,
        float(sense),
        reach,
        hits,
        np.empty_like(hits),
    )
    return Support(evidence, coverage, chance, samples, hits[:count].copy())


def rank(field: EdgeField, ellipses: Array, senses: Array) -> Array:
    """Return the evidence (n) for many ellipses (n, 5) at once."""
    return _rank(field.points, field.index, field.grey, field.box, field.seen, ellipses, senses, _REACH)


@njit(cache=True)
def _rank(points, index, grey, box, seen_at, ellipses, senses, reach):
    found = np.empty(len(ellipses))
    hits = np.empty(_MOST_SAMPLES, np.int64)
    beside = np.empty(_MOST_SAMPLES, np.int64)
    for k in range(len(ellipses)):
        found[k] = _evidence(points, index, grey, box, seen_at, ellipses[k], senses[k], reach, hits, beside)[0]
    return found


@njit(cache=True)
def _evidence(points, index, grey, box, seen_at, ellipse, sense, reach, hits, beside):
    found, samples, count = _count(points, index, box, seen_at, ellipse, 0.0, sense, reach, hits)
    if samples < _FEWEST_SAMPLES:
        return -np.inf, 0.0, 0.0, count, samples
    chance, counted = 0.05, 0.5
    for offset in (-13.0, -10.0, -7.0, 7.0, 10.0, 13.0):
        if ellipse[3] + offset < 4.0:
            continue
        others, there, _ = _count(points, index, box, seen_at, ellipse, offset, sense, reach, beside)
        if there > 5:
            chance += others / there
            counted += 1.0
    chance = min(max(chance / counted, _CHANCE[0]), _CHANCE[1])
    seen = max(_SEEN, chance + 0.02)
    hit, miss = math.log(seen / chance), math.log((1.0 - seen) / (1.0 - chance))
    total = 0.0
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    for k in range(count):
        if hits[k] > 0:
            total += hit
        elif hits[k] == 0:
            turn = 2.0 * math.pi * k / count
            u, v = ellipse[2] * math.cos(turn), ellipse[3] * math.sin(turn)
            column = min(max(int(ellipse[0] + cos * u - sin * v), 0), grey.shape[1] - 1)
            row = min(max(int(ellipse[1] + sin * u + cos * v), 0), grey.shape[0] - 1)
            total += miss * min(max((grey[row, column] - _BLACK) / _LIT, _BLIND), 1.0)
    return total, found / samples, chance, count, samples


@njit(cache=True)
def _count(points, index, box, seen_at, ellipse, offset, sense, reach, hits):
    """Hits and samples inside the frame along the curve `offset` outside the ellipse, and all samples round it."""
    major, minor = ellipse[2], ellipse[3]
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    round_it = math.pi * (3.0 * (major + minor) - math.sqrt((3.0 * major + minor) * (major + 3.0 * minor)))
    count = min(int(round_it / _STEP) + 1, len(hits))
    samples = found = 0
    for k in range(count):
        turn = 2.0 * math.pi * k / count
        u, v = major * math.cos(turn), minor * math.sin(turn)
        normal_u, normal_v = minor * math.cos(turn), major * math.sin(turn)
        length = math.hypot(normal_u, normal_v)
        normal_u, normal_v = normal_u / length, normal_v / length
        u, v = u + offset * normal_u, v + offset * normal_v
        x, y = ellipse[0] + cos * u - sin * v, ellipse[1] + sin * u + cos * v
        out_x, out_y = cos * normal_u - sin * normal_v, sin * normal_u + cos * normal_v
        hits[k] = -1
        if x < box[0] or x > box[1] or y < box[2] or y > box[3] or not seen_at[round(y), round(x)]:
            continue
        samples += 1
        hits[k] = 0
        nearest = reach + 0.5
        for step in range(-int(reach) - 1, int(reach) + 2):
            column, row = round(x + step * out_x), round(y + step * out_y)
            if column < 0 or row < 0 or column >= index.shape[1] or row >= index.shape[0]:
                continue
            point = index[row, column]
            if point < 0:
                continue
            rises = points[point, 2] * out_x + points[point, 3] * out_y
            if (abs(rises) if sense == 0.0 else sense * rises) < _COSINE:
                continue
            off = abs((points[point, 0] - x) * out_x + (points[point, 1] - y) * out_y)
            if off < nearest:
                nearest = off
                hits[k] = 1 + point
        if hits[k] > 0:
            found += 1
    return found, samples, count
