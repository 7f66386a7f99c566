"""Places of joints that A alone has seen, where B's own joints are so regular that its odometer cannot have slipped."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .features import JOINT
from .module import is_regular, joint_module

if TYPE_CHECKING:
    from .fit import Sense
    from .states import State

_SIGMAS = 3.0
_TOLERANCE = 0.2
_ALIKE = 0.05
_MOST_LENGTHS = 8


def lattice_places(
    sense: Sense, state: State, index_a: np.ndarray, index_b: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return joints of A (k,), where their lattice puts them in B (k,) [m], and the one-sigma of that (k,) [m].

    Between two paired joints that lie whole modules apart in both lists, B's odometer did not slip where their distance
    in B is what the module makes it; a slip of A between them then lies before or after a joint that A alone has seen.

    Args:
        sense: The chain.
        state: The state that fits best.
        index_a, index_b: (p,) pairs, into the features of the chain.
    """
    module, spacing = joint_module(sense.b)
    none = np.empty(0)
    alike = abs(module - sense.laid.module) < _ALIKE * module
    if not (is_regular(module, spacing) and sense.laid.regular and alike):
        return none.astype(np.int64), none, none
    both = (sense.a.kind[index_a] == JOINT) & (sense.b.kind[index_b] == JOINT)
    index_a, index_b = index_a[both], index_b[both]
    alone = np.flatnonzero((sense.a.kind == JOINT) & sense.laid.seen)
    alone = alone[~np.isin(alone, index_a)]
    rows = []
    for p, q, i, j in zip(index_a[:-1], index_a[1:], index_b[:-1], index_b[1:], strict=True):
        lengths = round(float(sense.b.chainage[j] - sense.b.chainage[i]) / module)
        if not 2 <= lengths <= _MOST_LENGTHS:
            continue
        gap = sense.b.chainage[j] - sense.b.chainage[i]
        off = _SIGMAS * np.hypot(np.sqrt(lengths) * spacing, np.sqrt(2.0) * state.noise)
        if abs(gap - lengths * module) > min(off, _TOLERANCE * module):
            continue
        for k in alone[(alone > p) & (alone < q)]:
            before, behind = sense.a.chainage[k] - sense.a.chainage[p], sense.a.chainage[q] - sense.a.chainage[k]
            n = round(float(before) / sense.laid.module)
            # A false joint lies whole modules from neither of both.
            ends = (before, n), (behind, lengths - n)
            if 0 < n < lengths and any(_whole(sense, state, distance, count) for distance, count in ends):
                share = n / lengths
                own = share * (1.0 - share) * lengths * spacing**2
                rows.append((k, sense.b.chainage[i] + share * gap, np.sqrt(own + 2.0 * state.noise**2)))
    k, y, sigma = np.array(rows).reshape(-1, 3).T
    return k.astype(np.int64), y, sigma


def _whole(sense: Sense, state: State, distance: float, count: int) -> bool:
    """Return whether two joints of A may lie so many modules apart."""
    scatter = np.hypot(np.sqrt(count) * sense.laid.spacing, np.sqrt(2.0) * state.noise)
    return bool(abs(distance - count * sense.laid.module) < _SIGMAS * scatter)
