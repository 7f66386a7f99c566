"""Lists of features along a pipe: what two inspections have in common to be matched by."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError, nearest

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

KINDS = ("joint", "lateral", "bend", "manhole", "defect", "other")
"""Kinds of feature the matcher tells apart; `other` is for what does not fit the rest."""

JOINT, MANHOLE = KINDS.index("joint"), KINDS.index("manhole")


@dataclass(frozen=True)
class FeatureList:
    """Features of one inspection, in the order of travel.

    Attributes:
        chainage: (n,) as the inspection's own counter gives it [m], never falling.
        kind: (n,) index into `KINDS`.
        bearing: (n,) [rad], from +z counter-clockwise to +y, looking along this inspection's travel; NaN = not given.
        size: (n,) along the wall [m]; NaN = not given.
        extent: First and last chainage inspected [m].
        name: What messages call the list.
        repeated: How many entries repeated another and were taken once.
    """

    chainage: np.ndarray
    kind: np.ndarray
    bearing: np.ndarray
    size: np.ndarray
    extent: tuple[float, float]
    name: str
    repeated: int = 0

    def __len__(self) -> int:
        return len(self.chainage)

    @property
    def length(self) -> float:
        """Length inspected [m]."""
        return self.extent[1] - self.extent[0]

    def mirrored(self) -> FeatureList:
        """Return the list as seen driving the other way, over the same extent.

        Chainage y becomes first + last - y, bearing theta becomes pi - theta: left and right change sides.

        >>> a = feature_list([0.0, 10.0, 30.0], "lateral", bearing=[0.0, 0.5, 1.0])
        >>> a.mirrored().chainage.tolist()
        [0.0, 20.0, 30.0]
        """
        back = slice(None, None, -1)
        return FeatureList(
            chainage=(self.extent[0] + self.extent[1]) - self.chainage[back],
            kind=self.kind[back],
            bearing=np.mod(np.pi - self.bearing[back], 2 * np.pi),
            size=self.size[back],
            extent=self.extent,
            name=self.name,
        )

    def between(self, first: float, last: float) -> FeatureList:
        """Return the part from chainage `first` to `last` [m], as far as it was inspected."""
        part = self.take((self.chainage >= first) & (self.chainage <= last))
        return replace(part, extent=(max(self.extent[0], first), min(self.extent[1], last)))

    def take(self, index: ArrayLike) -> FeatureList:
        """Return the features at `index` (indices or a mask), with the same extent."""
        parts = (self.chainage[index], self.kind[index], self.bearing[index], self.size[index])
        return FeatureList(*parts, self.extent, self.name)

    def first_of_each(self) -> np.ndarray:
        """Return the indices (k,) of the features that repeat no earlier one in place, kind, bearing and size.

        >>> feature_list([0.0, 4.0, 4.0, 4.0], ["joint", "joint", "lateral", "joint"]).first_of_each().tolist()
        [0, 1, 2]
        """
        unknown = -1.0  # one that no bearing and no size has, as NaN differs from itself
        table = np.column_stack(
            (self.chainage, self.kind, *(np.nan_to_num(v, nan=unknown) for v in (self.bearing, self.size)))
        )
        return np.sort(np.unique(table, axis=0, return_index=True)[1])

    def once(self) -> FeatureList:
        """Return the list with features that repeat another in place, kind, bearing and size taken once."""
        kept = self.take(self.first_of_each())
        return replace(kept, repeated=len(self) - len(kept))


def feature_list(
    chainage: ArrayLike,
    kind: ArrayLike,
    *,
    bearing: ArrayLike = np.nan,
    size: ArrayLike = np.nan,
    extent: tuple[float, float] | None = None,
    name: str = "feature list",
) -> FeatureList:
    """Return a checked list of features.

    Args:
        chainage: (n,) [m], never falling.
        kind: One of `KINDS` for all, or (n,) of them.
        bearing: (n,) or scalar [rad]; NaN = not given.
        size: (n,) or scalar [m]; NaN = not given.
        extent: First and last chainage inspected [m]; those of the features when not given.
        name: What messages call the list.

    Raises:
        InputError: The list is empty or not in order of chainage, a chainage is not finite, a kind is unknown, the
            arrays differ in length, a bearing or a size is infinite, or the extent does not hold the features.

    >>> len(feature_list([0.0, 2.5, 5.0], "joint"))
    3
    >>> feature_list([5.0, 2.5], "joint", name="B")
    Traceback (most recent call last):
    springline.errors.InputError: B, feature 2: chainage 2.5 m comes after 5 m; expected chainages that never fall. ...
    """
    x = _numbers(chainage, "chainage", name)
    if x.ndim != 1 or not x.size:
        raise InputError(
            "there is no feature in it",
            where=name,
            expected="at least two features",
            mend="check the column map and which codes are kept",
        )
    kinds = _kinds(kind, x.size, name)
    theta, extent_size = (_measured(v, x.size, what, name) for v, what in ((bearing, "bearing"), (size, "size")))
    bad = np.flatnonzero(~np.isfinite(x))
    if bad.size:
        raise InputError(
            "the chainage is missing",
            where=f"{name}, feature {bad[0] + 1}",
            expected="a number in every row",
            mend="leave out features whose place is not known",
        )
    fall = np.flatnonzero(np.diff(x) < 0)
    if fall.size:
        i = int(fall[0]) + 1
        raise InputError(
            f"chainage {x[i]:g} m comes after {x[i - 1]:g} m",
            where=f"{name}, feature {i + 1}",
            expected="chainages that never fall",
            mend="sort the list by chainage; if the counter was reset on the way, split it there",
        )
    low, high = (float(x[0]), float(x[-1])) if extent is None else (float(extent[0]), float(extent[1]))
    if not (-np.inf < low <= x[0] and x[-1] <= high < np.inf):
        raise InputError(
            f"the extent {low:g} to {high:g} m does not hold the features at {x[0]:g} to {x[-1]:g} m",
            where=name,
            expected="the first and the last chainage inspected",
        )
    return FeatureList(x, kinds, np.mod(theta, 2 * np.pi), extent_size, (low, high), name)


def _kinds(kind: ArrayLike, n: int, name: str) -> np.ndarray:
    index = {k: i for i, k in enumerate(KINDS)}
    words = np.atleast_1d(np.asarray(kind, dtype=object))
    for i, word in enumerate(words):
        if word not in index:
            raise InputError(
                f"the kind {word!r} is not known" + nearest(str(word), KINDS),
                where=f"{name}, feature {i + 1}",
                expected="one of " + ", ".join(KINDS),
            )
    return _column([index[word] for word in words], n, "kind", name, dtype=np.int64)


def _numbers(values: ArrayLike, what: str, name: str) -> np.ndarray:
    try:
        return np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        raise InputError(f"{what} holds something else than numbers", where=name, expected="numbers") from None


def _measured(values: ArrayLike, n: int, what: str, name: str) -> np.ndarray:
    column = _column(_numbers(values, what, name), n, what, name)
    if np.isinf(column).any():
        i = int(np.flatnonzero(np.isinf(column))[0])
        raise InputError(
            f"the {what} is infinite",
            where=f"{name}, feature {i + 1}",
            expected="a number, or NaN where it is not known",
        )
    return column


def _column(values: ArrayLike, n: int, what: str, name: str, dtype: type = np.float64) -> np.ndarray:
    column = np.atleast_1d(np.asarray(values, dtype=dtype))
    if column.shape not in ((1,), (n,)):
        raise InputError(f"{what} has shape {column.shape}", where=name, expected=f"{n} values, as many as chainages")
    return np.broadcast_to(column, (n,)).copy()
