"""The module of the joints: a pipe laid of equal lengths has its joints, seen or not, on a lattice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .features import JOINT, FeatureList

_FEWEST_JOINTS = 4
_REGULAR = 0.05
_TOLERANCE = 0.2
_MOST_LENGTHS = 8


def joint_module(features: FeatureList) -> tuple[float, float]:
    """Return the distance between joints [m] and its standard deviation [m]; NaN when too few joints show it.

    The median of the distances is taken for one pipe's length; only distances near it count, so that a missed joint
    (twice the length) or a false one (a part of it) does not.

    >>> from .features import feature_list
    >>> joint_module(feature_list([0.0, 2.0, 4.0, 6.1, 10.1, 12.0], "joint"))[0]
    2.0
    """
    x = features.chainage[features.kind == JOINT]
    if x.size < _FEWEST_JOINTS:
        return np.nan, np.nan
    gaps = np.diff(x)
    module = float(np.median(gaps))
    near = gaps[np.abs(gaps - module) < 0.3 * module]
    if near.size < _FEWEST_JOINTS - 1:
        return np.nan, np.nan
    return module, float(1.4826 * np.median(np.abs(near - np.median(near))))


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
