"""What several frames show of one thing, put together: one place, one size, one probability."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from springline.imaging.wall import Mark

_NEAR_X = {"joint": 0.4, "lateral": 0.5}  # radii of the pipe within which two marks are of one thing
_NEAR_BEARING = 0.45  # rad, of laterals
_ONE_SEEN = 1.0  # log odds against anything at all being where it is seen
_SHORTEST = 2.0  # radii of the pipe between two joints
_OVERLAP = 0.8  # of the sum of two bores: nearer than that they are one
_MISSED = 0.5  # log odds against it for every frame that should show it and does not
_USUAL = (0.4, 0.45)  # bore of a lateral in radii of the pipe, and the one-sigma of its logarithm
_STEADY = 0.02  # of the way ahead: what the pose leaves uncertain of it


class Standing(Protocol):
    """Anything that stands somewhere in the pipe."""

    kind: str
    x: float
    bearing: float
    radius: float


@dataclass(frozen=True)
class Sighting:
    """A joint or a lateral, seen in one frame or more.

    Attributes:
        kind: joint or lateral.
        x: Along the pipe [m], and its one-sigma; of a lateral where its axis meets the wall.
        bearing: Of a lateral [rad], and its one-sigma; NaN for a joint.
        radius: Of a lateral's bore [m], and its one-sigma; NaN for a joint.
        frames: Which frames show it, the best first.
        expected: In how many frames it stood in good view.
        log_odds: That it is there.
    """

    kind: str
    x: float
    x_sigma: float
    bearing: float
    bearing_sigma: float
    radius: float
    radius_sigma: float
    frames: tuple[int, ...]
    expected: int
    log_odds: float

    @property
    def probability(self) -> float:
        """That it is there."""
        return 1.0 / (1.0 + math.exp(-min(max(self.log_odds, -50.0), 50.0)))


def put_together(
    marks: Sequence[tuple[int, Mark]], eyes: Sequence[float], radius: float, *, view: tuple[float, float] = (0.8, 2.4)
) -> list[Sighting]:
    """Return what marks of many frames are of.

    Args:
        marks: Frame and mark, x along the pipe common to all.
        eyes: x of the camera in every frame that was looked at [m].
        radius: Of the pipe [m].
        view: How far ahead, in radii, things stand in good view.

    Returns:
        Sightings in order along the pipe.
    """
    cell = _SHORTEST * radius
    groups: dict[int, list[list[tuple[int, Mark]]]] = {}
    for frame, mark in sorted(marks, key=lambda one: -one[1].odds):
        at = math.floor(mark.x / cell)
        for group in _beside(groups, at):
            if _one_thing(group[0][1], mark, radius) and all(frame != other for other, _ in group):
                group.append((frame, mark))
                break
        else:
            groups.setdefault(at, []).append([(frame, mark)])
    place = np.sort(np.asarray(eyes, dtype=float))
    found = [_together(group, place, radius, view) for there in groups.values() for group in there]
    kept: dict[int, list[Sighting]] = {}
    for one in sorted(found, key=lambda one: -one.log_odds):
        at = math.floor(one.x / cell)
        if not any(excludes(other, one, radius) for other in _beside(kept, at)):
            kept.setdefault(at, []).append(one)
    return sorted((one for there in kept.values() for one in there), key=lambda one: one.x)


def _beside(cells: dict[int, list[Any]], at: int) -> list[Any]:
    """What lies in a cell along the pipe or in one of its neighbours."""
    return [one for cell in (at - 1, at, at + 1) for one in cells.get(cell, ())]


def excludes(kept: Standing, other: Standing, radius: float) -> bool:
    """Return whether what stands somewhere leaves no room for another thing.

    No pipe between two joints is shorter than it is wide, and no two laterals open into one another: what is seen
    there is the same thing, seen askew.

    Args:
        kept, other: With kind, x, bearing and radius; a lateral of unknown bore is taken for a usual one.
        radius: Of the pipe [m].
    """
    if kept.kind != other.kind:
        return False
    if kept.kind == "joint":
        return abs(kept.x - other.x) < _SHORTEST * radius
    turn = (kept.bearing - other.bearing + math.pi) % (2.0 * math.pi) - math.pi
    room = sum(one.radius if math.isfinite(one.radius) else _USUAL[0] * radius for one in (kept, other))
    return math.hypot(kept.x - other.x, radius * turn) < _OVERLAP * room


def _one_thing(one: Mark, other: Mark, radius: float) -> bool:
    if one.kind != other.kind or abs(one.x - other.x) > _NEAR_X[one.kind] * radius:
        return False
    if one.kind == "joint":
        return True
    turn = (one.bearing - other.bearing + math.pi) % (2.0 * math.pi) - math.pi
    return abs(turn) < _NEAR_BEARING


def _together(group: list[tuple[int, Mark]], eyes: np.ndarray, radius: float, view: tuple[float, float]) -> Sighting:
    marks = [mark for _, mark in group]
    kind, first = marks[0].kind, marks[0]
    x = np.array([mark.x for mark in marks])
    x_sigma = np.array([math.hypot(mark.x_sigma, _STEADY * mark.ahead) for mark in marks])
    place, place_sigma = _mean(x, x_sigma)
    bearing = bearing_sigma = size = size_sigma = math.nan
    if kind == "lateral":
        turns = np.array([(m.bearing - first.bearing + math.pi) % (2 * math.pi) - math.pi for m in marks])
        bearing, bearing_sigma = _mean(turns, np.array([max(m.bearing_sigma, 0.01) for m in marks]))
        bearing += first.bearing
        log_size, log_sigma = _mean(
            np.log([m.radius for m in marks]), np.array([max(m.radius_sigma / m.radius, 0.01) for m in marks])
        )
        size, size_sigma = math.exp(log_size), math.exp(log_size) * log_sigma
    nearest, farthest = np.searchsorted(eyes, [place - view[0] * radius, place - view[1] * radius])
    expected = int(nearest - farthest)
    shown = sum(view[0] * radius < place - (mark.x - mark.ahead) < view[1] * radius for mark in marks)
    missed = max(expected - shown, 0)
    odds = _log_odds(marks, missed)
    if kind == "lateral":
        odds -= 0.5 * (math.log(size / (_USUAL[0] * radius)) / _USUAL[1]) ** 2
    return Sighting(
        kind,
        place,
        place_sigma,
        bearing,
        bearing_sigma,
        size,
        size_sigma,
        tuple(frame for frame, _ in group),
        expected,
        odds,
    )


def _log_odds(marks: list[Mark], missed: int) -> float:
    """Each frame that shows it speaks for it; each that should and does not, against it."""
    return sum(mark.odds for mark in marks) - _ONE_SEEN - _MISSED * missed


def _mean(values: np.ndarray, sigmas: np.ndarray) -> tuple[float, float]:
    """Weighted mean, in which what lies off counts less, and its one-sigma with the scatter about it."""
    weight = 1.0 / sigmas**2
    middle = float(np.sum(weight * values) / weight.sum())
    if len(values) > 2:
        order = np.argsort(values)
        middle = float(values[order][np.searchsorted(np.cumsum(weight[order]), 0.5 * weight.sum())])
        for _ in range(5):
            robust = weight / (1.0 + ((values - middle) / (3.0 * sigmas)) ** 2)
            middle = float(np.sum(robust * values) / robust.sum())
        weight = robust
    scatter = float(np.sum(weight * ((values - middle) / sigmas) ** 2) / weight.sum())
    return middle, float(math.sqrt(max(scatter, 1.0) / weight.sum()))
