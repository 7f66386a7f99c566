"""Marks found on the unrolled wall of a whole survey: where joints, openings and bumps may be.

Arrays in, a list of `Seen` out. Distances are those of the rings, bearings run from +z counter-clockwise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .chance import confidence, robust_sigma, threshold
from .regions import regions, runs
from .steps import jumps, peaks
from .wallmap import confirmed, lasting_shape, smoothed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from .wallmap import WallMap

_LONGEST_GROOVE = 0.5
_BRIDGED = 0.03
_LONGEST_OPENING = 3.0
_WIDEST_OPENING = np.radians(190.0)
_FOOT = 0.2
_LOWEST = -np.cos(np.radians(20.0))
_WIDEST_BUMP = np.radians(200.0)
_LEAST_OPEN = 6
_BLIND = 0.3
_PARTLY = 0.05
_MOSTLY = 0.6
_ROUND = 0.6
_WIDE = 0.2
_SHORT = 0.5
_HALF = 0.5
_LEAST_STEP = 0.008


class Seen(NamedTuple):
    """One mark: what it may be, where, how large, and which rings show it.

    Attributes:
        kind: joint, lateral or inward.
        first_ring, last_ring: Rings that show it.
        bearing: Of its middle [rad]; NaN for what goes all round.
        span: Arc that it takes [rad].
        depth: Most that it stands outward (positive) or inward (negative) [m]; NaN when unseen.
        score: In sigmas of what chance shows.
        probability: That it is there.
    """

    kind: str
    first_ring: int
    last_ring: int
    bearing: float
    span: float
    depth: float
    score: float
    probability: float


class Rings(NamedTuple):
    """What is known of each ring.

    Attributes:
        distance: (ring,) increasing [m].
        centre: (ring, 2) centre_z, centre_y of its own fit [m]; NaN = not known.
        radius: (ring,) mean radius of its own fit [m]; NaN = not known.
        offset: (ring,) mean of how far those of its readings stand out that do [m]; 0 where none does.
        outside: (ring, sector) whether most readings of an arc stand out.
        known: (ring, sector) whether the arc has readings.
        diameter: Typical diameter [m].
    """

    distance: NDArray[np.float64]
    centre: NDArray[np.float64]
    radius: NDArray[np.float64]
    offset: NDArray[np.float64]
    outside: NDArray[np.bool_]
    known: NDArray[np.bool_]
    diameter: float


def find_grooves(rings: Rings) -> list[Seen]:
    """Return the open joints: short runs of rings that between them stand out all round.

    A tilted ring enters a gap bit by bit, and one that is tilted by more than the gap never lies in it as a whole.
    """
    share = rings.outside.mean(axis=1)
    spacing = float(np.median(np.diff(rings.distance))) if len(share) > 1 else rings.diameter
    bridge = max(1, round(_BRIDGED * rings.diameter / spacing))
    longest = _LONGEST_GROOVE * rings.diameter
    stretches = []
    for first, last in runs(share > _PARTLY, bridge=bridge).tolist():
        if rings.distance[last] - rings.distance[first] <= longest:
            stretches.append((first, last))
        else:
            # A lateral beside a joint makes one long run: the joint is where most of the ring stands out.
            mostly = runs(share[first : last + 1] > _MOSTLY, bridge=bridge) + first
            stretches += [(a, b) for a, b in mostly.tolist() if rings.distance[b] - rings.distance[a] <= longest]
    found = []
    for first, last in stretches:
        rows = slice(first, last + 1)
        known = rings.known[rows].any(axis=0)
        round_ = rings.outside[rows].any(axis=0).sum() / max(known.sum(), 1)
        if known.mean() < _HALF or last - first == len(share) - 1:
            continue
        # An opening as wide as this would be longer: what is wide and short is a joint between two rings.
        length = rings.distance[last] - rings.distance[first] + spacing
        wide = rings.diameter * np.sin(min(np.pi * round_, 0.5 * np.pi))
        if round_ < _ROUND and (round_ < _WIDE or length > _SHORT * wide):
            continue
        weight = share[rows]
        depth = float(np.average(rings.offset[rows], weights=weight))
        # Sectors are independent witnesses; chance has each of them outside as often as elsewhere in the survey.
        witnesses = float(rings.outside[rows].sum())
        sure = float(1.0 - np.exp(-0.2 * witnesses) * 0.5)
        found.append(Seen("joint", first, last, np.nan, 2.0 * np.pi, depth, witnesses, sure))
    return found


def find_steps(rings: Rings, grooves: list[Seen], *, window: int, false_alarms: float) -> list[Seen]:
    """Return the closed joints: places where the pipe's middle or radius jumps between two rings.

    Args:
        rings: The rings.
        grooves: Joints found already; nothing is looked for within half a diameter of them.
        window: Rings on each side.
        false_alarms: How many the survey may show by chance.
    """
    values = np.column_stack([rings.centre, rings.radius])
    near = np.zeros(len(values), bool)
    for one in grooves:
        values[max(one.first_ring - 1, 0) : one.last_ring + 2] = np.nan
        low, high = np.searchsorted(
            rings.distance,
            [
                rings.distance[one.first_ring] - 0.5 * rings.diameter,
                rings.distance[one.last_ring] + 0.5 * rings.diameter,
            ],
        )
        near[low:high] = True
    step = jumps(rings.distance, values, np.ones(3), window=window).step
    sigma = np.array([robust_sigma(column) for column in step.T])
    if not np.isfinite(sigma).all():
        return []
    with np.errstate(invalid="ignore"):
        score = np.sqrt(np.nansum((step / np.maximum(sigma, 1e-7)) ** 2, axis=1) / 3.0)
        size = np.hypot(np.hypot(step[:, 0], step[:, 1]), step[:, 2])
    looks = len(score)
    score[near | ~(size > _LEAST_STEP * rings.diameter)] = 0.0
    least = threshold(false_alarms, looks)
    found = []
    for k in peaks(score, rings.distance, least=least, apart=0.5 * rings.diameter).tolist():
        sure = float(confidence(score[k], looks, expected=1.0))
        bearing = float(np.arctan2(step[k, 1], step[k, 0]))
        found.append(Seen("joint", k - 1, k, bearing, 2.0 * np.pi, np.nan, float(score[k]), sure))
    return found


def find_openings(rings: Rings, cells: WallMap, joints: NDArray[np.bool_], *, window: int) -> list[Seen]:
    """Return the openings: patches where the wall is missing or stands far out, with wall all about them.

    Args:
        rings: The rings.
        cells: The unrolled wall.
        joints: (row,) rows that belong to joints; they bound no opening and are none.
        window: Rows over which missing readings are taken for a property of the sensor or of standing water.
    """
    base = lasting_shape(cells.missing / np.maximum(cells.possible, 1), window=window)
    # Where readings are lacking for metres (a blind sector, water) their lack says nothing.
    counts = np.clip(1.0 - base / _BLIND, 0.0, 1.0) * (cells.water == 0)
    opened = cells.far + counts * cells.missing
    flags = opened > 0.5 * np.maximum(cells.possible, 1)
    flags[joints] = False
    flags = _bridged(flags, joints)
    patch = regions(flags)
    width = 2.0 * np.pi / flags.shape[1]
    spacing = float(np.median(np.diff(rings.distance)))
    found = []
    ring_of = np.searchsorted(cells.row, np.arange(len(cells.possible) + 1))
    for k in range(len(patch.cells)):
        first, last = int(ring_of[patch.first_row[k]]), int(ring_of[patch.last_row[k] + 1]) - 1
        length = rings.distance[last] - rings.distance[first]
        span = float(patch.columns[k] * width)
        if length > _LONGEST_OPENING * rings.diameter or span > _WIDEST_OPENING:
            continue
        if length + 2.0 * spacing < _SHORT * rings.diameter * np.sin(min(0.5 * span, 0.5 * np.pi)):
            continue
        if patch.first_row[k] == 0 or patch.last_row[k] == len(flags) - 1:
            continue
        rows = slice(patch.first_row[k], patch.last_row[k] + 1)
        inside = patch.labels[rows] == k + 1
        possible, far, gone = (a[rows][inside].sum() for a in (cells.possible, cells.far, opened))
        if gone < _LEAST_OPEN:
            continue
        bearing = float(patch.first_column[k] * width + 0.5 * span)
        sure = _opening_sure(far, gone - far)
        found.append(Seen("lateral", first, last, bearing % (2 * np.pi), span, np.nan, np.sqrt(possible), sure))
    return found


def _bridged(flags: NDArray[np.bool_], joints: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the flags with an opening on both sides of a joint's rows carried across them."""
    out = flags.copy()
    for first, last in runs(joints).tolist():
        if first > 0 and last + 1 < len(flags):
            out[first : last + 1] = flags[first - 1] & flags[last + 1]
    return out


