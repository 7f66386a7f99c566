"""The module of the joints: a pipe laid of equal lengths has its joints, seen or not, on a lattice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .features import JOINT, FeatureList

_FEWEST_JOINTS = 4
_REGULAR = 0.05
_TOLERANCE = 0.2
_ONE_LENGTH = 0.1  # of a length, by which a distance may be off the whole lengths in it when the length is sought
_FALSE = 0.05  # share of distances that a false joint ends
_MOST_LENGTHS = 8
_MOST_MISSED = 4  # lengths between neighbours of the list by which the length itself is told


def joint_module(features: FeatureList) -> tuple[float, float]:
    """Return the distance between joints [m] and its standard deviation [m]; NaN when too few joints show it.

    Each distance between neighbours, or a half to a quarter of it, is tried as the length. A distance of k whole
    lengths speaks for it, the less the larger k is, so that a length is taken before its half; one that is none speaks
    against it, as a false joint is rarer than missed ones.

    >>> from .features import feature_list
    >>> joint_module(feature_list([0.0, 2.0, 4.0, 6.1, 10.1, 12.0], "joint"))[0]
    2.0
    >>> joint_module(feature_list([0.0, 6.0, 12.0, 18.0, 20.0, 24.0, 28.0], "joint"))[0]
    2.0
    """
    x = features.chainage[features.kind == JOINT]
    gaps = np.diff(x)
    gaps = gaps[gaps > 0]
    if x.size < _FEWEST_JOINTS or gaps.size < _FEWEST_JOINTS - 1:
        return np.nan, np.nan
    tried = np.unique(gaps[:, None] / np.arange(1, _MOST_MISSED + 1))
    tried = tried[tried >= gaps.min() * (1.0 - _ONE_LENGTH)]
    lengths, off = _whole_lengths(gaps, tried[:, None])
    fits = np.abs(off) < _ONE_LENGTH
    best = tried[np.argmax(np.where(fits, -np.log(2.0 * _ONE_LENGTH * lengths), np.log(_FALSE)).sum(axis=1))]
    lengths, off = _whole_lengths(gaps, best)
    near = np.abs(off) < _ONE_LENGTH
    if near.sum() < _FEWEST_JOINTS - 1:
        return np.nan, np.nan
    module = float(np.median(gaps[near] / lengths[near]))
    own = (gaps[near] - lengths[near] * module) / np.sqrt(lengths[near])
    return module, float(1.4826 * np.median(np.abs(own - np.median(own))))


def _whole_lengths(gaps: np.ndarray, length: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Return how many whole lengths lie in each gap, at least one, and by how much of a length it is off them."""
    lengths = np.clip(np.round(gaps / length), 1, _MOST_MISSED)
    return lengths, gaps / length - lengths


@dataclass(frozen=True)
class Laid:
    """A list with the joints that must be there though they were not seen.

    Attributes:
        features: The list, seen and unseen features in order.
        seen: (n,) whether each was seen.
        variance: (n,) of the place of each unseen joint [m2]; 0 where seen.
        module: Distance between joints [m]; NaN when not known.
        spacing: Its standard deviation [m]; NaN when not known.
    """

    features: FeatureList
    seen: np.ndarray
    variance: np.ndarray
    module: float
    spacing: float

    @property
    def regular(self) -> bool:
        """Whether the joints lie on a lattice."""
        return is_regular(self.module, self.spacing)


def is_regular(module: float, spacing: float) -> bool:
    """Return whether distances between joints [m] scatter so little that missing joints can be counted.

    >>> is_regular(2.5, 0.01), is_regular(float("nan"), float("nan"))
    (True, False)
    """
    return bool(np.isfinite(module) and spacing < _REGULAR * module)


def laid(features: FeatureList) -> Laid:
    """Return the list with its unseen joints, where the joints are regular and a gap is a multiple of their module.

    Without them two pipes of one module seem to agree the better the more of their joints happen to be seen in both;
    that says nothing, as every joint of one then has a place in the other.

    >>> from .features import feature_list
    >>> laid(feature_list([0.0, 2.0, 4.0, 8.0, 10.0], "joint")).features.chainage.tolist()
    [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    """
    module, spacing = joint_module(features)
    x, variance = np.empty(0), np.empty(0)
    if is_regular(module, spacing):
        x, variance = _unseen(features.chainage[features.kind == JOINT], module, spacing)
    none = np.full(x.size, np.nan)
    order = np.argsort(np.concatenate((features.chainage, x)), kind="stable")
    both = (
        (features.chainage, x),
        (features.kind, np.full(x.size, JOINT)),
        (features.bearing, none),
        (features.size, none),
    )
    parts = (np.concatenate(pair)[order] for pair in both)
    return Laid(
        features=FeatureList(*parts, features.extent, features.name),
        seen=(order < len(features)),
        variance=np.concatenate((np.zeros(len(features)), variance))[order],
        module=module,
        spacing=spacing,
    )


def _unseen(x: np.ndarray, module: float, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Return chainages [m] and variances [m2] of the joints missing between joints x that lie whole modules apart."""
    places: list[float] = []
    variances: list[float] = []
    i = 0
    while i < x.size - 1:
        gaps = x[i + 1 : i + 2 + _MOST_LENGTHS] - x[i]
        lengths = np.round(gaps / module)
        fits = (np.abs(gaps - lengths * module) < _TOLERANCE * module) & (lengths >= 1) & (lengths <= _MOST_LENGTHS)
        if not fits.any():
            i += 1
            continue
        step = int(np.argmax(fits))
        count, gap = int(lengths[step]), gaps[step]
        share = np.arange(1, count) / count
        places += (x[i] + share * gap).tolist()
        own = count * spacing**2 + (gap - count * module) ** 2
        variances += (share * (1.0 - share) * own).tolist()
        i += step + 1
    return np.array(places), np.array(variances)
