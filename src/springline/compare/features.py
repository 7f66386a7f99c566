"""Lists of features along a pipe: what two inspections have in common to be matched by."""

from __future__ import annotations

from dataclasses import dataclass
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
    """

    chainage: np.ndarray
    kind: np.ndarray
    bearing: np.ndarray
    size: np.ndarray
    extent: tuple[float, float]
    name: str

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

    def until(self, chainage: float) -> FeatureList:
        """Return the part up to `chainage` [m]."""
        part = self.take(self.chainage <= chainage)
        return FeatureList(
            part.chainage,
            part.kind,
            part.bearing,
            part.size,
            (self.extent[0], min(chainage, self.extent[1])),
            self.name,
        )

    def take(self, index: ArrayLike) -> FeatureList:
        """Return the features at `index` (indices or a mask), with the same extent."""
        parts = (self.chainage[index], self.kind[index], self.bearing[index], self.size[index])
        return FeatureList(*parts, self.extent, self.name)


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
            arrays differ in length, or the extent does not hold the features.

    >>> len(feature_list([0.0, 2.5, 5.0], "joint"))
    3
    >>> feature_list([5.0, 2.5], "joint", name="B")
    Traceback (most recent call last):
    springline.errors.InputError: B, feature 2: chainage 2.5 m comes after 5 m; expected chainages that never fall. ...
    """
    x = np.atleast_1d(np.asarray(chainage, dtype=np.float64))
    if x.ndim != 1 or not x.size:
        raise InputError(
            "there is no feature in it",
            where=name,
            expected="at least two features",
            mend="check the column map and which codes are kept",
        )
    kinds = _kinds(kind, x.size, name)
    theta, extent_size = (_column(v, x.size, what, name) for v, what in ((bearing, "bearing"), (size, "size")))
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
    if not (low <= x[0] and x[-1] <= high):
        raise InputError(
            f"the extent {low:g} to {high:g} m does not hold the features at {x[0]:g} to {x[-1]:g} m", where=name
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


def _column(values: ArrayLike, n: int, what: str, name: str, dtype: type = np.float64) -> np.ndarray:
    column = np.atleast_1d(np.asarray(values, dtype=dtype))
    if column.shape not in ((1,), (n,)):
        raise InputError(f"{what} has shape {column.shape}", where=name, expected=f"{n} values, as many as chainages")
    return np.broadcast_to(column, (n,)).copy()
