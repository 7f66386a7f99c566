"""Where geometry proposes to look: what rings show, and where the regular spacing of joints says that one is."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ...imaging.sightings import Sighting
    from ...imaging.wall import Mark
    from ...survey import Survey

KINDS = ("joint", "lateral")
_CERTAIN = 4.0
_LEAST_PROBABILITY = 0.05
_SAME = 0.1
_FEWEST_JOINTS = 6
_REGULAR = 0.15
_SPACED = 1.0
_IRREGULAR = -2.5
_SCATTER = 4.0
_LEAST_SCATTER = 0.01
_WITHIN = 0.05
_ALIKE = 0.5
_TURNED = 0.45


@dataclass
class Place:
    """Somewhere that a joint or a lateral may be.

    Attributes:
        kind: joint or lateral.
        x: Chainage [m].
        within: How far off a joint may be [m]; of a lateral that is told by `is_of`.
        log_odds: That it is there, by all that has spoken so far.
        bearing: Of a lateral [rad]; NaN for a joint.
        radius: Of a lateral's bore [m]; NaN when it is not known, and for a joint.
        by_rings: Whether rings propose it, and not the spacing of joints alone.
        feature: Its row in `/features`; -1 without one.
        looked: Frames that were looked at and in which it stood in good view.
        shown: Those of them that show it.
    """

    kind: str
    x: float
    within: float
    log_odds: float
    bearing: float = math.nan
    radius: float = math.nan
    by_rings: bool = True
    feature: int = -1
    looked: list[int] = field(default_factory=list)
    shown: list[int] = field(default_factory=list)


def places_of(survey: Survey, radius: float) -> list[Place]:
    """Return the places that rings propose, in order along the pipe.

    These are the joints and laterals of `/features`, the candidates that were too doubtful for it, and where a joint
    is missing from a row of evenly spaced ones. A joint that does not fit such a row is doubted.

    Args:
        survey: With `/features`, `/candidates` and `/section`.
        radius: The pipe's [m].
    """
    found, seen, section = survey.features, survey.candidates, survey.section
    columns = [found[name].values for name in ("chainage", "confidence", "bearing", "size")]
    places = []
    for row, kind in enumerate(found["kind"].values.astype(str)):
        if kind in KINDS:
            x, probability, bearing, size = (float(column[row]) for column in columns)
            odds = log_odds(probability)
            places.append(Place(kind, x, _within(kind, radius), odds, bearing, 0.5 * size, feature=row))
    confirmed = [(place.kind, place.x) for place in places]
    distance = seen["distance"].values
    x = np.interp(distance, section["distance"].values, section["chainage"].values)
    for row in np.flatnonzero(seen["probability"].values >= _LEAST_PROBABILITY):
        kind = str(seen["kind"].values[row])
        if kind in KINDS and all(kind != other or abs(x[row] - at) > _SAME for other, at in confirmed):
            odds = min(log_odds(float(seen["probability"].values[row])), 0.0)
            bearing, size = (float(seen[name].values[row]) for name in ("bearing", "size"))
            places.append(Place(kind, float(x[row]), _within(kind, radius), odds, bearing, 0.5 * size))
    return sorted(places + spaced_joints(places), key=lambda place: place.x)


def is_of(place: Place, one: Mark | Sighting, radius: float) -> bool:
    """Return whether a mark or a sighting may be of a place, in a pipe of this radius [m]."""
    if one.kind != place.kind:
        return False
    off = abs(one.x - place.x)
    if place.kind == "joint":
        return off < place.within + 2.0 * one.x_sigma
    turn = (one.bearing - place.bearing + math.pi) % (2.0 * math.pi) - math.pi
    return off < _ALIKE * radius and abs(turn) < _TURNED


def log_odds(probability: float) -> float:
    """Return the log odds of a probability, no surer than one part in fifty."""
    probability = min(max(probability, 1e-9), 1.0 - 1e-9)
    return min(max(math.log(probability / (1.0 - probability)), -_CERTAIN), _CERTAIN)


def _within(kind: str, radius: float) -> float:
    return 0.15 * radius if kind == "joint" else 0.4 * radius


def spaced_joints(places: list[Place]) -> list[Place]:
    """Return where joints are missing from an even row; doubt those that lie beside it.

    Args:
        places: What is known; joints less likely than not are left aside. Those beside the row lose log odds.
    """
    joints = sorted((p for p in places if p.kind == "joint" and p.log_odds > 0), key=lambda p: p.x)
    if len(joints) < _FEWEST_JOINTS:
        return []
    x = np.array([joint.x for joint in joints])
    gaps = np.diff(x)
    length = float(np.median(gaps[gaps < 1.4 * np.quantile(gaps, 0.3)]))
    many = np.maximum(np.rint(gaps / length), 1)
    off = np.abs(gaps - many * length)
    usual = float(np.median(off[many == 1]))
    if usual > _WITHIN * length:
        return []
    even = off < np.clip(_SCATTER * 1.4826 * usual, _LEAST_SCATTER * length, _WITHIN * length) * np.sqrt(many)
    for k, joint in enumerate(joints):
        beside = even[max(k - 1, 0) : k + 1]
        if len(beside) == 2 and not beside.any():
            joint.log_odds += _IRREGULAR
    regular = [joint for k, joint in enumerate(joints) if even[max(k - 1, 0) : k + 1].any()]
    x = np.array([joint.x for joint in regular])
    missing: list[Place] = []
    for before, after in itertools.pairwise(x):
        count = round((after - before) / length)
        if count < 2 or abs(after - before - count * length) > _REGULAR * length:
            continue
        missing += [
            Place("joint", float(at), _WITHIN * length, _SPACED, by_rings=False)
            for at in np.linspace(before, after, count + 1)[1:-1]
            if all(p.kind != "joint" or abs(p.x - at) > _WITHIN * length for p in places)
        ]
    return missing