def _opening_sure(far: float, missing: float) -> float:
    """Return the probability that a patch is an opening: returns from beyond the wall prove it, their lack does not.

    Wet or black wall sends nothing back either, so that a patch of missing readings alone is an opening in half of all
    cases at best.
    """
    proof = far / max(far + missing, 1.0)
    several = 1.0 - np.exp(-0.25 * (far + missing))
    return float(several * (0.5 + 0.5 * min(1.0, proof / 0.1)))


def find_bumps(
    cells: WallMap,
    height: NDArray[np.float64],
    noise: NDArray[np.float64],
    *,
    false_alarms: float,
    least: float,
) -> list[Seen]:
    """Return where the wall stands inward over a patch: dents, deposits, intrusions.

    Boxes of one, three and seven cells are compared with what such boxes show elsewhere on the same wall, so that
    roughness, which errs alike over a patch, counts as it is.

    Args:
        cells: The unrolled wall.
        height: (row, column) deviation of the wall from what goes on along the pipe [m]; NaN = not seen.
        noise: (row,) one-sigma of a reading [m]: where a sensor sees worse, more is asked for.
        false_alarms: How many the survey may show by chance.
        least: Least depth [m].
    """
    height = confirmed(height)
    unit = noise / np.median(noise)
    flags = np.zeros(height.shape, bool)
    seeds, scores = np.zeros(height.shape, bool), np.zeros(height.shape)
    for size in (1, 3, 7):
        if size > height.shape[1] // 3:
            continue
        mean, _ = smoothed(height, along=size, around=size)
        level = mean / unit[:, None]
        sigma = max(robust_sigma(level), 1e-7)
        limit = threshold(false_alarms / 3.0, height.size / size**2)
        with np.errstate(invalid="ignore"):
            score = np.nan_to_num(-level / sigma)
            seeds |= (score > limit) & (mean < -least) & np.isfinite(height)
            flags |= (score > 3.0) & (mean < -0.25 * least)
        scores = np.maximum(scores, score)
    width = 2.0 * np.pi / height.shape[1]
    ring_of = np.searchsorted(cells.row, np.arange(len(cells.possible) + 1))
    found = []
    for first, last, columns, best, deepest in _peaks(height, flags | seeds, seeds, scores):
        span = float(len(columns) * width)
        if span > _WIDEST_BUMP:
            continue
        if _by_water(cells.water, first, last, columns):
            continue
        score = float(scores[best])
        sure = float(confidence(score, height.size, expected=1.0))
        rows = int(ring_of[first]), int(ring_of[last + 1]) - 1
        found.append(Seen("inward", *rows, float((best[1] + 0.5) * width), span, deepest, score, sure))
    return found


