"""Where two lists may overlap when their starts lie far apart: a stretch of the shorter slid along the longer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .features import JOINT
from .fit import Sense, cell
from .module import is_regular, joint_module
from .states import Grid

if TYPE_CHECKING:
    from .features import FeatureList
    from .options import MatchOptions

_STRETCH = 150.0  # m that is slid: scales of the odometers hardly smear it, and it holds enough to tell its place
_FEWEST = 3
_LONGEST = 2400.0  # m of the shorter list
_EXCERPT = 0.5  # of the longer list: the middle of a shorter one lies in it
_APART = 8.0  # m from one place to another
_MOST = 3
_LEAST = -4.0  # nats of a stretch, the prior of its start among them, that the rest of the overlap can make up for
_NATS_KEPT = 12.0
_REACH = 12.0  # m about a place
_MARGIN = 5.0  # m beyond the overlap
_MOST_CELLS = 400_000


@dataclass(frozen=True)
class Overlap:
    """A common stretch that is worth a closer look.

    Attributes:
        a, b: The parts of both lists in it, with a margin; B seen in A's sense.
        first_a, first_b: Index of their first features in the whole lists.
        shift: Chainage in B less that in A in its middle [m].
        log_prior: Of starts so far apart, against equal ones.
    """

    a: FeatureList
    b: FeatureList
    first_a: int
    first_b: int
    shift: float
    log_prior: float

    def sense(self, options: MatchOptions) -> Sense:
        """Return the chain of both parts."""
        reach = _REACH + options.scale_sigma * self.a.length
        return Sense(self.a, self.b, replace(options, offset_limit=reach), shift=self.shift)


def overlaps(a: FeatureList, b: FeatureList, options: MatchOptions) -> list[Overlap]:
    """Return the stretches in which `a` and `b`, driven the same way, may be one pipe; the likeliest first.

    None where both lists are long: their starts are then taken to be near each other.
    """
    if min(a.length, b.length) > _LONGEST:
        return []
    swapped = b.length < a.length
    short, long = (_telling(f, a) for f in ((b, a) if swapped else (a, b)))
    found: list[tuple[float, float]] = []
    for stretch in _stretches(short, excerpt=short.length < _EXCERPT * long.length):
        found += _places(stretch, long, short.extent[0], options)
    found.sort(reverse=True)
    kept: list[float] = []
    for weight, shift in found:
        if weight > max(_LEAST, found[0][0] - _NATS_KEPT) and all(abs(shift - other) > _APART for other in kept):
            kept.append(shift)
    cuts = (_cut(a, b, -shift if swapped else shift, options) for shift in kept[:_MOST])
    return [cut for cut in cuts if cut is not None]


def _telling(features: FeatureList, whose: FeatureList) -> FeatureList:
    """Return the features without the joints, where those are of one module: they fit at each of its multiples."""
    other = features.kind != JOINT
    return features.take(other) if is_regular(*joint_module(whose)) and other.sum() >= _FEWEST else features


def _stretches(features: FeatureList, excerpt: bool) -> list[FeatureList]:
    """Return a stretch in the middle, or three when the overlap may leave the middle out."""
    first = features.extent[0]
    width = min(_STRETCH, features.length if excerpt else 0.5 * features.length)
    middles = (0.5,) if excerpt else (0.0, 0.5, 1.0)
    starts = (first + share * (features.length - width) for share in middles)
    parts = (features.between(start, start + width) for start in starts)
    return [part for part in parts if len(part) >= _FEWEST]


def _places(stretch: FeatureList, long: FeatureList, start: float, options: MatchOptions) -> list[tuple[float, float]]:
    """Return log weight and shift [m] of the places of a stretch of a list that starts at `start` [m]."""
    sense = Sense(stretch, long, options, shift=long.extent[0] - start)
    state = sense.wide
    low, high = long.extent[0] - stretch.extent[1], long.extent[1] - stretch.extent[0]
    step = max(cell(state.noise), (high - low) / _MOST_CELLS)
    grid = Grid(low, step, int((high - low) / step) + 1)
    found = []
    for scale in sense.scales(state):
        at = replace(state, scale=float(scale))
        log_evidence, drift = sense.last(at, grid)
        in_middle = 0.5 * (scale - 1.0) * stretch.length
        weight = log_evidence + sense.prior(at) + np.log(np.maximum(drift, 1e-30))
        for _ in range(_MOST):
            top = int(np.argmax(weight))
            found.append((float(weight[top]), float(grid.drift[top]) + in_middle))
            reach = int(_APART / step)
            weight[max(0, top - reach) : top + reach + 1] = -np.inf
    return found


def _cut(a: FeatureList, b: FeatureList, shift: float, options: MatchOptions) -> Overlap | None:
    """Return the parts of both lists that overlap when B's chainage is A's and `shift` [m]."""
    low, high = max(a.extent[0], b.extent[0] - shift), min(a.extent[1], b.extent[1] - shift)
    if high <= low:
        return None
    margin = _MARGIN + options.scale_sigma * (high - low)
    bounds = (low - margin, high + margin), (low - margin + shift, high + margin + shift)
    part_a, part_b = (f.between(*at) for f, at in zip((a, b), bounds, strict=True))
    if min(len(part_a), len(part_b)) < _FEWEST:
        return None
    apart = (shift - b.extent[0] + a.extent[0]) / options.offset_scale
    first_a, first_b = (int(np.searchsorted(f.chainage, at[0])) for f, at in zip((a, b), bounds, strict=True))
    return Overlap(part_a, part_b, first_a, first_b, shift, -float(np.log1p(apart**2)))
