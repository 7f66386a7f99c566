"""Features seen in both inspections: which is which once every ring has its place, and how they changed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from .changes import Change
from .verdicts import UNCLEAR, verdict

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .epochs import Epoch
    from .registration import Registration
    from .result import Match

_REACH = 0.1  # m beside four sigmas: within it two features of a kind can be one
_TURN = np.radians(30.0)
_CLEAR = 0.03  # m
_HUNDRED = 100.0
_ENOUGH = 8
_RAREST = 0.01

MEASURED = {
    "joint": (("joint gap", "size"), ("joint step", "step"), ("joint kink", "kink")),
    "lateral": (("lateral size", "size"), ("lateral bearing", "bearing"), ("lateral protrusion", "protrusion")),
    "bend": (("bend angle", "angle"),),
    "dent": (("dent depth", "depth"),),
    "deposit": (("deposit depth", "depth"),),
    "intrusion": (("intrusion depth", "depth"),),
}
"""What is compared of each kind of feature: key of `verdicts.QUANTITIES`, and quantity of `Epoch.measured`."""


BY_GAP = ("step", "kink")
"""Variables of a joint that are not compared where no ring stands in its gap: rings that the gap cuts gave them."""


@dataclass(frozen=True)
class Paired:
    """Features seen in both inspections, in the order of A.

    Attributes:
        index_a, index_b: (k,) index into the features of A and of B.
        probability: (k,) posterior of each pair; NaN where the rings' places alone paired it.
        residual: (k,) chainage in B less where A's feature lies in B [m].
    """

    index_a: NDArray[np.int64]
    index_b: NDArray[np.int64]
    probability: NDArray[np.float64]
    residual: NDArray[np.float64]


def pair_features(a: Epoch, b: Epoch, match: Match | None, placed: Registration) -> Paired:
    """Return the pairs of the match, and those that the registration adds: mutual nearest of one kind.

    Args:
        a, b: The inspections.
        match: Of their features; None, or refused, when only the wall told where A lies in B.
        placed: Where A lies in B.
    """
    none = np.empty(0, np.int64)
    if a.features is None or b.features is None:
        return Paired(none, none, np.empty(0), np.empty(0))
    i, j, probability = none, none, np.empty(0)
    if match is not None and match.accepted:
        i, j, probability = match.pairs.index_a, match.pairs.index_b, match.pairs.probability
    more_i, more_j = _nearest(a, b, placed, i, j)
    i, j = np.concatenate((i, more_i)), np.concatenate((j, more_j))
    probability = np.concatenate((probability, np.full(len(more_i), np.nan)))
    order = np.lexsort((j, i))
    i, j, probability = i[order], j[order], probability[order]
    return Paired(i, j, probability, b.features.chainage[j] - placed.at(a.features.chainage[i])[0])


def _nearest(a: Epoch, b: Epoch, placed: Registration, i: NDArray, j: NDArray) -> tuple[NDArray, NDArray]:
    """Return the pairs of features not yet taken that are mutual nearest of one kind."""
    left_a = np.setdiff1d(np.arange(len(a.features)), i)
    left_b = np.setdiff1d(np.arange(len(b.features)), j)
    if not left_a.size or not left_b.size:
        return left_a[:0], left_b[:0]
    x = a.features.chainage[left_a]
    y, sigma = placed.at(x)
    own = [e.measured("chainage")[1][rows] for e, rows in ((a, left_a), (b, left_b))]
    reach = _REACH + 4.0 * np.sqrt(
        np.nan_to_num(sigma)[:, None] ** 2 + np.nan_to_num(own[0])[:, None] ** 2 + np.nan_to_num(own[1])[None, :] ** 2
    )
    apart = np.abs(b.features.chainage[left_b][None, :] - y[:, None])
    theta = b.features.bearing[left_b]
    if placed.reversed:
        theta = np.pi - theta
    turn = theta[None, :] + placed.roll_at(x)[:, None] - a.features.bearing[left_a][:, None]
    turn = np.abs(np.mod(turn + np.pi, 2 * np.pi) - np.pi)
    kinds = [np.array(e.kinds(), dtype=object)[rows] for e, rows in ((a, left_a), (b, left_b))]
    fits = (apart <= reach) & (kinds[0][:, None] == kinds[1][None, :]) & ~(turn > _TURN)
    fits &= placed.reliable(x)[:, None]
    cost = np.where(fits, apart, np.inf)
    best_b, best_a = cost.argmin(axis=1), cost.argmin(axis=0)
    mutual = np.isfinite(cost.min(axis=1)) & (best_a[best_b] == np.arange(len(left_a)))
    return left_a[mutual], left_b[best_b[mutual]]


def feature_changes(
    a: Epoch, b: Epoch, paired: Paired, placed: Registration, *, rate: float, works: bool
) -> tuple[list[Change], dict[str, float]]:
    """Return significant changes of paired features, and the change of each quantity that is told in 95 % of cases.

    A sigma is the stated one, widened where the pairs of one kind scatter more than their sigmas say; most of them have
    not changed. Where none is stated and at least eight pairs are there, their scatter serves.

    Args:
        a, b: The inspections.
        paired: Features seen in both.
        placed: Where A lies in B.
        rate: False alarms per 100 m, over all features and quantities.
        works: Whether the pipe was cleaned, repaired or lined in between.
    """
    rows = _measured(a, b, paired, placed)
    tests = sum(np.isfinite(r[4]).sum() for r in rows.values())
    length = max(a.extent[1] - a.extent[0], 1.0)
    chance = min(rate * length / _HUNDRED / max(tests, 1), _RAREST)
    limit = float(norm.isf(chance / 2.0))
    changes, detectable = [], {}
    for quantity, (index, before, after, change, sigma) in rows.items():
        known = np.isfinite(sigma)
        if not known.any():
            continue
        least = (limit + float(norm.isf(0.05))) * float(np.median(sigma[known]))
        if quantity != "lateral bearing" or least < np.pi:  # no two bearings are further apart than half a turn
            detectable[quantity] = least
        for k in np.flatnonzero(known & (np.abs(change) > limit * sigma)):
            z = abs(change[k] / sigma[k])
            said, reason = verdict(quantity, float(change[k]), works=works)
            per_100 = 2.0 * float(norm.sf(z)) * tests * _HUNDRED / length
            n = paired.index_a[index[k]]
            changes.append(
                Change(
                    quantity, float(a.features.chainage[n]), 0.0, float(a.features.bearing[n]), np.nan,
                    float(before[k]), float(after[k]), float(change[k]), float(sigma[k]), per_100, said, reason,
                )
            )  # fmt: skip
    return changes, detectable


def _measured(a: Epoch, b: Epoch, paired: Paired, placed: Registration) -> dict[str, tuple[NDArray, ...]]:
    """Return rows of the pairs, values before and after, change and sigma of each quantity that both have."""
    kinds = np.array(a.kinds(), dtype=object)[paired.index_a]
    found = {}
    for kind, quantities in MEASURED.items():
        index = np.flatnonzero(kinds == kind)
        if not index.size:
            continue
        both = (a, paired.index_a), (b, paired.index_b)
        for quantity, variable in quantities:
            (v_a, s_a), (v_b, s_b) = (tuple(part[rows[index]] for part in e.measured(variable)) for e, rows in both)
            if variable in BY_GAP:
                # A joint in whose gap no ring stands has its step and angle from rings that the gap cuts.
                sized = [np.isfinite(e.measured("size")[0][rows[index]]) for e, rows in both]
                v_a, v_b = np.where(sized[0], v_a, np.nan), np.where(sized[1], v_b, np.nan)
            if variable == "depth":
                # One that a joint cuts is measured in pieces, which differ from one inspection to the next.
                whole = np.logical_and(*(_clear_of_joints(e, rows[index]) for e, rows in both))
                v_a, v_b = np.where(whole, v_a, np.nan), np.where(whole, v_b, np.nan)
            if variable == "bearing":
                v_b = _seen_from_a(v_a, v_b, a.features.chainage[paired.index_a[index]], placed)
            change = v_b - v_a
            if np.isfinite(change).any():
                found[quantity] = index, v_a, v_b, change, _sigma(change, np.hypot(s_a, s_b))
    return found


def _clear_of_joints(epoch: Epoch, rows: NDArray) -> NDArray[np.bool_]:
    """Return whether each feature of `rows` (k,) ends before the joints beside it."""
    (at, _), (length, _) = (epoch.measured(name) for name in ("chainage", "length"))
    joint, gap = epoch.joints.T
    reach = 0.5 * np.nan_to_num(length[rows])[:, None] + 0.5 * np.nan_to_num(gap)[None, :] + _CLEAR
    return ~(np.abs(at[rows][:, None] - joint[None, :]) < reach).any(axis=1)


def _seen_from_a(v_a: NDArray, v_b: NDArray, x: NDArray, placed: Registration) -> NDArray[np.float64]:
    """Return bearings of B in A's frame, within half a turn of A's."""
    theta = (np.pi - v_b if placed.reversed else v_b) + placed.roll_at(x)
    return v_a + np.mod(theta - v_a + np.pi, 2 * np.pi) - np.pi


def _sigma(change: NDArray, stated: NDArray) -> NDArray[np.float64]:
    known = np.isfinite(change)
    if known.sum() < _ENOUGH:
        return np.where(known, stated, np.nan)
    if not (np.isfinite(stated[known]) & (stated[known] > 0)).any():
        # About 0, as what all have in common (a roll, a habit of rounding) is no change of any of them.
        scatter = 1.4826 * float(np.median(np.abs(change[known])))
        return np.where(known, scatter if scatter > 0 else np.nan, np.nan)
    middle = np.median(change[known])
    z = (change - middle) / np.where(stated > 0, stated, np.nan)
    return np.where(known, stated * max(1.0, 1.4826 * float(np.nanmedian(np.abs(z)))), np.nan)


def alone(a: Epoch, b: Epoch, paired: Paired, placed: Registration) -> list[Change]:
    """Return features found in one inspection only, where the other has looked too."""
    changes: list[Change] = []
    if a.features is None or b.features is None or (a.listed is None) != (b.listed is None):
        return changes
    nan = float("nan")
    for epoch, taken, first in ((a, paired.index_a, True), (b, paired.index_b, False)):
        kinds = epoch.kinds()
        for n in np.setdiff1d(np.arange(len(epoch.features)), taken):
            x = float(epoch.features.chainage[n])
            at = x if first else _in_a(x, placed)
            y = float(placed.at(np.array(at))[0]) if np.isfinite(at) else np.nan
            if not (b.extent[0] <= y <= b.extent[1] and placed.reliable(np.array(at))):
                continue
            theta = float(epoch.features.bearing[n])
            if not first:
                theta = (np.pi - theta if placed.reversed else theta) + float(placed.roll_at(np.array(at)))
            words = f"{kinds[n]} found in {'A' if first else 'B'} alone; detectors miss some and invent some"
            changes.append(
                Change("found", at, 0.0, theta, nan, 1.0 * first, 1.0 * (not first), nan, nan, nan, UNCLEAR, words)
            )
    return changes


def _in_a(y: float, placed: Registration) -> float:
    """Return the chainage in A of a chainage in B [m]; NaN outside."""
    nodes = placed.drift
    order = np.argsort(nodes.chainage_b)
    return float(np.interp(y, nodes.chainage_b[order], nodes.chainage_a[order], left=np.nan, right=np.nan))