def _by_water(water: NDArray[np.float64], first: int, last: int, columns: NDArray[np.int64]) -> bool:
    """Return whether what stands in right at the invert adjoins water or a bed: it is where that runs out, no mark."""
    rows = slice(max(first - 3, 0), last + 4)
    around = np.unique(np.concatenate([columns - 1, columns, columns + 1]) % water.shape[1])
    turn = (columns + 0.5) * 2.0 * np.pi / water.shape[1]
    middle = np.angle(np.exp(1j * turn).mean())
    return bool(np.sin(middle) < _LOWEST and water[rows][:, around].sum() > 0)


def _peaks(
    height: NDArray[np.float64], flags: NDArray[np.bool_], seeds: NDArray[np.bool_], scores: NDArray[np.float64]
) -> Iterator[tuple]:
    """Yield first and last row, columns, deepest cell and depth of each bump, down to a fifth of its depth."""
    patch = regions(flags)
    for k in range(len(patch.cells)):
        rows = slice(patch.first_row[k], patch.last_row[k] + 1)
        inside = (patch.labels[rows] == k + 1) & np.isfinite(height[rows])
        left = seeds[rows] & inside
        while left.any():
            best = np.unravel_index(np.argmax(np.where(left, scores[rows], -1.0)), left.shape)
            near = inside[max(best[0] - 1, 0) : best[0] + 2]
            about = height[rows][max(best[0] - 1, 0) : best[0] + 2]
            deepest = float(np.min(np.where(near, about, np.inf)))
            part = regions(inside & (height[rows] < _FOOT * deepest))
            label = part.labels[best]
            if label == 0:
                left[best] = False
                continue
            own = part.labels == label
            left &= ~_grown(own)
            at = np.flatnonzero(own.any(axis=1))
            columns = np.flatnonzero(own.any(axis=0))
            middle = int(best[0]) + rows.start, int(best[1])
            yield int(at[0]) + rows.start, int(at[-1]) + rows.start, columns, middle, deepest


def _grown(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the flags with the cells about them, so that a bump's slopes are no bumps of their own."""
    out = flags.copy()
    for _ in range(3):
        out = out | np.roll(out, 1, axis=1) | np.roll(out, -1, axis=1)
        out[1:] |= out[:-1].copy()
        out[:-1] |= out[1:].copy()
    return out
